#!/bin/sh
# Goal: a face's asymmetry over HTTP and by surfacelab: both give the same figures, which follow
# the asymmetry of the generated face; half a face is inconclusive, and other input an error.
# surfacelab simplify keeps within its tolerance and writes a scan.
# shellcheck disable=SC2016 # the variables are jq's
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# asymmetry FILE [OPTION...]: runs surfacelab asymmetry; sets CODE, the JSON is in $T/body.
asymmetry() {
    "$BUILD/surfacelab" asymmetry --json "$@" >"$T/body" 2>"$T/err"
    CODE=$?
}

# body TITLE FILTER: jq's FILTER is true for the last JSON.
body() {
    ok "$1" jq_true "$2" "$T/body"
}

scan 4 1 "$T/even.xyz" --symmetry 1 --yaw 9 --roll -6 --tx 12
scan 4 1 "$T/odd.xyz" --symmetry 0 --yaw 9 --roll -6 --tx 12
scan 4 1 "$T/odder.json" --symmetry -1 --yaw 9 --roll -6 --tx 12
awk '$1 > 10' "$T/even.xyz" >"$T/half.xyz"
start_daemon --no-auth

send POST /v1/asymmetry 'Content-Type: text/plain' "$T/even.xyz"
is "a symmetric face" "$STATUS $(get .conclusive)" "200 true"
body "no more than the scanner's error" '.plain_mm < 0.3 and .plain_mm <= .first_mm'
# The plane is that of the frontal view: back to the file's axes.
body "the plane is where the head was turned to" '.scan.view as $v | .plane |
    .normal as $n | [range(3) | . as $j | [range(3) | $n[.] * $v[4 * . + $j]] | add] as $at |
    .stop == "converged" and $at[0] > 0.97 and ($at[1] + 0.105 | fabs) < 0.01 and
    ($at[2] + 0.156 | fabs) < 0.01 and .turn_deg < 0.5 and .shift_mm < 0.5'
body "by the learned weight" '.weighted_mm > 0 and .weighted_mm < 0.3 and
    .weighted_mm != .plain_mm'
body "volume over area" '.volume_mm3 / .overlap_mm2 / .plain_mm - 1 | fabs < 1e-3'
figures='[.conclusive, .plain_mm, .weighted_mm, .first_mm, .volume_mm3, .overlap_mm2, .plane.normal]'
get "$figures" >"$T/even.http"
asymmetry "$T/even.xyz"
is "surfacelab's exit" "$CODE" 0
is "surfacelab's figures" "$(get "$figures")" "$(cat "$T/even.http")"

asymmetry "$T/odd.xyz"
odd=$(get .plain_mm)
body "an asymmetric face" '.plain_mm > 0.6 and .plain_mm < 2'
send POST /v1/asymmetry "$JSON" "$T/odder.json"
body "twice the asymmetry: about two times ${odd} mm" ".plain_mm / $odd | . > 1.5 and . < 2.1"
"$BUILD/surfacelab" asymmetry "$T/odd.xyz" >"$T/text"
is "as text" "$? $(grep -cE '^(asymmetry|weighted|first|common|plane|scan) ' "$T/text")" "0 6"

asymmetry "$T/half.xyz"
is "half a face: exit" "$CODE $(get .conclusive)" "2 false"
send POST /v1/asymmetry 'Content-Type: text/plain' "$T/half.xyz"
is "half a face" "$STATUS $(get .conclusive)" "200 false"

# ---- simplify

# simplify FILE OPTION...: to $T/small.ply; sets CODE, the JSON is in $T/body.
simplify() {
    "$BUILD/surfacelab" simplify --json "$@" --force --out "$T/small.ply" >"$T/body" 2>"$T/err"
    CODE=$?
}

scan 4 1 "$T/a.ply"
for mm in 0.1 0.5; do
    simplify "$T/a.ply" --tolerance "$mm"
    is "simplify by $mm mm" "$CODE" 0
    body "within it" ".error_mm <= $mm and .plain_mm < .error_mm and .kept < .points"
    body "the share" '.kept / .points - .share | fabs <= 0.00005'
done
is "as many points as reported" "$(sed -n 's/element vertex //p' "$T/small.ply")" "$(get .kept)"
body "fewer than a third" '.share < 0.33'
is "only its owner can read it" "$(stat -c %a "$T/small.ply")" 600
kept=$(get .kept) mean=$(get .plain_mm)
cp "$T/small.ply" "$T/again.ply"
simplify "$T/again.ply" --tolerance 0.001
is "a scan like any other" "$CODE $(get .points)" "0 $kept"
simplify "$T/a.ply" --tolerance "$mean" --mean
is "by the mean" "$CODE" 0
body "within it" ".plain_mm <= $mean and .kept < $kept"
"$BUILD/surfacectl" compare "$T/a.ply" "$T/small.ply" >"$T/text"
is "it still matches" $? 0
"$BUILD/surfacelab" simplify "$T/a.ply" -o "$T/dir/b.ply" --tolerance 1 >"$T/text"
is "as text" "$? $(grep -cE '^(kept|error|disparity|file) ' "$T/text")" "0 4"
ok "a missing folder is made" test -s "$T/dir/b.ply"
simplify "$T/a.ply"
is "no tolerance: exit" "$CODE" 64
simplify "$T/a.ply" --tolerance -1
is "a negative one: exit" "$CODE" 64
"$BUILD/surfacelab" simplify "$T/a.ply" --tolerance 1 >"$T/text" 2>&1
is "no --out: exit" $? 64
"$BUILD/surfacelab" simplify "$T/a.ply" --tolerance 1 --out "$T/dir/" >"$T/text" 2>&1
is "to a folder: exit" $? 65
"$BUILD/surfacelab" asymmetry "$T/a.ply" --tolerance 1 >"$T/text" 2>&1
is "an option of another command: exit" $? 64

printf '0 0 0\n1 1 1\n' >"$T/few.xyz"
asymmetry "$T/few.xyz"
is "two points: exit" "$CODE" 65
asymmetry "$T/none.xyz"
is "no file: exit" "$CODE" 66
finish
