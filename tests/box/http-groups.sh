#!/bin/sh
# Goal: for a token that is bound to groups a subject of other groups does not exist: on every route of
# the API's description it is answered as one that is missing, byte for byte but for its id.  A route
# that is not in the table below fails the test.  Then what such a token may change, which tokens
# exist for it, lists, and a subject that moves between groups meanwhile.
. tests/box/lib.sh

# METHOD PATH, and the status for a subject (template, token) of the token's groups, and for one that is
# missing; "-": the route is about no subject; "all": it needs a scope that no bound token has.
cat >"$T/routes" <<'END'
POST /v1/subjects/{subject}/verify 200 404 scan
POST /v1/templates/{template_id}/verify 200 404 scan
GET /v1/subjects/{subject} 200 404
GET /v1/subjects/{subject}/templates/compare 200 404
PATCH /v1/subjects/{subject} 200 404 change
GET /v1/templates/{template_id} 200 404
GET /v1/templates/{template_id}/surface 200 404
DELETE /v1/subjects/{subject}/attempts 204 404
DELETE /v1/tokens/{token_id}/attempts 204 404
POST /v1/tokens/{token_id}/rotate 200 404 rotate
DELETE /v1/tokens/{token_id} 204 404
POST /v1/subjects/{subject}/templates 422 422 bad
DELETE /v1/templates/{template_id} 204 404
DELETE /v1/subjects/{subject} 200 404
GET /v1/subjects list
POST /v1/subjects new
GET /v1/tokens list
POST /v1/tokens new
GET /v1/token own
POST /v1/identify search
POST /v1/compare -
POST /v1/check -
POST /v1/asymmetry -
POST /v1/challenge -
GET /v1/recent all
GET /v1/events own
GET /v1/audit all
POST /v1/audit/verify all
GET /v1/audit/export all
GET /v1/stats all
GET /healthz -
GET /readyz -
GET /metrics -
GET /openapi.json -
GET / -
GET /docs -
GET /console -
GET /version -
END

BOUND=verify,enroll,identify,read,delete,manage,tokens,events,score,detail
MISSING=ffffffffffffffffffffffffffffffff
MERGE='Content-Type: application/merge-patch+json'

for n in 1 2 3 4; do
    scan "$n" 0 "$T/scan$n.ply" --points 1000
done
scan 1 1 "$T/probe.ply" --points 1000
printf '0 0 0\n90 0 5\n0 90 5\n' >"$T/bad"
echo '{"hold": false}' >"$T/change"
echo '{}' >"$T/rotate"
cp "$T/probe.ply" "$T/scan"
start_daemon --rate-limit-tokens 1000
n=0
for who in p-east:east p-both:west,east p-west:west p-none:; do
    n=$((n + 1))
    ctl_exits 0 enroll "${who%:*}" "$T/scan$n.ply" --group "${who#*:}"
done
admin=$(new_token admin)
east=$(new_token east --scope $BOUND --group east)
both=$(new_token both --scope $BOUND --group west,east,east)
new_token west --scope read --group west >"$T/out"
AUTH=$east
req GET /v1/token
is "its own groups" "$(get '.groups | tojson')" '["east"]'

# ---- every route

# id_of KIND WHO: the id of a subject, of its template, or of a token of the same groups.
id_of() {
    case $1:$2 in
    subject:*) echo "$2" ;;
    *:p-gone) echo $MISSING ;;
    template_id:*) ctl template list "$2" && said '.templates[0].template_id' ;;
    token_id:*) ctl token list && said ".tokens[] | select(.name == \"${2#p-}\") | .id" ;;
    esac
}

# ask METHOD PATH BODY ID: sends the request; $T/answer is the response without the id and the time.
ask() {
    a_path=$(echo "$2" | sed "s/{[a-z_]*}/$4/")
    case ${3:-} in
    change) send "$1" "$a_path" "$MERGE" "$T/$3" -H 'X-Request-Id: same' ;;
    rotate) send "$1" "$a_path" "$JSON" "$T/$3" -H 'X-Request-Id: same' ;;
    ?*) send "$1" "$a_path" "$BYTES" "$T/$3" -H 'X-Request-Id: same' ;;
    *) req "$1" "$a_path" -H 'X-Request-Id: same' ;;
    esac
    { grep -v '^Date:' "$T/head" && cat "$T/body"; } | sed "s/$4/ID/g" >"$T/answer"
}

new_token none --scope read >"$T/out" # one that is not bound is none of its own
req GET /openapi.json
jq -r '.paths | to_entries[] | .key as $p | .value | keys[] | select(. != "parameters")
    | "\(ascii_upcase) \($p)"' "$T/body" | sort >"$T/described"
is "the routes are those of the description" "$(cut -d ' ' -f 1,2 "$T/routes" | sort)" "$(cat "$T/described")"
while read -r verb route inside missing body; do
    case $inside in
    [0-9]*)
        kind=$(echo "$route" | sed 's/.*{\(.*\)}.*/\1/')
        ask "$verb" "$route" "$body" "$(id_of "$kind" p-gone)"
        is "$verb $route: missing" "$STATUS" "$missing"
        cp "$T/answer" "$T/wanted"
        for who in p-west p-none; do
            id=$(id_of "$kind" $who)
            ok "$kind of $who" test -n "$id"
            ask "$verb" "$route" "$body" "$id"
            ok "$verb $route: $who as if it were missing: $(diff "$T/wanted" "$T/answer")" \
                cmp -s "$T/wanted" "$T/answer"
        done
        [ "$kind" = token_id ] || {
            ask "$verb" "$route" "$body" "$(id_of "$kind" p-east)"
            is "$verb $route: inside" "$STATUS" "$inside"
        }
        ;;
    all)
        req "$verb" "$route"
        is "$verb $route" "$STATUS $(get .code)" '403 insufficient_scope'
        ;;
    esac
done <"$T/routes"
is "nobody else's was erased" "$(ctl subject list && said '[.subjects[] | "\(.subject) \(.templates)"] | join(", ")')" \
    'p-both 1, p-west 1, p-none 1'
ctl audit show --limit 1000
is "nothing of others in the log" "$(said '[.entries[] | select(.actor | test("^[0-9a-f]{32}$"))
    | .subject | select(. == "p-west" or . == "p-none")] | length')" 0

# ---- lists

# people QUERY: the subjects of all pages of one, with their groups.
people() {
    cursor=
    while :; do
        req GET "/v1/subjects?limit=1$1${cursor:+&cursor=$cursor}"
        get '.subjects[] | "\(.subject)[\(.groups | join(","))]"'
        cursor=$(get '.next_cursor // ""')
        [ -n "$cursor" ] || break
    done | paste -sd ' '
}

is "a list" "$(people '')" 'p-both[east]'
is "by a group of its own" "$(people '&group=east')" 'p-both[east]'
is "by a group of others" "$(people '&group=west')" ''
AUTH=$both
is "a list of two groups" "$(people '')" 'p-both[east,west] p-west[west]'
AUTH=$admin
is "a list of all" "$(people '')" 'p-both[east,west] p-west[west] p-none[]'
is "by a group" "$(people '&group=west')" 'p-both[east,west] p-west[west]'
is "by a group and a state" "$(people '&group=west&state=disabled')" ''
for group in '' West a,b "$(printf '%065d' 0)"; do
    req GET "/v1/subjects?group=$group"
    is "group=$group" "$STATUS $(get .code)" '400 invalid_parameter'
done

# ---- new subjects

# add JSON: STATUS, code, groups
add() {
    req POST /v1/subjects -H "$JSON" --data-binary "$1"
    ADDED="$STATUS $(get '.code // (.groups | join(","))')"
}
AUTH=$both
add '{"subject": "n1"}'
is "the token's groups" "$ADDED" '201 east,west'
add '{"subject": "n2", "groups": ["west"], "identify": false}'
is "one of them" "$ADDED $(get .identify)" '201 west false'
add '{"subject": "n3", "groups": ["north"]}'
is "another" "$ADDED" '403 forbidden'
add '{"subject": "n3", "groups": ["east", "north"]}'
is "another, too" "$ADDED" '403 forbidden'
add '{"subject": "n3", "groups": null, "identify": null}'
is "null" "$ADDED $(get .identify)" '201 east,west true'
for groups in '"east"' '[1]' '["East"]' '[""]' '["a,b"]' '[null]' '["1","2","3","4","5","6","7","8","9"]'; do
    add "{\"subject\": \"n4\", \"groups\": $groups}"
    is "groups $groups" "$ADDED" '400 malformed'
done
AUTH=$east
add '{"subject": "p-west"}'
is "an id that others have" "$ADDED" '409 exists'
send POST /v1/subjects/p-west/templates "$PLY" "$T/scan4.ply"
is "a template for such an id" "$STATUS $(get .code)" '409 exists'
gives 201 "a subject that is new" send POST /v1/subjects/p-new/templates "$PLY" "$T/scan1.ply"
ctl subject show p-new
is "has the token's groups" "$(said '.groups | tojson')" '["east"]'
gives 200 "a template of one that is there" send POST /v1/subjects/p-both/templates "$PLY" "$T/scan2.ply"
is "no template of others is new" "$(ctl subject show p-west && said '.templates | length')" 1

# ---- changes

# change SUBJECT JSON: status, code, groups that the response has
change() {
    req PATCH "/v1/subjects/$1" -H "$MERGE" --data-binary "$2"
    CHANGED="$STATUS $(get '.code // (.groups | join(","))')"
}
all_of() { ctl subject show "$1" && said '.groups | join(",")'; }
change p-both '{"groups": ["east"]}'
is "its own groups" "$CHANGED" '200 east'
is "those of others stay" "$(all_of p-both)" east,west
for groups in null '[]' '["west"]' '["east","west"]'; do
    for who in p-both p-west p-gone; do
        change $who "{\"groups\": $groups, \"consent\": \"x\"}"
        is "$who: groups $groups" "$CHANGED" '403 forbidden'
    done
done
change p-west '{"groups": ["east"]}'
is "one of others is not taken" "$CHANGED" '404 not_found'
is "nor changed" "$(all_of p-west)" west
is "none of this is half done" "$(ctl subject show p-both && said .consent)" null
AUTH=$both
change p-both '{"groups": ["west"], "identify": false}'
is "from one to another" "$CHANGED $(get .identify)" '200 west false'
AUTH=$east
gives 404 "the next request of the first does not see it" req GET /v1/subjects/p-both
AUTH=$admin
change p-both '{"groups": ["b", "a", "b"], "identify": null}'
is "by a token that is not bound" "$CHANGED $(get .identify)" '200 a,b true'
change p-both '{"groups": null}'
is "none" "$CHANGED" '200 '
ctl audit show --limit 1000
is "in the log" "$(said '[.entries[].kind | select(. == "set_groups" or . == "opt_out" or . == "opt_in")] | group_by(.)
    | map("\(.[0]) \(length)") | join(", ")')" 'opt_in 1, opt_out 2, set_groups 4'

# ---- tokens

# make JSON: status, code, groups
make_token() {
    req POST /v1/tokens -H "$JSON" --data-binary "$1"
    MADE="$STATUS $(get '.code // (.groups | join(","))')"
}
make_token '{"name": "x", "scopes": ["read"], "groups": ["x", "a"]}'
is "a token in groups" "$MADE" '201 a,x'
make_token '{"name": "x", "scopes": ["audit"], "groups": ["x"]}'
is "one with audit" "$MADE" '400 malformed'
AUTH=$both
make_token '{"name": "child", "scopes": ["read"]}'
is "one of a bound one" "$MADE" '201 east,west'
child=$(get .id)
make_token '{"name": "x", "scopes": ["read"], "groups": ["east"]}'
is "of some of its groups" "$MADE" '201 east'
for groups in '["north"]' '["east","north"]'; do
    make_token "{\"name\": \"x\", \"scopes\": [\"read\"], \"groups\": $groups}"
    is "of groups $groups" "$MADE" '403 forbidden'
done
req GET /v1/tokens
is "those that exist for it" "$(get '[.tokens[] | "\(.name)[\(.groups | join(","))]"] | join(" ")')" \
    'east[east] both[east,west] west[west] child[east,west] x[east]'
AUTH=$east
req GET /v1/tokens
is "those that exist for the other" "$(get '[.tokens[] | .name] | join(" ")')" 'east x'
gives 404 "not another's" req DELETE "/v1/tokens/$child"
AUTH=$both
gives 204 "its own" req DELETE "/v1/tokens/$child"
ctl token create y --scope audit,read --group east
ctl_failed "surfacectl with audit" 65 'cannot have the scope audit'

# ---- a subject that comes and goes: each response is of one moment, before or after

AUTH=$admin
rm -f "$T"/[soh].*
for i in $(seq 30); do
    AUTH=$admin beside "to$i" PATCH /v1/subjects/p-both -H "$MERGE" \
        --data-binary "{\"groups\": [\"$([ $((i % 2)) = 0 ] && echo east || echo west)\"]}"
    AUTH=$east beside "get$i" GET /v1/subjects/p-both
    AUTH=$east beside "set$i" PATCH /v1/subjects/p-both -H "$MERGE" --data-binary '{"groups": ["east"]}'
done
all_sent
is "only 200 and 404" "$(cat "$T"/s.* | sort -u | paste -sd ' ')" '200 404'
is "no group of others is seen" "$(cat "$T"/o.get* "$T"/o.set* | jq -r '.groups[]?' | sort -u)" east
is "none is in both" "$(all_of p-both | grep -c ,)" 0
finish
