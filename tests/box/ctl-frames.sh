#!/bin/sh
# Goal: surfacectl takes several files as the frames of one capture session: one template, one probe;
# what is left out is told, and another person's frame refuses all.
. tests/box/lib.sh
in_folder

for k in 0 1 2 3 4 5; do
    scan 1 $k a$k.ply --pose 5 --noise 0.8
done
scan 2 0 b0.ply --noise 0.8
echo 'no scan' >none.ply
"$ctl" --db "$DB" init >init.out
DB=$T/faces.db
list() { said '[.frames[] | if .used then "used" else .reason.code end] | join(" ")'; }
stored() { sql 'SELECT count(*) FROM templates'; }

ctl_exits 0 enroll alice a0.ply none.ply a1.ply a2.ply
is "a session" "$(list) $(said '.templates | length') $(stored)" 'used malformed used used 1 1'
is "of the base" "$(said '.templates[0].file | test("^a[012].ply$")')" true
ok "what is left out is told" grep -q '^surfacectl: left out: none.ply: ' ctl.err
ctl_exits 0 enroll alice a0.ply none.ply a1.ply a2.ply
is "again" "$(said '.templates[0].new') $(stored)" 'false 1'
ctl_exits 65 enroll bob a0.ply b0.ply a1.ply
is "two people" "$(list)" 'used several_people used'
ok "it says whose" grep -q 'b0.ply shows another person than a[01].ply' ctl.err
ctl_exits 65 enroll alice b0.ply
ctl_exits 65 enroll bob none.ply none.ply
is "nothing was stored" "$(stored)" 1
ctl_exits 0 verify alice a3.ply a4.ply none.ply
is "a probe" "$(said .decision) $(list)" 'match used used malformed'
mkdir frames
cp a3.ply a4.ply a5.ply frames
ctl_exits 0 verify alice frames
is "a folder" "$(said .decision) $(list)" 'match used used used'
ctl_exits 65 verify alice a3.ply b0.ply
ok "two people" grep -q 'shows another person than' ctl.err
ctl_exits 1 verify alice b0.ply
is "one file" "$(said '.frames')" null
expect 0 "as text" "$ctl" --db "$DB" verify alice a3.ply a4.ply
has out '^decision     match$'
has out '^a[34].ply  has 9[0-9] % of the face, noise 0\.[0-9]* mm$'
has out '^a[34].ply  adds [0-9none% ]* of the face; noise 0\.[0-9]* mm -> 0\.[0-9]* mm$'
ctl_exits 0 check-database
finish
