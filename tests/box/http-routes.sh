#!/bin/sh
# Goal: every route works as described, with every format of clouds (what is refused:
# http-bad-input.sh).
. tests/box/lib.sh

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
scan 1 1 "$T/a2.json" --pose 8 --shift 10
scan 1 1 "$T/a2.xyz" --pose 8 --shift 10
sed 's/^/v /' "$T/a2.xyz" >"$T/a2.obj"
scan 2 0 "$T/b.ply" --pose 8 --shift 10
start_daemon --no-auth

# ---- about the daemon
req GET /healthz
is healthz "$STATUS $(get .status)" "200 ok"
req GET /readyz
is readyz "$STATUS $(cat "$T/body")" '200 {"status":"ready"}'
req GET /version
version=$(get .version)
is version "$STATUS $(cat "$T/body")" "200 {\"version\":\"$version\"}"
is "the program's" "$version" "$("$BUILD/surfaced" --version | sed 's|.*/\([0-9.]*\) .*|\1|')"
req GET /openapi.json
is "openapi's version" "$STATUS $(get .info.version)" "200 $version"
is "openapi's format" "$(get .openapi)" 3.1.0
# shellcheck disable=SC2016 # $d is jq's
ok "openapi's references resolve" jq_true '. as $d
    | [.. | objects | ."$ref"? // empty | ltrimstr("#/") / "/"]
    | all(. as $p | $d | getpath($p) != null)' "$T/body"

# ---- enroll
gives 201 "enroll" send POST '/v1/subjects/alice/templates?label=scanner%201' "$PLY" "$T/a.ply"
id=$(get .template_id)
is "Location" "$(field Location)" "/v1/templates/$id"
is "its description" "$(get '[.subject, .label, .points > 2900, .triangles > 5000,
    (.digest | length), (.created | test("^20.*Z$")), .quality.score > 0.3,
    .quality.coverage > 0.3, .quality.density_mm > 0.5, .quality.noise_mm >= 0,
    (.engine | test("^surfaced/"))] | @csv')" \
    '"alice","scanner 1",true,true,64,true,true,true,true,true,true'
cp "$T/body" "$T/first"
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply" -H 'Idempotency-Key: one'
is "the same cloud again, whatever its key" "$STATUS$(field Idempotent-Replayed)" 200
ok "the same template" cmp -s "$T/body" "$T/first"
gives "409 sample_mismatch" "another subject's sample" send POST /v1/subjects/alice/templates "$PLY" "$T/b.ply"
is "and nothing of the comparison" "$(get 'keys | join(" ")')" \
    "code detail request_id status title type"
awk '$2 < 0' "$T/a2.xyz" >"$T/part.xyz"
send POST /v1/subjects/alice/templates 'Content-Type: text/plain' "$T/part.xyz"
problem "a part of the face" 422 not_a_face 'wanted'
req GET /v1/subjects/alice
is "nothing was stored" "$(get '.templates | length')" 1

# ---- verify, in each form of cloud
for form in "$PLY:ply" "Content-Type: application/x-ply:ply" "$BYTES:ply" "$BYTES:obj" \
    "Content-Type: model/obj:obj" "Content-Type: text/plain; charset=utf-8:xyz" \
    "$BYTES:xyz" "$JSON; charset=utf-8:json" "content-type: MODEL/X-PLY:ply"; do
    send POST /v1/subjects/alice/verify "${form%:*}" "$T/a2.${form##*:}"
    is "verify as $form" "$STATUS $(get .decision)" "200 match"
done
is "every member is there" "$(get '[.score, .threshold, .fmr_at_score, .disparity_mm,
    .overlap, .templates_compared, .quality.score,
    .timing_ms.parse, .timing_ms.prepare, .timing_ms.score, .timing_ms.align,
    .timing_ms.minimal, .timing_ms.total] | all(type == "number" and . >= 0)')" true
is "the minimal disparity takes its time of the total" \
    "$(get '.timing_ms | .minimal > 0 and .score + .align + .minimal < .total')" true
is "subject, template, engine" "$(get '[.subject, .template_id, .engine] | @tsv')" \
    "$(printf 'alice\t%s\t%s' "$id" "$(jq -r .engine "$T/first")")"
is "decided by the threshold" "$(get '.score >= .threshold')" true
send POST '/v1/subjects/alice/verify?detail=measure' "$PLY" "$T/a2.ply"
is "disparity = volume / area" "$(get '(.disparity_mm - (.minimal | .volume_mm3 / .overlap_mm2)) | fabs < 1e-4')" true
is "weighted it is another" "$(get '.minimal.weighted_mm
    | type == "number" and . > 0' && get '.minimal.weighted_mm == .disparity_mm')" "$(printf 'true\nfalse')"
is "the transforms are affine" "$(get '.alignment.transform, .minimal.transform
    | length == 16 and .[12:] == [0,0,0,1]' | sort -u)" true
is "another pose, near the alignment" "$(get '[.alignment.transform, .minimal.transform]
    | transpose | map(.[0] - .[1] | fabs) | max < 20')" true
is "the regions' parts are the score" "$(get '([.regions[] | numbers] | add) - .score | fabs < 0.05')" true
send POST "/v1/templates/$id/verify" "$PLY" "$T/a2.ply"
is "verify against one template" "$STATUS $(get .decision)" "200 match"
send POST /v1/subjects/alice/verify "$PLY" "$T/b.ply"
is "verify another subject's scan" "$STATUS $(get .decision)" "200 no_match"
send POST '/v1/subjects/alice/verify?detail=heatmap' "$JSON" "$T/a2.json"
is "a gap for each point" "$(get '.heatmap | length')" "$(jq '.points | length' "$T/a2.json")"
is "each a number or null" "$(get '.heatmap | all(type == "number" or type == "null")')" true
is "mostly numbers" "$(get '(.heatmap | map(numbers) | length) > (.heatmap | length / 2)')" true
scan 1 1 "$T/less.xyz" --pose 0 --shift 0
awk '$2 < 0' "$T/less.xyz" >"$T/forehead.xyz"
send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/forehead.xyz"
is "a part of the face" "$STATUS $(get .decision)" "200 inconclusive"
for query in '' '&' 'units=mm&'; do
    send POST "/v1/subjects/alice/verify?$query" "$PLY" "$T/a2.ply"
    is "'$query'" "$STATUS $(get .decision)" "200 match"
done

jq -c '{points: [.points[] | map(. / 1000)], units: "m"}' "$T/a2.json" >"$T/m.json"

# ---- several templates: the lowest disparity decides
gives 201 "force" send POST '/v1/subjects/alice/templates?force=true' "$PLY" "$T/b.ply"
other=$(get .template_id)
scan 2 1 "$T/b1.ply"
send POST /v1/subjects/alice/verify "$PLY" "$T/b1.ply"
is "the best of two" "$(get '[.decision, .templates_compared, .template_id] | @tsv')" \
    "$(printf 'match\t2\t%s' "$other")"
scan 2 5 "$T/b5.ply" --pose 5 --shift 5
gives 201 "a sample that matches the second template only" send POST /v1/subjects/alice/templates "$PLY" "$T/b5.ply"
req DELETE "/v1/templates/$(get .template_id)"
send POST '/v1/subjects/alice/templates?force=true' 'Content-Type: text/plain' "$T/part.xyz"
problem "a part of the face, by force" 422 not_a_face

# ---- compare
jq -c -n --slurpfile a "$T/a2.json" --slurpfile b "$T/m.json" '{a: $a[0], b: $b[0]}' >"$T/ab.json"
send POST /v1/compare "$JSON" "$T/ab.json"
is "compare" "$STATUS $(get '[.decision, .subject, .template_id, .templates_compared] | @csv')" \
    '200 "match",,,1'
is "a cloud with itself" "$(get '.disparity_mm < 0.01 and .score > .threshold')" true

# ---- read and delete
req GET "/v1/templates/$id"
is "the description again, without the scan" "$(jq -c . "$T/body")" "$(jq -c 'del(.scan)' "$T/first")"
gives 200 "HEAD" req HEAD "/v1/templates/$id"
req GET /v1/subjects/alice
is "subject" "$(get '[.subject, (.templates | length), .templates[0].template_id] | @tsv')" \
    "$(printf 'alice\t2\t%s' "$id")"
for s in 'b@x' c:1 d_2 'e.3' f-4; do
    gives 201 "enroll $s" send POST "/v1/subjects/$s/templates" "$PLY" "$T/a.ply"
done
req GET /v1/subjects
cursor='' seen=''
for _ in 1 2 3; do
    req GET "/v1/subjects?limit=2&cursor=$cursor"
    seen="$seen $(get '[.subjects[].subject] | join(" ")')"
    cursor=$(get .next_cursor)
done
is "pages" "$seen, then $cursor" " alice b@x c:1 d_2 e.3 f-4, then null"
req GET /v1/subjects/b%40x
is "an encoded id" "$(get .subject)" b@x
req DELETE "/v1/templates/$other"
is "delete a template" "$STATUS $(wc -c <"$T/body" | tr -d ' ')" "204 0"
gives "404 not_found" "delete it again" req DELETE "/v1/templates/$other"
gives "404 not_found" "verify against it" send POST "/v1/templates/$other/verify" "$PLY" "$T/b.ply"
send POST /v1/subjects/alice/verify "$PLY" "$T/b.ply"
is "it does not match any more" "$(get '[.decision, .templates_compared] | @tsv')" \
    "$(printf 'no_match\t1')"
# If another process deletes a template, the daemon must not match it either.
send POST /v1/subjects/f-4/verify "$PLY" "$T/a2.ply"
is "f-4 matches" "$STATUS $(get .decision)" "200 match"
f4=$(get .template_id)
ctl template delete "$f4" --yes
gives "404 not_found" "deleted by another process" send POST /v1/subjects/f-4/verify "$PLY" "$T/a2.ply"
gives "404 not_found" "by template too" send POST "/v1/templates/$f4/verify" "$PLY" "$T/a2.ply"
req DELETE /v1/subjects/alice
is "erase" "$STATUS $(get '[.subject, .templates_removed] | @tsv')" "$(printf '200 alice\t1')"
is "erased_at" "$(get '.erased_at | test("^20.*Z$")')" true
is "what was removed" "$(get '.template_ids | @csv')" "\"$id\""
is "its digest" "$(get .digest)" \
    "$(get '"surface erasure 2", .subject, .subject_uid, .erased_at, .template_ids[]' | sha256sum | cut -c 1-64)"
is "its entry in the audit log" "$(sql "SELECT kind, at, lower(hex(hash)) FROM $ENTRIES
    WHERE log = 0 AND seq = $(get .audit.seq)")" "$(get '"delete_subject|\(.erased_at)|\(.audit.hash)"')"
gives "404 not_found" "erase again" req DELETE /v1/subjects/alice
gives "404 not_found" "verify an erased subject" send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
gives "404 not_found" "or its template" send POST "/v1/templates/$id/verify" "$PLY" "$T/a2.ply"

# ---- targets in other forms: what a proxy sends, and the whole server
for target in http://127.0.0.1/healthz HTTP://example.org:8080/healthz https://example.org/healthz?; do
    req GET / --request-target "$target"
    is "$target" "$STATUS $(get .status)" "200 ok"
done
req GET / --request-target http://127.0.0.1
is "the root is the console" "$STATUS $(field Location)" "303 console"
gives "400 invalid_parameter" "a query is no path" req GET / --request-target 'http://127.0.0.1?x=/healthz'
for target in http:/healthz ftp://127.0.0.1/healthz '*'; do
    gives "404 no_such_route" "$target" req GET / --request-target "$target"
done
send POST / "$PLY" "$T/a2.ply" --request-target "http://127.0.0.1/v1/subjects/alice/verify?detail=none"
problem "with its query" 400 invalid_parameter
req OPTIONS / --request-target '*'
is "OPTIONS *" "$STATUS $(field Allow)" '204 GET, HEAD, POST, PATCH, DELETE, OPTIONS'

# ---- request ids
req GET /healthz -H 'X-Request-Id: abc.DEF-1_2'
is "a valid one is used" "$(field X-Request-Id)" abc.DEF-1_2
for bad in 'a b' 'a"b' "$(printf '%065d' 1)" '<x>'; do
    req GET /healthz -H "X-Request-Id: $bad"
    ok "'$bad' is replaced" matches "$(field X-Request-Id)" '^[0-9a-f]{8}-[0-9a-f]{8}$'
done

# ---- the description: kept by its ETag, compressed
req GET /openapi.json
is "the description" "$STATUS $(field Content-Encoding)$(field Cache-Control) $(field Vary)" \
    '200 no-cache Accept-Encoding'
cp "$T/body" "$T/whole"
tag=$(field ETag)
for coding in gzip 'br, gzip;q=0.5' '*'; do
    req GET /openapi.json -H "Accept-Encoding: $coding"
    is "$coding" "$STATUS $(field Content-Encoding)" '200 gzip'
    ok "$coding: the same" sh -c "gzip -dc '$T/body' | cmp -s - '$T/whole'"
    ok "$coding: a fifth of it at most" test "$(($(wc -c <"$T/body") * 5))" -lt "$(wc -c <"$T/whole")"
done
packed=$(field ETag)
ok "its tag is another" test "$packed" != "$tag"
for coding in '' identity 'gzip;q=0' 'gzip; q=0.0, br' xgzip; do
    req GET /openapi.json -H "Accept-Encoding: $coding"
    is "'$coding': as it is" "$STATUS $(field Content-Encoding)" '200 '
done
for match in "$tag" "W/$tag" "\"other\", $packed" '*'; do
    : >"$T/body" # which curl does not touch where there is none
    req GET /openapi.json -H "If-None-Match: $match"
    is "$match" "$STATUS $(field ETag) $(wc -c <"$T/body")" "304 $tag 0"
done
gives 200 "another tag" req GET /openapi.json -H 'If-None-Match: "other"'
req HEAD /openapi.json -H 'Accept-Encoding: gzip'
is "HEAD" "$STATUS $(field ETag)" "200 $packed"
req GET /healthz
is "other responses are not kept" "$(field Cache-Control)$(field ETag)" no-store
finish
