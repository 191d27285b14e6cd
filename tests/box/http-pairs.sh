#!/bin/sh
# Goal: the templates of a person compared with each other: each pair decides as a comparison of the
# two scans, one of another person is named, a token without score gets no number, one that is bound to
# other groups nothing; and nothing is stored or counted.
. tests/box/lib.sh
start_daemon --workers 2
AUTH=$(new_token all)
all=$AUTH

scan 1 0 "$T/a0.ply"
scan 1 1 "$T/a1.ply"
scan 1 2 "$T/a2.ply"
scan 2 0 "$T/b0.ply"
# add SUBJECT FILE [QUERY]: enrols it.
add() {
    send POST "/v1/subjects/$1/templates${3:-}" "$PLY" "$2"
    is "$1 has $(basename "$2")" "$STATUS" 201
    last=$(get .template_id)
}
pairs() {
    req GET "/v1/subjects/$1/templates/compare"
}

# ---- none, and one
echo '{"subject": "alice", "groups": ["west"]}' >"$T/new.json"
send POST /v1/subjects "$JSON" "$T/new.json"
pairs alice
is "no template" "$STATUS $(get '.templates + .pairs | length')" "200 0"
add alice "$T/a0.ply"
first=$last
pairs alice
is "one template" "$STATUS $(get '[.templates[0].fits, .templates[0].matches, (.pairs | length)] | @csv')" "200 ,0,0"

# ---- three that fit
add alice "$T/a1.ply"
add alice "$T/a2.ply"
pairs alice
is "all fit" "$(get '[.templates[] | .fits, .matches, .compared] | @csv')" "true,2,true,true,2,true,true,2,true"
is "three pairs" "$(get '[.pairs[].decision] | unique[] | .' | paste -sd ' ') $(get '.pairs | length')" "match 3"
is "of the threshold in force" "$(get '.pairs | map(.score >= 8) | all')" true
score=$(get '.pairs[0].score')
curl -sS -o "$T/body" -H "Authorization: Bearer $AUTH" -F "a=@$T/a0.ply" -F "b=@$T/a1.ply" "$URL/v1/compare"
is "a pair has the score of a comparison of both scans" "$score" "$(get .score)"

# ---- one of another person
add alice "$T/b0.ply" '?force=true&label=foreign'
foreign=$last
pairs alice
is "the stranger's alone does not fit" "$(get '[.templates[] | select(.fits == false) | .template_id, .label, .matches] | @csv')" \
    "\"$foreign\",\"foreign\",0"
is "the others still do" "$(get '[.templates[] | select(.fits) | .matches] | @csv')" "2,2,2"
is "six pairs, three do not match" "$(get '[.pairs[] | select(.decision == "no_match")] | length') $(get '.pairs | length')" "3 6"
score=$(get ".pairs[] | select(.b == \"$foreign\" and .a == \"$first\").score")
curl -sS -o "$T/body" -H "Authorization: Bearer $AUTH" -F "a=@$T/a0.ply" -F "b=@$T/b0.ply" "$URL/v1/compare"
is "with the score of a comparison" "$score" "$(get .score)"

# ---- two that do not fit each other: none of them is named alone
add carol "$T/a0.ply"
add carol "$T/b0.ply" '?force=true'
pairs carol
is "neither fits" "$(get '[.templates[].fits] | @csv')" false,false

# ---- 20 of them, one of which is foreign
set --
for i in $(seq 0 18); do
    scan 3 "$i" "$T/many$i.ply"
    set -- "$@" -F "file=@$T/many$i.ply"
done
curl -sS -o "$T/body" -H "Authorization: Bearer $AUTH" "$@" "$URL/v1/subjects/many/templates?fuse=false&force=true"
is "19 are enrolled" "$(get '[.templates[] | select(.template_id != null)] | length')" 19
add many "$T/b0.ply" '?force=true'
pairs many
is "190 pairs" "$STATUS $(get '.pairs | length')" "200 190"
is "the foreign one is named" "$(get '[.templates[] | select(.fits == false).template_id] | @csv')" "\"$last\""

# ---- surfacectl has the same
pairs alice
ctl template list alice --compare
is "surfacectl" "$CODE" 1
jq -S . "$T/body" >"$T/wanted"
jq -S . "$T/ctl" >"$T/got"
ok "says the same" cmp "$T/wanted" "$T/got"
"$BUILD/surfacectl" --db "$DB" template list alice --compare >"$T/text"
ok "as text" grep -q "^$foreign .* 0  foreign  does not fit$" "$T/text"
is "with the pairs that do not match" "$(grep -c "^no_match .* $foreign " "$T/text")" 3

# ---- whoever may not be verified can still be looked at
"$BUILD/surfacectl" --db "$DB" subject disable alice >"$T/ctl" 2>&1
gives 200 "a person who is disabled" pairs alice

# ---- what is kept: an entry for each, nothing else
is "an entry each" "$(sql "SELECT count(*) || ' ' || max(outcome) FROM access_log WHERE kind = 'compare_templates'")" "10 written"
is "no attempt" "$(sql 'SELECT count(*) FROM attempts')" 0
is "no score of a day" "$(sql 'SELECT count(*) FROM days')" 0

# ---- scopes and groups
AUTH=$(new_token reads --scope read)
pairs alice
is "a token that reads gets the decisions" "$STATUS $(get '[.pairs[].decision] | length') $(get '[.templates[] | select(.fits == false)] | length')" "200 6 1"
is "and no score" "$(get '[.pairs[].score] | unique | @csv')" ""
for scope in score detail manage; do
    AUTH=$(new_token "$scope" --scope "read,$scope")
    pairs alice
    is "with $scope there are scores" "$(get '[.pairs[].score | numbers] | length')" 6
done
AUTH=$(new_token doors --scope verify,score,detail,manage)
pairs alice
is "not without read" "$STATUS $(get .code)" "403 insufficient_scope"
AUTH=$(new_token west --scope read,score --group west)
gives 200 "bound to her group" pairs alice
AUTH=$(new_token east --scope read,score --group east)
pairs alice
is "bound to another" "$STATUS $(get .code)" "404 not_found"
AUTH=$all

# ---- erased
req DELETE /v1/subjects/carol
pairs carol
is "erased" "$STATUS $(get .code)" "404 not_found"
finish
