#!/bin/sh
# Goal: the pages that surfacectl explain, surfacectl scan and surfacelab explain write are one small
# file each, show in a real browser who and what was compared, when, and what decided, ask nothing of
# a network, and run no script but their own.
. tests/box/lib.sh
needs_section browser chromedriver
in_folder

scan 1 0 a.ply
scan 1 1 a2.ply --pose 8 --shift 10
scan 2 0 other.ply
hostile="<img src=x onerror=alert(1)>'\$(id).ply"
cp a2.ply "$hostile"
"$BUILD/headscan" --kind bust --seed 3 made-up:5 -o bust.ply
head -n 50 bust.ply >none.ply
awk 'BEGIN { for (i = 0; i < 3000; i++) print i % 60 / 300, int(i / 60) / 300, 5 }' >plane.xyz
"$ctl" --db faces.db init >/dev/null
"$ctl" --db faces.db enroll alice a.ply >/dev/null
created=$("$ctl" --db faces.db subject show alice --json | jq -r '.templates[0].created | .[:19] | sub("T"; " ")')

expect 0 "one person" "$ctl" --db faces.db explain alice "$hostile" --page match.html
expect 1 "two people" "$ctl" --db faces.db explain alice other.ply --page differ.html
expect 0 "two files" "$lab" explain a.ply a2.ply
cp explanation/explain.html files.html
expect 0 "a scan" "$ctl" scan bust.ply --page scan.html
expect 1 "a scan without a face" "$ctl" scan plane.xyz --page plane.html
for page in match differ scan plane files; do
    is "$page: its owner's alone" "$(stat -c %a $page.html)" 600
    ok "$page: $(wc -c <$page.html) bytes, of at most 300 KB" test "$(wc -c <$page.html)" -le 307200
    ok "$page: no address in it" sh -c "! sed 's|http://www.w3.org/2000/svg||' $page.html | grep -q 'https*://'"
done
cp match.html before.html
expect 65 "a second time" "$ctl" --db faces.db explain alice other.ply --page match.html
has err 'match.html: the file exists: use --force'
ok "it is as it was" cmp -s match.html before.html
expect 1 "with --force" "$ctl" --db faces.db explain alice other.ply --page before.html --force
ok "is another" sh -c "! cmp -s match.html before.html"
expect 65 "over the scan itself" "$ctl" scan bust.ply --page bust.ply --force
expect 65 "over the database" "$ctl" --db faces.db explain alice a2.ply --page faces.db --force
expect 64 "one page of two scans" "$ctl" scan a.ply a2.ply --page two.html
expect 1 "of what is no scan" "$ctl" scan none.ply --page none.html
ok "there is none" [ ! -e none.html ]
sed 's/stage.show(nodes, two,/stage.show(nodes, !two,/' match.html >changed.html
ok "one is changed" sh -c "! cmp -s match.html changed.html"

browser_tests 60 "$OLDPWD/tests/box/page.py" "file://$T" "$T" - "$created" "$hostile"
finish
