#!/bin/sh
# Goal: surfacectl explain says why a scan matches a subject or a template, or not: its figures
# agree with each other and with verify, the audit log has an entry, and nothing is explained of
# somebody who is not there.  surfacelab explain does it of two files, as tables.  The pages
# in a browser: page.sh.
# shellcheck disable=SC2016 # the variables are jq's
. tests/box/lib.sh
in_folder

scan 1 0 a0.ply --pose 0 --shift 0
scan 1 1 a1.ply --pose 5 --shift 5
scan 2 0 b0.ply --pose 0 --shift 0
scan 1 1 a1.xyz --pose 0 --shift 0
awk '$2 < 0' a1.xyz >part.xyz
"$ctl" --db faces.db init >/dev/null
id=$("$ctl" --db faces.db enroll alice a0.ply | cut -d' ' -f1)
"$ctl" --db faces.db enroll --force alice b0.ply >/dev/null
"$ctl" --db faces.db enroll bob b0.ply >/dev/null

expect 0 "one person" "$ctl" --db faces.db explain alice a1.ply
has out '^decision *match: the score reaches the threshold'
has out '^fmr .* at this score'
has out "^template *$id, with the highest score of 2"
has out '^template *29[0-9]* points, quality'
expect 0 "as JSON" "$ctl" --db faces.db explain alice a1.ply --json
ok "its members" jq_true '.decision == "match" and .score >= .threshold and
    .fmr_at_score < 0.01 and .disparity_mm > 0 and .overlap > 0.8 and .expected > .threshold and
    .quality.score > 0.5 and .template_quality.score > 0.5 and
    (.alignment.transform | length) == 16' out
is "the template that decides" "$(jq -r .template_id out)" "$id"
"$ctl" --db faces.db verify alice a1.ply --json >verified
is "as verify" "$(jq -c '[.decision, .score, .disparity_mm, .template_id]' verified)" \
    "$(jq -c '[.decision, .score, .disparity_mm, .template_id]' out)"
ok "what each cell adds to the score" jq_true '(.score + ([.templates_compared] | map(log)[0])) as $s |
    .cells | .nx * .ny == (.part | length) and (.part | map(numbers) | add - $s | fabs < 0.02)' out
expect 1 "two people" "$ctl" --db faces.db explain bob a1.ply --json
ok "more lies between them" jq_true '.reason == "the score is below the threshold"' out
expect 2 "a part of the face" "$ctl" --db faces.db explain alice part.xyz
has out '^decision *inconclusive: '
expect 0 "a template" "$ctl" --db faces.db explain "$id" a1.ply
is "the events" "$(sqlite3 faces.db \
    "SELECT count(*) FROM $ENTRIES WHERE kind = 'explain' AND object = '$id' AND outcome = 'match'")" 3
expect 66 "no such subject" "$ctl" --db faces.db explain carl a1.ply
expect 66 "no such template" "$ctl" --db faces.db explain 00000000000000000000000000000000 a1.ply
expect 66 "no such scan" "$ctl" --db faces.db explain alice none.ply
expect 64 "a threshold of one's own" "$ctl" --db faces.db explain --threshold -50 alice a1.ply

# ---- two files
expect 0 "two files" "$lab" explain a0.ply a1.ply
has out '^decision *match, score'
is "the files" "$(files explanation)" 'cells.csv explain.html explain.json points.csv'
is "the folder's mode" "$(stat -c %a explanation)" 700
is "the files' modes" "$(stat -c %a explanation/* | sort -u)" 600
"$ctl" compare --json a0.ply a1.ply >compared
is "as compare" "$(jq -c '[.decision, .score, .disparity_mm]' compared)" \
    "$(jq -c '[.decision, .score, .disparity_mm]' explanation/explain.json)"
is "every point of the probe's face" "$(wc -l <explanation/points.csv)" $(($("$ctl" scan --json a1.ply | jq '.scans[0].scan.points_used') + 1))
ok "the cells' parts sum up to the score" awk -F, -v score="$(jq -r .score explanation/explain.json)" \
    'NR > 1 { s += $4 } END { d = s - score; exit d * d > 0.05 ^ 2 }' explanation/cells.csv
ok "the regions' too" jq_true '.score as $s | .regions | map(numbers) | add - $s | fabs < 0.05' \
    explanation/explain.json
ok "a part only with a gap" awk -F, '$4 == "" && $5 != "" { exit 1 }' explanation/points.csv
expect 65 "a second time" "$lab" explain a0.ply b0.ply
expect 1 "two people" "$lab" explain a0.ply b0.ply --force
expect 2 "a part of the face" "$lab" explain a0.ply part.xyz --out part
expect 66 "no such scan" "$lab" explain a0.ply none.ply --out none
ok "no folder for it" [ ! -e none ]
finish
