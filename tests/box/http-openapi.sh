#!/bin/sh
# Goal: the API's description is valid and true.  The script sends requests for every described
# operation, so that every described status occurs, and checks each response, body and headers,
# against its description; also the description's own examples.  An undescribed status fails the
# test; so does a described one that never occurs, unless UNSEEN names it.
. tests/box/lib.sh
needs jsonschema

# Responses that no request can cause: METHOD PATH STATUS.
# 503: these use neither the database nor the queue, and fail only without memory.
UNSEEN='GET / 503
GET /healthz 503
GET /metrics 503
GET /openapi.json 503
GET /docs 503
GET /console 503
GET /version 503'

LIMIT=200000
SEEN=$T/seen

# ---- requests

# note METHOD PATH: keeps the last response for the checks at the end.
note() {
    n_type=$(field Content-Type)
    case $n_type in
    *json) n_read=--slurpfile ;;
    *) n_read=--rawfile ;;
    esac
    # A repeated header gets its values joined, which no pattern here allows.
    tr -d '\r' <"$T/head" | sed -n '/^HTTP/d; s/^\([^:]*\): \(.*\)$/\L\1\E\t\2/p' |
        jq -R -s 'split("\n") | map(select(. != "") | split("\t")) | group_by(.[0])
            | map({key: .[0][0], value: (map(.[1]) | join(", "))}) | from_entries' >"$T/headers"
    jq -c -n --arg m "$1" --arg p "$2" --arg s "$STATUS" --arg t "${n_type%%;*}" \
        --slurpfile h "$T/headers" $n_read b "$T/body" \
        '{method: $m, path: ($p | sub("\\?.*"; "")), status: $s, type: $t, headers: $h[0],
          body: (if $b | type == "array" then $b[0] else $b end)}' >>"$SEEN"
}

# ask METHOD PATH WANTED-STATUS [CURL-OPTION...]: sends a request and notes the response.
ask() {
    a_method=$1 a_path=$2 a_status=$3
    shift 3
    req "$a_method" "$a_path" "$@"
    is "$a_method $a_path $*" "$STATUS" "$a_status"
    note "$a_method" "$a_path"
}

# put METHOD PATH WANTED-STATUS TYPE FILE [CURL-OPTION...]: the same with FILE as the body.
put() {
    p_method=$1 p_path=$2 p_status=$3 p_type=$4 p_file=$5
    shift 5
    ask "$p_method" "$p_path" "$p_status" -H "$p_type" --data-binary "@$p_file" "$@"
}

# select_operations FILTER: writes the operations that jq's FILTER selects to $T/each, one a line.
select_operations() {
    jq -r "$OPERATIONS | select($1) | [.method, .asked, (.body | tojson)] | @tsv" \
        "$T/api" >"$T/each"
    ok "some operations: $1" test -s "$T/each"
}

# each WANTED-STATUS FILTER [CURL-OPTION...]: sends a request for each of these operations, with
# the examples of the parameters in its path.
each() {
    e_status=$1
    select_operations "$2"
    shift 2
    while IFS="$(printf '\t')" read -r e_method e_path _; do
        ask "$e_method" "$e_path" "$e_status" "$@"
    done <"$T/each"
}

# A jq program: the document's operations, with references resolved one step.
# shellcheck disable=SC2016 # the variables are jq's
OPERATIONS='. as $d
    | def deref: if type == "object" and has("$ref")
        then . as $r | $d | getpath($r["$ref"] | ltrimstr("#/") / "/") else . end;
    .paths | to_entries[] | .key as $path | .value as $item
    | $item | to_entries[] | select(.key != "parameters") | .value as $op
    | [($item.parameters // [])[], ($op.parameters // [])[] | deref] as $params
    | {method: (.key | ascii_upcase), path: $path, params: $params,
       asked: (reduce ($params[] | select(.in == "path")) as $p ($path;
            sub("\\{" + $p.name + "\\}"; $p.example))),
       open: ($op.security == [] or any($op.security[]; . == {})),
       scopes: [$op.security[] | .token // [] | .[]],
       cloud: ($op.requestBody["$ref"] != null),
       body: ($op.requestBody | deref | if . then .content["application/json"].example else null end),
       request: ($op.requestBody | deref | if . then .content else {} end),
       responses: ($op.responses | map_values(deref
            | .headers = ((.headers // {}) | map_values(deref))))}'

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.json" --pose 8 --shift 10
scan 2 0 "$T/b.ply"
scan 2 1 "$T/b1.ply"
jq -c -n --slurpfile a "$T/a2.json" '{a: $a[0], b: $a[0]}' >"$T/ab.json"
jq -r '.points[] | map(tostring) | join(" ")' "$T/a2.json" >"$T/a2.xyz"
start_daemon --workers 1 --queue 1 --max-body $LIMIT
TOKEN=$(new_token one)
curl -sS -o "$T/api" "$URL/openapi.json"

# ---- the document itself
jsonschema -i "$T/api" tests/box/openapi-3.1.schema.json >"$T/body" 2>&1
is "it is OpenAPI 3.1" $? 0
is "its codes are the daemon's" \
    "$(jq -r '.components.schemas.Problem.properties.code.enum[]' "$T/api" | sort)" \
    "$(sed -n 's/.*{[0-9]*, "\([a-z_]*\)",.*/\1/p' server/http/errmap.c | sort -u)"
is "operation ids that occur twice" "$(jq -r '.paths[][] | .operationId? // empty' "$T/api" |
    sort | uniq -d)" ""
is "bodies without an example" "$(jq -c 'paths(objects | has("schema") and (has("in") or has("required") | not)
    and (has("example") or has("examples") | not) and (.schema | has("const") | not))
    | select(.[-2] == "content")' "$T/api")" ""

# ---- without a token, with a wrong scope, and the public paths
each 401 '.open | not'
for path in /v1/subjects /metrics; do
    ask GET "$path" 401 -H 'Authorization: Bearer 0123456789abcdef'
done
each 200 '.open and .path != "/"'
ask GET / 303
: >"$T/body"
ask GET /openapi.json 304 -H 'If-None-Match: *'
for scope in verify read; do
    AUTH=$(new_token "$scope" --scope "$scope")
    each 403 "(.scopes != []) and (.scopes | index(\"$scope\") | not)"
done
AUTH=$TOKEN

# ---- bad headers and parameters
head -c $((LIMIT + 1)) /dev/zero >"$T/big"
each 413 '.request != {}' -H "$BYTES" --data-binary "@$T/big"
each 400 '.request == {}' -H "$BYTES" --data-binary "@$T/big"
is "without the limit" "$(get .detail)" "this method of this path takes no body"
each 400 '.request == {}' -H "$JSON" -H 'Transfer-Encoding: chunked' -d '{"force": true}'
rm "$T/big"
each 411 .body
each 415 .body -H 'Content-Type: image/jpeg' -d x
put POST /v1/compare 415 "$JSON" "$T/ab.json" -H 'Content-Encoding: br'
for last in templates verify; do
    put POST "/v1/subjects/a%20b/$last" 400 "$PLY" "$T/a.ply"
    put POST "/v1/subjects/alice/$last" 400 "$PLY" "$T/a.ply" -H 'Content-Encoding: gzip'
done
put POST '/v1/subjects/alice/templates?units=inch' 400 "$PLY" "$T/a.ply"
ask GET /v1/subjects/a%20b 400
ask GET /v1/subjects/a%20b/templates/compare 400
ask DELETE /v1/subjects/a%20b 400
ask GET '/v1/subjects?limit=0' 400
put POST '/v1/compare?detail=x' 400 "$JSON" "$T/ab.json"
select_operations true
while IFS="$(printf '\t')" read -r e_method e_path _; do
    ask "$e_method" "$e_path?threshold=8" 400
done <"$T/each"
put POST '/v1/asymmetry?units=inch' 400 "$PLY" "$T/a.ply"

# ---- before and after an enrolment
each 404 '(.method | IN("GET", "DELETE")) and (.params | any(.in == "path"))'
put POST /v1/subjects/alice/verify 404 "$PLY" "$T/a.ply"
put POST /v1/templates/00000000000000000000000000000000/verify 404 "$PLY" "$T/a.ply"
each 200 '.asked == "/v1/subjects" and .method == "GET"'
MIN='Prefer: return=minimal'
put POST '/v1/subjects/alice/templates?label=scanner%201' 201 "$PLY" "$T/a.ply"
id=$(get .template_id)
put POST /v1/subjects/alice/templates 200 "$PLY" "$T/a.ply"
put POST /v1/subjects/alice/templates 204 "$PLY" "$T/a.ply" -H "$MIN"
put POST /v1/subjects/alice/templates 409 "$PLY" "$T/b.ply"
put POST '/v1/subjects/alice/templates?force=true' 201 "$PLY" "$T/b.ply" -H "$MIN"
other=$(field Location)
ask GET /v1/subjects/alice/templates/compare 200
# several files: taken, there already, and none of them
jq -c '{points: .points[:3]}' "$T/a2.json" >"$T/few.json"
for status in 201 200; do
    ask POST /v1/subjects/erin/templates?fuse=false $status -F "file=@$T/a.ply" -F "file=@$T/few.json" \
        -F "file=@$T/b.ply" -F "file=@$T/a2.json"
done
ask POST /v1/subjects/erin/templates?fuse=false 409 -F "file=@$T/b.ply" -F "file=@$T/few.json"
ask POST /v1/subjects/erin/templates?fuse=false 422 -F "file=@$T/few.json" -F "file=@$T/b.ply"
head -c 50000 "$T/api" >"$T/odd"
ask POST /v1/subjects/erin/templates?fuse=false 400 -F "file=@$T/odd" -F "file=@$T/b.ply"
ask DELETE /v1/subjects/erin 200
for one in subjects/alice "templates/$id"; do
    put POST "/v1/$one/verify" 200 "$JSON" "$T/a2.json"
    put POST "/v1/$one/verify" 200 "$JSON" "$T/a2.json" -H "$MIN"
    put POST "/v1/$one/verify?detail=heatmap" 200 "$JSON" "$T/a2.json"
    put POST "/v1/$one/verify?detail=surface" 200 "$JSON" "$T/a2.json"
    put POST "/v1/$one/verify" 200 "$PLY" "$T/b1.ply"
    put POST "/v1/$one/verify" 200 'Content-Type: text/plain' "$T/a2.xyz"
    put POST "/v1/$one/verify?units=0" 400 "$JSON" "$T/a2.json"
done
put POST /v1/subjects/alice/verify 422 "$PLY" "$T/b.ply"
put POST '/v1/identify?candidates=3' 200 "$JSON" "$T/a2.json"
put POST /v1/identify 200 "$JSON" "$T/a2.json" -H "$MIN"
put POST '/v1/identify?candidates=51' 400 "$JSON" "$T/a2.json"
# a subject before its first sample
echo '{"subject": "dora", "consent": "C-18"}' >"$T/new"
put POST /v1/subjects 201 "$JSON" "$T/new"
put POST /v1/subjects 409 "$JSON" "$T/new"
echo '{"subject": "dora", "hold": true}' >"$T/new"
put POST /v1/subjects 400 "$JSON" "$T/new"
# changing it
MERGE='Content-Type: application/merge-patch+json'
echo '{"consent": "C-17", "expires_at": "2031-01-31", "hold": true}' >"$T/change"
put PATCH /v1/subjects/nobody 404 "$MERGE" "$T/change"
put PATCH /v1/subjects/alice 200 "$MERGE" "$T/change"
ask GET /v1/subjects/alice 200
echo '{"consent": null, "expires_at": null, "hold": false}' >"$T/change"
put PATCH /v1/subjects/alice 204 "$JSON" "$T/change" -H "$MIN"
echo '{"held": true}' >"$T/change"
put PATCH /v1/subjects/alice 400 "$JSON" "$T/change"
put PATCH /v1/subjects/a%20b 400 "$JSON" "$T/change"
put PATCH /v1/subjects/alice 400 "$JSON" "$T/change" -H 'Content-Encoding: gzip'
put PATCH /v1/subjects/alice 415 "$PLY" "$T/change"
# by a token that is bound to a group
AUTH=$(new_token bound --scope enroll,manage,tokens --group door-3)
echo '{"subject": "of-others", "groups": ["west"]}' >"$T/new"
put POST /v1/subjects 403 "$JSON" "$T/new"
echo '{"groups": ["west"]}' >"$T/change"
put PATCH /v1/subjects/alice 403 "$MERGE" "$T/change"
echo '{"name": "x", "scopes": ["enroll"], "groups": ["west"]}' >"$T/new"
put POST /v1/tokens 403 "$JSON" "$T/new"
put POST /v1/subjects/alice/templates 409 "$PLY" "$T/a.ply"
AUTH=$TOKEN
# on hold, disabled
subject() { "$BUILD/surfacectl" --db "$DB" subject "$1" alice >"$T/ctl" 2>&1; }
subject hold
ask DELETE /v1/subjects/alice 409
ask DELETE "/v1/templates/$id" 409
subject release
subject disable
for one in subjects/alice "templates/$id"; do
    put POST "/v1/$one/verify" 403 "$PLY" "$T/a.ply"
    is "disabled" "$(get .code)" subject_disabled
done
put POST "/v1/subjects/alice/templates?force=true" 403 "$PLY" "$T/a.ply"
is "not enrolled either" "$(get .code)" subject_disabled
subject enable
ending >"$T/change"
put PATCH /v1/subjects/alice 200 "$MERGE" "$T/change"
sleep 1.1
for one in subjects/alice "templates/$id"; do
    put POST "/v1/$one/verify" 403 "$PLY" "$T/a.ply"
    is "expired" "$(get .code)" subject_expired
done
put POST /v1/subjects/alice/templates 403 "$PLY" "$T/a.ply"
is "not enrolled either" "$(get .code)" subject_expired
echo '{"expires_at": null}' >"$T/change"
put PATCH /v1/subjects/alice 200 "$MERGE" "$T/change"
put POST /v1/compare 200 "$JSON" "$T/ab.json"
put POST /v1/compare 200 "$JSON" "$T/ab.json" -H "$MIN"
put POST '/v1/compare?detail=measure' 200 "$JSON" "$T/ab.json"
put POST '/v1/compare?detail=surface' 200 "$JSON" "$T/ab.json"
ask POST /v1/compare 200 -F "a=@$T/a.ply" -F "b=@$T/b.ply"
ask GET /v1/token 200
ask GET '/v1/recent?limit=20' 200
ask GET '/v1/subjects?q=ali&state=active' 200
ask GET '/v1/subjects?state=gone' 400
ask GET '/v1/audit?limit=20' 200
ask GET '/v1/events?last=20' 200
ask GET '/v1/events?after=0-0&limit=1' 200
is "a page of one" "$(get '.events | length')" 1
ask GET '/v1/events?last=5' 200 -H 'Accept: text/event-stream' -m 1
ask GET '/v1/events?after=x' 400
ask GET '/v1/events?after=999999-0' 410
ask GET '/v1/audit?after=0-0' 200
ask GET '/v1/audit?before=0' 400
ask GET '/v1/audit?subject=nobody' 404
ask POST /v1/audit/verify 200
ask GET /v1/audit/export 200
ask GET '/v1/audit/export?format=csv' 200
ask GET '/v1/audit/export?format=xml' 400
ask GET '/v1/audit/export?format=csv&subject=nobody' 404
ask GET /v1/stats 200
# tokens: made, rotated, revoked
ask GET /v1/tokens 200
select_operations '.path == "/v1/tokens" and .method == "POST"'
cut -f 3 "$T/each" >"$T/sent"
put POST /v1/tokens 201 "$JSON" "$T/sent"
made=/v1/tokens/$(get .id)
echo '{"name": "x"}' >"$T/sent"
put POST /v1/tokens 400 "$JSON" "$T/sent"
echo '{"grace_s": 60}' >"$T/sent"
put POST "$made/rotate" 200 "$JSON" "$T/sent"
put POST /v1/tokens/00000000000000000000000000000000/rotate 404 "$JSON" "$T/sent"
ask DELETE "$made/attempts" 204
ask DELETE "$made" 204
put POST "$made/rotate" 409 "$JSON" "$T/sent"
put POST "$made/rotate" 400 "$JSON" "$T/new"
ask GET /v1/token 200
ask DELETE "/v1/tokens/$(get .id)" 409
ask GET '/v1/recent?limit=0' 400
ask DELETE /v1/subjects/alice/attempts 204
ask DELETE /v1/subjects/a%20b/attempts 400
ask POST /v1/challenge 200
put POST /v1/asymmetry 200 "$PLY" "$T/a.ply"
# what would be done: all, nothing but reading it, and what stops before that
put POST /v1/check 200 "$PLY" "$T/a.ply"
put POST '/v1/check?detail=surface' 200 "$PLY" "$T/a.ply"
put POST '/v1/check?detail=all' 400 "$PLY" "$T/a.ply"
put POST '/v1/check?units=cm&axes=scanner' 200 "$PLY" "$T/a.ply"
is "not usable" "$(get .code)" units_suspicious
select_operations '.body and .path == "/v1/check"'
cut -f 3 "$T/each" >"$T/sent"
put POST /v1/check 200 "$JSON" "$T/sent"
is "too few" "$(get .code)" too_few_points
put POST '/v1/check?units=inch' 400 "$PLY" "$T/a.ply"
# The examples of clouds are parsed, and have too few points.
select_operations '.body and (.path | test("check$|subjects(/{subject})?$|/tokens") | not)'
while IFS="$(printf '\t')" read -r e_method e_path e_body; do
    printf '%s' "$e_body" >"$T/sent"
    put "$e_method" "$(echo "$e_path" | sed "s/[0-9a-f]\{32\}/$id/")" 422 "$JSON" "$T/sent"
    is "too few" "$(get .code)" too_few_points
done <"$T/each"
ask GET /v1/subjects 200
ask GET /v1/subjects/alice 200
ask GET "/v1/templates/$id" 200
ask GET "/v1/templates/$id/surface" 200
ask GET "/v1/templates/$id/surface?format=ply" 200
ask GET "/v1/templates/$id/surface?format=stl" 400
ask DELETE "$other" 204
ask DELETE "/v1/templates/$id" 204 -H "$MIN"
put POST /v1/subjects/alice/templates 201 "$PLY" "$T/a.ply"
ask DELETE /v1/subjects/alice 200
put POST /v1/subjects/bob/templates 201 "$PLY" "$T/a.ply"
ask DELETE /v1/subjects/bob 204 -H "$MIN"

# ---- a full queue: the only worker waits for the database, which another process has locked,
# and one more request waits for the worker.
hold_db 'BEGIN IMMEDIATE'
clients=
for _ in 1 2 3; do
    while [ ! -e "$T/enough" ]; do
        curl -sS -m 60 -o /dev/null -H "Authorization: Bearer $AUTH" -H "$PLY" \
            --data-binary "@$T/b.ply" "$URL/v1/subjects/busy/templates"
        sleep 0.1
    done &
    clients="$clients $!"
done
select_operations '.responses["503"] and .path != "/readyz"'
printf 'GET\t/readyz\tnull\n' >>"$T/each"
while IFS="$(printf '\t')" read -r e_method e_path e_body; do
    printf '%s' "$e_body" >"$T/sent"
    set --
    [ "$e_body" = null ] || set -- -H "$JSON" --data-binary "@$T/sent"
    ! echo "$UNSEEN" | grep -qx "$e_method $e_path 503" || continue
    for _ in $(seq 200); do
        req "$e_method" "$e_path" "$@"
        [ "$STATUS" != 503 ] || break
    done
    is "$e_method $e_path, a full queue" "$STATUS" 503
    note "$e_method" "$e_path"
done <"$T/each"
: >"$T/enough"
release_db
# shellcheck disable=SC2086 # a list
wait $clients

# ---- a damaged database, before the daemon looks through it (a minute after its start)
stop_daemon
start_daemon --workers 1 --queue 1 --max-body $LIMIT
sql 'UPDATE tokens SET name = name || 1'
each 500 '.responses["500"]' -d x

# ---- lock-out and rate limit
sql 'UPDATE tokens SET name = substr(name, 1, length(name) - 1)'
put POST /v1/subjects/carol/templates 201 "$PLY" "$T/a.ply"
id=$(get .template_id)
sql "INSERT INTO attempts SELECT subject_key, tokens.id, 3, 1000 * unixepoch(), 9
    FROM tokens, templates JOIN subjects USING (uid) WHERE templates.id = '$id'"
put POST /v1/subjects/carol/verify 429 "$PLY" "$T/a.ply"
put POST /v1/subjects/carol/templates 429 "$PLY" "$T/b.ply"
put POST "/v1/templates/$id/verify" 429 "$PLY" "$T/a.ply"
AUTH=0123456789abcdef
select_operations '.scopes != []'
while IFS="$(printf '\t')" read -r e_method e_path _; do
    for _ in $(seq 50); do
        req "$e_method" "$e_path"
        [ "$STATUS" != 429 ] || break
    done
    is "$e_method $e_path, a wrong token" "$STATUS" 429
    note "$e_method" "$e_path"
done <"$T/each"

# ---- every response against the description
# shellcheck disable=SC2016 # the variables are jq's
jq -n --slurpfile doc "$T/api" --slurpfile seen "$SEEN" --arg unseen "$UNSEEN" '
    $doc[0] | . as $doc | [ '"$OPERATIONS"' ] as $ops
    # No response has a member that is not described.
    | def strict: walk(if type == "object" and .properties and .type == "object"
            then .additionalProperties = false else . end);
    def closed: if type == "object" and (has("$ref") or has("allOf"))
        then .unevaluatedProperties = false else . end;
    def examples: if has("example") then .example else (.examples // {})[].value end;
    def schema_of($op; $r): $op.responses[$r.status] as $a
        | {properties: {
            type: {enum: (if $a.content == null or $r.body == "" then [""]
                          else $a.content | keys end)},
            body: (if $r.body == "" then $a.content == null
                        or $r.headers["preference-applied"] == "return=minimal"
                   else ($a.content // {})[$r.type].schema // false | closed end),
            headers: {
                required: [$a.headers | to_entries[] | select(.value.required)
                    | .key | ascii_downcase],
                properties: ($a.headers | with_entries({key: (.key | ascii_downcase),
                    value: .value.schema}))}}};
    [$seen | to_entries[] | .value as $r | ("\($r.method) \($r.path) \($r.status) #\(.key)") as $name
        | [$ops[] | select(.method == $r.method) | . as $op
            | select($r.path | test("^" + ($op.path | gsub("\\{[^}]*\\}"; "[^/]+")) + "$"))][0]
        | {name: $name, value: $r, key: "\(.method) \(.path) \($r.status)",
           schema: (if .responses[$r.status] then schema_of(.; $r) else null end)}] as $got
    | [$ops[] | . as $op | "\(.method) \(.path)" as $name
        | (.params[] | {name: "\($name) \(.name)", schema: .schema, value: .example}),
          (.request | to_entries[] | {name: "\($name) \(.key)", schema: .value.schema,
              value: (.value | examples)}),
          (.responses | to_entries[] | .key as $s
            | (.value.content // {} | to_entries[] | {name: "\($name) \($s) \(.key)",
                schema: (.value.schema | closed), value: (.value | examples)}),
              (.value.headers | to_entries[] | select(.value.example) | {
                name: "\($name) \($s) \(.key)", schema: .value.schema,
                value: .value.example}))]
      | to_entries | map(.value + {name: "example \(.key): \(.value.name)"}) as $examples
    | ([$got[].key] | unique) as $came
    | [$ops[] | .responses as $r | "\(.method) \(.path) \($r | keys[])"] as $described
    | ($unseen / "\n") as $unseen
    | {undocumented: [$got[] | select(.schema == null) | .name],
       never: ($described - $came - $unseen),
       in_vain: ($unseen - ($described - $came)),
       count: ($got | length),
       instance: [$got[], $examples[] | {key: .name, value: .value}] | from_entries,
       schema: {
         "$schema": "https://json-schema.org/draft/2020-12/schema",
         "$defs": $doc.components.schemas,
         components: ($doc.components | .schemas |= with_entries(
             if .key | IN("Problem", "Mismatch") then . else .value |= strict end)),
         properties: ([$got[], $examples[] | select(.schema != null)
             | {key: .name, value: .schema}] | from_entries)}}' >"$T/all"
is "responses that are not described" "$(jq -c .undocumented "$T/all")" '[]'
is "described responses that never occurred" "$(jq -c .never "$T/all")" '[]'
is "in UNSEEN, but occurred or not described" "$(jq -c .in_vain "$T/all")" '[]'
is "problems whose status or request_id differs from the header's" "$(jq -c 'select(.type == "application/problem+json")
    | select((.body.status | tostring) != .status
        or .body.request_id != .headers["x-request-id"]) | .path' "$SEEN")" ''
jq .instance "$T/all" >"$T/instance"
jq .schema "$T/all" >"$T/schema"
jsonschema --error-format '{error.json_path}: {error.message}
' -i "$T/instance" "$T/schema" >"$T/out" 2>&1
is "$(jq .count "$T/all") responses as described" $? 0
grep '^\$' "$T/out" | cut -c 1-400
finish
