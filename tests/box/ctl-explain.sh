#!/bin/sh
# Goal: surfacectl explain says why a comparison came out so: every file is there, whole,
# its owner's alone, of this comparison and no other, and they agree with each other.
set -u
BUILD=${BUILD:-build}
case $BUILD in /*) ;; *) BUILD=$PWD/$BUILD ;; esac
ctl=$BUILD/surfacectl
for tool in jq sqlite3; do
    command -v "$tool" >/dev/null 2>&1 || {
        echo "SKIP $0: $tool is not installed"
        exit 0
    }
done
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 1
unset SURFACED_DB
passed=0 failed=0

# expect CODE WHAT COMMAND...: run it, its output in the files out and err
expect() {
    want=$1 what=$2
    shift 2
    "$@" >out 2>err </dev/null
    got=$?
    that "$what: exit $got, wanted $want: $(cat err)" [ "$got" -eq "$want" ]
}

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
has() { that "$what: no '$2' in $1: $(head -n 20 "$1")" grep -q -e "$2" "$1"; }
files() { find "$1" -mindepth 1 -printf '%f\n' | LC_ALL=C sort | paste -sd ' '; }

# vertices FILE: of a cloud that explain wrote: all, without a gap, in grey, contradictions
vertices() {
    header=$(grep -abo -m 1 end_header "$1" | cut -d: -f1)
    od -An -v -tu1 -w19 -j $((header + 11)) "$1" | awk '{ grey = $13 $14 $15 == 150150150
            nan = $16 == 0 && $17 == 0 && $18 == 192 && $19 == 127
            nans += nan; greys += grey; bad += NF != 19 || nan != grey }
        END { print NR, nans, greys, bad }'
}

scan() { "$BUILD/facegen" --subject "$1" --scan "$2" --pose "$3" --shift "$3" -o "$4"; }
scan 1 0 0 a0.ply || exit 1
scan 1 1 5 a1.ply || exit 1
scan 2 0 0 b0.ply || exit 1
scan 1 0 0 a0.xyz || exit 1
all='explain.json explain.txt gap.ply'
if command -v gnuplot >/dev/null 2>&1; then
    pictures="$all gap.png histogram.png" drawn=true
else
    echo "SKIP pictures: gnuplot is not installed"
    pictures=$all drawn=false
fi

# ---- the same person
expect 0 "one person" "$ctl" explain a0.ply a1.ply
has out '^decision *match: the disparity is not above the threshold'
has out '^common .* weight'
has out '^template *3000 points, quality'
is "the files" "$(files explanation)" "$pictures"
is "the directory's mode" "$(stat -c %a explanation)" 700
is "the files' modes" "$(stat -c %a explanation/* | sort -u)" 600
that "explain.txt is what is printed" sh -c "sed '/^written to/d' out | cmp -s - explanation/explain.txt"
for picture in $pictures; do
    case $picture in
    *.png) is "$picture" "$(head -c 8 "explanation/$picture" | od -An -tx1 | tr -d ' ')" 89504e470d0a1a0a ;;
    esac
done
expect 0 "as JSON" "$ctl" explain --json a0.ply a1.ply --out json
is "explain.json is what is printed" "$(jq -cS . json/explain.json)" \
    "$(jq -cS 'del(.directory, .pictures)' out)"
is "it says where, and if there are pictures" "$(jq -c '[.directory, .pictures]' out)" \
    "[\"json\",$drawn]"
that "its members" jq -e '.decision == "match" and .disparity_mm <= .threshold_mm and
    .fmr_at_score < 0.01 and .plain_mm > 0 and .overlap > 0.8 and .weight_overlap > 0.8 and
    .quality.score > 0.5 and .template_quality.score > 0.5 and (.alignment.transform | length) == 16 and
    .gap.points == 3000 and .gap.compared > 2500 and (.gap.median_mm | fabs) < 0.5 and
    .gap.share_beyond_1_mm < 0.2 and
    (.gap.size_quantiles | map(.mm) | . == sort and length == 6)' out >/dev/null
"$ctl" compare --json a0.ply a1.ply >compared
is "the verdict of compare" \
    "$(jq -cS '[.decision, .disparity_mm, .plain_mm, .alignment.transform]' compared)" \
    "$(jq -cS '[.decision, .disparity_mm, .plain_mm, .alignment.transform]' out)"
compared=$(jq .gap.compared out)
is "gap.ply: every point; no gap, no colour" "$(vertices json/gap.ply)" \
    "3000 $((3000 - compared)) $((3000 - compared)) 0"
expect 0 "gap.ply is a scan, where the template is" "$ctl" compare --json a0.ply json/gap.ply
that "it need not be moved" jq -e '[.alignment.transform, [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]] |
    transpose | all(.[0] - .[1] | fabs < 0.05)' out >/dev/null
expect 0 "a face and itself" "$ctl" explain --json a0.xyz a0.ply --out same
that "no gap" jq -e '.gap.size_quantiles[2].mm < 0.01' out >/dev/null

# ---- another person, into the same directory
rm explanation/gap.ply
echo mine >kept
ln -s ../kept explanation/gap.ply
expect 1 "two people" "$ctl" explain a0.ply b0.ply
has out '^decision *no_match: the disparity is above the threshold'
is "the files again" "$(files explanation)" "$pictures"
is "what a link pointed to" "$(cat kept)" mine
is "gap.ply is a file now" "$(stat -c '%F %a' explanation/gap.ply)" 'regular file 600'
expect 64 "by a threshold of one's own" "$ctl" explain --threshold-mm 50 a0.ply b0.ply --out 50
awk '$1 < -22' a0.xyz >part.xyz
expect 2 "a part of the face" "$ctl" explain a0.ply part.xyz --out part
has out '^decision *inconclusive: '
expect 0 "from a pipe" sh -c "'$ctl' explain a0.ply - --out pipe <a1.ply"

# ---- from the database
"$ctl" --db faces.db init >/dev/null
id=$("$ctl" --db faces.db enroll alice a0.ply | cut -d' ' -f1)
"$ctl" --db faces.db enroll --force alice b0.ply >/dev/null
expect 0 "a subject" "$ctl" --db faces.db explain alice a1.ply --out db --json
is "the template that decides" "$(jq -r .template_id out)" "$id"
is "as with the scan" "$(jq -c .gap out)" "$(jq -c .gap json/explain.json)"
expect 0 "a template" "$ctl" --db faces.db explain "$id" a1.ply --out db
has out "$id"
is "the events" "$(sqlite3 faces.db \
    "SELECT count(*) FROM events WHERE kind = 'explain' AND template_id = '$id' AND outcome = 'match'")" 2
expect 66 "no such subject" "$ctl" --db faces.db explain bob a1.ply --out bob
expect 66 "no such template" "$ctl" --db faces.db explain 00000000000000000000000000000000 \
    a1.ply --out bob
that "nothing is written then" [ ! -e bob ]

# ---- what can go wrong
mkdir bin
expect 0 "no gnuplot" env PATH="$dir/bin" "$ctl" explain a0.ply a1.ply
has err 'no pictures: gnuplot is not installed'
is "the rest, and no older pictures" "$(files explanation)" "$all"
printf '#!/bin/sh\necho half a picture\necho it broke >&2\nexit 1\n' >bin/gnuplot
chmod +x bin/gnuplot
expect 70 "a gnuplot that fails" env PATH="$dir/bin:$PATH" "$ctl" explain a0.ply a1.ply
has err 'it broke'
is "no half a picture" "$(files explanation)" "$all"
expect 74 "a disk that is full" sh -c "trap '' XFSZ; ulimit -f 40; exec '$ctl' explain a0.ply a1.ply"
has err 'gap.ply: File too large'
is "no half a cloud" "$(files explanation)" 'explain.json explain.txt'
expect 74 "a file in the place of the directory" "$ctl" explain a0.ply a1.ply --out kept
is "it is as it was" "$(cat kept)" mine
expect 74 "a directory in a directory that is missing" "$ctl" explain a0.ply a1.ply --out no/where
expect 66 "no such scan" "$ctl" explain a0.ply none.ply --out none
that "no directory for it" [ ! -e none ]
expect 64 "--out elsewhere" "$ctl" compare a0.ply a1.ply --out x
expect 0 help "$ctl" explain --help
has out '^Example:'
has out '--out DIR'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
