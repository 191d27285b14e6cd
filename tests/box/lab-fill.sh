#!/bin/sh
# Goal: surfacelab fill restores the points missing in a scan's holes: the scan's own points stay
# as they came, in their unit; the restored ones are marked, and the size of each hole and the
# expected error are told; what was filled is not filled again; no file is overwritten.
. tests/box/lib.sh
in_folder

# disc FILE X Y RADIUS: an XYZ file without the points in this disc.
disc() {
    awk -v x="$2" -v y="$3" -v r="$4" '($1 - x) ^ 2 + ($2 - y) ^ 2 >= r ^ 2' "$1"
}

# points FILE MARK: the coordinates of a filled file's points with this mark, of the scan (0) or
# restored (1).
points() {
    sed '1,/^end_header$/d' "$1" | awk -v mark="$2" '$4 == mark { print $1, $2, $3 }'
}

scan 4 1 whole.xyz
disc whole.xyz -25 -25 8 | disc - 30 40 12 >holes.xyz
missing=$(($(wc -l <whole.xyz) - $(wc -l <holes.xyz)))

expect 0 "fill" "$lab" fill --json holes.xyz --out filled.ply
cp out told
ok "the holes, the larger first" jq_true '.holes | length >= 2 and length <= 4 and
    (.[0].diameter_mm - 24 | fabs) < 3 and (.[1].diameter_mm - 16 | fabs) < 3 and
    (map(.area_mm2) | . == (sort | reverse))' told
ok "area and diameter" jq_true '.holes | all(.diameter_mm * .diameter_mm * 0.785398 /
    .area_mm2 - 1 | fabs < 1e-3)' told
ok "the error grows with the hole" jq_true '.holes | .[0].error_rms_mm > .[1].error_rms_mm and
    all(.error_95_mm > .error_rms_mm and .error_rms_mm > 0.2)' told
ok "about as many points as are missing: $missing" jq_true \
    ".restored / $missing | . > 0.6 and . < 1.5" told
ok "in the holes" jq_true '(.holes | map(.restored) | add) == .restored' told
is "the points of the scan" "$(jq .points told)" "$(wc -l <holes.xyz)"
points filled.ply 0 >own
ok "they are as they came" sh -c "paste -d ' ' own holes.xyz |
    awk '\$1 != \$4 || \$2 != \$5 || \$3 != \$6 || NF != 6 { exit 1 }'"
points filled.ply 1 >restored
is "those restored" "$(wc -l <restored)" "$(jq .restored told)"
is "outside the holes, but for natural gaps" "$(disc restored -25 -25 9 | disc - 30 40 13 |
    awk 'END { print (NR > 20) }')" 0
is "the vertices of the file" "$(sed -n 's/^element vertex //p' filled.ply)" \
    "$(jq '.points + .restored' told)"
is "only its owner can read it" "$(stat -c %a filled.ply)" 600

expect 0 "a scan like any other" "$ctl" compare whole.xyz filled.ply
expect 0 "filled again" "$lab" fill --json filled.ply --out again.ply
is "nothing is added" "$(jq -c '[.points, .restored, .holes]' out)" \
    "$(jq -c '[.points + .restored, 0, []]' told)"
ok "and nothing changed" sh -c "sed '1,/^end_header/d; s/ [01]\$//' filled.ply >a;
    sed '1,/^end_header/d; s/ [01]\$//' again.ply | cmp -s a -"
expect 0 "the same again" "$lab" fill holes.xyz --out same.ply
ok "gives the same file" cmp -s filled.ply same.ply
has out '^restored '
has out '^hole .* mm across, .* mm2, points restored: .*; error about'
has out '^beyond .* not filled'
has out '^file  *same.ply'

# ---- units; what nobody knows
awk '{ printf "%.17g %.17g %.17g\n", $1 / 10, $2 / 10, $3 / 10 }' holes.xyz >cm.xyz
expect 0 "centimetres" "$lab" fill --units cm --json cm.xyz --out cm.ply
is "as much is restored" "$(jq -c .holes out)" "$(jq -c .holes told)"
ok "in centimetres" grep -q '^comment cm$' cm.ply
points cm.ply 0 >own
ok "the points are as they came" sh -c "paste -d ' ' own cm.xyz |
    awk '\$1 != \$4 || \$2 != \$5 || \$3 != \$6 { exit 1 }'"
points cm.ply 1 | awk '{ printf "%.3f %.3f %.3f\n", 10 * $1, 10 * $2, 10 * $3 }' >a
awk '{ printf "%.3f %.3f %.3f\n", $1, $2, $3 }' restored | cmp -s a -
is "those restored are at the same places" $? 0
disc whole.xyz 0 0 38 >wide.xyz
expect 0 "a hole wider than any that was studied" "$lab" fill --json wide.xyz --out wide.ply
is "its error" "$(jq -c '.holes[0] | [.error_rms_mm, .error_95_mm]' out)" '[null,null]'
rm wide.ply
expect 0 "as text" "$lab" fill wide.xyz --out wide.ply
has out 'the error is unknown'

# ---- refused
expect 65 "the file exists" "$lab" fill whole.xyz --out filled.ply
has err filled.ply
ok "it is as it was" cmp -s filled.ply same.ply
expect 64 "no --out" "$lab" fill holes.xyz
expect 64 "two files" "$lab" fill holes.xyz whole.xyz --out none.ply
expect 64 "an option of another command" "$lab" fill holes.xyz --tolerance 1 --out none.ply
expect 64 "a mistyped command" "$lab" fil holes.xyz
has err 'there is no command'
expect 66 "no such scan" "$lab" fill --json none.xyz --out none.ply
is "as JSON" "$(jq -r '.error | [.code, .exit] | @tsv' out | tr '\t' ' ')" 'not_found 66'
head -n 50 whole.xyz >few.xyz
expect 65 "too few points" "$lab" fill few.xyz --out none.ply
expect 74 "no such folder" "$lab" fill holes.xyz --out none/x/none.ply
is "nothing is left behind" "$(files . | tr ' ' '\n' | grep -c 'none\|part')" 0
finish
