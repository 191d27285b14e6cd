#!/bin/sh
# Goal: the studies of the papers run, give the same output for the same seed, and have the
# expected results: errors grow with removal on average, values known by hand are met, and all
# figures and tables are on one page.
# shellcheck disable=SC2016 # awk's own variables
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# study NAME [OPTION]...: runs a reduced study into $T/NAME.
study() {
    mkdir -p "$T/$1"
    ok "study $*" "$BUILD/study" "$@" --reduced --out "$T/$1" >"$T/$1.log"
}

# value FILE ROW COLUMN: of the line that begins with ROW
value() { awk -F, -v row="$2" -v k="$3" 'index($0, row ",") == 1 { print $k }' "$T/$1"; }

# grows FILE COLUMN: for each function (column 1) the column grows from line to line.
# shellcheck disable=SC2317 # called by ok
grows() {
    awk -F, -v k="$2" 'NR > 1 { if ($1 == last && $k <= was) { print; bad = 1 }
        last = $1; was = $k; n++ } END { exit bad || n < 6 }' "$T/$1"
}

# between TITLE NUMBER LOW HIGH
between() { ok "$1: $2 in [$3, $4]" awk "BEGIN { exit !($2 >= $3 && $2 <= $4) }"; }

# row FILE NAME CASE COLUMN: of the line whose first columns are NAME and CASE
row() { awk -F, -v a="$2" -v b="$3" -v k="$4" '$1 == a && $2 == b { print $k }' "$T/$1"; }

# ---- missing points
study missing
ok "it prints its seed" grep -q 'seed 20261121' "$T/missing.log"
ok "totals grow with removal" grows missing/table2.csv 5
ok "means at the removed points grow" grows missing/table3.csv 6
ok "means on the grid grow" grows missing/grid.csv 3
ok "the hull shrinks" grows missing/grid.csv 9
is "F2 is (tanh + 1) / 9" "$(value missing/bounds.csv 'F2 cliff' 4)" 0.2222
is "F4 is 1/3 in the middle" "$(value missing/bounds.csv 'F4 gentle' 3)" 0.3333
is "F6 is 8/9 - 1/2 in the middle" "$(value missing/bounds.csv 'F6 sphere' 3)" 0.3889
is "F6: the radicand in a corner" \
    "$(value missing/radicand.csv 'least at the 36 points (a corner)' 2)" 23.50
is "with nothing removed, no difference from the surface of all points" "$(value missing/grid.csv 'F1 exponential,0' 8)" 0.0000
# Euler: e = 3n - 3 - h, and 16 of the 36 points lie on the square's rim.
is "edges of figure 2" "$(grep -c '^0,' "$T/missing/fig2-edges.csv")" 89
mkdir "$T/again"
"$BUILD/study" missing --reduced --out "$T/again" >"$T/log"
ok "another run gives the same" diff -r "$T/missing" "$T/again"
"$BUILD/study" missing --reduced --seed 5 --out "$T/again" >"$T/log"
ok "another seed gives other draws" sh -c "! cmp -s '$T/missing/table2.csv' '$T/again/table2.csv'"

# ---- the method: counted, not timed
study method
between "exponent of location along the tree" \
    "$(value method/steps-fit.csv 'a mesh along the tree' 3)" 0.95 1.05
between "exponent of single locations" \
    "$(value method/steps-fit.csv 'one point from the middle' 3)" 0.4 0.6
ok "the walks find the triangles of locate_mesh()" \
    awk -F, 'NR > 1 && $4 != 0 { exit 1 }' "$T/method/steps.csv"
ok "the sign cases have the volumes worked out by hand" \
    awk -F, 'NR > 1 && $8 > 1e-12 { exit 1 } END { exit NR != 7 }' "$T/method/signs.csv"

# ---- the general triangulation and the exact volume
study approx
ok "general triangulation: 2 n - 2 - (hull of 4) cells of 2 N - 4 points" \
    awk -F, 'NR > 1 && $4 != 4 * $2 - 14 { exit 1 }' "$T/approx/approx.csv"
ok "surfaces that differ: within 2 % from N = 1000" awk -F, '$2 >= 1000 &&
    $1 ~ /^(apart|crossing|faces)$/ && $7 > 2 { exit 1 }' "$T/approx/approx.csv"
for pair in apart crossing faces; do
    between "$pair: the difference falls" "$(value approx/fit.csv "$pair" 3)" -2 -0.3
done

# ---- cost: counts, no times
study cost
between "triangles of the general triangulation, exponent" \
    "$(value cost/growth-fit.csv 'triangles of the general triangulation' 3)" 0.99 1.01
is "2 (2 N) - 2 of them, ghosts included" "$(value cost/growth.csv 10000 9)" 39998

# ---- two faces, the weight
study faces
between "mated, after alignment: mm" \
    "$(row faces/alignment.csv 'the same person again' 'after alignment' 5)" 0.1 0.6
between "mated, at the true pose: mm" \
    "$(row faces/alignment.csv 'the same person again' 'at the true pose' 5)" 0.1 0.3
is "a constant weight changes no mean" "$(sed -n 3p "$T/faces/weights.csv" | cut -d, -f2-)" \
    "$(sed -n 2p "$T/faces/weights.csv" | cut -d, -f2-)"

# ---- scans as scanners deliver them
study scans
is "every kind of every source, both ways" "$(wc -l <"$T/scans/decisions.csv")" $((1 + 2 * (8 + 7 + 7)))
ok "control: told that unit and axes are as agreed, busts are refused" \
    awk -F, '$2 == "bust" && $3 == "as agreed" { n = $8 } END { exit n != 2 }' "$T/scans/decisions.csv"
ok "told nothing: heads, busts, points all round, a depth camera's grid match" awk -F, \
    '$1 == "heads" && $2 ~ /^(head|bust|round|depth)$/ && $3 == "found" { n += $5; others += $13 }
    END { exit n != 8 || others != 0 }' "$T/scans/decisions.csv"
ok "the unit is found" awk -F, '$1 == "heads" && $2 ~ /^(bust|depth)$/ { n += $5 }
    END { exit n != 4 }' "$T/scans/found.csv"
ok "two faces are not enrolled" awk -F, '$1 == "two" { n = $7 } END { exit n != 2 }' "$T/scans/enrolment.csv"

# ---- the minimal disparity
study minimal
ok "what is reported is the measure at its pose" \
    awk -F, 'NR > 1 && $3 != $2 { exit 1 } END { exit NR < 3 }' "$T/minimal/summary.csv"
mated='mated made up' others='non-mated made up'
between "mated: % of the pairs within 1 % of the best known" "$(value minimal/summary.csv "$mated" 4)" 98 100
between "mated: the furthest above it" "$(value minimal/summary.csv "$mated" 8)" 1 1.02
between "non-mated: % of the pairs within 2 %" "$(value minimal/summary.csv "$others" 5)" 98 100
ok "the best known is a minimum: below the alignment, the area kept" \
    awk -F, 'NR > 1 && ($9 <= 1.01 || $16 < 0.95) { exit 1 }' "$T/minimal/summary.csv"

# ---- a lower bound of it
study bound
ok "the frozen measure is the measure where it was frozen" \
    awk -F, 'NR > 1 && ($4 - $5 > 1e-9 || $5 - $4 > 1e-9) { exit 1 } END { exit NR != 3 }' "$T/bound/check.csv"
ok "no pose lies below the bound of its box" \
    awk -F, 'NR > 1 && ($9 < 400 || $10 != 0 || $11 < 1) { exit 1 }' "$T/bound/check.csv"
ok "no gap of a corner lies outside the bounds that are added up" \
    awk -F, 'NR > 1 && $13 != 0 { exit 1 } END { exit NR != 3 }' "$T/bound/check.csv"
ok "the bound is nearly met somewhere" awk -F, 'NR > 1 && $11 > 1.01 { exit 1 }' "$T/bound/check.csv"
ok "control: poses do lie below the bound of half the box" \
    awk -F, 'NR > 1 && $12 == 0 { exit 1 }' "$T/bound/check.csv"
ok "the wider the box, the lower the bound; never above what is reported" \
    awk -F, 'NR > 1 && ($9 > 1 || ($2 == last && $9 > was + 0.005)) { exit 1 } { last = $2; was = $9 }' "$T/bound/bounds.csv"
ok "within 0.25 mm the bound is close" awk -F, 'NR == 2 && ($2 < 0.9 || $5 < 0.9) { exit 1 }' "$T/bound/summary.csv"
ok "near it the frozen measure is the measure to 2 %" \
    awk -F, 'NR > 1 && $4 <= 0.5 && ($8 < 0.98 || $10 > 1.02) { exit 1 }' "$T/bound/sampled.csv"

# ---- hill climbing
study climb
ok "every attempt is counted, and the highest score never falls" awk -F, '
    NR > 1 { key = $1 "," $2
        if (key == last && ($3 <= at || $5 < matched || $8 < score - 1e-9)) exit bad = 1
        last = key; at = $3; matched = $5; score = $8; n++ }
    END { exit bad || n != 6 * 7 }' "$T/climb/climb.csv"
ok "the same first attempt, whatever is told" awk -F, '
    NR > 1 && $3 == 1 { if ($1 in first && first[$1] != $8) exit bad = 1; first[$1] = $8 }
    END { exit bad }' "$T/climb/climb.csv"
is "each on each" "$(value climb/early.csv 1 2)" 6
# 3 at once, then 30 s, 60 s, 120 s, ... up to a day
is "the days that attempts take with the lock-out" \
    "$(cut -d, -f1,8 "$T/climb/early.csv" | sed 1d | paste -sd ' ')" \
    "1,0 2,0 3,0 5,0.00104 10,0.0441 14,0.711 30,16.4"
is "and warnings" "$(cut -d, -f9 "$T/climb/early.csv" | sed 1d | paste -sd ' ')" "0 0 1 3 8 12 28"

# ---- the best of several templates
study several
ok "the best of more accepts more; less ln n, never more than as it is" awk -F, '
    NR > 1 { if ($9 > $6 || $11 < $8 || ($3 == at && ($6 < was || $8 > missed))) exit bad = 1
        at = $3; was = $6; missed = $8; n++ }
    END { exit bad || n < 6 }' "$T/several/several.csv"
ok "nothing is lowered where there is one" awk -F, '$2 == 1 && ($6 != $9 || $8 != $11) { exit 1 }' "$T/several/several.csv"

# ---- asymmetry
study mirror
between "the asymmetry follows the generated one" "$(value mirror/summary.csv 'of the final one' 3)" 0.95 1
between "the plane, degrees" "$(value mirror/summary.csv 'plane: largest error degrees' 3)" 0 0.8

# ---- the effect of removals
study removal
ok "the error of every kind of removal grows with it" grows removal/mean.csv 3
ok "without bridges the error is smaller" awk -F, 'NR > 1 && $4 > $3 { exit 1 }' "$T/removal/mean.csv"
ok "holes cost more than points at random" awk -F, '$2 == 75 { e[$1] = $3 }
    END { exit !(e["blobs"] > 3 * e["random"]) }' "$T/removal/mean.csv"

# ---- faces with parts missing
study cover
ok "with bridges, the more is missing, the larger the error" \
    awk -F, 'NR > 1 && $2 <= was { exit 1 } NR > 1 { was = $2 }' "$T/cover/truth.csv"
ok "without bridges the error is smaller" awk -F, 'NR > 1 && $6 > $2 { exit 1 }' "$T/cover/truth.csv"
is "a whole face matches" "$(value cover/madeup.csv 0 4)" 100.0
is "non-mated comparisons do not match" "$(value cover/madeup.csv 0 8)" 0.00

# ---- restored points
study filled
ok "the error grows with the hole" awk -F, '$1 == "3000 points; round" && $3 >= 10 {
    if ($6 <= was) bad = 1; was = $6; n++ } END { exit bad || n < 4 }' "$T/filled/filled.csv"
ok "it is at least the scanner's" awk -F, 'NR > 1 && $4 > 0 && ($6 < 0.15 || $8 < $6) {
    exit 1 }' "$T/filled/filled.csv"

# ---- simplified surfaces
study fewer
ok "the fewer points, the larger the gap" awk -F, 'NR > 1 && $1 == last && $3 <= was { bad = 1 }
    { last = $1; was = $3 } END { exit bad || NR < 50 }' "$T/fewer/curves.csv"
ok "by the volume: a smaller mean gap, a larger maximum" \
    awk -F, 'NR > 1 && ($6 > $4 || $5 < $3) { exit 1 }' "$T/fewer/curves.csv"
is "a whole template matches" "$(value fewer/verify.csv 100 4)" 100.0

# ---- errors
for bad in "" "nothing" "missing --seed" "missing --seed x" "missing --seed -1" "missing more"; do
    # shellcheck disable=SC2086 # arguments
    "$BUILD/study" $bad >"$T/log" 2>&1
    is "study $bad" $? 64
done
"$BUILD/study" missing --reduced --out "$T/none" >"$T/log" 2>&1
is "an output folder that does not exist" $? 1

# ---- pictures and the page
if command -v gnuplot >/dev/null 2>&1; then
    ok "scripts/studies" env BUILD="$BUILD" scripts/studies --reduced --out "$T/page" \
        >"$T/log" 2>&1
    for picture in "$T"/page/*/*.png; do
        is "$picture" "$(head -c 8 "$picture" | od -An -tx1 | tr -d ' ')" 89504e470d0a1a0a
    done
    is "every figure on the page" "$(grep -c '<img ' "$T/page/report.html")" \
        "$(cat studies/*.html | grep -c '^@figure ')"
    is "no warning" "$(grep -i warning "$T/log")" ''
    is "no nan in the tables" "$(grep -il '\(^\|[^a-z]\)nan\($\|[^a-z]\)' "$T"/page/*/*.csv)" ''
    is "no nan on the page" "$(grep -c '<td>-\{0,1\}nan' "$T/page/report.html")" 0
    is "every table on the page" "$(grep -c '<table>' "$T/page/report.html")" \
        "$(cat studies/*.html | grep -c '^@table ')"
    ok "no placeholder is left" sh -c "! grep -q '^@' '$T/page/report.html'"
else
    echo "SKIP pictures: gnuplot is not installed"
fi
finish
