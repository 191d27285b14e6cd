#!/bin/sh
# Goal: dedup finds the same face under two subjects, and no other pair: sorted by score,
# the same for any number of threads, with the digits of a comparison; it says in advance
# what it costs, and changes nothing.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
unset SURFACED_DB SURFACED_MODEL

who() { said '[.duplicates[] | .subject_a + "=" + .subject_b] | join(" ")'; }
rows() { sql "SELECT (SELECT count(*) FROM $ENTRIES), (SELECT count(*) FROM templates)"; }

for n in 1 2 3 4 5 6; do
    scan $n 0 "$T/s$n.ply" --points 1000
done
scan 2 1 "$T/again.ply" --points 1000 --pose 8 --shift 10

# ---- no subject, one, and different ones
ctl_exits 0 init
ctl_exits 0 dedup
is "nobody" "$(said '.subjects, .pairs, .compared' | tr '\n' ' ')" '0 0 0 '
ctl_exits 0 enroll s1 "$T/s1.ply"
ctl_exits 0 dedup
is "alone" "$(said '.subjects, .pairs, .compared' | tr '\n' ' ')" '1 0 0 '
for n in 2 3 4 5; do ctl_exits 0 enroll s$n "$T/s$n.ply"; done
ctl_exits 0 enroll s1 "$T/s1.ply" --label 'the same again'
"$BUILD/surfacectl" --db "$DB" subject set nobody --consent none >"$T/text"
ctl_exits 0 dedup
is "different people" "$(said '.subjects, .pairs, .compared' | tr '\n' ' ')" '5 10 0 '
is "there is no pair" "$(who)" ''

# ---- one face under two subjects, and one scan enrolled twice
ctl_exits 0 enroll stranger "$T/again.ply"
ctl_exits 0 enroll copy "$T/s4.ply"
before=$(rows)
ctl_exits 1 dedup --threads 1
is "both are found, the copy first" "$(who)" 's4=copy s2=stranger'
is "the very same scan" "$(said '[.duplicates[].same_scan] | join(" ")')" 'true false'
is "each two once" "$(said .pairs)" 21
ok "compared are those alone who may be alike" jq_true '.compared >= 2 and .compared < 21' "$T/ctl"
is "all were searched" "$(said '[.skipped, .damaged] | @csv')" 0,0
cp "$T/ctl" "$T/one"
ctl_exits 1 dedup --threads 3
ok "the same on three threads" cmp "$T/one" "$T/ctl"
score=$(said '.duplicates[1].score')
between=$(said '(.duplicates[0].score + .duplicates[1].score) / 2')
"$BUILD/surfacectl" --json compare "$T/s2.ply" "$T/again.ply" >"$T/ctl"
is "by the digits of a comparison" "$(said .score)" "$score"
"$BUILD/surfacectl" --db "$DB" dedup >"$T/text" 2>"$T/ctl.err"
is "as text: exit" $? 1
ok "the pairs" grep -Eq '^ +[-0-9.]+ +[0-9.e+-]+  s4  copy  \(identical scan\)$' "$T/text"
ok "and how many" grep -Eq '^2 pairs of subjects, by [0-9]+ comparisons' "$T/text"
ok "the costs" grep -q "^surfacectl: 21 pairs of templates of 7 subjects; by chance .* of other people" "$T/ctl.err"
ctl_exits 0 dedup --dry-run
is "told in advance alone" "$(said '.pairs, .compared' | tr '\n' ' ')" '21 null '
"$BUILD/surfacectl" --json --db "$DB" calibrate --reset --dry-run >"$T/shipped"
knot=$(jq '.table[-2].score' "$T/shipped") rate=$(jq '.table[-2].rate' "$T/shipped")
ctl_exits 0 dedup --dry-run --threshold "$knot"
# shellcheck disable=SC2016 # the variables are jq's
ok "those by chance, by the calibration" jq_true --argjson r "$rate" \
    '(.by_chance / 21 / $r - 1 | fabs < 0.01) and (.extrapolated | not)' "$T/ctl"
ctl_exits 0 dedup --dry-run --threshold 40
ok "beyond its table by its law" jq_true '.extrapolated and .by_chance > 0 and .by_chance < 1e-5' "$T/ctl"

# ---- of one alone; by another threshold
ctl_exits 1 dedup --subject stranger
is "one with all" "$(who) $(said .compared)" 's2=stranger 6'
ctl_exits 1 dedup --subject s2
is "from the other side" "$(who) $(said .compared)" 's2=stranger 6'
ctl_exits 0 dedup --subject s5
ctl_exits 66 dedup --subject nobody
ctl_exits 66 dedup --subject nowhere
ctl_exits 1 dedup --threshold "$between"
is "by a threshold" "$(who)" 's4=copy'
ctl_exits 64 dedup s2

# ---- a pair is of subjects, by the nearest of their templates
ctl_exits 0 enroll stranger "$T/s2.ply"
ctl_exits 1 dedup
is "once, by the nearest" "$(who | tr ' ' '\n' | sort | paste -sd ' ')" 's2=stranger s4=copy'
is "of more pairs" "$(said .pairs)" 27
is "nothing else was written" "$(rows | cut -d'|' -f2) $(echo "$before" | cut -d'|' -f2)" '8 7'
"$BUILD/surfacectl" --db "$DB" template delete "$(said '.duplicates[] | select(.subject_b == "copy").template_b')" --yes >"$T/text"
ctl_exits 1 dedup
is "gone when it is" "$(who)" 's2=stranger'

# ---- one that is damaged: it is told, and the others are compared
sql "UPDATE faces SET face = zeroblob(length(face)) WHERE template_key =
    (SELECT template_key FROM templates ORDER BY template_key LIMIT 1)"
ctl_exits 65 dedup
is "the others are found" "$(who)" 's2=stranger'
is "it is counted" "$(said '[.damaged, .skipped] | @csv')" 1,1
ok "and named" grep -q "^surfacectl: template [0-9a-f]*: " "$T/ctl.err"

# ---- among many, whole and partial ones: all that comparing all with all finds
DB="$T/many.db"
mkdir "$T/many"
"$BUILD/facegen" --count 40 --points 500 -o "$T/many/a%_enroll.ply"
"$BUILD/facegen" --count 15 --subject 10 --scan 1 --points 900 --holes 0.25 -o "$T/many/b%_enroll.ply"
ctl_exits 0 init
ctl enroll "$T/many" # some have too many holes
ok "most are enrolled: $(said .enrolled)" test "$(said .enrolled)" -ge 48
ctl_exits 1 dedup --threshold -10
said '.duplicates[] | [.subject_a, .subject_b, .score] | @csv' | sort >"$T/found"
"$BUILD/surfacectl" --json --db "$DB" subject list | jq -r '.subjects[].subject' >"$T/all"
: >"$T/each"
while read -r id; do
    "$BUILD/surfacectl" --json --db "$DB" dedup --threshold -10 --subject "$id" 2>"$T/ctl.err" |
        jq -r '.duplicates[] | [.subject_a, .subject_b, .score] | @csv' >>"$T/each"
done <"$T/all"
sort -u "$T/each" >"$T/wanted"
ok "as all with all" diff "$T/wanted" "$T/found"
ok "$(wc -l <"$T/found") pairs, of lookalikes too" test "$(wc -l <"$T/found")" -gt 30

# ---- heads of other sizes, whose pairs a search makes too low by most: the margin finds them
DB="$T/small.db"
for of in '0 0.80' '1 0.88'; do
    # shellcheck disable=SC2086 # two words
    set -- $of
    scan 1 "$1" "$T/frontal.xyz" --points 900 --pose $((6 * $1))
    awk -v z="$2" '{ print $1 * z, $2 * z, $3 * z }' "$T/frontal.xyz" >"$T/child$1.xyz"
done
ctl_exits 0 init
ctl_exits 0 enroll a "$T/child0.xyz"
ctl_exits 0 enroll b "$T/child1.xyz"
ctl_exits 1 dedup --threshold 3
is "two scans of a child" "$(who)" 'a=b'
finish
