#!/bin/sh
# Goal: the studies of the papers run, give the same output for the same seed, and have the
# expected results: errors grow with removal on average, values known by hand are met, and all
# figures and tables are on one page.
# shellcheck disable=SC2016 # awk's own variables
. tests/box/lib.sh

# study NAME: its reduced results, in $T/NAME: those of the page, or else made here.
study() {
    if [ -d "$T/page/$1" ]; then
        mv "$T/page/$1" "$T/$1"
    else
        mkdir "$T/$1"
        ok "study $1" "$BUILD/surfacelab" study "$1" --reduced --out "$T/$1" >"$T/$1.log"
    fi
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

# ---- pictures and the page
if command -v gnuplot >/dev/null 2>&1; then
    ok "scripts/studies" env BUILD="$BUILD" scripts/studies --reduced --out "$T/page" \
        >"$T/log" 2>&1
    for picture in "$T"/page/*/*.png; do
        is "$picture" "$(head -c 8 "$picture" | od -An -tx1 | tr -d ' ')" 89504e470d0a1a0a
    done
    is "every figure on the page" "$(grep -c '<img ' "$T/page/report.html")" \
        "$(cat lab/study/*.html | grep -c '^@figure ')"
    is "no warning" "$(grep -i warning "$T/log" | grep -v "^make")" ''
    is "no nan in the tables" "$(grep -il '\(^\|[^a-z]\)nan\($\|[^a-z]\)' "$T"/page/*/*.csv)" ''
    is "no nan on the page" "$(grep -c '<td>-\{0,1\}nan' "$T/page/report.html")" 0
    is "every table on the page" "$(grep -c '<table>' "$T/page/report.html")" \
        "$(cat lab/study/*.html | grep -c '^@table ')"
    is "each is in the contents" "$(grep -o 'href="#[^"]*"' "$T/page/report.html" | sed 's/.*#//; s/"//' | sort)" \
        "$(grep -o ' id="[^"]*"' "$T/page/report.html" | sed 's/.*="//; s/"//' | sort)"
    ok "the page has 1 MB at most" test "$(wc -c <"$T/page/report.html")" -le 1000000
    ok "no placeholder is left" sh -c "! grep -q '^@' '$T/page/report.html'"
else
    echo "SKIP pictures: gnuplot is not installed"
fi

# ---- missing points
study missing
ok "another run prints its seed" sh -c "mkdir '$T/again' &&
    '$BUILD/surfacelab' study missing --reduced --out '$T/again' | grep -q 'seed 20261121'"
ok "totals grow with removal" grows missing/table2.csv 5
ok "means at the removed points grow" grows missing/table3.csv 6
# Euler: e = 3n - 3 - h, and 16 of the 36 points lie on the square's rim.
is "edges of figure 2" "$(grep -c '^0,' "$T/missing/fig2-edges.csv")" 89
ok "and gives the same tables" sh -c "for f in '$T'/again/*; do cmp -s \"\$f\" '$T/missing/'\"\${f##*/}\" || exit 1; done"
"$BUILD/surfacelab" study missing --reduced --seed 5 --out "$T/again" >"$T/log"
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

# ---- cost: the paper's times, as printed; ours differ from run to run
study cost
is "the paper's sums" "$(value cost/table1.csv sum 2),$(value cost/table1.csv sum 3)" 405,242

# ---- two faces
study faces
between "mated, after alignment: mm" \
    "$(row faces/alignment.csv 'the same person again' 'after alignment' 5)" 0.1 0.6
between "mated, at the true pose: mm" \
    "$(row faces/alignment.csv 'the same person again' 'at the true pose' 5)" 0.1 0.3
for pair in 'the same person again' 'another person'; do
    between "$pair, at the minimum: mm" "$(row faces/alignment.csv "$pair" 'at the minimum' 5)" 0.1 \
        "$(row faces/alignment.csv "$pair" 'after alignment' 5)"
done
mkdir "$T/others"
"$BUILD/surfacelab" study faces --seed 5 --out "$T/others" >"$T/log"
ok "another seed takes other people" sh -c "! cmp -s '$T/faces/alignment.csv' '$T/others/alignment.csv'"
# ---- errors
for bad in "nothing" "missing --seed" "missing --seed x" "missing --seed -1" "missing more"; do
    # shellcheck disable=SC2086 # arguments
    "$BUILD/surfacelab" study $bad >"$T/log" 2>&1
    is "study $bad" $? 64
done
"$BUILD/surfacelab" study missing --reduced --out "$T/none" >"$T/log" 2>&1
is "an output folder that does not exist" $? 1

finish
