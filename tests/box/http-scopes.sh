#!/bin/sh
# Goal: what each scope alone may do, on every route of the API's description.  A route that is not
# in the table below fails the test, and so does one that the description does not have.  Then what
# every error of every route looks like, and what a stranger is told of the daemon.  On a server only what
# is allowed: the rest is refused before a statement is run.
. tests/box/lib.sh

# METHOD PATH, and the scopes of which a token needs one; "-": none is needed.
cat >"$T/matrix" <<'END'
POST /v1/subjects/{subject}/templates enroll
POST /v1/subjects/{subject}/verify verify
POST /v1/templates/{template_id}/verify verify
POST /v1/compare verify
POST /v1/identify identify
POST /v1/check verify,enroll,identify
POST /v1/asymmetry verify
POST /v1/challenge verify,enroll
GET /v1/subjects read
POST /v1/subjects enroll
GET /v1/subjects/{subject} read
GET /v1/subjects/{subject}/templates/compare read
PATCH /v1/subjects/{subject} manage
DELETE /v1/subjects/{subject} delete
GET /v1/templates/{template_id} read
DELETE /v1/templates/{template_id} delete
GET /v1/templates/{template_id}/surface detail
GET /v1/token verify,enroll,identify,read,delete,manage,tokens,audit,events,score,detail
GET /v1/recent audit
GET /v1/events events
DELETE /v1/subjects/{subject}/attempts manage
DELETE /v1/tokens/{token_id}/attempts manage
GET /v1/audit audit
POST /v1/audit/verify audit
GET /v1/audit/export audit
GET /v1/tokens tokens
POST /v1/tokens tokens
DELETE /v1/tokens/{token_id} tokens
POST /v1/tokens/{token_id}/rotate tokens
GET /v1/stats audit
GET / -
GET /healthz -
GET /readyz -
GET /metrics -,audit
GET /openapi.json -
GET /docs -
GET /console -
GET /version -
END
scan 1 0 "$T/a.ply"
scan 1 1 "$T/p.ply"
"$BUILD/facegen" --subject 1 --points 1000 --format json >"$T/c.json"
jq -c '{a: ., b: .}' "$T/c.json" >"$T/two.json"
echo '{"subject": "bob"}' >"$T/new.json"
echo '{"hold": false}' >"$T/change.json"
echo '{"name": "x", "scopes": ["tokens"]}' >"$T/token.json"
echo '{"grace_s": 1}' >"$T/rotate.json"
start_daemon --workers 3 --queue 77 --max-body 7654321 --attempts 19 \
    --attempt-wait 71 --timeout 43 --max-connections 911 --rate-limit-tokens 1000

curl -sS -o "$T/api" "$URL/openapi.json"
jq -r '.paths | to_entries[] | .key as $p | .value | to_entries[] | select(.key != "parameters")
    | "\(.key | ascii_upcase) \($p) \(.value.security | if . == [] then "-"
        else [.[] | .token // ["-"] | .[]] | join(",") end)"' "$T/api" | sort >"$T/described"
is "routes and their scopes, as described" "$(cat "$T/described")" "$(sort "$T/matrix")"
is "no other in the table of the program" "$(grep -c '{REQUEST_' server/api/routes.c)" \
    "$(($(wc -l <"$T/matrix") + 3))" # and the two files of /docs, and those of /console

# enrolled: alice has a template, whose id is $template; bob is nobody; there is a token that only
# manages, whose id is $token.
enrolled() {
    if [ -z "$token" ]; then
        new_token other --scope tokens >"$T/other"
        token=$(sql "SELECT id FROM tokens WHERE name = 'other' AND revoked IS NULL")
    fi
    [ -z "$template" ] || return
    e_auth=$AUTH AUTH=$all
    req DELETE /v1/subjects/bob
    send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
    template=$(get .template_id)
    AUTH=$e_auth
}

# try METHOD PATH [QUERY]: a request that succeeds with every scope, once enrolled.
try() {
    t_path=$(echo "$2" | sed "s/{subject}/alice/; s/{template_id}/$template/; s/{token_id}/$token/")${3:-}
    case $1.$2 in
    POST.*/compare) send POST "$t_path" "$JSON" "$T/two.json" ;;
    POST./v1/subjects) send POST "$t_path" "$JSON" "$T/new.json" ;;
    POST./v1/tokens) send POST "$t_path" "$JSON" "$T/token.json" ;;
    POST.*/rotate) send POST "$t_path" "$JSON" "$T/rotate.json" ;;
    POST./v1/challenge | POST./v1/audit/verify) req POST "$t_path" -H 'Content-Length: 0' ;;
    POST.*/verify | POST./v1/identify) send POST "$t_path" "$PLY" "$T/p.ply" ;;
    POST.*) send POST "$t_path" "$PLY" "$T/a.ply" ;;
    PATCH.*) send PATCH "$t_path" "$JSON" "$T/change.json" ;;
    *) req "$1" "$t_path" ;;
    esac
    case $1.$2.$STATUS in
    DELETE.*/attempts.20?) ;;
    DELETE./v1/tokens/*.20?) token='' ;;
    DELETE.*.20? | POST./v1/subjects.20?) template='' ;;
    esac
}

all=$(new_token all)
template='' token=''
for scope in $(echo "$ALL" | tr ',' ' '); do
    one=$(new_token "$scope" --scope "$scope")
    others=$(new_token "not-$scope" --scope "$(echo ",$ALL," | sed "s/,$scope,/,/; s/^,//; s/,\$//")")
    while read -r verb route needs; do
        enrolled
        AUTH=$one needs=${needs#-,}
        case ,$needs, in
        ,-, | *,"$scope",*)
            try "$verb" "$route"
            ok "$scope alone may $verb $route: $STATUS" matches "$STATUS" '^(20[014]|303)$'
            ;;
        *)
            [ -z "${PGHOST:-}" ] || continue
            try "$verb" "$route"
            case $needs in
            *,*) needed="with one of the scopes $needs;" ;;
            *) needed="with the scope $needs;" ;;
            esac
            problem "$scope alone may not $verb $route" 403 insufficient_scope "$needed"
            is "nor is told what it would need otherwise" "$(field WWW-Authenticate)" \
                "Bearer realm=\"surfaced\", error=\"insufficient_scope\", scope=\"$(echo "$needs" | tr ',' ' ')\""
            ;;
        esac
        [ "$needs" = "$scope" ] || continue
        [ -z "${PGHOST:-}" ] || continue
        enrolled
        AUTH=$others
        try "$verb" "$route"
        problem "all but $scope may not $verb $route" 403 insufficient_scope "$scope"
    done <"$T/matrix"
done
# What takes a scope more, wherever it can be asked for.
enrolled
AUTH=$(new_token narrow --scope enroll,verify,identify,read,delete)
awk '$1 == "POST" && $2 ~ /}\/verify$/ { print $2 }' "$T/matrix" >"$T/comparing"
while read -r route; do
    for detail in measure heatmap surface; do
        try POST "$route" "?detail=$detail"
        problem "$route, $detail" 403 insufficient_scope detail
    done
done <"$T/comparing"
try POST /v1/compare '?detail=measure' # of the caller's own scans
is "a comparison, measure" "$STATUS" 200
is "routes with detail" "$(jq -r '[.paths[][] | objects | .parameters // [] | map(.["$ref"] // "")
    | select(any(endswith("/Detail")))] | length' "$T/api")" 3
try POST '/v1/subjects/{subject}/templates' '?force=true'
problem "force" 403 insufficient_scope manage

# ---- errors, on every route
AUTH=$all
[ -z "${PGHOST:-}" ] || : >"$T/matrix"
while read -r verb route needs; do
    enrolled
    AUTH=
    try "$verb" "$route"
    [ "${needs%%,*}" = - ] || problem "$verb $route without a token" 401 unauthorized
    AUTH=$all
    for name in threshold dry_run x; do
        try "$verb" "$route" "?$name=1"
        problem "$verb $route?$name" 400 invalid_parameter "unknown query parameter $name;"
    done
    known=$(jq -r --arg p "$route" --arg m "$verb" '. as $d | .paths[$p][$m | ascii_downcase].parameters // []
        | map(if has("$ref") then . as $r | $d | getpath($r["$ref"] | ltrimstr("#/") / "/") else . end)
        | map(select(.in == "query") | .name) | first // ""' "$T/api")
    if [ -n "$known" ]; then
        try "$verb" "$route" "?$known=1&$known=1"
        problem "$verb $route?$known twice" 400 invalid_parameter "$known is given twice"
    fi
    real=$(echo "$route" | sed "s/{subject}/alice/; s/{template_id}/$template/; s/{token_id}/$token/")
    AUTH=
    req OPTIONS "$real"
    ok "OPTIONS $route: $STATUS $(field Allow)" matches "$STATUS $(field Allow)" "^204 (.*, )?$verb, (.*, )?OPTIONS\$"
    AUTH=$all
    for wrong in PUT TRACE BREW; do
        gives "405 method_not_allowed" "$wrong $route" req "$wrong" "$real"
        ok "$wrong $route, Allow: $(field Allow)" matches "$(field Allow)" "(^|, )$verb(,|\$)"
    done
    case $verb.$route in
    POST./v1/challenge | POST./v1/audit/verify | GET.* | DELETE.*)
        req "$verb" "$real" -H "$JSON" -d '{"tolerance": 1}'
        problem "$verb $route, a body" 400 malformed 'takes no body'
        ;;
    *)
        gives "411 length_required" "$verb $route without a length" req "$verb" "$real" -H "$JSON" -H 'Content-Length:'
        req "$verb" "$real" -H 'Content-Type: image/gif' -d x
        problem "$verb $route, a picture" 415 unsupported_media_type
        req "$verb" "$real" -H "$JSON" -H 'Expect:' -H 'Content-Length: 99999999' -d '{}' -m 5
        problem "$verb $route, too long" 413 body_too_large
        case $route in # as a file is what it is: members of JSON alone can be misspelt
        */compare) jq -c '.tolerance = 1' "$T/two.json" >"$T/odd.json" ;;
        /v1/subjects) echo '{"subject": "eve", "tolerance": 1}' >"$T/odd.json" ;;
        /v1/tokens*) echo '{"tolerance": 1}' >"$T/odd.json" ;;
        *) jq -c '.tolerance = 1' "$T/c.json" >"$T/odd.json" ;;
        esac
        [ "$verb" != PATCH ] || echo '{"hold": true, "tolerance": 1}' >"$T/odd.json"
        send "$verb" "$real" "$JSON" "$T/odd.json"
        problem "$verb $route, an unknown member" 400 malformed tolerance
        ;;
    esac
done <"$T/matrix"
is "alice was not held" "$(sql 'SELECT count(*) FROM subjects')" 1

# ---- a stranger
AUTH=
for route in /healthz /readyz /version /metrics; do
    gives 200 "$route" req GET "$route"
    # the engine, the compiler, files, what was given above, how much is enrolled
    told=$(grep -Eo 'model/|measure/|GCC|Debian|/tmp|faces.db|threshold|calibration|plaintext|_limit|[^0-9.](77|911)$|7654321|13631488|_max_fds|_templates |_subjects ' "$T/body" | paste -sd ' ')
    is "$route tells nothing of the configuration" "$told" ""
done
is "what /metrics tells of the moment" "$(curl -sS "$URL/metrics" | sed -n 's/^# TYPE \(.*\) gauge$/\1/p' | paste -sd ' ')" \
    "surfaced_rows_verified_age_seconds surfaced_database_refused surfaced_queue_depth surfaced_workers_busy surfaced_storage_full surfaced_connections surfaced_held_bytes process_start_time_seconds process_resident_memory_bytes process_virtual_memory_bytes process_open_fds"
is "and what it counts" "$(curl -sS "$URL/metrics" | sed -n 's/^# TYPE \(.*\) \(counter\|histogram\)$/\1/p' | paste -sd ' ')" \
    surfaced_connections_closed_total
is "members of /readyz and /version" "$(curl -sS "$URL/readyz" "$URL/version" | jq -r 'keys[]' | paste -sd ' ')" \
    "status version"
req GET /healthz -H 'Expect:' -H 'Content-Length: 99999999' -d x -m 5
ok "nor does an error" sh -c "! grep -q 7654321 '$T/body'"
gives 413 "a length that is no number" req GET /healthz -H 'Content-Length: 99999999999999999999999' -m 5
ok "nor does that error" sh -c "! grep -q 7654321 '$T/body'"
finish
