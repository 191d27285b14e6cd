#!/bin/sh
# Goal: surfacectl explain says why a comparison came out so: every file is there, whole,
# its owner's alone, of this comparison and no other, and they agree with each other.
# shellcheck disable=SC2016 # the variables are jq's
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
in_folder

# vertices FILE: of a cloud that explain wrote: all; without a gap; without a part; in grey;
# contradictions (grey is what has no part, and a part is where a gap is)
vertices() {
    header=$(grep -abo -m 1 end_header "$1" | cut -d: -f1)
    od -An -v -tu1 -w27 -j $((header + 11)) "$1" | awk '
        function nan(at) { return $at == 0 && $(at + 1) == 0 && $(at + 2) == 192 && $(at + 3) == 127 }
        { grey = $13 $14 $15 == 150150150; gap = nan(16); part = nan(24)
            gaps += gap; parts += part; greys += grey
            bad += NF != 27 || part != grey || (gap && !(part && nan(20))) }
        END { print NR, gaps, parts, greys, bad }'
}

scan 1 0 a0.ply --pose 0 --shift 0
scan 1 1 a1.ply --pose 5 --shift 5
scan 2 0 b0.ply --pose 0 --shift 0
scan 1 0 a0.xyz --pose 0 --shift 0
all='explain.json explain.ply explain.txt'
if command -v gnuplot >/dev/null 2>&1; then
    pictures='explain.json explain.ply explain.png explain.txt' drawn=true
else
    echo "SKIP pictures: gnuplot is not installed"
    pictures=$all drawn=false
fi

# ---- the same person
expect 0 "one person" "$ctl" explain a0.ply a1.ply
has out '^decision *match: the score is not below the threshold'
has out '^false match *rate at this score'
has out '^common .* face'
has out '^template *3000 points, quality'
is "the files" "$(files explanation)" "$pictures"
is "the directory's mode" "$(stat -c %a explanation)" 700
is "the files' modes" "$(stat -c %a explanation/* | sort -u)" 600
ok "explain.txt is what is printed" sh -c "sed '/^written to/d' out | cmp -s - explanation/explain.txt"
for picture in $pictures; do
    case $picture in
    *.png) is "$picture" "$(head -c 8 "explanation/$picture" | od -An -tx1 | tr -d ' ')" 89504e470d0a1a0a ;;
    esac
done
expect 0 "as JSON" "$ctl" explain --json a0.ply a1.ply --out json
is "explain.json is what is printed" "$(jq -cS . json/explain.json)" \
    "$(jq -cS 'del(.directory, .picture)' out)"
is "it says where, and if there are pictures" "$(jq -c '[.directory, .picture]' out)" \
    "[\"json\",$drawn]"
ok "its members" jq_true '.decision == "match" and .score >= .threshold and
    .fmr_at_score < 0.01 and .disparity_mm > 0 and .overlap > 0.8 and .expected > .threshold and
    .quality.score > 0.5 and .template_quality.score > 0.5 and (.alignment.transform | length) == 16 and
    .gap.points == 3000 and .gap.compared > 2500 and (.gap.median_mm | fabs) < 0.6 and
    .gap.share_beyond < 0.2 and .gap.limit_mm == 1 and
    (.gap.amount_quantiles | map(.mm) | . == sort and length == 6)' out
"$ctl" compare --json a0.ply a1.ply >compared
is "the verdict of compare" \
    "$(jq -cS '[.decision, .score, .disparity_mm, .minimal, .alignment, .regions]' compared)" \
    "$(jq -cS '[.decision, .score, .disparity_mm, .minimal, .alignment, .regions]' out)"
ok "what each adds to the score" jq_true '.score as $s | .cells | .nx * .ny == (.part | length) and
    (.part | map(numbers) | add - $s | fabs < 0.02)' out
ok "little lies between the cells" jq_true '.cells.compared > 500 and .cells.limit_mm == 1 and
    .cells.mean_amount_mm < 0.5 and .cells.share_beyond < 0.2' out
has json/explain.txt '^gap .*it does not decide'
has json/explain.txt '^cells .*of it the score is taken'
ok "the colours are those of the parts" grep -aq 'colours: part' json/explain.ply
compared=$(jq .gap.compared out)
# shellcheck disable=SC2046 # five numbers
set -- $(vertices json/explain.ply)
is "explain.ply: every point; no gap, no colour; no contradiction" "$1 $2 $5" \
    "3000 $((3000 - compared)) 0"
ok "no part, no colour either" [ "$3" -ge "$2" ]
ok "but most have one" [ "$3" -lt 600 ]
expect 0 "explain.ply is a scan, where the template is" "$ctl" compare --json a0.ply json/explain.ply
ok "it need not be moved" jq_true '[.alignment.transform, [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]] |
    transpose | all(.[0] - .[1] | fabs < 0.05)' out
expect 0 "a face and itself" "$ctl" explain --json a0.xyz a0.ply --out same
ok "no gap" jq_true '.gap.amount_quantiles[2].mm < 0.01 and .cells.amount_quantiles[2].mm < 0.01' out

# ---- another person, into the same directory
rm explanation/explain.ply
echo mine >kept
ln -s ../kept explanation/explain.ply
expect 1 "two people" "$ctl" explain a0.ply b0.ply --force
has out '^decision *no_match: the score is below the threshold'
is "the files again" "$(files explanation)" "$pictures"
ok "much lies between the cells" jq_true '.cells.share_beyond > 0.3' explanation/explain.json
is "what a link pointed to" "$(cat kept)" mine
is "explain.ply is a file now" "$(stat -c '%F %a' explanation/explain.ply)" 'regular file 600'
expect 64 "by a threshold of one's own" "$ctl" explain --threshold -50 a0.ply b0.ply --out 50
scan 1 1 a1.xyz --pose 0 --shift 0
awk '$2 < 0' a1.xyz >part.xyz
expect 2 "a part of the face" "$ctl" explain a0.ply part.xyz --out part
has out '^decision *inconclusive: '
expect 0 "from a pipe" sh -c "'$ctl' explain a0.ply - --out pipe <a1.ply"

# ---- what is drawn: the three fields, each with its own scale, centred where it must be
if [ $drawn = true ]; then
    mkdir script
    printf '#!/bin/sh\ntee "%s/script/in" | exec %s --default-settings\n' "$T" \
        "$(command -v gnuplot)" >script/gnuplot
    chmod +x script/gnuplot
    what="the picture's script"
    expect 0 "a match drawn" env PATH="$T/script:$PATH" "$ctl" explain a0.ply a1.ply --out drawn
    what="the picture's script"
    has script/in '^set title "{/:Bold The gap as measured}'
    has script/in '^set title "{/:Bold The gap by cells, each face in its own frame}'
    has script/in '^set title "{/:Bold What each place adds to the score}'
    is "scales" "$(grep -a '^set cbrange' script/in | tr ':[]' '   ' | cut -d' ' -f4- |
        tr -s ' \n' ' ')" '-3 3 -3 3 -0.3 0.3 '
    # the tallest bar is below the upper end of the axis, and the bars are all of it
    grep -a '^set yrange\|^[-0-9.]* [-0-9.]* [0-9]*$' script/in | awk '
        /yrange/ { gsub(/[^-0-9.:]/, ""); split($0, end, ":"); next }
        { n++; cut += $2 >= end[2] || $2 < end[1] } END { print (n > 120), cut + 0 }' >bars
    is "no bar is cut off" "$(cat bars)" "1 0"
fi

# ---- from the database
"$ctl" --db faces.db init >/dev/null
id=$("$ctl" --db faces.db enroll alice a0.ply | cut -d' ' -f1)
"$ctl" --db faces.db enroll --force alice b0.ply >/dev/null
expect 0 "a subject" "$ctl" --db faces.db explain alice a1.ply --out db --force --json
is "the template that decides" "$(jq -r .template_id out)" "$id"
is "as with the scan" "$(jq -cS '[.gap, .minimal]' out)" "$(jq -cS '[.gap, .minimal]' json/explain.json)"
expect 0 "a template" "$ctl" --db faces.db explain "$id" a1.ply --out db --force
has out "$id"
is "the events" "$(sqlite3 faces.db \
    "SELECT count(*) FROM $ENTRIES WHERE kind = 'explain' AND object = '$id' AND outcome = 'match'")" 2
SURFACED_DB=faces.db
export SURFACED_DB
expect 0 "a subject of SURFACED_DB" "$ctl" explain alice a1.ply --out db --force --json
is "it is a template" "$(jq -r .template_id out)" "$id"
expect 0 "a scan, for there is no such subject" "$ctl" explain a0.ply a1.ply --out db --force --json
is "it is none" "$(jq -r .template_id out)" null
expect 66 "no scan either" "$ctl" explain nobody a1.ply --out db --force
cp a0.ply alice
expect 0 "the subject before the file" "$ctl" explain alice a1.ply --out db --force --json
is "so it is" "$(jq -r .template_id out)" "$id"
expect 0 "the file" "$ctl" explain ./alice a1.ply --out db --force --json
is "as one says" "$(jq -r .template_id out)" null
unset SURFACED_DB
expect 66 "no such subject" "$ctl" --db faces.db explain bob a1.ply --out bob
expect 66 "no such template" "$ctl" --db faces.db explain 00000000000000000000000000000000 \
    a1.ply --out bob
ok "nothing is written then" [ ! -e bob ]

# ---- what can go wrong
mkdir bin
expect 0 "no gnuplot" env PATH="$T/bin" "$ctl" explain a0.ply a1.ply --force
has err 'no picture: gnuplot is not installed'
is "the rest, and no older pictures" "$(files explanation)" "$all"
printf '#!/bin/sh\necho half a picture\necho it broke >&2\nexit 1\n' >bin/gnuplot
chmod +x bin/gnuplot
expect 70 "a gnuplot that fails" env PATH="$T/bin:$PATH" "$ctl" explain a0.ply a1.ply --force
has err 'it broke'
is "no half a picture" "$(files explanation)" "$all"
expect 74 "a disk that is full" sh -c "trap '' XFSZ; ulimit -f 40; exec '$ctl' explain a0.ply a1.ply --force"
has err 'explain.ply: File too large'
is "no half a cloud" "$(files explanation)" 'explain.json explain.txt'
expect 74 "a file in the place of the directory" "$ctl" explain a0.ply a1.ply --out kept
is "it is as it was" "$(cat kept)" mine
expect 74 "a directory in a directory that is missing" "$ctl" explain a0.ply a1.ply --out no/where
expect 66 "no such scan" "$ctl" explain a0.ply none.ply --out none
ok "no directory for it" [ ! -e none ]
expect 64 "--out elsewhere" "$ctl" compare a0.ply a1.ply --out x
expect 0 help "$ctl" explain --help
has out '^Example:'
has out '--out DIR'

finish
