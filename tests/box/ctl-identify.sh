#!/bin/sh
# Goal: a folder of scans is enrolled, and surfacectl says whose a scan is: a name, nobody, or that it cannot
# tell and what helps; candidates alone where asked for; each search is recorded, a dry run is not.
. tests/box/lib.sh
in_folder

mkdir scans frames
for n in 1 2 3 4 5 6; do
    scan $n 0 "scans/p${n}_1.ply"
done
scan 3 1 probe.ply --pose 8 --shift 10
scan 3 2 frames/1.ply --pose 5 --noise 0.8
scan 3 3 frames/2.ply --pose 5 --noise 0.8
scan 9 0 stranger.ply
"$ctl" --db "$DB" init >init.out
DB=$T/faces.db
entries() { sql "SELECT count(*) FROM $ENTRIES WHERE kind = '$1'"; }
# reads TITLE PATTERN...: the text has each.
reads() {
    title=$1
    shift
    for pattern; do contains "$title" text "$pattern"; done
}
text() { "$ctl" --db "$DB" identify "$@" >text 2>err; }

ctl_exits 1 identify probe.ply
is "nobody is enrolled" "$(said '[.decision, .subject, .searched, .compared, .score] | join(" ")')" 'no_match  0 0 '
text probe.ply
reads "as text" '^subject      none: there is nobody to search$'
ctl_exits 0 enroll scans
ctl_exits 0 identify probe.ply
is "a match" "$(said '[.decision, .subject, .searched, .skipped, .compared] | join(" ")')" 'match p3 6 0 6'
ok "the template" test "$(said .template_id)" = "$("$ctl" --db "$DB" template list p3 --json | jq -r '.templates[0].template_id')"
ok "the threshold of verifications for so few" jq_true '.threshold == 8 and .score > .threshold' "$T/ctl"
score=$(said .score)
is "no candidates" "$(said '.candidates')" null
text probe.ply
reads "as text" '^decision     match$' '^subject      p3 \(template [0-9a-f]{32}\)$' \
    "^score        $score \\(a match at 8\\.00 or above, among 6 people\\)$" '^fpir         [0-9].* at this score' \
    '^searched     6 people; 6 compared exactly, 0 templates skipped$' '^gallery      6 templates, .* of memory, loaded in '
ok "nobody else is named" sh -c '! grep -q "p[12456] " text'
ctl_exits 0 verify p3 probe.ply
is "the score is a verification's" "$(said .score)" "$score"

ctl_exits 1 identify stranger.ply
is "a stranger" "$(said '[.decision, .subject, .template_id] | join(" ")')" 'no_match  '
text stranger.ply
reads "as text" '^decision     no_match$' '^subject      none of those searched$'
ok "nobody is named" sh -c '! grep -q "p[1-6] " text'
is "nor recorded as a candidate" "$(entries candidate)" 0

ctl_exits 1 identify stranger.ply --candidates 3
is "three candidates" "$(said '.candidates | length')" 3
ok "by falling score" jq_true '[.candidates[].score] | . == (sort | reverse)' "$T/ctl"
ok "the first has the score that decides" jq_true '.candidates[0].score == .score' "$T/ctl"
is "each is recorded" "$(entries candidate)" 3
text stranger.ply --candidates 3
reads "as text" '^candidates   to be reviewed by a person: ' '^ +-?[0-9.]+  fmr [0-9.e-]+ +p[1-6] +template [0-9a-f]{32}$'
first=$(said '.candidates[0].subject')
ctl_exits 1 verify "$first" stranger.ply
is "the score is a verification's" "$("$ctl" --db "$DB" identify stranger.ply --candidates 1 --json | jq .score)" "$(said .score)"

# ---- a scan that could be anybody's
scan 3 1 holes.ply --holes 0.75
ctl_exits 2 identify holes.ply
is "too little of a face" "$(said '[.decision, .subject, .searched, .compared] | join(" ")')" 'inconclusive  6 0'
text holes.ply
reads "as text" '^subject      cannot tell: too little of the face is known'
ctl_exits 2 verify p3 holes.ply

# ---- several frames
ctl_exits 0 identify frames/1.ply frames/2.ply
is "two files" "$(said '[.subject, (.frames | length)] | join(" ")')" 'p3 2'
ctl_exits 0 identify frames
is "a folder" "$(said '[.subject, (.frames | length)] | join(" ")')" 'p3 2'
echo 'no scan' >none.ply
ctl_exits 65 identify none.ply
ctl_exits 66 identify missing.ply

# ---- who cannot be found
"$ctl" --db "$DB" subject disable p3 >out
ctl_exits 1 identify probe.ply --candidates 50
is "disabled" "$(said '[.searched, (.candidates | map(.subject) | index("p3"))] | join(" ")')" '5 '
"$ctl" --db "$DB" subject enable p3 >out
ctl_exits 1 identify probe.ply --group door-3
is "a group without anybody" "$(said '[.decision, .searched] | join(" ")')" 'no_match 0'
for n in 1 2; do "$ctl" --db "$DB" subject set p$n --group door-3,staff >out; done
ctl_exits 1 identify probe.ply --group door-3
is "a group without the person" "$(said '[.decision, .searched] | join(" ")')" 'no_match 2'
"$ctl" --db "$DB" subject set p3 --group door-3 >out
ctl_exits 0 identify probe.ply --group door-3
is "with the person" "$(said '[.decision, .subject, .searched] | join(" ")')" 'match p3 3'
"$ctl" --db "$DB" subject set p3 --identify no >out
ctl_exits 1 identify probe.ply
is "opted out" "$(said '[.decision, .searched] | join(" ")')" 'no_match 5'
ctl_exits 0 verify p3 probe.ply
"$ctl" --db "$DB" subject set p3 --identify yes >out

# ---- a dry run
searches=$(entries identify)
ctl_exits 0 identify --dry-run
is "a dry run" "$(said '[.searched, .skipped, .threshold, .people_supported, .templates] | join(" ")')" '6 0 8 10000 6'
ok "what it would take" jq_true '.memory_bytes > 0 and .load_ms > 0 and .search_ms > 1 and
    .fpir_at_threshold > 0 and .fpir_at_threshold <= 0.01' "$T/ctl"
text --dry-run --group door-3
reads "as text, of a group" '^people       3 of the group door-3$' '^time         about '
ctl_exits 0 identify probe.ply --dry-run
is "nothing is searched, nor recorded" "$(said .decision) $(entries identify)" "null $searches"

# ---- more people than the calibration is good for
sed '/^4663 /d; /^5701 /d; /^7303 /d; s/^knots 14$/knots 11/; s/^tail 10000$/tail 3/' "$OLDPWD/core/face/default.model" >few.model
export SURFACED_MODEL=few.model
"$ctl" --db few.db init >out
"$ctl" --db few.db enroll scans >out 2>&1
DB=few.db
ctl_exits 2 identify probe.ply
is "inconclusive" "$(said '[.decision, .subject, .threshold] | join(" ")')" 'inconclusive  '
text probe.ply
reads "what helps" '^subject      cannot tell: the calibration is good for [1-5] people at most' 'surfacectl calibrate' \
    '^score        .* \(among 6 people no score is a match\)$'
ok "nobody is named" sh -c '! grep -q "p[1-6] " text'
ctl_exits 0 identify --dry-run
is "a dry run says so" "$(said '[.threshold, .fpir_at_threshold, (.people_supported < 6)] | join(" ")')" '  true'
for n in 1 2 3; do "$ctl" --db few.db subject set p$n --group few >out; done
ctl_exits 0 identify probe.ply --group few
is "a group of fewer" "$(said .subject)" p3
unset SURFACED_MODEL
DB=faces.db

# ---- bad command lines
for line in '' '--group door-3' 'probe.ply --candidates 51' 'probe.ply --candidates 0' 'probe.ply --group Door' \
    'probe.ply --group a,b'; do
    # shellcheck disable=SC2086 # arguments
    ctl_exits 64 identify $line
done
ctl_exits 0 check-database
finish
