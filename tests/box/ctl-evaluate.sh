#!/bin/sh
# Goal: surfacectl evaluate compares what it should, says so in every file alike, the same on
# any number of threads, claims no rate that the comparisons do not support, and lists what
# it could not use.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
in_folder

get() { jq -r "$2" "$1/report.json"; }

# lines DIR TYPE DECISION: how many comparisons scores.csv has of both (. is any)
lines() { awk -F, -v t="$2" -v d="$3" '$6 ~ t && $7 ~ d' "$1/scores.csv" | wc -l; }

mkdir scans
for s in 1 2 3 4 5; do
    scan $s 0 "scans/p${s}_enroll.ply" --pose 0 --shift 0
    scan $s 1 "scans/p${s}_again.ply" --pose 6 --shift 6
    scan $s 2 "scans/p${s}_Third_time.xyz" --pose 6 --shift 6
done
scan 6 0 scans/p6_a.ply --pose 0 --shift 0 # none is marked: the first one is enrolled
scan 6 1 scans/p6_b.ply --pose 6 --shift 6
tables='rates.csv report.html report.json report.md scores.csv'
if command -v gnuplot >/dev/null 2>&1; then
    all='det.png det.svg rates.csv report.html report.json report.md scores.csv scores.png scores.svg'
else
    echo "SKIP the pictures: gnuplot is not installed"
    all=$tables
fi

expect 0 "a folder" "$ctl" evaluate scans
has out 'The report is in evaluation/'
has out 'own template nearest'
has out 'FMR 0.1 %: not supported by 55 non-mated comparisons; it takes 3000'
has out '| mated, Third\\_time | 5 | 5 | 0 | 0 | FNMR below 60.0 % (0 of 5) |'
is "the files" "$(files evaluation)" "$all"
is "the folder is its owner's alone" "$(stat -c %a evaluation)" 700
is "mated" "$(get evaluation '.mated[0].comparisons')" 11
is "non-mated" "$(get evaluation .non_mated.comparisons)" 55
is "of kind b" "$(get evaluation '.mated[] | select(.probes == "b") | .comparisons')" 1
is "all are accepted" "$(get evaluation '.mated[0].match')" 11
is "nobody else is" "$(get evaluation .non_mated.match)" 0
is "no rate is claimed" "$(get evaluation '[.non_mated.fmr, .mated[].eer, .mated[].fnmr, .mated[].tar[]]
    | map(.value) | unique')" "$(printf '[\n  null\n]')"
is "but a bound is" "$(get evaluation '.non_mated.fmr.below * 55 | round')" 3
for type in mated non-mated relative; do
    for d in match no_match inconclusive; do
        path=$([ $type != mated ] && echo ".$type.$d" | tr - _ || echo ".mated[0].$d")
        is "$type $d" "$(lines evaluation "^$type" "^$d")" "$(get evaluation "$path")"
    done
done
is "p6_a is enrolled" "$(grep -c '^p6_a.ply,p6_b.ply,p6,p6,b,mated,match' evaluation/scores.csv)" 1
is "no rank is lost" "$(get evaluation '.mated[0].own_template_nearest')" 11
# What rates.csv says at a threshold is what scores.csv says.
is "rates and scores" "$(awk -F, 'FNR == 1 { next }
    NR == FNR { type[NR] = $6; mm[NR] = $8; next }
    FNR % 50 == 0 { g = i = ga = ia = 0
        for (k in mm) if (type[k] == "mated") { g++; ga += (mm[k] <= $1) } else { i++; ia += (mm[k] <= $1) }
        a = $2 - ia / i; b = $3 - 1 + ga / g
        bad += (a * a + b * b > 1e-12); n++ }
    END { print (n > 9), bad + 0 }' evaluation/scores.csv evaluation/rates.csv)" "1 0"
case $all in
*png*)
    is "a PNG" "$(head -c 4 evaluation/det.png | od -An -c | tr -d ' ')" '211PNG'
    ok "an SVG" grep -q '</svg>' evaluation/scores.svg
    ok "the axis has its unit" grep -q 'comparison score, mm' evaluation/scores.svg
    ;;
esac

# One page: the same words as the Markdown, and the pictures in it.
page=evaluation/report.html
what="the page"
has $page '<h2>Rates</h2>'
has $page '<tr><td>mated, Third_time</td><td>5</td><td>5</td><td>0</td><td>0</td><td>FNMR below 60.0 % (0 of 5)</td></tr>'
is "no Markdown is left" "$(grep -c '^[|#!]\|[\\]' $page)" 0
is "every row" "$(grep -c '^<tr>' $page)" \
    "$(grep '^|' evaluation/report.md | grep -vc '^|---\|^| | |$')"
if command -v xmllint >/dev/null 2>&1; then
    expect 0 "well-formed" xmllint --html --noout $page
    is "without a complaint" "$(cat err)" ''
fi
ok "it loads nothing" sh -c "! grep -q 'src=\"[^d]\|href\|<script' $page"
# With errors, one scan under another's name: fewer than 3 are a bound too, but a higher one.
mkdir wrong
cp scans/* wrong
cp scans/p2_again.ply wrong/p1_again.ply
expect 0 "one error" "$ctl" evaluate wrong --out erred
has out '| mated, all | 11 | 10 | 1 | 0 | FNMR below 43.1 % (1 of 11) |'
has out '| non-mated | 55 | 1 | 54 | 0 | FMR below 8.6 % (1 of 55) |'
is "and in JSON" "$(get erred '[(.mated[0].fnmr.below * 11), (.non_mated.fmr.below * 55)]
    | map(. * 100 | round / 100) | join(" ")')" '4.74 4.74'
if [ "$all" != "$tables" ]; then
    for n in det scores; do
        ok "$n is in it" grep -q "src=\"data:image/svg+xml;base64,$(base64 -w 0 evaluation/$n.svg)\"" $page
    done
    # What gnuplot is told: without errors, the bounds, a sentence, and no empty plot.
    mkdir bin
    printf '#!/bin/sh\ncat >"%s/script.$$"\nexec %s --default-settings <"%s/script.$$"\n' \
        "$T" "$(command -v gnuplot)" "$T" >bin/gnuplot
    chmod +x bin/gnuplot
    expect 0 "drawn" env PATH="$T/bin:$PATH" "$ctl" evaluate scans --out drawing
    cat "$T"/script.* >script
    what="the DET curve"
    has script 'at the threshold: FMR below 5.5 % (0 of 55), FNMR below 27.3 % (0 of 11)'
    has script 'No error at some thresholds: the rates are below the dashed bound'
    has script "label 1 'FMR below 3 / 55: too few"
    has script "label 2 'FNMR below 3 / 11: too few"
    is "the threshold's point is the bounds" "$(grep -A 1 'point0 <<' script | sed -n 2p)" \
        '0.054545455 0.27272727'
    # inside the axes, and in a line: down at the one bound, then along the other
    is "the bound is drawn" "$(awk '/^\$bound0 / { on = 1; next } /^EOD/ { on = 0 }
        on && NF == 2 { n++; down += $1 == 0.054545455; along += $2 == 0.27272727
            low += $1 < 0.054545 || $2 < 0.272727 }
        END { print (n / 2 > 5), (down > 4), (along > 4), low + 0 }' script)" "1 1 1 0"
    what="the histogram"
    is "no bar is cut off" "$(awk '/^\$(mated|non_mated|relative) / { on = 1; next } /^EOD/ { on = 0 }
        on { n++; if ($2 > most) most = $2 }
        sub(/.*set yrange \[0:/, "") { top = $1 + 0 }
        END { print (n > 40), (top >= 1.05 * most && top < 1.2 * most) }' script)" "1 1"
    rm -f "$T"/script.*
    expect 0 "with errors" env PATH="$T/bin:$PATH" "$ctl" evaluate wrong --out drawing
    cat "$T"/script.* >script
    is "the curve is drawn" "$(awk '/^\$curve0 / { on = 1; next } /^EOD/ { on = 0 }
        on && NF == 2 { n++; bad += $1 <= 0 || $2 <= 0 } END { print (n > 4), bad + 0 }' script)" "1 0"
fi

for n in 1 3; do
    expect 0 "$n threads" "$ctl" evaluate scans --threads $n --out "by-$n"
    ok "$n threads: the same scores" cmp evaluation/scores.csv "by-$n/scores.csv"
    ok "$n threads: the same rates" cmp evaluation/rates.csv "by-$n/rates.csv"
done
expect 0 "JSON" "$ctl" evaluate scans --json --non-mated 2 --out drawn
ok "what is printed is report.json" cmp out drawn/report.json
is "two non-mated comparisons a probe" "$(lines drawn non-mated .)" 22
is "it says so" "$(get drawn .non_mated.of_each_probe)" 2
expect 0 "drawn again" "$ctl" evaluate scans --non-mated 2 --threads 1 --out again
ok "the same are drawn" cmp drawn/scores.csv again/scores.csv
expect 0 "another threshold" "$ctl" evaluate scans --threshold-mm 5 --out wide
is "all are accepted there" "$(get wide '.non_mated | .match == .comparisons and .fmr.value == 1')" true

# Without gnuplot: everything else, and no picture of a former run.
expect 0 "no gnuplot" env PATH=/nowhere "$ctl" evaluate scans
has err 'no pictures: gnuplot is not installed'
has evaluation/report.md 'There are no pictures'
has evaluation/report.html 'There are no pictures'
is "the other files" "$(files evaluation)" "$tables"

# A manifest: populations, relatives, poses, and scans that cannot be used.
printf 'ply\nnot a scan\n' >scans/p1_broken.ply
printf '1 2 3\n' >scans/p9_enroll.xyz
scan 9 1 scans/p9_again.ply --pose 0 --shift 0
{
    printf '\357\273\277"subject",file,kind,yaw,pitch,roll,tx,ty,tz\r\n'
    for s in 1 2 3 4 5; do
        printf 'p%s,scans/p%s_enroll.ply,enroll,0,0,0,0,0,0\r\n' $s $s
    done
    scan 1 3 scans/p1_straight.ply --pose 0 --shift 0
    printf '%s\r\n' 'p1,scans/p1_straight.ply,"straight, neutral",0,0,0,0,0,0' \
        'p1,scans/p1_broken.ply,broken,0,0,0,0,0,0' 'p2,scans/p2_again.ply,later,0,0,0,0,0,0' \
        'p9,scans/p9_enroll.xyz,enroll,0,0,0,0,0,0' 'p9,scans/p9_again.ply,later,0,0,0,0,0,0'
} >list.csv
printf 'id,population,relative_of\np1,a,\np2,a,p1\np3,a,\np4,b,\np5,b,\np9,a,\n' >subjects.csv
expect 0 "a manifest" "$ctl" evaluate list.csv --out listed
is "failures to enrol" "$(get listed .failures_to_enrol)" 1
is "failures to acquire" "$(get listed '.mated[0].failures_to_acquire')" 1
is "why" "$(get listed '[.refused[] | .file + .reason[0:0]] | sort | join(" ")')" \
    'scans/p1_broken.ply scans/p9_enroll.xyz'
has listed/report.md 'scans/p1\\_broken.ply .*a probe.*line'
has listed/report.md 'false reject rate 25.0 %'
is "mated ones that were possible" "$(get listed '.mated[0].comparisons')" 2
is "impossible ones are listed" "$(grep -c ',refused,' listed/scores.csv)" 7
# p1 and p2 are relatives; p3 and p9 are of their population, p4 and p5 are not
is "relatives" "$(get listed .relative.comparisons)" 2
is "non-mated" "$(grep -c ',non-mated,[mn]' listed/scores.csv)" 5
is "none across populations" "$(grep -c 'p[45]_' listed/scores.csv)" 0
is "a kind with a comma" "$(get listed '[.mated[].probes] | contains(["straight, neutral"])')" true
is "a quoted field" "$(grep -c '"straight, neutral",mated,match' listed/scores.csv)" 1
is "the pose was found" "$(get listed '.mated[] | select(.probes == "straight, neutral")
    | .rotation_error_deg.largest < 1')" true

# A scan before a wall that was turned to the front first: the pose is that of the scan as it was sent.
scan 1 4 turned.xyz --yaw 20 --pitch 10 --roll 70
awk -v OFMT=%.9g '{ print $1 / 1000, $2 / 1000, $3 / 1000 }
    END { for (i = 0; i < 6400; i++) print i % 80 / 100 - 0.4, int(i / 80) / 100 - 0.4, -0.4 }' \
    turned.xyz >metres.xyz
printf '%s\n' 'subject,file,yaw,pitch,roll,tx,ty,tz' p1,scans/p1_enroll.ply,0,0,0,0,0,0 \
    p1,metres.xyz,20,10,70,0,0,0 p3,scans/p3_enroll.ply,0,0,0,0,0,0 >turned.csv
expect 0 "turned and in metres" "$ctl" evaluate turned.csv --out turned
is "its pose was found" "$(get turned '.mated[0].rotation_error_deg.largest < 1')" true

printf 'file,subject\nscans/p1_enroll.ply,p1\nscans/nothing.ply,p1\n' >bad.csv
expect 66 "a scan is missing" "$ctl" evaluate bad.csv --out none
has err 'bad.csv, line 3, column file'
printf 'file,subject\n"scans/p1_enroll.ply,p1\n' >bad.csv
expect 65 "malformed" "$ctl" evaluate bad.csv --out none
has err 'a quotation is not closed'
printf 'scan,subject\nscans/p1_enroll.ply,p1\n' >bad.csv
expect 65 "no column" "$ctl" --json evaluate bad.csv --out none
has err 'no column is named file'
is "an error in JSON" "$(jq .error.exit out)" 65
printf 'file,subject\nscans/p1_enroll.ply,p1\n' >bad.csv
expect 65 "nothing to compare" "$ctl" evaluate bad.csv --out none
has err 'no subject has a second scan'
expect 66 "no such folder" "$ctl" evaluate nowhere
mkdir empty
expect 65 "an empty folder" "$ctl" evaluate empty --out none
has err 'no scans'
expect 64 "no folder given" "$ctl" evaluate
expect 64 "no non-mated comparisons" "$ctl" evaluate scans --non-mated 0
expect 64 "no threads" "$ctl" evaluate scans --threads few
ok "nothing was written" [ ! -e none ]
: >file
rm scans/p1_broken.ply scans/p9_enroll.xyz
expect 74 "the output is no folder" "$ctl" evaluate scans --out file

# The calibration of a database.
expect 0 init "$ctl" --db faces.db init
expect 0 "by a database" "$ctl" --db faces.db evaluate scans --non-mated 1 --out by-db
has by-db/report.md 'calibration as shipped'
expect 66 "no such database" "$ctl" --db nowhere.db evaluate scans
expect 0 "help" "$ctl" evaluate --help
has out '^Example:'

finish
