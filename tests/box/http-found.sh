#!/bin/sh
# Goal: without an option the face is found in any unit and axes, among points from elsewhere, and
# in dense scans; the heat map, the view and the advice are about the file that was sent.
# shellcheck disable=SC2016 # the variables are jq's and awk's
. tests/box/lib.sh

TEXT='Content-Type: text/plain'
scan 2 0 "$T/a.xyz"
scan 2 1 "$T/b.xyz"
scan 12 0 "$T/other.xyz"
start_daemon --no-auth --attempts 0

# moved FILE AWK: its points as the AWK expressions say, in which x, y and z are a point's.
moved() {
    awk "{ x = \$1; y = \$2; z = \$3; print $2 }" "$1"
}

send POST /v1/subjects/mm/templates "$TEXT" "$T/a.xyz"
is "enrolled in mm, from the front" "$STATUS $(get '.scan | [.units, .points_used > 2800] | tojson')" '201 ["mm",true]'
send POST /v1/subjects/mm/verify "$TEXT" "$T/b.xyz"
score=$(get .score)

# ---- units and axes
# One of each: the unit, the axes, and what the response says of the unit.
while read -r unit words; do
    moved "$T/b.xyz" "$words" >"$T/x"
    send POST /v1/subjects/mm/verify "$TEXT" "$T/x"
    is "$unit: $words" "$STATUS $(get '[.decision, .scan.units] | join(" ")')" "200 match $unit"
    ok "$unit: nearly the same score, $(get .score)" jq_true ".score - $score | fabs < 3" "$T/body"
    ok "its view is a turn in its unit" jq_true '.scan.view as $v
        | {mm: 1, cm: 10, m: 1000, in: 25.4}[.scan.units] as $u
        | ($v[0] * ($v[5] * $v[10] - $v[6] * $v[9]) - $v[1] * ($v[4] * $v[10] - $v[6] * $v[8])
           + $v[2] * ($v[4] * $v[9] - $v[5] * $v[8])) / ($u * $u * $u) - 1 | fabs < 1e-3' "$T/body"
    # A face seen from the front, with its nose in the middle.
    ok "it maps the file to the frontal view" awk -v view="$(get '.scan.view | map(tostring) | join(" ")')" '
        function wide(value) { return value < -150 || value > 150 }
        BEGIN { split(view, v, " ") }
        { for (i = 0; i < 3; i++) p[i] = v[4 * i + 1] * $1 + v[4 * i + 2] * $2 + v[4 * i + 3] * $3 + v[4 * i + 4]
          if (wide(p[0]) || wide(p[1])) far++
          if (NR == 1 || p[2] > top) { top = p[2]; side = p[0] } }
        END { exit far > 0 || side < -20 || side > 20 }' "$T/x"
    other=$words
done <<'EOF'
mm x, -y, -z
mm z, x, y
mm 0.6 * x + 0.8 * y + 5000, z, 0.8 * x - 0.6 * y
cm x / 10, y / 10, z / 10
m x / 1000, y / 1000, z / 1000
m -x / 1000, -y / 1000, z / 1000
m x / 1000, -y / 1000, -z / 1000
m y / 1000, z / 1000, x / 1000
in x / 25.4, y / 25.4, z / 25.4
EOF
moved "$T/other.xyz" "$other" >"$T/x"
send POST /v1/subjects/mm/verify "$TEXT" "$T/x"
is "somebody else" "$STATUS $(get .decision)" "200 no_match"
moved "$T/a.xyz" 'x / 1000, -y / 1000, -z / 1000' >"$T/camera"
send POST /v1/check "$TEXT" "$T/camera"
is "a note" "$(get '[.usable, .enrollable, .notes] | tojson')" \
    '[true,true,["detected metres; units=m skips the detection"]]'
send POST '/v1/check?units=m' "$TEXT" "$T/camera"
is "the unit given" "$(get '[.usable, .enrollable, .advice, .notes] | tojson')" '[true,true,[],[]]'
send POST '/v1/check?axes=scanner&units=m' "$TEXT" "$T/camera"
is "axes=scanner: nothing is turned" "$STATUS $(get .usable)" "200 false"
jq -R -s -c '{axes: "scanner", units: "m", points: split("\n") | map(select(. != "")
    | split(" ") | map(tonumber))}' "$T/camera" >"$T/camera.json"
send POST /v1/check "$JSON" "$T/camera.json"
is "likewise as a member" "$STATUS $(get .usable)" "200 false"
jq -c '.axes = "auto"' "$T/camera.json" >"$T/x"
send POST /v1/check "$JSON" "$T/x"
is "but auto" "$STATUS $(get .usable)" "200 true"
send POST /v1/subjects/camera/templates "$TEXT" "$T/camera"
is "enrolled as a camera sees it" "$STATUS $(get .scan.units)" '201 m'
send POST /v1/subjects/camera/verify "$TEXT" "$T/b.xyz"
is "verified from the front" "$STATUS $(get .decision)" '200 match'

# ---- points from elsewhere: a wall of 4,000 points before and after those of the face
awk 'BEGIN { for (i = 0; i < 4000; i++) print -400 + 13 * (i % 63), -400 + 12 * (i / 63), -420 }' >"$T/wall"
cat "$T/wall" "$T/b.xyz" "$T/wall" >"$T/walled"
send POST '/v1/subjects/mm/verify?detail=heatmap' "$TEXT" "$T/walled"
is "a wall behind" "$STATUS $(get .decision)" '200 match'
ok "it is told" jq_true '.scan | .points_read == 11000 and .points_used > 2500 and .points_used <= 3000
    and .warnings == ["points_elsewhere"]' "$T/body"
is "the heat map has a value for each point sent" "$(get '.heatmap | length')" 11000
is "null on the wall" "$(get '.heatmap | (.[:4000] + .[-4000:]) | all(. == null)')" true
ok "small on the face" jq_true '.heatmap[4000:7000] | map(numbers) | length > 2300 and
    (map(select(fabs < 1)) | length) > 0.9 * length' "$T/body"
send POST /v1/check "$TEXT" "$T/walled"
contains "a note" "$T/body" '"7[0-9] % of the points are outside the face and were ignored"'

# ---- a dense scan is thinned
scan 2 2 "$T/dense.xyz" --points 40000
send POST '/v1/subjects/mm/verify?detail=heatmap' "$TEXT" "$T/dense.xyz"
is "a dense scan" "$STATUS $(get '[.decision, .scan.warnings] | tojson')" '200 ["match",["thinned"]]'
ok "thinned" jq_true '.scan | .points_used <= 10000 and .points_used > 5000 and .points_read > 39000' "$T/body"
ok "a value for each point used at most" jq_true '(.heatmap | length) == .scan.points_read
    and (.heatmap | map(numbers) | length) <= .scan.points_used' "$T/body"

# ---- two faces: a verification takes the nearest, an enrolment none
{ cat "$T/b.xyz"; moved "$T/other.xyz" 'x + 320, y, z - 150'; } >"$T/two"
send POST /v1/subjects/mm/verify "$TEXT" "$T/two"
is "the nearest is verified" "$STATUS $(get '[.decision, (.scan.warnings | contains(["several_faces"]))] | tojson')" \
    '200 ["match",true]'
send POST /v1/subjects/two/templates "$TEXT" "$T/two"
problem "two are not enrolled" 422 several_faces \
    '^points: an enrolment needs exactly one face: let only one person be in view: 2 faces were found'
send POST /v1/check "$TEXT" "$T/two"
fits "a check of both" Check
is "a check of both" "$STATUS $(get '[.usable, .enrollable, .code] | tojson')" '200 [true,false,"several_faces"]'
is "counted" "$(metric 'surfaced_scans_refused_total{code="several_faces"}')" 1
is "counted" "$(metric 'surfaced_checks_total{outcome="usable"}')" 1

# ---- depths in steps, a picture on its side, a wrong focal length
scan 2 3 "$T/steps.xyz" --points 6000
awk '{ printf "%.4f %.4f %.4f\n", $1, $2, 3 * int($3 / 3 + 1000.5) - 3000 }' "$T/steps.xyz" >"$T/steps"
send POST /v1/check "$TEXT" "$T/steps"
fits "a check of depths in steps" Check
ok "steps are told" jq_true '.usable and (.scan.warnings | contains(["stepped"])) and .quality.noise_mm >= 1.5' "$T/body"
contains "what to change" "$T/body" 'its depths are 3.0 mm apart, 1.2 mm or less is good'
send POST /v1/check "$TEXT" "$T/steps.xyz"
ok "none are told of continuous ones" jq_true '.scan.warnings | contains(["stepped"]) | not' "$T/body"
moved "$T/b.xyz" '0 - y, x, z' >"$T/side"
send POST /v1/check "$TEXT" "$T/side"
ok "on its side" jq_true '.usable and .enrollable and (.scan.yaw_deg | fabs < 15)' "$T/body"
contains "it is told" "$T/body" 'the picture is turned by [89][0-9]°: hold the scanner upright'

finish
