#!/bin/sh
# Goal: a scan verifies a subject once.  The cloud of a template is refused as a probe, whatever
# the order and number of its points, the format and the unit, over HTTP and by surfacectl; a probe
# that matched is refused for --replay-window, also by another process; a retry with its
# Idempotency-Key gets the response that it had, and is compared anew by another process.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

XYZ='Content-Type: text/plain'

# verify SUBJECT TYPE FILE [CURL-OPTION...]
verify() {
    v_subject=$1
    shift
    send POST "/v1/subjects/$v_subject/verify" "$@"
}

decides() {
    is "$1" "$STATUS $(get .decision)" "200 $2"
}

kept() {
    sqlite3 "$DB" "SELECT count(*) FROM clouds WHERE template_key IS NULL"
}

scan 1 0 "$T/a.ply"
scan 1 0 "$T/a.xyz"
scan 1 1 "$T/a1.ply"
scan 1 1 "$T/a1.xyz"
scan 1 2 "$T/a2.ply"
scan 2 0 "$T/b.ply"
shuf --random-source=/dev/zero "$T/a.xyz" >"$T/shuffled.xyz"
cat "$T/a.xyz" "$T/shuffled.xyz" >"$T/twice.xyz"
awk '{ printf "%s[%s,%s,%s]", NR == 1 ? "{\"points\":[" : ",", $1, $2, $3 } END { print "]}" }' \
    "$T/shuffled.xyz" >"$T/a.json"
awk '{ print $1 / 1000, $2 / 1000, $3 / 1000 }' CONVFMT=%.9g OFMT=%.9g "$T/a.xyz" >"$T/metres.xyz"
gzip -c "$T/a.ply" >"$T/a.ply.gz"
# Each coordinate is moved by 0.2 mm at most.
awk 'BEGIN { srand(1) } function moved(v) { return v + 0.4 * (rand() - 0.5) }
    { printf "%.6f %.6f %.6f\n", moved($1), moved($2), moved($3) }' "$T/a.xyz" >"$T/moved.xyz"
# On its side, so that the face has to be found.
awk '{ print -$2, $1, $3 }' "$T/a1.xyz" >"$T/turned.xyz"
tac "$T/turned.xyz" >"$T/turned-tac.xyz"

# ---- the cloud of a template
start_daemon --no-auth --attempts 0
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
id=$(get .template_id)
send POST /v1/subjects/bob/templates "$XYZ" "$T/turned.xyz"
is "a scan on its side is enrolled" "$STATUS" 201
for i in a.ply shuffled.xyz twice.xyz a.json metres.xyz a.ply.gz; do
    verify alice "$BYTES" "$T/$i"
    problem "$i" 422 replayed 'scan again'
    ok "$i: no disparity" sh -c "! grep -q disparity '$T/body'"
done
verify alice "$XYZ" "$T/turned-tac.xyz"
decides "the scan of another subject's template" match
verify bob "$XYZ" "$T/turned-tac.xyz"
problem "one that is turned, in another order" 422 replayed
send POST "/v1/templates/$id/verify" "$JSON" "$T/a.json"
problem "by template" 422 replayed
# Enrolled again it is the template that is there, also where not all of its points are used.
same() {
    send POST "/v1/subjects/$2/templates" "$BYTES" "$3"
    is "$1 is enrolled again: the same template" "$STATUS $(get .template_id)" "200 $4"
}
for i in a.ply shuffled.xyz twice.xyz a.json metres.xyz a.ply.gz; do
    same "$i" alice "$T/$i" "$id"
done
scan 1 5 "$T/dense.ply" --points 12000
scan 1 5 "$T/dense.xyz" --points 12000
shuf --random-source=/dev/zero "$T/dense.xyz" >"$T/dense-shuffled.xyz"
awk '{ print $1 / 1000, $2 / 1000, $3 / 1000 }' OFMT=%.9g CONVFMT=%.9g "$T/dense.xyz" >"$T/dense-metres.xyz"
send POST /v1/subjects/dan/templates "$BYTES" "$T/dense.ply"
dense=$(get .template_id)
is "a dense scan is enrolled, thinned" "$STATUS $(get '.scan.warnings | tojson')" '201 ["thinned"]'
for i in dense.xyz dense-shuffled.xyz dense-metres.xyz; do
    same "$i" dan "$T/$i" "$dense"
done
req DELETE /v1/subjects/dan
verify alice "$XYZ" "$T/moved.xyz" # what is not found, as docs/threat-model.md says
decides "other points" match
is "they are events" "$(sqlite3 "$DB" "SELECT count(*) FROM events WHERE kind = 'verify' AND outcome = 'replayed'")" 8
is "and counted" "$(metric surfaced_replayed_total)" 8
is "but no decisions" "$(metric 'surfaced_decisions_total{decision="match"}')" 2
ctl verify alice "$T/shuffled.xyz"
is "surfacectl verify" "$CODE $(grep -c 'not a new one' "$T/ctl.err")" "65 1"
ctl verify alice "$T/a1.ply"
is "and another scan" "$CODE" 0
verify alice "$PLY" "$T/a1.ply"
decides "which was not recorded" match
verify alice "$PLY" "$T/a1.ply"
decides "nor without a window" match
is "nothing is kept" "$(kept)" 0
req DELETE /v1/subjects/alice
send POST /v1/subjects/alice/templates "$PLY" "$T/a1.ply"
is "erased and enrolled again" "$STATUS" 201
verify alice "$PLY" "$T/a.ply"
decides "what the template was made of that is gone" match
verify alice "$PLY" "$T/a1.ply"
problem "the new one's" 422 replayed
req DELETE /v1/subjects/alice
req DELETE /v1/subjects/bob
is "nothing is left" "$(sqlite3 "$DB" "SELECT count(*) FROM clouds")" 0
stop_daemon

# ---- it counts as a failure
start_daemon --no-auth
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
for i in 1 2 3; do
    verify alice "$PLY" "$T/a.ply"
    problem "replay $i" 422 replayed
done
verify alice "$PLY" "$T/a1.ply"
problem "then" 429 too_many_attempts
ctl attempts reset alice
stop_daemon

# ---- probes that matched, by two processes
start_daemon --no-auth --attempts 0 --replay-window 1000
first=$PID first_url=$URL
start_daemon --no-auth --attempts 0 --replay-window 1000
second=$PID second_url=$URL
verify alice "$PLY" "$T/a1.ply"
decides "a probe" match
is "it is kept" "$(kept)" 1
verify alice "$XYZ" "$T/a1.xyz"
problem "it comes again" 422 replayed
URL=$first_url
verify alice "$PLY" "$T/a1.ply"
problem "to the other process" 422 replayed
ctl verify alice "$T/a1.ply"
is "by surfacectl" "$CODE" 65
verify alice "$PLY" "$T/b.ply"
decides "another face" no_match
verify alice "$PLY" "$T/b.ply"
decides "which is not kept" no_match
verify alice "$PLY" "$T/a2.ply"
decides "another probe" match
sqlite3 "$DB" "UPDATE clouds SET until_ms = until_ms - 1000001 WHERE template_key IS NULL"
verify alice "$PLY" "$T/a1.ply"
decides "after the window" match
is "what was kept for long enough goes" "$(kept)" 1
: >"$T/urls"
sqlite3 "$DB" "DELETE FROM clouds WHERE template_key IS NULL"
for i in 1 2 3 4 5 6; do
    url=$first_url
    [ $((i % 2)) -eq 0 ] || url=$second_url
    printf 'next\nurl = "%s/v1/subjects/alice/verify"\nheader = "%s"\ndata-binary = "@%s"\nwrite-out = "%%{http_code}\\n"\noutput = "%s"\n' \
        "$url" "$PLY" "$T/a2.ply" "$T/many.$i" >>"$T/urls"
done
sed -i 1d "$T/urls"
curl -sS -m 120 --parallel --parallel-max 6 -K "$T/urls" >"$T/codes" 2>"$T/curl"
is "one of six at once" "$(sort "$T/codes" | uniq -c | tr -s ' ' | tr '\n' ';')" ' 1 200; 5 422;'

# ---- a retry
sqlite3 "$DB" "DELETE FROM clouds WHERE template_key IS NULL"
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: one'
decides "with a key" match
cp "$T/body" "$T/before"
uses=$(sqlite3 "$DB" "SELECT count(*) FROM events")
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: one'
decides "the retry" match
is "it is the same response" "$(cmp "$T/body" "$T/before" && echo same)" same
is "and said so" "$(field Idempotent-Replayed)" true
is "without an event" "$(sqlite3 "$DB" "SELECT count(*) FROM events")" "$uses"
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: two'
problem "another key" 422 replayed
verify alice "$PLY" "$T/a2.ply" -H 'Idempotency-Key: one'
problem "the key with another scan" 422 idempotency_key_reused
id=$(sqlite3 "$DB" "SELECT id FROM templates")
send POST "/v1/templates/$id/verify" "$PLY" "$T/a2.ply" -H 'Idempotency-Key: three'
decides "by template" match
send POST "/v1/templates/$id/verify" "$PLY" "$T/a2.ply" -H 'Idempotency-Key: three'
decides "the retry" match
for i in 1 2 3; do
    verify alice "$PLY" "$T/b.ply" -H 'Idempotency-Key: four'
    decides "a failure, try $i" no_match
done
is "it is one event" "$(sqlite3 "$DB" "SELECT count(*) FROM events WHERE outcome = 'no_match'")" 3
# Who may not be verified by now does not match again.
for state in disable expire; do
    case $state in
    disable) ctl subject disable alice ;;
    *) ctl subject set alice --expires 2020-01-01 ;;
    esac
    for path in subjects/alice "templates/$id"; do
        key=one file=$T/a1.ply
        [ "$path" = subjects/alice ] || key=three file=$T/a2.ply
        send POST "/v1/$path/verify" "$PLY" "$file" -H "Idempotency-Key: $key"
        ok "a retry after $state, $path: $STATUS $(get .code)" matches "$STATUS $(get .code)" "^403 subject_$state"
        is "which is no response from before" "$(field Idempotent-Replayed)" ''
    done
    ctl subject enable alice
    ctl subject set alice --expires never
done
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: one'
decides "a retry when alice may again" match
is "is the response from before" "$(cmp "$T/body" "$T/before" && echo same)" same
# Where nobody has that response any more a retry is compared anew, once.
URL=$second_url
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: two'
problem "another key, to the other process" 422 replayed
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: one'
decides "the retry, to the other process" match
is "which is no response from before" "$(field Idempotent-Replayed)" ''
PID=$second
stop_daemon
start_daemon --no-auth --attempts 0 --replay-window 1000
second=$PID second_url=$URL
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: one'
problem "once more, after a restart" 422 replayed
send POST "/v1/templates/$id/verify" "$PLY" "$T/a2.ply" -H 'Idempotency-Key: three'
decides "the retry of the other scan" match
URL=$first_url
# Erased by another process: the response is gone too.
ctl subject erase --yes alice
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: one'
problem "after the subject was erased" 404 not_found
send POST "/v1/templates/$id/verify" "$PLY" "$T/a2.ply" -H 'Idempotency-Key: three'
problem "by template" 404 not_found
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
verify alice "$PLY" "$T/a1.ply" -H 'Idempotency-Key: one'
problem "and enrolled again" 404 not_found
verify alice "$PLY" "$T/a1.ply"
decides "without the key" match
PID=$second
stop_daemon
PID=$first
finish
