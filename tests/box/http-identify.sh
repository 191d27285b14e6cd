#!/bin/sh
# Goal: POST /v1/identify names a person by another scan, with the numbers of a verification, and nobody who may not
# be found; what one process changes the next search of another one knows; without a match a narrow token learns
# nothing; searches are recorded and limited.
. tests/box/lib.sh

PEOPLE=12
for n in $(seq 1 $PEOPLE); do
    scan "$n" 0 "$T/e$n.ply"
    [ "$n" -gt 4 ] || scan "$n" 1 "$T/p$n.ply" --pose 10 --shift 10
done
scan 99 0 "$T/stranger.ply"
scan 98 0 "$T/other.ply"
ctl_exits 0 init
for n in $(seq 2 $PEOPLE); do ctl_exits 0 enroll "s$n" "$T/e$n.ply"; done
start_daemon
all=$(new_token all)
AUTH=$all

# who FILE [QUERY]: identifies a scan; prints status, decision and subject.
who() {
    send POST "/v1/identify${2:-}" "$PLY" "$1"
    echo "$STATUS $(get '.decision, .subject' | tr '\n' ' ')"
}

# entries KIND: the newest such entry of the access log: subject and outcome.
entries() {
    ctl audit show --kind "$1" --limit 1
    said '.entries[0] | "\(.subject) \(.outcome)"'
}

# ---- a match, and the numbers of a verification
is "a person" "$(who "$T/p2.ply" '?candidates=50')" '200 match s2 '
is "how many" "$(get '.searched, .skipped, .compared, (.candidates | length)' | tr '\n' ' ')" '11 0 11 11 '
cp "$T/body" "$T/list"
matches "$(entries identify)" '^s2 match [0-9.]+ of 11$' || ok "recorded: $(entries identify)" false
matches "$(entries candidate)" '^s[0-9]+ -?[0-9.]+ of 11$' || ok "each candidate: $(entries candidate)" false
is "an entry each" "$(ctl audit show --kind candidate; said '.entries | length')" 11
ok "the best first" jq_true '.candidates | map(.score) | . == (sort | reverse)' "$T/list"
for s in $(jq -r '.candidates[:4][].subject' "$T/list"); do
    send POST "/v1/subjects/$s/verify" "$PLY" "$T/p2.ply"
    is "$s as verified" "$(jq -c --arg s "$s" '.candidates[] | select(.subject == $s)
        | [.subject, .template_id, .score, .fmr_at_score]' "$T/list")" \
        "$(jq -c '[.subject, .template_id, .score, .fmr_at_score]' "$T/body")"
done
is "a stranger" "$(who "$T/stranger.ply")" '200 no_match null '
is "recorded" "$(entries identify)" 'null no_match of 11'
is "the minimum" "$(send POST /v1/identify "$PLY" "$T/p3.ply" -H 'Prefer: return=minimal'; get 'keys | join(" ")')" \
    'decision subject template_id'
is "a template's own cloud" "$(who "$T/e2.ply")" '422 null null '
is "is no new scan" "$(get .code)" replayed
send POST /v1/identify 'Content-Type: multipart/form-data' /dev/null -F "file=@$T/p2.ply" -F "file=@$T/p2.ply"
req POST /v1/identify -F "file=@$T/p2.ply" -F "file=@$T/p2.ply"
is "frames of one session" "$STATUS $(get .subject) $(get '.frames | length')" '200 s2 2'

# ---- nobody who may not be found; by another process, from the next search on
is "not enrolled" "$(who "$T/p1.ply")" '200 no_match null '
for round in 1 2 3 4 5; do
    ctl_exits 0 enroll s1 "$T/e1.ply"
    is "enrolled, $round" "$(who "$T/p1.ply")" '200 match s1 '
    case $round in
    1) ctl_exits 0 --yes subject erase s1 ;;
    2) ctl_exits 0 subject disable s1 ;;
    3) ctl_exits 0 --yes template delete "$(get .template_id)" ;;
    4) ctl_exits 0 subject set s1 --identify no ;;
    5) ctl_exits 0 subject set s1 --expires "$(date -u -d '+6 sec' +%FT%TZ)" && sleep 6.1 ;;
    esac
    is "gone, $round" "$(who "$T/p1.ply" '?candidates=50')" '200 no_match null '
    ok "and not listed" jq_true '.candidates | map(.subject) | index("s1") == null' "$T/body"
    case $round in
    2) ctl_exits 0 subject enable s1 && is "again, $round" "$(who "$T/p1.ply")" '200 match s1 ' ;;
    4) ctl_exits 0 verify s1 "$T/p1.ply" && ctl_exits 0 subject set s1 --identify yes &&
        is "again, $round" "$(who "$T/p1.ply")" '200 match s1 ' ;;
    5) ctl_exits 0 --yes subject erase s1 ;;
    *) ctl subject erase s1 --yes ;;
    esac
done

# ---- twenty templates of one do not hide another
for n in $(seq 1 20); do
    scan 3 "$n" "$T/more.ply" --pose 6
    send POST /v1/subjects/s3/templates "$PLY" "$T/more.ply"
done
is "of twenty" "$(who "$T/p3.ply" '?candidates=50')" '200 match s3 '
ok "each once" jq_true '.candidates | map(.subject) | length == 11 and (unique | length == 11)' "$T/body"
is "another" "$(who "$T/p2.ply")" '200 match s2 '

# ---- groups
ctl_exits 0 subject set s2 --group door-1
ctl_exits 0 subject set s3 --group door-1,door-2
is "in the group" "$(who "$T/p2.ply" '?group=door-1') $(get .searched)" '200 match s2  2'
is "recorded" "$(entries identify | sed 's/ [0-9.]* of/ of/')" 's2 match of 2 door-1'
is "in none" "$(who "$T/p2.ply" '?group=none') $(get .searched)" '200 no_match null  0'
is "no group" "$(who "$T/p2.ply" '?group=A%20b')" '400 null null '
AUTH=$(new_token bound --scope identify --group door-2)
is "a token of another group" "$(who "$T/p2.ply") $(get .searched)" '200 no_match null  1'
is "of its own" "$(who "$T/p3.ply")" '200 match s3 '
is "of a group that is not its own" "$(who "$T/p2.ply" '?group=door-1')" '403 null null '

# ---- a narrow token
AUTH=$(new_token narrow --scope identify)
is "a match" "$(who "$T/p2.ply")" '200 match s2 '
ok "with 1 decimal" jq_true '.score * 10 | . == round' "$T/body"
is "no names" "$(who "$T/p2.ply" '?candidates=1') $(get .code)" '403 null null  insufficient_scope'
for probe in stranger other p1; do
    who "$T/$probe.ply" >"$T/said"
    is "$probe: nothing" "$(get 'keys | join(" ")')" \
        'decision engine quality scan searched subject template_id timing_ms'
    is "$probe: nor by the times" "$(get '.timing_ms | keys | join(" ")')" 'parse prepare'
    is "$probe" "$(cat "$T/said")" '200 no_match null '
done
AUTH=$(new_token verifier --scope verify,read)
is "without the scope" "$(who "$T/p2.ply")" '403 null null '
stop_daemon

# ---- how often
start_daemon --identify-failures 2
AUTH=$all
for n in 1 2; do is "without a match, $n" "$(who "$T/stranger.ply")" '200 no_match null '; done
is "then no more" "$(who "$T/stranger.ply") $(get .code)" '429 null null  too_many_searches'
ok "but later" test "$(field Retry-After)" -gt 1000
is "not even a match" "$(who "$T/p2.ply")" '429 null null '
AUTH=$(new_token another)
is "another token" "$(who "$T/p2.ply")" '200 match s2 '
stop_daemon

# ---- memory
start_daemon --gallery-memory 0
AUTH=$all
is "off" "$(who "$T/p2.ply") $(get .code)" '503 null null  gallery_unavailable'
stop_daemon
start_daemon --gallery-memory 100K
ok "the log says it" soon grep -q 'level=error msg="nobody can be identified" reason="the descriptors' "$LOG"
is "too small" "$(who "$T/p2.ply") $(get .code)" '503 null null  gallery_unavailable'
send POST /v1/subjects/s2/verify "$PLY" "$T/p2.ply"
is "verifications go on" "$STATUS $(get .decision)" '200 match'
gives 200 "and it is ready" req GET /readyz
stop_daemon

# ---- templates of another engine may be anybody's
awk '/^change/ { on = 0 } on { for (i = 1; i <= NF; i++) if ($i != ".") $i += 1500 } /^mean/ { on = 1 } { print }' \
    core/face/default.model >"$T/raised.model"
ctl_exits 0 enroll s1 "$T/e1.ply" --axes scanner --model "$T/raised.model"
start_daemon
is "skipped" "$(who "$T/p1.ply") $(get '.skipped, .searched' | tr '\n' ' ')" '200 inconclusive null  1 11 '
is "others" "$(who "$T/p2.ply")" '200 match s2 '
ctl_exits 0 template reencode
is "re-encoded" "$(who "$T/p1.ply") $(get '.skipped, .searched' | tr '\n' ' ')" '200 match s1  0 12 '
stop_daemon

# ---- two daemons: what one changes the other knows with its next request
mkdir "$T/people"
for n in 0 1 2 3 4 5; do
    scan $((40 + n)) 0 "$T/people/e$n.ply"
    scan $((40 + n)) 1 "$T/people/p$n.ply" --pose 6
done
start_daemon --no-auth --attempts 0 --identify-failures 0
one=$PID one_url=$URL
start_daemon --no-auth --attempts 0 --identify-failures 0
ok "100 rounds" python3 tests/box/rounds.py 100 1 "$T/people" "$one_url" "$URL"
stop_daemon
PID=$one
finish
