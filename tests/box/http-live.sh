#!/bin/sh
# Goal: whoever stands beside a door finds what was decided a moment ago, and why not, and can end a
# lock-out; with the scopes audit and manage alone, and from the daemon's memory alone.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8
scan 2 0 "$T/b.ply"
start_daemon --attempts 2
AUTH=$(new_token me)
req GET /v1/recent
is "nobody yet" "$(get tojson)" '{"last":0,"recent":[]}'
req POST /v1/subjects/alice/templates -H "$PLY" --data-binary "@$T/a.ply"
id=$(get .template_id)
req POST /v1/subjects/alice/verify -H "$PLY" --data-binary "@$T/a2.ply"
score=$(get .score)
req POST "/v1/templates/$id/verify" -H "$PLY" --data-binary "@$T/b.ply"
req POST /v1/subjects/nobody/verify -H "$PLY" --data-binary "@$T/b.ply"
req POST /v1/subjects/alice/verify -H "$PLY" --data-binary "@$T/b.ply"
gives "429 too_many_attempts" "locked out" req POST /v1/subjects/alice/verify -H "$PLY" --data-binary "@$T/a2.ply"
req POST /v1/compare -F "a=@$T/a.ply" -F "b=@$T/b.ply"
req GET /v1/recent
is "what happened" "$(get '[.recent[] | [.seq, .kind, .subject, .outcome, .code] | map(tostring) | join(" ")] | join("; ")')" \
    '1 enroll alice enrolled null; 2 verify alice match null; 3 verify alice no_match null; 4 verify nobody refused not_found; 5 verify alice no_match null; 6 verify alice refused too_many_attempts'
is "by whom" "$(get '[.recent[].token] | unique | join(" ")')" me
is "the score is the response's" "$(get '.recent[1].score')" "$score"
ok "a refusal has its detail" jq_true '.recent[5].detail | test("locked out")' "$T/body"
req GET '/v1/recent?after=4&limit=1'
is "the newest one beyond the fourth" "$(get '[[.recent[].seq], .last] | tojson')" '[[6],6]'
req GET '/v1/recent?after=6'
is "none beyond the last" "$(get tojson)" '{"last":6,"recent":[]}'
gives 204 "the lock-out ends" req DELETE /v1/subjects/alice/attempts
req POST /v1/subjects/alice/verify -H "$PLY" --data-binary "@$T/a2.ply"
is "at once" "$STATUS $(get .decision)" '200 match'
is "and is recorded" "$(sql "SELECT count(*) FROM $ENTRIES WHERE kind LIKE '%attempts%'")" 1
ok "nothing of it is in the log" sh -c "! grep -q alice '$LOG'"
finish
