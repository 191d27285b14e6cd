#!/bin/sh
# Goal: a response says what was found in the scan; /v1/check says what would be done with one and
# what to change, and stores nothing; a form with one file is the same as the file; refusals are
# counted by their code.
# shellcheck disable=SC2016 # the variables are jq's
. tests/box/lib.sh

scan 2 2 "$T/enrolled.ply"
scan 2 0 "$T/a.ply"
scan 2 0 "$T/a.xyz"
scan 2 1 "$T/b.json"
scan 2 1 "$T/noisy.ply" --noise 6
awk '{ print $1, $2, 0 }' "$T/a.xyz" >"$T/flat.xyz"
awk '{ print $1 / 1000, $2 / 1000, $3 / 1000 }' "$T/a.xyz" >"$T/metres.xyz"
start_daemon --attempts 0 --max-body 2000000
AUTH=$(new_token one)

# ---- what was found: the same object wherever a scan is taken
FRONTAL='{"face":true,"points_dropped":0,"points_read":3000,"units":"mm"}'
# found TITLE [FILTER]: the last response has it as .scan, or where FILTER says.
found() {
    is "$1: status" "$STATUS" "${3:-200}"
    is "$1: what was found" "$(get "${2:-.scan} | {points_dropped, points_read, units,
        face: (.points_used > 2800 and .points_used <= 3000)}" | jq -c .)" "$FRONTAL"
    ok "$1: the view is a rigid one" jq_true "${2:-.scan} | .view | length == 16 and .[12:] == [0, 0, 0, 1]
        and ([.[0:3], .[4:7], .[8:11]] | map(map(. * .) | add) | all(. > 0.99999 and . < 1.00001))" \
        "$T/body"
    is "$1: nothing is covered, and no warning" "$(get "${2:-.scan} | [.occluded < 0.2, .warnings] | tojson")" \
        '[true,[]]'
}
send POST /v1/subjects/alice/templates "$PLY" "$T/enrolled.ply"
found "enrolment" .scan 201
is "its format" "$(get .scan.format)" ply
id=$(get .template_id)
send POST /v1/subjects/alice/templates "$PLY" "$T/enrolled.ply"
found "enrolled before"
for route in subjects/alice "templates/$id"; do
    send POST "/v1/$route/verify" "$JSON" "$T/b.json"
    found "verify at $route"
    is "its format" "$(get .scan.format)" json
    send POST "/v1/$route/verify" "$JSON" "$T/b.json" -H 'Prefer: return=minimal'
    is "the decision alone" "$(get 'keys | tojson')" '["decision","subject","template_id"]'
done
jq -c '{a: ., b: .}' "$T/b.json" >"$T/ab.json"
send POST /v1/compare "$JSON" "$T/ab.json"
found "compare, a" .scan.a
found "compare, b" .scan.b
send POST /v1/asymmetry "$PLY" "$T/a.ply"
found "asymmetry"
req GET "/v1/templates/$id"
is "what is stored does not say" "$(get 'has("scan")')" false

# ---- the unit and the axes
for query in units=auto units=mm axes=auto axes=scanner 'units=auto&axes=scanner' 'axes=auto&units=mm'; do
    send POST "/v1/subjects/alice/verify?$query" "$PLY" "$T/a.ply"
    found "$query"
    is "$query" "$(get .decision)" match
done
for member in '.units = "auto"' '.units = "mm"' '.axes = "auto"' '.axes = "scanner"' \
    '.units = "auto" | .axes = "scanner"'; do
    jq -c "$member" "$T/b.json" >"$T/x"
    send POST /v1/subjects/alice/verify "$JSON" "$T/x"
    found "$member"
    is "$member" "$(get .decision)" match
done
send POST '/v1/subjects/alice/verify?units=mm' "$BYTES" "$T/metres.xyz"
problem "metres said to be mm" 422 units_suspicious \
    '^points: the extent is 0\.1[0-9]* x 0\.1[0-9]* x 0\.0[0-9]* in the units given; a face has 60 to 500 mm: is it metres\?'
send POST '/v1/subjects/alice/verify?units=m' "$BYTES" "$T/metres.xyz"
is "metres" "$STATUS $(get '[.decision, .scan.units, (.scan.view | .[0] | round)] | tojson')" \
    '200 ["match","m",1000]'
awk '{ print $1 * 1000, $2 * 1000, $3 * 1000 }' "$T/a.xyz" >"$T/micro.xyz"
for units in auto um; do # a unit that is told is one that is taken
    send POST "/v1/subjects/alice/verify?units=$units" "$BYTES" "$T/micro.xyz"
    is "micrometres, $units" "$STATUS $(get '[.decision, .scan.units, (.scan.view[0] * 1000 | round)] | tojson')" \
        '200 ["match","um",1]'
done
awk '{ print $1 / 100, $2 / 100, $3 / 100 }' "$T/a.xyz" >"$T/deci.xyz"
send POST /v1/check "$BYTES" "$T/deci.xyz"
is "decimetres" "$STATUS $(get '[.usable, .code] | tojson')" '200 [false,"units_suspicious"]'
ok "decimetres: the unit that would fit" matches "$(get .detail)" \
    'a face in none of the units; at about (9[0-9]|1[01]0) mm a unit it would be'
jq -c .points "$T/b.json" >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x"
is "the list of points alone" "$STATUS $(get .decision)" '200 match'
jq -c '{points: [.points[] | map(. * 1000)], units: "um"}' "$T/b.json" >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x"
is "micrometres in JSON" "$STATUS $(get '[.decision, .scan.units] | tojson')" '200 ["match","um"]'
jq -c '{points: [.points[] | map(. / 10)], units: "cm"}' "$T/b.json" >"$T/x"
send POST '/v1/subjects/alice/verify?units=m' "$JSON" "$T/x"
is "the file's own unit wins" "$STATUS $(get '[.decision, .scan.units] | tojson')" '200 ["match","cm"]'

# ---- check
logged() {
    sql "SELECT count(*) FROM $ENTRIES WHERE outcome NOT LIKE '% verify'; SELECT count(*) FROM templates" |
        paste -sd ' '
}
before=$(logged)
send POST /v1/check "$PLY" "$T/a.ply"
found "check"
is "usable" "$(get '[.usable, .enrollable, .code, .detail] | tojson')" '[true,true,null,null]'
is "no advice" "$(get '.advice | tojson')" '[]'
is "its quality" "$(get '.quality | .score > 0.9 and .reasons == []')" true
send POST /v1/check "$BYTES" "$T/flat.xyz"
is "a plane" "$STATUS $(get '[.usable, .enrollable] | tojson')" '200 [false,false]'
ok "a plane: not a face: $(get .code)" matches "$(get .code)" '^(not_a_face|no_face)$'
ok "the detail ends with the advice" jq_true '. as $c | .advice | length > 0
    and all(. as $line | $c.detail | contains($line))' "$T/body"
code=$(get .code)
detail=$(get .detail)
send POST /v1/subjects/alice/verify "$BYTES" "$T/flat.xyz"
problem "as a verification says it" 422 "$code"
is "in the same words" "$(get .detail)" "$detail"
send POST '/v1/check?axes=scanner' "$PLY" "$T/noisy.ply"
is "noise" "$STATUS $(get '[.usable, .enrollable, .code] | tojson')" '200 [false,false,"low_quality"]'
is "its reasons" "$(get '.quality.reasons | tojson')" '["noisy"]'
ok "hold still" jq_true '.advice[0] | test("^hold still and scan again: the noise is [0-9.]+ mm")' \
    "$T/body"
send POST '/v1/check?units=mm' "$BYTES" "$T/metres.xyz"
is "metres said to be mm" "$STATUS $(get '[.usable, .code, .scan.units] | tojson')" \
    '200 [false,"units_suspicious","mm"]'
contains "is it metres?" "$T/body" '"is it metres\?'
echo '{"points": [[1, 2, 3]]}' >"$T/x"
send POST /v1/check "$JSON" "$T/x"
is "a point" "$STATUS $(get '[.usable, .code, .quality] | tojson')" '200 [false,"too_few_points",null]'
printf '1 2 nan\n3 nan 1\n' >"$T/x"
send POST /v1/check "$BYTES" "$T/x"
is "points without a value alone" "$STATUS $(get '[.usable, .code, .scan, .quality] | tojson')" \
    '200 [false,"not_finite",null,null]'
awk 'BEGIN { for (i = 0; i <= 300000; i++) print "v 1 2 3" }' | gzip >"$T/many.gz"
send POST /v1/check "$BYTES" "$T/many.gz"
problem "too many bytes when unpacked" 413 body_too_large 'limit is 2000000 bytes when unpacked'
is "nothing was stored, and a refused verification alone logged" "$(logged)" "$before"

# ---- counted
is "checked, good" "$(metric 'surfaced_checks_total{outcome="enrollable"}')" 1
is "checked, bad" "$(metric 'surfaced_checks_total{outcome="unusable"}')" 6
is "refused" "$(metric "surfaced_scans_refused_total{code=\"$code\"}")" 1
is "refused" "$(metric 'surfaced_scans_refused_total{code="units_suspicious"}')" 1
is "a check is no refusal" "$(metric 'surfaced_scans_refused_total{code="too_few_points"}')" 0

# ---- a form with one file is the file
is_match() {
    is "$1" "$STATUS $(get .decision)" '200 match'
    is "$1: the same digits" "$(get .score)" "$score"
}
send POST /v1/subjects/alice/verify "$JSON" "$T/b.json"
score=$(get .score)
for type in '' ';type=application/json' ';type=application/octet-stream' ';type=image/jpeg' \
    ';filename=../../x y";.json'; do
    req POST /v1/subjects/alice/verify -F "file=@$T/b.json$type"
    is_match "curl -F, $type"
done
req POST /v1/subjects/alice/verify -F "anything=<$T/b.json"
is_match "a part without a file name"
req POST /v1/subjects/alice/verify -F "file=@-" <"$T/b.json" -H 'Transfer-Encoding: chunked'
is_match "in chunks"
gzip -k "$T/b.json"
req POST /v1/subjects/alice/verify -F "file=@$T/b.json.gz"
is_match "a .gz file"
req POST /v1/subjects/alice/verify \
    -F "file=@$T/b.json.gz;type=application/json;headers=Content-Encoding: gzip"
is_match "a coding of its own"
req POST /v1/subjects/bob/templates -F "file=@$T/a.ply;type=model/ply"
is "enrolled by a form" "$STATUS $(get .scan.format)" '201 ply'
req POST '/v1/check?units=mm' -F "file=@$T/a.ply"
is "checked by a form" "$STATUS $(get .usable)" '200 true'
head -c 2100000 /dev/zero >"$T/zero"
gzip -c "$T/zero" >"$T/zero.gz"
gives "413 body_too_large" "a large file" req POST /v1/subjects/alice/verify -F "file=@$T/zero"
for part in '' ';headers=Content-Encoding: gzip'; do
    req POST /v1/subjects/alice/verify -F "file=@$T/zero.gz$part"
    problem "a file that is large when unpacked$part" 413 body_too_large
done
finish
