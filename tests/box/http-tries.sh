#!/bin/sh
# Goal: who tries faces by `verify` alone does not get far, keeps nobody else out, and is seen: a
# token that fails locks itself out of a subject and others for a minute at most; the failures of
# several tokens add up; one face is not tried on everybody; attempts between the matches of the right
# person are told; the counts hold across processes and restarts.
. tests/box/lib.sh

# verify TOKEN SUBJECT FILE
verify() {
    AUTH=$1
    send POST "/v1/subjects/$2/verify" "$PLY" "$3"
}

# decides TITLE DECISION [TOKEN SUBJECT FILE]: the last verification, or this one, gives it.
decides() {
    [ $# -eq 2 ] || verify "$3" "$4" "$5"
    is "$1" "$STATUS $(get .decision)" "200 $2"
}

# locked_out TITLE CODE LEAST MOST [TOKEN SUBJECT FILE]: refused, with so many seconds to wait.
locked_out() {
    [ $# -eq 4 ] || verify "$5" "$6" "$7"
    problem "$1" 429 "$2"
    again "$1" "$3" "$4"
    ok "$1: no disparity" sh -c "! grep -q disparity '$T/body'"
}

events() {
    sql "SELECT count(*) FROM $ENTRIES WHERE kind = '$1'"
}

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a1.ply"
scan 2 0 "$T/b.ply"
"$BUILD/surfacectl" --db "$DB" init >"$T/ctl"
for i in alice bob carol dave erin frank; do
    "$BUILD/surfacectl" --db "$DB" enroll "$i" "$T/a.ply" >"$T/ctl"
done
thief=$(new_token thief --scope verify)
door=$(new_token door --scope verify)
reader=$(new_token reader --scope read)
WATCHER=$(new_token watcher --scope audit)
start_daemon --attempt-wait 1000 --attempt-subjects 4
thief_id=$(sql "SELECT id FROM tokens WHERE name = 'thief'")

# ---- three bad scans keep nobody else out
for i in 1 2 3; do
    decides "failure $i" no_match "$thief" alice "$T/b.ply"
done
locked_out "who failed" too_many_attempts 900 1000 "$thief" alice "$T/a1.ply"
locked_out "another token" too_many_attempts 1 60 "$door" alice "$T/a1.ply"
is "a lock-out is an event" "$(events locked_out)" 1
AUTH=$reader
req GET '/v1/subjects?state=locked'
is "who is locked out is listed" "$(get '[.subjects[].subject] | join(" ")')" alice
until=$(get '.subjects[0].locked_until')
req GET /v1/subjects/alice
is "until when" "$(get .attempts.locked_until | cut -c1-19)" "$(echo "$until" | cut -c1-19)"
req GET '/v1/subjects?q=bob'
is "who is not" "$(get '.subjects[0].locked_until')" null
ok "and a line in the log" grep -q 'level=warn .*locked out.*token='"$thief_id" "$LOG"
is "and counted" "$(metric 'surfaced_attempt_warnings_total{kind="locked_out"}')" 1
is "what was refused too" "$(metric 'surfaced_attempts_refused_total{reason="token"}')" 1
is "for others" "$(metric 'surfaced_attempts_refused_total{reason="others"}')" 1
sql "UPDATE attempts SET at_ms = at_ms - 61000"
decides "another token a minute later" match "$door" alice "$T/a1.ply"
locked_out "not who failed" too_many_attempts 900 939 "$thief" alice "$T/a1.ply"
ctl attempts list
is "surfacectl attempts list" "$(jq -c '.attempts | map([.subject, .token, .failures])' "$T/ctl")" \
    "[[\"alice\",\"$thief_id\",3]]"

# ---- one face on everybody
for i in bob carol dave; do
    decides "$i" no_match "$thief" "$i" "$T/b.ply"
done
locked_out "the fifth subject" too_many_subjects 860 900 "$thief" erin "$T/a1.ply"
decides "one of the four, again" no_match "$thief" bob "$T/b.ply"
decides "another token" match "$door" erin "$T/a1.ply"
is "it was told at two of four, and at four" "$(events many_subjects)" 2
is "as a metric" "$(metric 'surfaced_attempt_warnings_total{kind="many_subjects"}')" 2
is "what was refused" "$(metric 'surfaced_attempts_refused_total{reason="subjects"}')" 1
ok "and in the log" grep -q 'level=warn .*tried many subjects.*token='"$thief_id" "$LOG"

# ---- another process on the same database, and a restart
first=$PID first_url=$URL
start_daemon --attempt-wait 1000 --attempt-subjects 4
locked_out "another process" too_many_subjects 860 900 "$thief" erin "$T/a1.ply"
locked_out "and for the subject" too_many_attempts 900 939 "$thief" alice "$T/a1.ply"
stop_daemon
PID=$first URL=$first_url
decides "a match" match "$thief" bob "$T/a1.ply"
decides "it makes room for another subject" no_match "$thief" frank "$T/b.ply"
gives "429 too_many_subjects" "for one" verify "$thief" erin "$T/a1.ply"

# ---- an operator ends it
ctl attempts list
is "the list has the token, and at how many it failed" "$(said '[.tokens[] | [.token, .subjects]] | tojson')" "[[\"$thief_id\",4]]"
AUTH=$door
req DELETE "/v1/tokens/$thief_id/attempts"
problem "by nobody else" 403 insufficient_scope manage
AUTH=$(new_token guard --scope manage)
gives 204 "the token's lock-out is ended" req DELETE "/v1/tokens/$thief_id/attempts"
decides "it goes on" no_match "$thief" erin "$T/b.ply"
for i in alice carol dave; do verify "$thief" "$i" "$T/b.ply"; done
gives "429 too_many_subjects" "until the next" verify "$thief" frank "$T/a1.ply"
ctl_exits 0 attempts reset --token "$thief_id"
decides "by the command too" match "$thief" frank "$T/a1.ply"
is "both are recorded" "$(sql "SELECT count(*) FROM $ENTRIES WHERE kind = 'reset_attempts'")" 2
ctl_exits 64 attempts reset
ctl_exits 64 attempts reset alice --token "$thief_id"
ctl_exits 66 attempts reset --token 0123456789abcdef0123456789abcdef
AUTH=

# ---- many at once are no way round it
sql "DELETE FROM attempts"
AUTH=$thief
for i in alice bob carol dave erin frank; do
    beside "$i" POST "/v1/subjects/$i/verify" -H "$PLY" --data-binary "@$T/b.ply"
done
all_sent
is "6 subjects at once" "$TALLY" "200x4 429x2"

# ---- by enrolments too, with verifications
sql "DELETE FROM attempts"
before=$(events many_subjects) warned=$(metric 'surfaced_attempt_warnings_total{kind="many_subjects"}')
both=$(new_token both --scope verify,enroll)
AUTH=$both
gives "409 sample_mismatch" "enrolled in vain: alice" send POST /v1/subjects/alice/templates "$PLY" "$T/b.ply"
is "one subject is not yet many" "$(events many_subjects)" "$before"
gives "409 sample_mismatch" "bob" send POST /v1/subjects/bob/templates "$PLY" "$T/b.ply"
is "two of four are" "$(events many_subjects)" $((before + 1))
is "as a metric" "$(metric 'surfaced_attempt_warnings_total{kind="many_subjects"}')" $((warned + 1))
decides "verified in vain: carol" no_match "$both" carol "$T/b.ply"
AUTH=$both
gives "409 sample_mismatch" "enrolled in vain: dave" send POST /v1/subjects/dave/templates "$PLY" "$T/b.ply"
send POST /v1/subjects/erin/templates "$PLY" "$T/b.ply"
locked_out "an enrolment of the fifth subject" too_many_subjects 860 900
locked_out "a verification of it" too_many_subjects 860 900 "$both" erin "$T/a1.ply"
is "erin has one template" "$("$BUILD/surfacectl" --db "$DB" --json subject show erin 2>"$T/ctl" | jq '.templates | length')" 1

# ---- with the token, and with the subject, it goes
ctl subject erase --yes alice
ctl subject erase --yes bob
ctl subject erase --yes carol
ctl subject erase --yes dave
ok "with the subjects" test "$(sql "SELECT count(*) FROM attempts")" -le 2
ctl token revoke "$thief_id"
is "with the token" "$(sql "SELECT count(*) FROM attempts WHERE token = '$thief_id'")" 0
stop_daemon

# ---- the failures of several tokens add up
sql "DELETE FROM attempts"
start_daemon
before=$(events locked_out)
for i in 1 2 3 4 5 6 7; do new_token "key$i" --scope verify >"$T/key$i"; done
for i in 1 1 2; do
    is "no lock-out yet" "$(events locked_out)" "$before"
    decides "key $i" no_match "$(cat "$T/key$i")" frank "$T/b.ply"
done
is "the third failure is one" "$(events locked_out)" $((before + 1))
for i in 1 2 3 4 5 6 7; do
    locked_out "key $i waits too" too_many_attempts 25 30 "$(cat "$T/key$i")" frank "$T/b.ply"
done
sql "UPDATE attempts SET at_ms = at_ms - 31000"
decides "key 2, then" no_match "$(cat "$T/key2")" frank "$T/b.ply"
locked_out "and twice as long" too_many_attempts 55 60 "$(cat "$T/key2")" frank "$T/b.ply"

# ---- two attempts between two matches, by the token of a door
sql "DELETE FROM attempts"
before=$(events attempts_pattern) rounds=0
while [ "$(events attempts_pattern)" = "$before" ] && [ "$rounds" -lt 20 ]; do
    rounds=$((rounds + 1))
    [ "$rounds" != 4 ] || {
        stop_daemon
        start_daemon
    }
    for i in 1 2; do
        decides "round $rounds, attempt $i" no_match "$door" frank "$T/b.ply"
    done
    sql "UPDATE attempts SET at_ms = at_ms - 700000"
    decides "round $rounds, the right person" match "$door" frank "$T/a1.ply"
done
is "it is told after" "$rounds rounds" "8 rounds"
is "counted" "$(metric 'surfaced_attempt_warnings_total{kind="attempts_pattern"}')" 1
ok "in the log" grep -q 'level=warn .*fail again and again.*token=' "$LOG"
verify "$door" frank "$T/b.ply"
is "and once" "$(events attempts_pattern)" $((before + 1))
AUTH=$(new_token auditor --scope audit)
req GET "/v1/audit?kind=attempts_pattern"
is "in the audit log" "$(get '[.entries[] | .subject, .actor_name, .outcome] | join(", ")')" \
    "frank, door, failures between matches"
AUTH=
ctl attempts list
is "a row without failures is in no list" "$(said '[.attempts[] | .failures] | tojson')" "[1]"
finish
