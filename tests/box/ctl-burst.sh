#!/bin/sh
# Goal: surfacectl enroll --each takes several scans of a subject at once, files and folders, by the rule of the
# daemon: each that matches the first accepted sample becomes a template, all together or none.
. tests/box/lib.sh
in_folder

for k in 0 1 2 3; do
    scan 1 $k a$k.ply --pose $((2 * k))
done
scan 2 0 b.ply
echo 'no scan' >none.ply
"$ctl" --db "$DB" init >init.out
DB=$T/faces.db
list() { said '[.templates[] | if .refusal then .refusal.code elif .new then "new" else "same" end] | join(" ")'; }
stored() { sql 'SELECT count(*) FROM templates'; }

# ---- files
ctl_exits 65 enroll alice --each a0.ply b.ply none.ply a1.ply a0.ply --label sitting
is "a burst" "$(list) $(said .failed)" 'new sample_mismatch malformed new same 2'
is "the names" "$(said '[.templates[].file] | join(" ")')" 'a0.ply b.ply none.ply a1.ply a0.ply'
is "how many" "$(said .error.detail)" '2 of 5 scans were not enrolled'
ok "each is reported" grep -q '^surfacectl: b.ply: the sample does not fit: it does not match the first' ctl.err
ok "each is reported" grep -q '^surfacectl: none.ply: this is no list of numbers' ctl.err
ctl_exits 0 subject show alice
is "they are there" "$(said '[.templates[].label] | join(" ")')" 'sitting sitting'
ctl_exits 0 enroll alice --each a0.ply a1.ply
is "again" "$(list) $(stored)" 'same same 2'
expect 65 "as text" "$ctl" --db "$DB" enroll alice --each b.ply a0.ply a2.ply
has out '^[0-9a-f]*  a0.ply  29[0-9]* points, quality 0.9[0-9] (already enrolled)$'
has out '^[0-9a-f]*  a2.ply  29[0-9]* points, quality 0.9[0-9]$'
has err '^surfacectl: b.ply: the sample does not fit: it matches neither the subject'
has err '^surfacectl: 1 of 3 scans were not enrolled'
ctl_exits 65 enroll alice --each b.ply none.ply
is "none of them" "$(list) $(stored)" 'sample_mismatch malformed 3'
ctl_exits 66 enroll alice --each none.ply missing.ply
is "none is a scan" "$(list) $(stored)" 'malformed malformed 3'
ctl_exits 0 enroll alice --each b.ply a3.ply --force
is "with force" "$(list)" 'new new'

# ---- a folder
mkdir frames frames/more empty
cp a2.ply frames/f1.ply
cp b.ply frames/f2.ply
gzip -c a0.ply >frames/f3.ply.gz
cp a1.ply frames/.hidden.ply
echo 'who is who' >frames/README.txt
mv frames/README.txt frames/README
ctl_exits 65 enroll bob --each frames a3.ply
is "a folder and a file" "$(list)" 'new sample_mismatch new new'
is "by name" "$(said '[.templates[].file] | join(" ")')" 'frames/f1.ply frames/f2.ply frames/f3.ply.gz a3.ply'
ctl_exits 66 enroll bob empty
is "an empty one" "$(said .error.detail)" 'empty: no file in the folder has the extension of a scan format'
cp a0.ply "frames/$(printf 'x\033[1m.ply')"
ctl_exits 65 enroll bob --each frames
is "an odd name" "$(said .error.detail)" \
    'frames: the name of scan 4 in the folder has a control character, or is not UTF-8'

# ---- how many
set --
for k in $(seq 21); do
    cp a0.ply "empty/$k.ply"
    set -- "$@" a0.ply
done
before=$(stored)
ctl_exits 64 enroll carol --each "$@"
is "21 files" "$(said .error.detail)" '21 scans: a capture session has at most 20'
ctl_exits 64 enroll carol --each empty a1.ply
is "22 in a folder and beside it" "$(said .error.detail)" '22 scans: a capture session has at most 20'
is "nothing was stored" "$(stored)" "$before"
rm empty/21.ply
ctl_exits 0 enroll carol --each empty
is "20" "$(list)" "new$(printf ' same%.0s' $(seq 19))"
ctl_exits 0 check-database

# ---- no room: none of them
(
    trap '' XFSZ
    ulimit -f 8
    ctl enroll dave --each a0.ply a1.ply a2.ply
    test "$CODE" -eq 74
)
is "no room" $? 0
ctl_exits 66 subject show dave
ctl_exits 0 check-database
finish
