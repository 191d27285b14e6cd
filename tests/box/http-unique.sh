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

unique "$narrow" alice "$T/a.ply"
is "the first" "$STATUS" 201
unique "$narrow" bob "$T/b.ply"
is "another person" "$STATUS" 201
for token in "$narrow" "$reader"; do
    unique "$token" twin "$T/again.ply"
    problem "the first once more" 409 already_enrolled 'another subject$'
    is "the answer has no more than a problem" "$(get 'keys | join(" ")')" 'code detail request_id status title type'
    is "and names nobody" "$(grep -c alice "$T/body")" 0
done
unique "$wide" twin "$T/again.ply"
problem "to one that may identify and read" 409 already_enrolled 'another subject: alice$'
is "nothing was stored" "$(sql 'SELECT count(*) FROM templates')" 2
unique "$wide" alice "$T/again.ply"
is "a further sample of the subject itself" "$STATUS" 201
AUTH=$wide
send POST "/v1/subjects/twin/templates" "$PLY" "$T/again.ply"
is "without unique nobody is looked for" "$STATUS" 201
unique "$wide" third "$T/again.ply" '&fuse=maybe'
problem "a malformed parameter" 400 invalid_parameter
is "searches and their outcomes are in the audit log" "$(sql "SELECT outcome FROM $ENTRIES WHERE kind = 'identify'
    ORDER BY log, seq" | sed 's/ [0-9.]* of/ of/' | sort | uniq -c | sed 's/^ *//' | paste -sd ';')" \
    '3 match of 2, enroll;1 no_match of 0, enroll;1 no_match of 1, enroll'

# ---- of other groups nothing is learned
unique "$east" hidden "$T/a.ply"
is "for a token of a group the others are not there" "$STATUS" 201
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
unique "$narrow" new8 "$T/s8.ply"
is "one search" "$STATUS" 201
unique "$narrow" new9 "$T/s9.ply"
is "another one" "$STATUS" 201
unique "$narrow" new3 "$T/c.ply"
problem "a third one" 429 too_many_searches
stop_daemon
start_daemon --gallery-memory 0
unique "$narrow" new3 "$T/c.ply"
problem "nobody can be looked for" 503 gallery_unavailable
stop_daemon

# ---- surfacectl
ctl_exits 65 enroll --unique twin2 "$T/b.ply"
ok "it names the subject" matches "$(said .error.detail)" 'already, as subject bob'
ctl_exits 0 enroll --unique new3 "$T/c.ply"
finish
