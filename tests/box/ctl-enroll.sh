#!/bin/sh
# Goal: surfacectl enrolls a folder or a table of scans on all cores: bad scans are reported with
# the reason and stops nothing else; done again, or after it was killed, it goes on where it
# was; the same on any number of threads.
. tests/box/lib.sh

counts() { said '[.scans, .enrolled, .present, .failed, .undone] | join(" ")'; }
subjects() {
    "$BUILD/surfacectl" --db "$1" template list --json |
        jq -c '[.templates[] | [.subject, .label, .digest]] | sort'
}

mkdir "$T/scans"
for n in 1 2 3 4; do
    scan "$n" 0 "$T/scans/s${n}_enroll.ply"
    scan "$n" 1 "$T/scans/s${n}_later.ply" --pose 5
done
cp "$T/scans/s2_enroll.ply" "$T/scans/s1_wrong.ply" # another's face
head -c 3000 "$T/scans/s3_enroll.ply" >"$T/scans/s3_cut.ply"
cp "$T/scans/s4_enroll.ply" "$T/scans/s4_zagain.ply"

"$BUILD/surfacectl" --db "$DB" init >"$T/text"
ctl_exits 65 enroll "$T/scans"
is "scans, enrolled, there, failed, undone" "$(counts)" '11 8 1 2 0'
is "which failed" "$(said '[.failures[] | .file + " " + .reason] | join(", ")')" \
    "s1_wrong.ply the sample does not fit the subject's others, s3_cut.ply malformed input"
ok "each is reported" test "$(grep -c 's1_wrong.ply\|s3_cut.ply' "$T/ctl.err")" -eq 2
ok "and how many" grep -q '2 of 11 scans were not enrolled' "$T/ctl.err"
ctl_exits 0 template list s3
is "the kind is the label" "$(said '[.templates[].label] | join(" ")')" 'enroll later'
ctl_exits 65 enroll "$T/scans"
is "again: nothing is enrolled" "$(counts)" '11 0 9 2 0'
is "nor an event" "$(sql "SELECT count(*) FROM $ENTRIES WHERE kind = 'enroll'")" 8
"$BUILD/surfacectl" --db "$DB" enroll "$T/scans" >"$T/text" 2>/dev/null
ok "as text" grep -q '^11 scans of .*: 0 enrolled, 9 already enrolled, 2 failed; ' "$T/text"
ok "no bar but on a terminal" test "$(tr -d '\n' <"$T/ctl.err" | grep -c '#')" -eq 0
ctl_exits 0 check-database

# ---- what is no scan, or is not named like one, stops nothing either
cp -r "$T/scans" "$T/strays"
mkdir "$T/strays/older"
cp "$T/scans/s1_enroll.ply" "$T/strays/carol.ply"
cp "$T/scans/s1_enroll.ply" "$T/strays/dave-2.ply"
cp "$T/scans/s1_enroll.ply" "$T/strays/a b_1.ply"
cp "$T/scans/s1_enroll.ply" "$T/strays/$(printf 'bad\377\033[1m_1.ply')"
cp "$T/scans/s1_enroll.ply" "$T/strays/older/s1_hidden.ply"
echo 'who is who' >"$T/strays/README.txt"
echo 'a,b' >"$T/strays/list.csv"
touch "$T/strays/x_1.off" "$T/strays/list.xls" "$T/strays/e_1.ply" "$T/strays/.s1_2.ply"
printf 'OFF\n3 1 0\n' >"$T/strays/f_1.ply"
printf 'solid face\nendsolid\n' >"$T/strays/g_1.stl"
head -c 64 "$T/scans/s1_enroll.ply" >"$T/strays/h_1.glb"
mkfifo "$T/strays/pipe_1.ply"
ctl_exits 65 enroll "$T/strays"
is "of the scans" "$(counts) $(said .left_out)" '16 0 9 7 0 9'
is "all are reported" "$(said '[.failures[].file] | join(", ")')" \
    'a b_1.ply, e_1.ply, f_1.ply, g_1.stl, h_1.glb, s1_wrong.ply, s3_cut.ply, README.txt, bad??[1m_1.ply, carol.ply, dave-2.ply, list.csv, list.xls, older, pipe_1.ply, x_1.off'
ok "each of it, why" jq_true '.failures | all(.reason | length > 0)' "$T/ctl"
is "a name" "$(said '.failures[] | select(.file == "carol.ply").reason')" \
    'not named SUBJECT_KIND.ply (or list it in index.csv)'
is "a folder" "$(said '.failures[] | select(.file == "older").reason')" \
    'a folder, not a file: subfolders are not read'
ok "a format that is not read" jq_true '.failures[] | select(.file == "f_1.ply").detail |
    test("OFF file, which is not read")' "$T/ctl"
is "each in one line" "$(grep -c '^surfacectl: ' "$T/ctl.err")" 17
ok "how many" grep -q '13 of 22 scans were not enrolled' "$T/ctl.err"
"$BUILD/surfacectl" --db "$DB" enroll "$T/strays" >"$T/text" 2>/dev/null
contains "as text" "$T/text" '^16 scans of .*: 0 enrolled, 9 already enrolled, 7 failed; 9 others ignored; '
for why in '4  not named SUBJECT_KIND' '1  a folder' '1  unsupported format' '2  its extension is not that' '1  not a file'; do
    contains "and by reason" "$T/text" "^ +$why"
done
rm "$T"/strays/*.off "$T"/strays/[ae-hp]*_1.* "$T"/strays/bad* "$T"/strays/*.txt "$T"/strays/*.csv \
    "$T"/strays/carol.ply "$T"/strays/dave-2.ply "$T"/strays/s1_wrong.ply "$T"/strays/s3_cut.ply
ctl_exits 0 enroll "$T/strays"
is "a file that is no scan by its name is reported, and is no failure" \
    "$(counts) $(said '[.failures[].file] | join(", ")')" '9 0 9 0 0 list.xls, older'

# ---- the same on one thread
"$BUILD/surfacectl" --db "$T/one.db" init >"$T/text"
"$BUILD/surfacectl" --db "$T/one.db" enroll "$T/scans" --threads 1 >"$T/text" 2>&1
is "on one thread" "$(subjects "$T/one.db")" "$(subjects "$DB")"

# ---- some of them, by a table, with a label
printf 'subject,file,kind\n' >"$T/table.csv"
for n in 1 2 3; do
    printf 't%s,scans/s%s_enroll.ply,front\nt%s,scans/s%s_later.ply,side\n' $n $n $n $n
done >>"$T/table.csv"
ctl_exits 0 enroll "$T/table.csv" --kind front --label 'the door'
is "one kind" "$(counts)" '3 3 0 0 0'
ctl_exits 0 template list t2
is "a label" "$(said '[.templates[].label] | join(" ")')" 'the door'
ctl_exits 0 enroll "$T/table.csv"
is "the others" "$(counts)" '6 3 3 0 0'
ctl_exits 66 enroll "$T/table.csv" --kind back
ctl_exits 64 enroll "$T/none"
ctl_exits 64 enroll alice "$T/scans/s1_enroll.ply" --kind front
ctl_exits 64 enroll "$T/scans/s1_enroll.ply"
printf 'subject,file\na b,scans/s1_enroll.ply\n' >"$T/bad.csv"
ctl_exits 65 enroll "$T/bad.csv"
ok "an id that cannot be" grep -q 'a subject id is 1 to' "$T/ctl.err"
printf 'subject,file\nx,scans/s1_enroll.ply\nx,scans/none.ply\n' >"$T/bad.csv"
ctl_exits 66 enroll "$T/bad.csv"
ok "a file that is not there" grep -q 'bad.csv, line 3, column file: No such' "$T/ctl.err"
ctl_exits 66 subject show x

# ---- killed, it goes on
mkdir "$T/many"
for n in $(seq 20 49); do
    scan "$n" 0 "$T/many/m${n}_a.ply"
done
"$BUILD/surfacectl" --db "$T/killed.db" init >"$T/text"
"$BUILD/surfacectl" --db "$T/killed.db" enroll "$T/many" >"$T/text" 2>&1 &
killed=$!
# shellcheck disable=SC2317 # run by soon
some() { test "$(sqlite3 "$T/killed.db" 'SELECT count(*) FROM templates')" -gt 3; }
soon some
kill -9 "$killed" 2>/dev/null
wait "$killed" 2>/dev/null
DB=$T/killed.db
ctl_exits 0 check-database
before=$(said .templates)
ctl_exits 0 enroll "$T/many"
is "it went on" "$(counts)" "30 $((30 - before)) $before 0 0"
ctl_exits 0 check-database
is "all are there" "$(said .templates)" 30

# ---- a fault of the machine ends it, and is reported
"$BUILD/surfacectl" --db "$T/ro.db" init >"$T/text"
DB=$T/ro.db
trap '' XFSZ
ulimit -f 2000 # blocks of 512 bytes: a full disk, to the command
ctl_exits 74 enroll "$T/many"
ok "the scans not tried are counted" test "$(said .undone)" -gt 20
finish
