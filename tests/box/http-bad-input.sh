#!/bin/sh
# Goal: bad input gets an error with a code and a clear detail; the daemon keeps running and
# loses no data.
. tests/box/lib.sh

scan 1 1 "$T/enrolled.ply"
scan 1 0 "$T/a.ply"
scan 1 0 "$T/a.json"
start_daemon --no-auth --max-body 40000000
send POST /v1/subjects/alice/templates "$PLY" "$T/enrolled.ply"
is enroll "$STATUS" 201
id=$(get .template_id)

# bad TITLE STATUS CODE DETAIL-PATTERN TEXT: TEXT as a JSON body gives this problem.
bad() {
    printf '%s' "$5" >"$T/x"
    send POST /v1/subjects/alice/verify "$JSON" "$T/x"
    problem "$1" "$2" "$3" "$4"
}

# ---- JSON
bad "truncated" 400 malformed 'ends too early' '{"points": [[1,2,3],'
bad "malformed" 400 malformed 'byte 12' '{"points": [}'
bad "a huge number" 422 not_finite 'points\[1\] is not three finite numbers' \
    '{"points": [[1,2,3],[1,2,1e999]]}'
bad "a large number" 422 out_of_range 'point 201 of 201' "{\"points\": [$(seq -s, -f '[%.0f,1,2]' 1 200),[1e300,2,3]]}"
bad "a string" 400 malformed 'points\[0\] is not three finite numbers' \
    '{"points": [["1",2,3]]}'
bad "no points" 400 malformed 'points is missing' '{"units": "mm"}'
bad "a misspelt member" 400 malformed 'the JSON: unknown member "pts"; allowed: points, units and axes' '{"pts": []}'
bad "another member" 400 malformed 'unknown member "threshold"' '{"points": [], "threshold": -1e9}'
bad "a long one, truncated between characters" 400 malformed 'unknown member "xü*"' "{\"x$(printf '%050d' 0 | sed 's/0/ü/g')\": 1}"
bad "deep nesting" 400 malformed 'deeper than 16 at byte 16' "$(printf '%05000d' 0 | tr 0 '[')"
bad "not UTF-8" 400 malformed 'not UTF-8 at byte 12' "$(printf '{"points": "\377"}')"
bad "many members" 400 malformed 'members' "{$(seq -s, -f '"k%.0f":1' 1 100)}"
bad "few points" 422 too_few_points '100' '{"points": [[1,2,3]]}'
bad "an empty array" 422 too_few_points '' '{"points": []}'
printf '{"points": []}\0{}' >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x"
problem "a NUL in it" 400 malformed 'byte 14'
: >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x"
problem "empty" 400 malformed empty
send POST /v1/subjects/alice/verify "$PLY" "$T/x"
problem "empty file" 400 malformed empty
send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H 'Transfer-Encoding: chunked'
problem "empty, in chunks" 400 malformed empty
req POST /v1/subjects/alice/verify -H "$JSON"
problem "no length" 411 length_required

# ---- media types
# A type that says nothing, as curl's own, leaves it to the content; but JSON is said to be that.
for scan in a.json a.ply; do
    for type in 'Content-Type:' 'Content-Type: application/x-www-form-urlencoded'; do
        send POST /v1/subjects/alice/verify "$type" "$T/$scan"
        is "$scan, $type" "$STATUS $(get .decision)" '200 match'
    done
done
for type in 'Content-Type:' 'Content-Type: application/x-www-form-urlencoded'; do
    send POST /v1/compare "$type" "$T/a.json"
    problem "compare, $type" 415 unsupported_media_type '^Content-Type must be application/json, or multipart/form-data with the files a and b$'
done
send POST /v1/subjects/alice/verify 'Content-Type: application/merge-patch+json' "$T/a.json"
problem "a patch" 415 unsupported_media_type '^Content-Type must be model/ply, '
send POST /v1/subjects/alice/verify "$JSON" "$T/a.json" -H 'Content-Encoding: gzip'
problem "not compressed as declared" 400 damaged_content_encoding
send POST /v1/subjects/alice/verify "$JSON" "$T/a.json" -H 'Content-Encoding: br'
problem "an unsupported coding" 415 unsupported_content_encoding
send POST /v1/subjects/alice/verify "$JSON" "$T/a.ply"
problem "PLY sent as JSON" 400 malformed
send POST /v1/subjects/alice/verify "$PLY" "$T/a.json"
problem "JSON sent as PLY" 400 malformed

# ---- scanner files
# ply LINE...: sends a PLY file of these lines.
ply() {
    printf '%s\n' "$@" >"$T/x"
    send POST /v1/subjects/alice/verify "$PLY" "$T/x"
}
ply ply 'format ascii 1.0' 'element vertex 4000000000' 'property float x' \
    'property float y' 'property float z' end_header '1 2 3'
ok "a false count: $STATUS $(get .code)" test "$STATUS" -ge 400 -a "$STATUS" -lt 500
ply ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' \
    'property float z' end_header '1 2 3'
problem "too few lines" 400 malformed
head -c 9000 "$T/a.ply" >"$T/x"
send POST /v1/subjects/alice/verify "$PLY" "$T/x"
problem "a truncated file" 400 malformed
printf '1 2 3\n4 5 \001\002\377\n' >"$T/x"
send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/x"
problem "text with binary inside" 400 malformed 'line 2'
head -c 20000 /dev/zero >"$T/x"
send POST /v1/subjects/alice/verify "$BYTES" "$T/x"
problem "zeros" 400 malformed

# ---- shapes (what a scan is refused for: http-examples.sh)
awk 'BEGIN { for (i = 0; i < 300; i++) print 1, 2, 3 }' >"$T/x"
send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/x"
ok "all points equal: $STATUS $(get .code)" test "$STATUS" = 422
scan 1 1 "$T/a.xyz"
awk '{ print -$1, -$2, $3 }' "$T/a.xyz" >"$T/x"
send POST '/v1/subjects/alice/verify?axes=scanner' 'Content-Type: text/plain' "$T/x"
is "a face upside down, the axes told" "$STATUS $(get .decision)" "200 no_match"
send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/x"
is "the axes not told" "$STATUS $(get .decision)" "200 match"
awk 'BEGIN { printf "{\"points\": [[1,2,3]"
    for (i = 1; i < 1000001; i++) printf ",[%d,%d,3]", i % 1000, i / 1000; print "]}" }' >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x"
problem "one point too many" 422 too_many_points 'points has 1000001'

# ---- over the limit: rejected before the whole body is read
head -c 60000000 /dev/zero >"$T/big"
for how in 'Expect: 100-continue' 'Expect:' 'Transfer-Encoding: chunked'; do
    send POST /v1/subjects/alice/verify "$BYTES" "$T/big" -H "$how"
    problem "over the limit, $how" 413 body_too_large 40000000
done
sent=$(curl -sS -m 5 --limit-rate 2M -o "$T/body" -w '%{http_code} %{size_upload}' -H "$BYTES" \
    -H 'Expect:' --data-binary "@$T/big" "$URL/v1/subjects/alice/verify" 2>/dev/null)
ok "rejected by the headers alone: $sent" test "${sent% *}" = 413 -a "${sent#* }" -lt 20000000
send GET /healthz "$BYTES" "$T/big" -H 'Expect:'
problem "a large body of a GET request" 400 malformed "takes no body"
rm "$T/big"

# ---- clients that disconnect in the middle
clients=
for _ in 1 2 3; do
    curl -sS -m 1 --limit-rate 2000 -o /dev/null -H "$PLY" --data-binary "@$T/a.ply" \
        "$URL/v1/subjects/alice/verify" 2>/dev/null &
    clients="$clients $!"
    curl -sS -m 0.02 -o /dev/null -H "$PLY" --data-binary "@$T/a.ply" \
        "$URL/v1/subjects/alice/verify" 2>/dev/null &
    clients="$clients $!"
done
# shellcheck disable=SC2086 # a list
wait $clients
alive "clients that disconnect"
req GET /v1/subjects/alice
is "nothing changed" "$(get '.templates | length')" 1

# ---- paths
for path in /v1/subjects/a%2Fb /v1/subjects/a%00 /v1/subjects/%zz /v1/subjects/%4 \
    "/v1/subjects/$(printf '%0129d' 1)" /v1/subjects/%C3%A9 /v1/subjects/a%20b; do
    req GET "$path"
    problem "GET $path" 400 invalid_parameter 'subject id'
done
req GET "/v1/subjects/$(printf '%0128d' 1)"
problem "the longest id" 404 not_found
for path in /v1/templates/x /v1/templates/..%2f..%2fetc%2fpasswd "/v1/templates/${id}0"; do
    req GET "$path"
    problem "GET $path" 404 not_found
done
req GET /v1/subjects/../../etc/passwd --path-as-is
problem "dots" 404 no_such_route
req GET "/healthz?$(printf '%08000d' 1)"
problem "a long query" 400 invalid_parameter 'unknown query parameter 0{64};'
req GET "/healthz?$(printf '%020000d' 1)"
is "a query that is too long" "$STATUS" 414
for label in "$(printf '%0257d' 1)" %01 %FF %00 % a%E2%80%AEply.exe %E2%80%8Bx a%D8%9C; do
    send POST "/v1/subjects/bob/templates?label=$label" "$PLY" "$T/a.ply"
    is "label $label" "$STATUS" 400
done
req GET /v1/subjects/bob
is "nothing was stored" "$STATUS" 404

# ---- a damaged database
restart() {
    stop_daemon
    start_daemon --no-auth
}
damage_faces 1
restart
send POST /v1/subjects/alice/verify "$PLY" "$T/a.ply"
problem "a damaged model" 500 internal
ok "the response reveals no internals" sh -c "! grep -Eiq 'model|checksum|sqlite|corrupt|/tmp' '$T/body'"
ok "the log has the cause" grep -Eq 'status=500 .*fault="' "$LOG"
alive "a damaged model"
req GET "/v1/templates/$id"
is "its description is served" "$STATUS" 200
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
ok "enrolling while it is damaged: $STATUS" test "$STATUS" = 500 -o "$STATUS" = 200
req DELETE /v1/subjects/alice
is "it can be erased" "$STATUS" 200
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
is "and enrolled again" "$STATUS" 201
finish
