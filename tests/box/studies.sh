#!/bin/sh
# Goal: the studies of the papers run, say the same for the same seed, and come out as they
# must: errors grow with removal on average, values known by hand, everything on one page.
# shellcheck disable=SC2016 # awk's own variables
set -u
cd "$(dirname "$0")/../.." || exit 1
BUILD=${BUILD:-build}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
passed=0 failed=0

# that WHAT TEST...: a condition of the shell holds
that() {
    title=$1
    shift
    if "$@"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $title"
    fi
}

is() { that "$1: got '$2', wanted '$3'" [ "$2" = "$3" ]; }

# study NAME [OPTION]...: a reduced run into $dir/NAME
study() {
    mkdir -p "$dir/$1"
    that "study $*" "$BUILD/study" "$@" --reduced --out "$dir/$1" >"$dir/$1.log"
}

# value FILE ROW COLUMN: of the line that begins with ROW
value() { awk -F, -v row="$2" -v k="$3" 'index($0, row ",") == 1 { print $k }' "$dir/$1"; }

# grows FILE COLUMN: within each function (column 1) it grows from line to line
grows() {
    awk -F, -v k="$2" 'NR > 1 { if ($1 == last && $k <= was) { print; bad = 1 }
        last = $1; was = $k; n++ } END { exit bad || n < 6 }' "$dir/$1"
}

# ---- missing points
study missing
that "it says its seed" grep -q 'seed 20261121' "$dir/missing.log"
that "totals grow with removal" grows missing/table2.csv 5
that "means at the removed points grow" grows missing/table3.csv 6
that "means on the grid grow" grows missing/grid.csv 3
that "the hull shrinks" grows missing/grid.csv 9
is "F2 is (tanh + 1) / 9" "$(value missing/bounds.csv 'F2 cliff' 4)" 0.2222
is "F4 is 1/3 in the middle" "$(value missing/bounds.csv 'F4 gentle' 3)" 0.3333
is "F6 is 8/9 - 1/2 there" "$(value missing/bounds.csv 'F6 sphere' 3)" 0.3889
is "F6 under its root in a corner" \
    "$(value missing/radicand.csv 'least at the 36 points (a corner)' 2)" 23.50
is "with nothing removed, the surface of all" "$(value missing/grid.csv 'F1 exponential,0' 8)" 0.0000
# Euler: e = 3n - 3 - h, and 16 of the 36 points lie on the square's rim.
is "edges of figure 2" "$(grep -c '^0,' "$dir/missing/fig2-edges.csv")" 89
mkdir "$dir/again"
"$BUILD/study" missing --reduced --out "$dir/again" >"$dir/log"
that "the same again" diff -r "$dir/missing" "$dir/again"
"$BUILD/study" missing --reduced --seed 5 --out "$dir/again" >"$dir/log"
that "another seed, other draws" sh -c "! cmp -s '$dir/missing/table2.csv' '$dir/again/table2.csv'"

# ---- the method: counted, not timed
study method
between() { that "$1: $2 in [$3, $4]" awk "BEGIN { exit !($2 >= $3 && $2 <= $4) }"; }
between "exponent of location along the tree" \
    "$(value method/steps-fit.csv 'a mesh along the tree' 3)" 0.95 1.05
between "exponent of single locations" \
    "$(value method/steps-fit.csv 'one point from the middle' 3)" 0.4 0.6
that "the walks find what locate_mesh() finds" \
    awk -F, 'NR > 1 && $4 != 0 { exit 1 }' "$dir/method/steps.csv"
that "the sign cases are those worked out by hand" \
    awk -F, 'NR > 1 && $8 > 1e-12 { exit 1 } END { exit NR != 7 }' "$dir/method/signs.csv"

# ---- the general triangulation and the exact volume
study approx
that "general triangulation: 2 n - 2 - (hull of 4) cells of 2 N - 4 points" \
    awk -F, 'NR > 1 && $4 != 4 * $2 - 14 { exit 1 }' "$dir/approx/approx.csv"
that "surfaces that differ: within 2 % from N = 1000" awk -F, '$2 >= 1000 &&
    $1 ~ /^(apart|crossing|faces)$/ && $7 > 2 { exit 1 }' "$dir/approx/approx.csv"
for pair in apart crossing faces; do
    between "$pair: the difference falls" "$(value approx/fit.csv "$pair" 3)" -2 -0.3
done

# ---- cost: nothing that a clock says
study cost
between "triangles of the general triangulation, exponent" \
    "$(value cost/growth-fit.csv 'triangles of the general triangulation' 3)" 0.99 1.01
is "2 (2 N) - 2 of them, ghosts included" "$(value cost/growth.csv 10000 9)" 39998

# ---- two faces, the weight
study faces
row() { awk -F, -v a="$2" -v b="$3" -v k="$4" '$1 == a && $2 == b { print $k }' "$dir/$1"; }
between "aligned, one person: mm" \
    "$(row faces/alignment.csv 'the same person again' 'after alignment' 5)" 0.1 0.6
between "at the true pose: mm" \
    "$(row faces/alignment.csv 'the same person again' 'at the true pose' 5)" 0.1 0.3
is "a constant weight changes no mean" "$(sed -n 3p "$dir/faces/weights.csv" | cut -d, -f2-)" \
    "$(sed -n 2p "$dir/faces/weights.csv" | cut -d, -f2-)"

# ---- asymmetry
study mirror
between "asymmetry follows what was planted" "$(value mirror/summary.csv 'of the final one' 3)" 0.95 1
between "the plane, degrees" "$(value mirror/summary.csv 'plane: largest error degrees' 3)" 0 0.8

# ---- which removals hurt
study removal
that "every kind of removal hurts the more" grows removal/mean.csv 3
that "bridges left out, less" awk -F, 'NR > 1 && $4 > $3 { exit 1 }' "$dir/removal/mean.csv"
that "holes cost more than points at random" awk -F, '$2 == 75 { e[$1] = $3 }
    END { exit !(e["blobs"] > 3 * e["random"]) }' "$dir/removal/mean.csv"

# ---- faces with parts missing
study cover
that "with bridges, farther from the truth the more is missing" \
    awk -F, 'NR > 1 && $2 <= was { exit 1 } NR > 1 { was = $2 }' "$dir/cover/truth.csv"
that "without bridges nearer" awk -F, 'NR > 1 && $6 > $2 { exit 1 }' "$dir/cover/truth.csv"
is "a whole face is matched" "$(value cover/madeup.csv 0 4)" 100.0
is "other people do not match" "$(value cover/madeup.csv 0 8)" 0.00

# ---- simplified surfaces
study fewer
that "the fewer points, the larger the gap" awk -F, 'NR > 1 && $1 == last && $3 <= was { bad = 1 }
    { last = $1; was = $3 } END { exit bad || NR < 50 }' "$dir/fewer/curves.csv"
that "by the volume: a smaller mean gap, a larger largest" \
    awk -F, 'NR > 1 && ($6 > $4 || $5 < $3) { exit 1 }' "$dir/fewer/curves.csv"
is "a whole template matches" "$(value fewer/verify.csv 100 4)" 100.0

# ---- what can go wrong
for bad in "" "nothing" "missing --seed" "missing --seed x" "missing --seed -1" "missing more"; do
    # shellcheck disable=SC2086 # arguments
    "$BUILD/study" $bad >"$dir/log" 2>&1
    is "study $bad" $? 64
done
"$BUILD/study" missing --reduced --out "$dir/none" >"$dir/log" 2>&1
is "no folder" $? 1

# ---- pictures and the page
if command -v gnuplot >/dev/null 2>&1; then
    that "scripts/studies" env BUILD="$BUILD" scripts/studies --reduced --out "$dir/page" \
        >"$dir/log" 2>&1
    for picture in "$dir"/page/*/*.png; do
        is "$picture" "$(head -c 8 "$picture" | od -An -tx1 | tr -d ' ')" 89504e470d0a1a0a
    done
    is "every figure on the page" "$(grep -c '<img ' "$dir/page/report.html")" \
        "$(cat studies/*.html | grep -c '^@figure ')"
    is "no warning" "$(grep -i warning "$dir/log")" ''
    is "no number that is none" "$(grep -il '\(^\|[^a-z]\)nan\($\|[^a-z]\)' "$dir"/page/*/*.csv)" ''
    is "nor on the page" "$(grep -c '<td>-\{0,1\}nan' "$dir/page/report.html")" 0
    is "every table on it" "$(grep -c '<table>' "$dir/page/report.html")" \
        "$(cat studies/*.html | grep -c '^@table ')"
    that "nothing left to fill in" sh -c "! grep -q '^@' '$dir/page/report.html'"
else
    echo "SKIP pictures: gnuplot is not installed"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
