#!/bin/sh
# Goal: the refusals of scans in the API's description are what the daemon says, and the limits in
# them are those in force.  A scan of each kind is refused at enrolment and at verification; the
# detail must be that of the example, but for what was measured.
# shellcheck disable=SC2016 # the variables are jq's and awk's
. tests/box/lib.sh

TEXT='Content-Type: text/plain'
start_daemon --no-auth --attempts 0
curl -sS -o "$T/api" "$URL/openapi.json"

# A jq program: every figure becomes #, unless the words round it say that it is a limit.
MASK='def mask: gsub("(?<all>(?<of>(at least|up to|fewer than|limit is|beyond|a face has [0-9]+ to) )?-?[0-9]+([.,][0-9]+)*(e[+][0-9]+)?(?<to>( mm)? or (less|more))?)";
        if .of or .to then .all else "#" end);'

# refused CODE TYPE FILE [QUERY [ROUTE]]: the detail is that of the example, on both routes or ROUTE.
refused() {
    for route in ${5:-bob/templates alice/verify}; do
        case $route in */verify) group=Unusable ;; *) group=EnrollUnusable ;; esac
        send POST "/v1/subjects/$route?${4:-}" "$2" "$3"
        is "$1, $route" "$STATUS $(get .code)" "422 $1"
        is "$1, $route: its example" "$(jq -r --arg group $group --arg code "$1" "$MASK"'
            .components.responses[$group].content["application/problem+json"].examples[$code].value.detail
            | mask' "$T/api")" "$(jq -r "$MASK .detail | mask" "$T/body")"
        echo "$group $1" >>"$T/codes"
    done
}

scan 1 0 "$T/a.xyz"
scan 1 0 "$T/a.json"
scan 1 1 "$T/swapped.xyz"
scan 1 1 "$T/noisy.ply" --noise 6
send POST /v1/subjects/alice/templates "$TEXT" "$T/a.xyz"
head -n 3 "$T/a.xyz" >"$T/x"
refused too_few_points "$TEXT" "$T/x"
awk 'BEGIN { printf "{\"points\": [[1,2,3]"
    for (i = 1; i < 1000001; i++) printf ",[%d,%d,3]", i % 1000, i / 1000; print "]}" }' >"$T/x"
refused too_many_points "$JSON" "$T/x"
jq -c '.points[17][0] = "far"' "$T/a.json" | sed 's/"far"/1e999/' >"$T/x"
refused not_finite "$JSON" "$T/x"
awk 'NR == 18 { $1 = 17000 } { print }' "$T/a.xyz" >"$T/x"
refused out_of_range "$TEXT" "$T/x" 'axes=scanner&units=mm'
awk '{ print $1, $1, $1 }' "$T/a.xyz" >"$T/x"
refused degenerate "$TEXT" "$T/x"
awk '{ print $1 / 1000, $2 / 1000, $3 / 1000 }' "$T/a.xyz" >"$T/x"
refused units_suspicious "$TEXT" "$T/x" units=mm
awk 'BEGIN { srand(2); for (i = 0; i < 12000; i++) print 900000 * rand(), 900000 * rand(), 900000 * rand() }' >"$T/x"
refused no_face "$TEXT" "$T/x"
awk '{ print; print $1 + 300, $2, $3 }' "$T/a.xyz" >"$T/x"
refused several_faces "$TEXT" "$T/x" '' bob/templates
"$BUILD/headscan" --kind depth --mirrored made-up:1 -o "$T/x.pcd"
refused mirrored "$BYTES" "$T/x.pcd" '' bob/templates
awk '{ print -$1, $2, $3 }' "$T/swapped.xyz" >"$T/x"
refused mirrored "$TEXT" "$T/x" '' alice/verify
awk '{ print $1, $2, 20 * cos(sqrt($1 * $1 + $2 * $2) / 15) }' "$T/a.xyz" >"$T/x"
refused not_a_face "$TEXT" "$T/x"
refused low_quality "$PLY" "$T/noisy.ply" axes=scanner
scan 1 2 "$T/frame-1.ply"
scan 2 2 "$T/frame-2.ply" --noise 0.6
req POST /v1/subjects/bob/templates -F "file=@$T/frame-1.ply" -F "file=@$T/frame-2.ply"
is "a form of two people" "$(jq -c '.components.responses.EnrollUnusable.content["application/problem+json"].examples.several_people.value
    | [.code, .detail]' "$T/api")" "$(jq -c '[.code, .detail]' "$T/body")"
echo 'EnrollUnusable several_people' >>"$T/codes"
is "every code of a refused scan" "$(sort "$T/codes")" "$(jq -r '.components.responses
    | {Unusable, EnrollUnusable} | to_entries[] | .key as $group
    | [.value | .. | objects | .code.enum? // empty | .[]] | .[]
    | "\($group) \(.)"' "$T/api" | sort)"

# ---- what /v1/check says of a scan that can be verified by, and not enrolled
"$BUILD/headscan" --kind half --yaw 38 --unit 1000 made-up:2 -o "$T/half.ply"
send POST /v1/check "$PLY" "$T/half.ply"
for member in '[.usable, .enrollable, .code]' '.detail | mask' '[.advice[] | mask]' .scan.warnings; do
    is "check: $member" "$(jq -c "$MASK .paths[\"/v1/check\"].post.responses[\"200\"].content[\"application/json\"].example
        | $member" "$T/api")" "$(jq -c "$MASK $member" "$T/body")"
done
finish
