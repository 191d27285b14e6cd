#!/bin/sh
# Goal: a token of one scope does no more than that scope says.  The script does what an attacker
# with verify or enroll alone did: rebuild an enrolled face from two responses, try faces
# by enrolling them, enrol a stranger by force, mistype what keeps safe.
. tests/box/lib.sh

scan 1 0 "$T/alice.ply"
scan 1 1 "$T/alice2.ply" --pose 8 --shift 10
scan 2 0 "$T/mallory.json" --points 3000
scan 2 0 "$T/mallory.ply"
for i in $(seq 3 10); do scan "$i" 0 "$T/s$i.ply"; done
start_daemon --attempt-wait 1000
verify=$(new_token verify --scope verify)
enroll=$(new_token enroll --scope enroll)
all=$(new_token all)
WATCHER=$all
# no_shape WHAT: the last response has nothing that tells how the template is shaped.
no_shape() {
    is "$1: members" "$(get '[paths | map(strings) | join(".")] | unique | map(select(test(
        "heatmap|transform|alignment|regions|minimal[.]|volume|weight|overlap_mm2|plain_mm"
        ))) | join(" ")')" ""
}
AUTH=$all
gives 201 "alice is enrolled" send POST /v1/subjects/alice/templates "$PLY" "$T/alice.ply"
template=$(get .template_id)

# ---- a face from two heat maps
AUTH=$verify
probe=$T/mallory.json
for round in 1 2; do
    send POST '/v1/subjects/alice/verify?detail=heatmap' "$JSON" "$probe"
    problem "a heat map, round $round" 403 insufficient_scope detail
    ok "no face is rebuilt, round $round" sh -c \
        "! python3 tests/box/rebuild.py '$probe' '$T/body' '$T/rebuilt$round.json'"
    [ ! -f "$T/rebuilt$round.json" ] || probe=$T/rebuilt$round.json
done
# The matching face that the attack ends with.
AUTH=$all
if [ "$probe" != "$T/mallory.json" ]; then
    send POST /v1/subjects/alice/verify "$JSON" "$probe"
    ok "a face was rebuilt: $(get .decision) $(get .score)" false
fi
AUTH=$verify
jq -c -n --slurpfile a "$T/mallory.json" '{a: $a[0], b: $a[0]}' >"$T/two.json"
# Nothing of that in what verify alone is told of a match.
for path in subjects/alice/verify "templates/$template/verify"; do
    send POST "/v1/$path" "$PLY" "$T/alice2.ply"
    is "$path" "$STATUS $(get 'has("score")')" '200 true'
    no_shape "$path"
done
gives 200 "compare" send POST /v1/compare "$JSON" "$T/two.json"
no_shape compare

# ---- a face from the numbers of non-matches: nothing of the template is told
# silent WHAT: of the last response.
silent() {
    is "$1" "$STATUS $(get '[.decision, .template_id, (keys - ["frames"] | join(" ")), (.timing_ms | keys | join(" "))] | @csv')" \
        "200 \"$2\",,\"decision engine quality scan subject template_id timing_ms\",\"parse prepare\""
}
"$BUILD/facegen" --subject 1 --scan 1 --format xyz -o "$T/part.xyz"
awk '$2 < -14' "$T/part.xyz" >"$T/less.xyz"
sees=$(new_token sees --scope verify,audit,read)
knows=$(new_token knows --scope verify,audit,score)
for route in subjects/alice/verify "templates/$template/verify"; do
    AUTH=$sees
    send POST "/v1/$route" "$PLY" "$T/alice2.ply"
    is "$route, a match, in few digits" \
        "$(get '[.decision, .score * 10 == (.score * 10 | round), (.disparity_mm * 1000 - (.disparity_mm * 1000 | round) | fabs) < 1e-9] | @csv')" \
        '"match",true,true'
    few=$(get '[.score, .disparity_mm] | @csv')
    AUTH=$knows
    send POST "/v1/$route" "$PLY" "$T/alice2.ply"
    is "$route, the same with score" "$(get '[(.score * 10 | round) / 10, (.disparity_mm * 1000 | round) / 1000] | @csv')" "$few"
    ok "$route, in more digits" jq_true '.score * 10 != (.score * 10 | round)' "$T/body"
    AUTH=$sees
    send POST "/v1/$route" "$PLY" "$T/mallory.ply"
    silent "$route, another" no_match
    send POST "/v1/$route" 'Content-Type: text/plain' "$T/less.xyz"
    silent "$route, a part" inconclusive
    send POST "/v1/$route" "$PLY" "$T/mallory.ply" -H 'Prefer: return=minimal'
    is "$route, the decision alone" "$STATUS $(get tojson)" \
        '200 {"decision":"no_match","subject":"alice","template_id":null}'
    AUTH=$all
    req DELETE /v1/subjects/alice/attempts
    AUTH=$knows
    send POST "/v1/$route" "$PLY" "$T/mallory.ply"
    is "$route, with score" "$STATUS $(get '[.decision, .score < 0, .disparity_mm > 0, .template_id, (.timing_ms.minimal > 0)] | @csv')" \
        "200 \"no_match\",true,true,\"$template\",true"
    AUTH=$all
    req DELETE /v1/subjects/alice/attempts
done
for token in $sees $knows; do
    AUTH=$token
    req GET /v1/recent
    told=$(get '[.recent[] | select(.outcome == "no_match" or .outcome == "inconclusive") | .score, .threshold, .overlap | values] | length')
    req GET /v1/stats
    told="$told $(get '[.days[] | select(.bins)] | length') $(get '[.days[].n] | add')"
    case $token in
    "$sees") is "nor in what is told of it afterwards" "$told" "0 0 14" ;;
    *) is "but to whom may know" "$told" "24 3 14" ;;
    esac
done
AUTH=$sees
req GET /v1/audit
ok "nor in the log" sh -c "! grep -q score '$T/body'"

# ---- faces tried by enrolling them
AUTH=$enroll
tried=0
for i in $(seq 3 10); do
    send POST /v1/subjects/alice/templates "$PLY" "$T/s$i.ply"
    tried=$((tried + 1))
    if [ "$tried" -le 3 ]; then
        problem "another face, $tried" 409 sample_mismatch 'does not fit'
    else
        problem "another face, $tried" 429 too_many_attempts
        ok "and when again: $(field Retry-After)" test "$(field Retry-After)" -ge 900
    fi
    ok "no score in it" sh -c "! grep -Eq '_mm|score|disparity|[0-9][.][0-9]|decision' '$T/body'"
done
is "each is recorded" "$(sql \
    "SELECT count(*), min(outcome) FROM $ENTRIES WHERE kind = 'enroll_mismatch'")" "3|no_match"
is "and counted" "$(metric 'surfaced_enrollments_total{outcome="mismatch"}')" 3
send POST /v1/subjects/alice/templates "$PLY" "$T/alice2.ply"
problem "the right face has to wait too" 429 too_many_attempts
AUTH=$verify
gives "429 too_many_attempts" "and so do verifications" send POST /v1/subjects/alice/verify "$PLY" "$T/alice2.ply"
AUTH=$enroll
send POST '/v1/subjects/alice/templates?force=true' "$PLY" "$T/mallory.ply"
problem "by force" 403 insufficient_scope 'scope manage'
AUTH=$(new_token manage --scope manage)
send POST '/v1/subjects/alice/templates?force=true' "$PLY" "$T/mallory.ply"
problem "manage alone" 403 insufficient_scope 'scope enroll'
is "alice has one template" "$(sql 'SELECT count(*) FROM templates')" 1
"$BUILD/surfacectl" --db "$DB" attempts reset alice >/dev/null 2>&1
# Many at once are no way round it: a wrong face is told so three times at most.
AUTH=$enroll
for i in $(seq 3 10); do
    for k in 1 2 3; do
        beside "$i.$k" POST /v1/subjects/alice/templates -H "$PLY" --data-binary "@$T/s$i.ply"
    done
done
all_sent
is "of 24 at once" "$TALLY" "409x3 429x21"
"$BUILD/surfacectl" --db "$DB" attempts reset alice >/dev/null 2>&1
AUTH=$(new_token forced --scope enroll,manage)
gives 201 "with both, by force" send POST '/v1/subjects/alice/templates?force=true' "$PLY" "$T/mallory.ply"

# ---- tokens by silence
ctl token create door
is "a token without a scope" $CODE 64
contains "says which there are" "$T/ctl.err" "needs --scope: one or more of $ALL"
is "and is not made" "$(sql "SELECT count(*) FROM tokens WHERE name = 'door'")" 0
ctl_exits 0 token create door --scope verify
is "with the one, for a year" "$(said '[.scopes[], (((.expires_at[:19] + "Z" | fromdate) -
    (.created[:19] + "Z" | fromdate)) / 86400 | round)] | @csv')" '"verify",365'
ctl_exits 0 token create lasting --scope verify --expires never
is "for ever where that is asked for" "$(said .expires_at)" null
finish
