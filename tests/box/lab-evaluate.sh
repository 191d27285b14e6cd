#!/bin/sh
# Goal: surfacelab evaluate compares what it should, says so in every file alike, the same on
# any number of threads, claims no rate that the comparisons do not support, lists what it could
# not use and counts that as errors, and replaces no file unasked.
. tests/box/lib.sh
in_folder

get() { jq -r "$2" "$1/report.json"; }

# lines DIR TYPE DECISION: how many comparisons scores.csv has of both (. is any)
lines() { awk -F, -v t="$2" -v d="$3" '$7 ~ t && $8 ~ d' "$1/scores.csv" | wc -l; }

mkdir scans
for s in 1 2 3 4 5; do
    scan $s 0 "scans/p${s}_enroll.ply" --pose 0 --shift 0
    scan $s 1 "scans/p${s}_again.ply" --pose 6 --shift 6
    scan $s 2 "scans/p${s}_Third_time.xyz" --pose 6 --shift 6
done
scan 6 0 scans/p6_a.ply --pose 0 --shift 0 # none is marked: the first one is enrolled
scan 6 1 scans/p6_b.ply --pose 6 --shift 6
tables='det.csv rates.csv report.json scores.csv'

expect 0 "a folder" "$lab" evaluate scans
has out 'The report is in evaluation/'
has out '^TAR  *not supported at FMR 0.1 %: 3000 non-mated.*(counted: 11 of 11 mated match, 0 of 55 non-mated)'
has out '^FNMR  *below 27.3 % (0 of 11)'
is "the files" "$(files evaluation)" "$tables"
is "the folder is its owner's alone" "$(stat -c %a evaluation)" 700
is "mated" "$(get evaluation '.mated[0].comparisons')" 11
is "non-mated" "$(get evaluation .non_mated.comparisons)" 55
is "of kind b" "$(get evaluation '.mated[] | select(.probes == "b") | .comparisons')" 1
is "all are accepted" "$(get evaluation '.mated[0].match')" 11
is "nobody else is" "$(get evaluation .non_mated.match)" 0
is "no rate is claimed" "$(get evaluation '[.fte, .non_mated.fmr, .non_mated.far, (.mated[]
    | .fta, .fnmr, .frr, (.scored, .with_refusals | .eer, .tar[]))] | map(.value) | unique')" \
    "$(printf '[\n  null\n]')"
is "what was counted is there all the same" "$(get evaluation '[.mated[0].scored.tar[].observed,
    .mated[0].fnmr.observed] | join(" ")')" '1 1 1 0'
is "but a bound is" "$(get evaluation '.non_mated.fmr.below * 55 | round')" 3
for type in mated non-mated relative; do
    for d in match no_match inconclusive; do
        path=$([ $type != mated ] && echo ".$type.$d" | tr - _ || echo ".mated[0].$d")
        is "$type $d" "$(lines evaluation "^$type" "^$d")" "$(get evaluation "$path")"
    done
done
is "p6_a is enrolled" "$(grep -c '^p6_a.ply,p6_b.ply,p6,p6,a,b,mated,match' evaluation/scores.csv)" 1
is "what made the figures" "$(get evaluation '[.model.digest[0:8] == .engine[-8:], .threshold,
    .calibration, .learned_from_these_people] | map(tostring) | join(" ")')" \
    'true 8 of the model unknown'
is "no rank is lost" "$(get evaluation '.mated[0].own_template_nearest')" 11
# What rates.csv says at a threshold is what scores.csv says.
is "rates and scores" "$(awk -F, 'FNR == 1 { next }
    NR == FNR { type[NR] = $7; score[NR] = $9; next }
    FNR % 50 == 0 { g = i = ga = ia = 0
        for (k in score) if (type[k] == "mated") { g++; ga += (score[k] >= $1) } else { i++; ia += (score[k] >= $1) }
        a = $2 - ia / i; b = $3 - 1 + ga / g
        bad += (a * a + b * b > 1e-12); n++ }
    END { print (n > 9), bad + 0 }' evaluation/scores.csv evaluation/rates.csv)" "1 0"
is "det.csv has what is supported, each within its interval" "$(awk -F, 'NR > 1 && $2 != "" {
    n++; bad += !($3 <= $2 && $2 <= $4) || $1 < 3 / 55 } END { print (n > 9), bad + 0 }' evaluation/det.csv)" "1 0"
is "no minimal disparity nor regions unasked" \
    "$(awk -F, 'NR > 1 && $12 $14 $19 != ""' evaluation/scores.csv | wc -l)" 0

# With errors, one scan under another's name: fewer than 3 are a bound too, but a higher one.
mkdir wrong
cp scans/* wrong
cp scans/p2_again.ply wrong/p1_again.ply
expect 0 "one error" "$lab" evaluate wrong --out erred
has out '^FNMR  *below 43.1 % (1 of 11)'
has out '^FMR  *below 8.62 % (1 of 55)'
is "and in JSON" "$(get erred '[(.mated[0].fnmr.below * 11), (.non_mated.fmr.below * 55)]
    | map(. * 100 | round / 100) | join(" ")')" '4.74 4.74'

# ---- the pictures, of the tables
expect 64 "a format that is not drawn" "$OLDPWD/scripts/plot_evaluation" evaluation jpeg
expect 66 "not an evaluation" "$OLDPWD/scripts/plot_evaluation" scans
if command -v gnuplot >/dev/null 2>&1; then
    expect 0 "drawn" "$OLDPWD/scripts/plot_evaluation" erred
    is "without a complaint" "$(cat err)" ''
    ok "the curve, with its interval" grep -q '95 % interval' erred/det.svg
    ok "of each kind" grep -q '>Third_time<' erred/det.svg
    ok "the scores" grep -q '11 mated, 55 non-mated comparisons; threshold 8' erred/scores.svg
    expect 0 "without errors" "$OLDPWD/scripts/plot_evaluation" evaluation png
    is "a PNG" "$(head -c 4 evaluation/det.png | od -An -c | tr -d ' ')" '211PNG'
    is "its owner's alone" "$(stat -c %a evaluation/scores.png)" 600
    rm evaluation/*.png
else
    echo "SKIP the pictures: gnuplot is not installed"
fi

# ---- scores of other methods: the same ones; distances, of which two are missing
cp erred/scores.csv same.csv
expect 0 "the same scores" "$lab" evaluate wrong --scores same.csv --out method
has out '^method  *same: scores of 11 of 11 mated, 55 of 55 non-mated comparisons'
is "have the same rates" "$(get method '.methods[0] | [.eer, .tar] | tojson')" \
    "$(get method '.mated[0].with_refusals | [.eer, .tar] | tojson')"
is "at every rate" "$(awk -F, 'NR > 1 && $2 != $3' method/methods.csv | wc -l)" 0
is "none that is not supported" "$(awk -F, 'NR > 1 && $2 != "" { print $1; exit }' method/methods.csv)" 0.0562341
awk -F, 'BEGIN { print "METHOD,probe,template,distance,note" }
    NR > 1 { print "far," $2 "," $1 "," (-$9) ",x" }
    $7 == "mated" && ++n <= 2 { $9 = "" }
    NR > 1 { print "some," $2 "," $1 "," ($9 == "" ? "" : 9 - $9) "," }
    END { print "far,p1_again.ply,nobody.ply,3,not compared here" }' erred/scores.csv >methods.csv
expect 0 "distances" "$lab" evaluate wrong --scores methods.csv --out method --force
has out '^method  *some: scores of 9 of 11 mated, 55 of 55 non-mated'
is "the lower the more alike" "$(get method '.methods[0].eer.observed')" \
    "$(get method '.mated[0].with_refusals.eer.observed')"
is "a mated comparison without a score is an error" \
    "$(tail -n 1 method/methods.csv | awk -F, '{ printf "%.4f", $4 - $3 }')" 0.1818
if command -v gnuplot >/dev/null 2>&1; then
    expect 0 "methods drawn" "$OLDPWD/scripts/plot_evaluation" method
    is "without a complaint" "$(cat err)" ''
    ok "a curve for each" grep -q '>some<' method/methods.svg
fi
expect 65 "the table is not replaced" "$lab" evaluate wrong --scores methods.csv --out . --force
has err './methods.csv is a file that this command reads'
printf 'template,probe,score\np1_enroll.ply,p1_again.ply,1\np1_enroll.ply,p1_again.ply,2\n' >bad.csv
expect 65 "two scores of a pair" "$lab" evaluate wrong --scores bad.csv --out none
has err 'bad.csv, line 3, column probe: this pair has a score already'
printf 'template,probe,score\nx,y,1\n' >bad.csv
expect 65 "of other scans" "$lab" evaluate wrong --scores bad.csv --out none
has err 'no pair of bad is compared here'
expect 64 "of several collections" "$lab" evaluate wrong scans --scores same.csv

# ---- a file that exists is replaced with --force only, one that is read never
expect 65 "there is a report" "$lab" evaluate scans
has err 'evaluation/scores.csv: the file exists: use --force'
touch evaluation/matrix.csv # of a former run
expect 0 "replaced" "$lab" evaluate scans --force
is "nothing of the former one stays" "$(files evaluation)" "$tables"
printf 'file,subject\nscans/p1_enroll.ply,p1\nscans/p1_again.ply,p1\n' >scores.csv
expect 65 "over its manifest" "$lab" evaluate scores.csv --out . --force
has err './scores.csv is a file that this command reads'
ln scores.csv rates.csv
printf 'file,subject\nscans/p1_enroll.ply,p1\nrates.csv,p1\n' >with.csv
expect 65 "over a scan" "$lab" evaluate with.csv --out . --force
has err './scores.csv is a file that this command reads'
rm scores.csv rates.csv with.csv

# ---- every template with every probe
expect 0 "a matrix" "$lab" evaluate scans --matrix --minimal --regions --out full
ok "the same scores" test "$(cut -d, -f 1-11,13,20- full/scores.csv)" = \
    "$(cut -d, -f 1-11,13,20- evaluation/scores.csv)"
is "a row for each template, a column for each probe" \
    "$(awk -F, '{ n[NF]++ } END { for (k in n) print k, n[k] }' full/matrix.csv)" "12 7"
is "with the scores of the list" "$(awk -F, 'NR == FNR { score[$1, $2] = $9; next }
    FNR == 1 { for (i = 2; i <= NF; i++) probe[i] = $i; next }
    { for (i = 2; i <= NF; i++) { n++; bad += $i != score[$1, probe[i]] } }
    END { print n, bad + 0 }' full/scores.csv full/matrix.csv)" "66 0"
# Each probe as a search, recomputed from the list: t(N) is 8 up to 86 people.
is "searches, from the list" "$(get full '[.search.people, .search.threshold, .search.fpir.of,
    .search.fpir.observed, .search.fnir.of, .search.fnir.observed] | map(tostring) | join(" ")')" \
    "$(awk -F, 'NR == 1 || $7 == "relative" { next }
    $7 == "non-mated" { n[$2]++; if (!($2 in best) || $9 > best[$2]) best[$2] = $9 }
    $7 == "mated" { own[$2] = $9 }
    END { for (p in n) { of++; wrong += best[p] >= 8; if (n[p] + (p in own) > most) most = n[p] + (p in own) }
        for (p in own) { with++; miss += !(own[p] >= 8 && own[p] > best[p]) }
        printf "%d 8 %d %g %d %g", most, of, wrong / of, with, miss / with }' full/scores.csv)"
ok "the minimal disparity" test "$(awk -F, 'NR > 1 && $12 > 0' full/scores.csv | wc -l)" -eq 66
is "the regions' parts sum up to the score" "$(awk -F, 'NR == 1 { next }
    { d = $9 - $14 - $15 - $16 - $17 - $18 - $19; n++; bad += (d * d > 1e-6) }
    END { print n, bad + 0 }' full/scores.csv)" "66 0"
is "as compare says" "$(grep '^p1_enroll.ply,p2_again.ply,' full/scores.csv |
    awk -F, '{ printf "%.2f,%s", $9, $12 }')" \
    "$("$ctl" compare scans/p1_enroll.ply scans/p2_again.ply --json |
        jq -r '"\(.score) \(.disparity_mm)"' | awk '{ printf "%.2f,%s", $1, $2 }')"

# ---- another kind is enrolled
expect 0 "another kind" "$lab" evaluate scans --enroll-kind again --out other
is "p6 has none" "$(get other '[.templates, .subjects_without_that_kind, .enroll_kind] | join(" ")')" \
    '5 1 again'
is "its scans are probes all the same" "$(grep -c ',p6_a.ply,.*,non-mated,' other/scores.csv)" 5
is "mated ones with that template" "$(grep -c '^p1_again.ply,.*,mated,' other/scores.csv)" 2
expect 65 "a kind that is not there" "$lab" evaluate scans --enroll-kind smile --out none
has err 'no scan is of the kind smile: there are '

# ---- a list of pairs, as listed
mkdir protocol
printf '# template probe\n../scans/p2_enroll.ply ../scans/p1_again.ply\n%s\n%s\n' \
    '../scans/p1_enroll.ply ../scans/p1_again.ply' \
    '../scans/p1_again.ply ../scans/p1_enroll.ply' >protocol/pairs
expect 0 "pairs" "$lab" evaluate --pairs protocol/pairs --out paired
is "as listed" "$(cut -d, -f 1,2,7 paired/scores.csv | sed 1d | tr '\n' ' ')" \
    '../scans/p2_enroll.ply,../scans/p1_again.ply,non-mated ../scans/p1_enroll.ply,../scans/p1_again.ply,mated ../scans/p1_again.ply,../scans/p1_enroll.ply,mated '
is "the same score" "$(grep '/p2_enroll.ply,' paired/scores.csv | cut -d, -f 9)" \
    "$(grep '^p2_enroll.ply,p1_again.ply' evaluation/scores.csv | cut -d, -f 9)"
printf 'template,probe,label\np,q,genuine\nq,r,impostor\n' >protocol/labelled.csv
cp scans/p1_enroll.ply protocol/p
cp scans/p1_again.ply protocol/q
cp scans/p2_again.ply protocol/r
expect 0 "with labels" "$lab" evaluate --pairs protocol/labelled.csv --out labelled --matrix
is "by the labels" "$(cut -d, -f 3,4,7,8 labelled/scores.csv | sed 1d | paste -sd ' ')" \
    'p,p,mated,match p,r,non-mated,no_match'
is "people" "$(get labelled .subjects)" 2
is "the matrix has what is listed" "$(awk -F, 'NR > 1 { print ($2 != ""), ($3 != "") }' \
    labelled/matrix.csv | paste -sd ' ')" '1 0 0 1'
printf 'p q 1\nq nothing 0\n' >protocol/bad
expect 66 "no such scan" "$lab" evaluate --pairs protocol/bad --out none
has err 'protocol/bad, line 2: nothing: No such file'
expect 66 "no such list" "$lab" evaluate --pairs protocol/none --out none
expect 64 "pairs and a folder" "$lab" evaluate scans --pairs protocol/pairs
expect 64 "pairs and a kind" "$lab" evaluate --pairs protocol/pairs --enroll-kind a
has err 'takes neither'

# ---- several sets side by side
mkdir -p other/scans
cp scans/p[12]_*.ply other/scans
expect 0 "two sets" "$lab" evaluate scans other/scans/ wrong --out side
is "a summary each" "$(grep -c '^scans  *.*\(scans/*: [26]\|wrong: 6\) subjects' out)" 3
is "the folders" "$(files side | tr ' ' '\n' | grep -v 'report\|scores\|rates\|det' | paste -sd ' ')" \
    'scans scans-2 sets.csv wrong'
ok "each as by itself" cmp side/scans/scores.csv evaluation/scores.csv
is "as a table" "$(awk -F, '{ print NF }' side/sets.csv | uniq -c | tr -s ' ')" \
    " 4 $(head -n 1 side/sets.csv | tr , '\n' | wc -l)"
is "mated" "$(awk -F, 'NR == 1 { while ($++k != "mated") ; next } { print $k }' side/sets.csv |
    paste -sd ' ')" '11 2 11'
expect 65 "a second time" "$lab" evaluate scans other/scans/ wrong --out side
expect 0 "as JSON" "$lab" evaluate scans wrong --out side --force --json
is "each report" "$(jq -r '[.sets[] | .scans, .mated[0].comparisons] | join(" ")' out)" \
    'scans 11 wrong 11'
expect 66 "one that is missing" "$lab" evaluate scans nowhere --out none

for n in 1 3; do
    expect 0 "$n threads" "$lab" evaluate scans --threads $n --out "by-$n"
    ok "$n threads: the same scores" cmp evaluation/scores.csv "by-$n/scores.csv"
    ok "$n threads: the same rates" cmp evaluation/rates.csv "by-$n/rates.csv"
done
expect 0 "JSON" "$lab" evaluate scans --json --non-mated 2 --out drawn
ok "what is printed is report.json" cmp out drawn/report.json
is "two non-mated comparisons a probe" "$(lines drawn non-mated .)" 22
is "it says so" "$(get drawn .non_mated.of_each_probe)" 2
expect 0 "drawn again" "$lab" evaluate scans --non-mated 2 --threads 1 --out again
ok "the same are drawn" cmp drawn/scores.csv again/scores.csv
expect 0 "another threshold" "$lab" evaluate scans --threshold -999 --out wide
is "all are accepted there" "$(get wide '.non_mated | .match == .comparisons and .fmr.value == 1')" true
is "it says whose" "$(get wide '[.threshold, .calibration] | join(" ")')" '-999 replaced by --threshold'

# A manifest: populations, relatives, and scans that cannot be used.
printf 'ply\nnot a scan\n' >scans/p1_broken.ply
printf '1 2 3\n' >scans/p9_enroll.xyz
scan 9 1 scans/p9_again.ply --pose 0 --shift 0
{
    printf '\357\273\277"subject",file,kind\r\n'
    for s in 1 2 3 4 5; do
        printf 'p%s,scans/p%s_enroll.ply,enroll\r\n' $s $s
    done
    scan 1 3 scans/p1_straight.ply --pose 0 --shift 0
    printf '%s\r\n' 'p1,scans/p1_straight.ply,"straight, neutral"' \
        'p1,scans/p1_broken.ply,broken' 'p2,scans/p2_again.ply,later' \
        'p9,scans/p9_enroll.xyz,enroll' 'p9,scans/p9_again.ply,later'
} >list.csv
printf 'id,population,relative_of\np1,a,\np2,a,p1\np3,a,\np4,b,\np5,b,\np9,a,\n' >subjects.csv
expect 0 "a manifest" "$lab" evaluate list.csv --out listed
is "failures to enroll" "$(get listed .failures_to_enroll)" 1
is "failures to acquire" "$(get listed '.mated[0].failures_to_acquire')" 1
is "why" "$(get listed '[.refused[] | .file + .reason[0:0]] | sort | join(" ")')" \
    'scans/p1_broken.ply scans/p9_enroll.xyz'
is "mated ones that were possible" "$(get listed '.mated[0] | [.comparisons, .planned] | join(" ")')" '2 4'
is "refusals are errors" "$(get listed '.mated[0] | [.fnmr.of, .frr.of, .with_refusals.mated] | join(" ")')" '2 4 4'
is "impossible ones are listed" "$(grep -c 'mated,refused,\|relative,refused,' listed/scores.csv)" 7
is "and why" "$(lines listed '^mated' refused | tr -d ' ') $(grep -c 'refused,.*,too_few_points,$' listed/scores.csv)" '2 4'
is "refusals have rows of their own" "$(grep ',failure_to_' listed/scores.csv | cut -d, -f 1-8 | paste -sd ' ')" \
    'scans/p9_enroll.xyz,,p9,,enroll,,failure_to_enroll,refused ,scans/p1_broken.ply,,p1,,broken,failure_to_acquire,refused'
ok "with code and detail" grep -q ',failure_to_acquire,refused,.*,malformed,.*line' listed/scores.csv
is "in JSON too" "$(get listed '[.refused[] | select(.as) | .as, .code] | join(" ")')" \
    'template too_few_points probe malformed'
# p1 and p2 are relatives; p3 and p9 are of their population, p4 and p5 are not
is "relatives" "$(get listed .relative.comparisons)" 2
is "non-mated" "$(grep -c ',non-mated,[mn]' listed/scores.csv)" 5
is "none across populations" "$(grep -c 'p[45]_' listed/scores.csv)" 0
is "a kind with a comma" "$(get listed '[.mated[].probes] | contains(["straight, neutral"])')" true
is "a quoted field" "$(grep -c '"straight, neutral",mated,match' listed/scores.csv)" 1

printf 'file,subject\nscans/p1_enroll.ply,p1\nscans/nothing.ply,p1\n' >bad.csv
expect 66 "a scan is missing" "$lab" evaluate bad.csv --out none
has err 'bad.csv, line 3, column file'
printf 'file,subject\nscans/p1_enroll.ply,p1\n' >bad.csv
expect 65 "nothing to compare" "$lab" evaluate bad.csv --out none
has err 'nothing to compare: no probe has'
expect 66 "no such folder" "$lab" evaluate nowhere
mkdir empty
expect 65 "an empty folder" "$lab" evaluate empty --out none
has err 'no scans'
expect 64 "no folder given" "$lab" evaluate
has err 'usage: surfacelab evaluate DIR'
expect 64 "a scan given" "$lab" evaluate scans/p1_enroll.ply
has err 'is one scan; usage: surfacelab evaluate DIR'
expect 64 "no non-mated comparisons" "$lab" evaluate scans --non-mated 0
expect 64 "no threads" "$lab" evaluate scans --threads few
ok "nothing was written" [ ! -e none ]
: >file
rm scans/p1_broken.ply scans/p9_enroll.xyz
expect 74 "the output is no folder" "$lab" evaluate scans --out file

# ---- frames of a session
mkdir bursts
for s in 1 2; do
    for k in 0 1 2; do
        scan $s $k bursts/p${s}_enroll-$k.ply --noise 1
        scan $s $((k + 5)) bursts/p${s}_later-$k.ply --noise 1
    done
done
expect 0 "sessions" "$lab" evaluate bursts --burst 3 --enroll-kind enroll-0 --out burst --json
cut -d, -f1,2 burst/scores.csv | sed 1d | sort >pairs
is "are one scan each" "$(wc -l <pairs)" 4
expect 64 "too many frames" "$lab" evaluate bursts --burst 21
expect 64 "of pairs" "$lab" evaluate --pairs scans/list --burst 2

expect 0 "help" "$lab" evaluate --help
has out '^Usage: surfacelab evaluate DIR'

finish
