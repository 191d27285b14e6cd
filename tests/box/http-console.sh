#!/bin/sh
# Goal: the console's files and what they show: the pages are small, kept by browsers, may load
# nothing from elsewhere and can be left out; surfaces are sent as glTF to those alone who may have
# them, and that is recorded.  The pages in a browser: console.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
start_daemon

# ---- pages
files=$(find server/console -maxdepth 1 -type f -printf '%f\n' | sort)
total=0
for file in $files; do
    path=/console/$file
    [ "$file" != index.html ] || path=/console
    gives 200 "$path" req GET "$path" -H 'Accept-Encoding: gzip' --raw
    contains "$path: its policy" "$T/head" "default-src 'none'.*trusted-types 'none'"
    contains "$path: a browser asks again" "$T/head" '^Cache-Control: no-cache'
    total=$((total + $(wc -c <"$T/body")))
    tag=$(field ETag)
    gives 304 "$path, which the browser has" req GET "$path" -H "If-None-Match: $tag"
    req GET "$path"
    if [ "$file" = index.html ]; then at=server/console/index.html; else at=server/console/$file; fi
    ok "$path: the file" cmp -s "$T/body" "$at"
done
ok "all pages together have $total bytes, of at most 130 KB" test "$total" -le 133120
for file in one one_again one_turned other; do
    req GET "/console/$file.ply"
    is "the sample $file" "$STATUS $(wc -c <"$T/body")" "200 $(wc -c <"server/console/samples/$file.ply")"
    ok "is a small scan" test "$(wc -c <"$T/body")" -le 81920
    mv "$T/body" "$T/$file.ply"
done
for path in /console/ /console/none.js /console/../openapi.json /console/style.css/x /consoles; do
    gives 404 "$path" req GET "$path" --path-as-is
done
ok "no page has markup from texts" sh -c "! grep -En 'innerHTML|outerHTML|insertAdjacentHTML|document.write|eval\\(' server/console/*.js"
ok "nothing of it is stored in the browser" sh -c "! grep -En 'localStorage|sessionStorage|indexedDB|document.cookie' server/console/*.js"

# ---- surfaces
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
ME=$(new_token me)
AUTH=$ME
req GET /v1/token
is "what a token may do" "$(get '.name, (.scopes | join(","))' | paste -sd' ')" "me $ALL"
VERIFY=$(new_token door --scope verify)
AUTH=$VERIFY
req GET /v1/token
is "and another" "$(get '.name, (.scopes | join(",")), (.id | length)' | paste -sd' ')" "door verify 32"
AUTH=$ME
req POST /v1/subjects/alice/templates -H "$PLY" --data-binary "@$T/a.ply"
id=$(get .template_id)

# glb TITLE: the last response is one; its document is $T/glb.
glb() {
    is "$1: its type" "$STATUS $(field Content-Type)" '200 model/gltf-binary'
    n=$(od -An -tu4 -j 12 -N 4 "$T/body" | tr -d ' ')
    ok "$1: its length" test "$(od -An -tu4 -j 8 -N 4 "$T/body" | tr -d ' ')" = "$(wc -c <"$T/body" | tr -d ' ')"
    tail -c +21 "$T/body" | head -c "$n" >"$T/glb"
    # shellcheck disable=SC2016 # the variables are jq's
    ok "$1: every index is within its array" jq_true '. as $d
        | all(.bufferViews[]; .byteOffset + .byteLength <= $d.buffers[0].byteLength and .byteOffset % 4 == 0)
          and all(.meshes[].primitives[] | .attributes[]; . < ($d.accessors | length))' "$T/glb"
}
req POST '/v1/compare?detail=surface' -F "a=@$T/a.ply" -F "b=@$T/a2.ply"
glb "a comparison"
is "its nodes" "$(jq -r '[.nodes[].name] | join(" ")' "$T/glb")" 'template probe'
is "what the probe has" "$(jq -r '.meshes[1].primitives[0].attributes | keys | join(" ")' "$T/glb")" \
    'COLOR_0 POSITION _GAP_MM _PART _REST_MM'
cp "$T/glb" "$T/first"
req POST '/v1/compare?detail=measure' -F "b=@$T/a2.ply" -F "a=@$T/a.ply"
is "the response in it is the one without" "$(jq -c '.extras | del(.timing_ms, .calibration)' "$T/first")" \
    "$(jq -c 'del(.timing_ms)' "$T/body")"
ok "the calibration is with it" jq_true '.extras.calibration | .threshold == 8 and (.knots | length) > 3' "$T/first"
is "the qualities are both scans'" "$(get '.quality | keys | join(" ")')" 'a b'
req POST '/v1/check?detail=surface' -H "$PLY" --data-binary "@$T/a.ply"
glb "a check"
is "the nodes of a scan" "$(jq -r '[.nodes[].name] | join(" ")' "$T/glb")" 'face scan'
head -c 3000 /dev/zero | tr '\0' '1' | fold -w 3 | sed 's/$/ 2 3/' >"$T/line.xyz"
req POST '/v1/check?detail=surface' -H 'Content-Type: text/plain' --data-binary "@$T/line.xyz"
is "what cannot be used" "$STATUS" 200
req POST "/v1/subjects/alice/verify?detail=surface" -H "$PLY" --data-binary "@$T/a2.ply"
glb "a verification"
is "of whom" "$(jq -r .extras.subject "$T/glb")" alice
req GET "/v1/templates/$id/surface"
glb "a template"
is "the node of a template" "$(jq -r '[.nodes[].name] | join(" ")' "$T/glb")" face
req GET "/v1/templates/$id/surface?format=ply"
is "as PLY" "$STATUS $(head -n 1 "$T/body")" '200 ply'
is "each is recorded" "$(sql "SELECT count(*) FROM $ENTRIES WHERE kind = 'surface'")" 3

# ---- the samples say what their buttons say
for pair in one_again:match one_turned:match other:no_match; do
    req POST /v1/compare -F "a=@$T/one.ply" -F "b=@$T/${pair%:*}.ply"
    is "one and ${pair%:*}" "$(get .decision)" "${pair#*:}"
done
for file in one one_again other; do
    req POST /v1/check -H "$PLY" --data-binary "@$T/$file.ply"
    is "$file: nothing to advise" "$(get '.enrollable, (.advice | length)' | paste -sd' ')" 'true 0'
done
req POST /v1/check -H "$PLY" --data-binary "@$T/one_turned.ply"
contains "the turned one: something" "$T/body" 'turn the head towards the scanner'

# ---- who may have them
AUTH=$VERIFY
req POST '/v1/compare?detail=surface' -F "a=@$T/a.ply" -F "b=@$T/a2.ply"
is "a comparison takes no scope but verify" "$STATUS" 200

# ---- two files in a form
gzip -c "$T/a2.ply" >"$T/a2.ply.gz"
req POST /v1/compare -F "a=@$T/a.ply" -F "b=@$T/a2.ply.gz"
is "one of them packed" "$STATUS $(get .decision)" '200 match'
req POST /v1/compare -F "a=@$T/a.ply" -F "b=@$T/line.xyz"
problem "one of them unusable" 422 degenerate 'b\.points'
printf 'ply\nformat ascii 1.0\n' >"$T/broken.ply"
for _ in 1 2 3; do # a sanitizer finds what is not given back
    req POST /v1/compare -F "a=@$T/a.ply" -F "b=@$T/broken.ply"
done
problem "one of them broken" 400 malformed '^b: '
stop_daemon

# ---- left out
start_daemon --no-console
for path in /console /console/style.css; do
    gives 404 "$path with --no-console" req GET "$path"
done
req GET /
is "the root is the API's description then" "$STATUS $(field Location)" "303 docs"
finish
