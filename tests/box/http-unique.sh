#!/bin/sh
# Goal: an enrolment with unique=true refuses a new subject whose face another one has: by the threshold of
# an identification, among those whom the token may see, also if both come at once.  It says no more than
# that to a token that may not identify, counts as a search, and is in the audit log as one.
. tests/box/lib.sh

scan 1 0 "$T/a.ply" --points 1500
scan 1 1 "$T/again.ply" --points 1500 --pose 6 --shift 5
scan 2 0 "$T/b.ply" --points 1500
scan 3 0 "$T/c.ply" --points 1500
for n in 4 5 6 7 8 9; do scan $n 0 "$T/s$n.ply" --points 1500; done

start_daemon
narrow=$(new_token narrow --scope enroll)
reader=$(new_token reader --scope enroll,read)
wide=$(new_token wide --scope enroll,read,identify)
east=$(new_token east --scope enroll,read,identify --group east)

# unique TOKEN SUBJECT FILE [QUERY]
unique() {
    AUTH=$1
    send POST "/v1/subjects/$2/templates?unique=true${4-}" "$PLY" "$3"
}

gives 201 "the first" unique "$narrow" alice "$T/a.ply"
gives 201 "another person" unique "$narrow" bob "$T/b.ply"
for token in "$narrow" "$reader"; do
    unique "$token" twin "$T/again.ply"
    problem "the first once more" 409 already_enrolled 'another subject$'
    is "the answer has no more than a problem" "$(get 'keys | join(" ")')" 'code detail request_id status title type'
    is "and names nobody" "$(grep -c alice "$T/body")" 0
done
unique "$wide" twin "$T/again.ply"
problem "to one that may identify and read" 409 already_enrolled 'another subject: alice$'
is "nothing was stored" "$(sql 'SELECT count(*) FROM templates')" 2
gives 201 "a further sample of the subject itself" unique "$wide" alice "$T/again.ply"
AUTH=$wide
gives 201 "without unique nobody is looked for" send POST "/v1/subjects/twin/templates" "$PLY" "$T/again.ply"
unique "$wide" third "$T/again.ply" '&fuse=maybe'
problem "a malformed parameter" 400 invalid_parameter
is "searches and their outcomes are in the audit log" "$(sql "SELECT outcome FROM $ENTRIES WHERE kind = 'identify'
    ORDER BY log, seq" | sed 's/ [0-9.]* of/ of/' | sort | uniq -c | sed 's/^ *//' | paste -sd ';')" \
    '3 match of 2, enroll;1 no_match of 0, enroll;1 no_match of 1, enroll'

# ---- of other groups nothing is learned
gives 201 "for a token of a group the others are not there" unique "$east" hidden "$T/a.ply"
unique "$east" hidden2 "$T/again.ply"
problem "those of its group are" 409 already_enrolled 'another subject: hidden$'

# ---- two at once: one of them
for round in 4 5 6 7; do
    jobs=
    for k in 1 2 3; do
        curl -sS -o /dev/null -w '%{http_code}\n' -H "Authorization: Bearer $wide" -H "$PLY" \
            --data-binary "@$T/s$round.ply" "$URL/v1/subjects/at-once-$round-$k/templates?unique=true" >"$T/code$k" &
        jobs="$jobs $!"
    done
    # shellcheck disable=SC2086 # words
    wait $jobs
    is "three at once, round $round" "$(sort "$T/code1" "$T/code2" "$T/code3" | paste -sd ' ')" '201 409 409'
done
stop_daemon

# ---- the allowance of searches without a match is that of identifications
start_daemon --identify-failures 2
gives 201 "one search" unique "$narrow" new8 "$T/s8.ply"
gives 201 "another one" unique "$narrow" new9 "$T/s9.ply"
gives "429 too_many_searches" "a third one" unique "$narrow" new3 "$T/c.ply"
stop_daemon
start_daemon --gallery-memory 0
gives "503 gallery_unavailable" "nobody can be looked for" unique "$narrow" new3 "$T/c.ply"
stop_daemon

# ---- surfacectl
ctl_exits 65 enroll --unique twin2 "$T/b.ply"
ok "it names the subject" matches "$(said .error.detail)" 'already, as subject bob'
ctl_exits 0 enroll --unique new3 "$T/c.ply"
finish
