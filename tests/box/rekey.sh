#!/bin/sh
# Goal: `surfacectl rekey`: not beside a daemon and not unasked; afterwards the old key opens nothing
# and another key signs, while receipts of before stay true and the daemon serves the same subjects;
# from each kind of key to each.  What changes in the rows is in test_rekey.c, what a kill leaves in
# crash.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

scan 1 0 "$T/s1.ply" --points 1000
scan 1 1 "$T/p1.ply" --points 1000
ctl_exits 0 init
ctl_exits 0 enroll s1 "$T/s1.ply"
ctl_exits 0 subject set s4 --consent D
ctl_exits 0 subject erase s4 --yes
cp "$T/ctl" "$T/receipt"
AUTH=$(new_token door)

# ---- not while another process has it open, and not unasked
start_daemon
ctl_exits 75 rekey --yes
contains "it says what to do" "$T/ctl.err" 'stop surfaced first'
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "the daemon goes on" "$STATUS $(get .decision)" "200 match"
stop_daemon
sum=$(sha256sum <"$DB")
ctl_exits 64 rekey
contains "it is said what it would cost" "$T/ctl.err" 'older backups'
is "nothing changed" "$(sha256sum <"$DB")" "$sum"

# ---- every secret anew
ctl_exits 0 audit verify
public=$(said .public_key)
cp "$DB.key" "$T/stolen.key"
ctl_exits 0 rekey --yes
is "rekey" "$(said '.kind, .key' | tr '\n' ' ')" "file $DB.key "
is "the key is its owner's" "$(stat -c %a "$DB.key")" 600
is "nothing is left beside it" "$(files "$T" | tr ' ' '\n' | grep '^faces' | paste -sd ' ')" \
    "faces.db faces.db.key"
ctl_exits 77 subject list --key "$T/stolen.key"
ctl_exits 0 audit verify
new=$(said .public_key)
ok "another key signs the log" [ "$new" != "$public" ]
ctl_exits 0 audit export --out "$T/log.jsonl"
"$BUILD/surfacectl" audit verify "$T/log.jsonl" --public-key "$new" >"$T/text"
is "an export is verified by the new key" $? 0
"$BUILD/surfacectl" audit verify "$T/log.jsonl" --public-key "$public" >"$T/text"
is "and not by the old one" $? 1
ctl_exits 0 audit receipt "$T/receipt" --public-key "$public" # true by the old key
start_daemon
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "the daemon serves it, and knows the token" "$STATUS $(get .decision)" "200 match"
stop_daemon

# ---- other kinds: a key of one's own, a passphrase, none, and a first one
printf 'open sesame, open wide\n' >"$T/phrase"
printf 'tĥis ĥas 11\n' >"$T/short"
printf '%064d\n' 7 >"$T/own"
chmod 600 "$T/phrase" "$T/own" "$T/short"
ctl_exits 0 rekey --yes --new-key "$T/own"
ok "a key of one's own is in the key's place" cmp -s "$DB.key" "$T/own"
ctl_exits 65 rekey --yes --new-key "$T/phrase" # no key
ok "nothing is left of that" test ! -e "$DB.key.new"
ctl rekey --yes --passphrase --new-key "$T/short"
ctl_failed "a short passphrase" 65 '11 characters, fewer than 12.*--short-pass'
ctl_exits 65 export --all --archive-key "$T/short" -o "$T/archive"
"$BUILD/surfacectl" --db "$T/new" init --passphrase --key "$T/short" >"$T/ctl" 2>&1
is "nor for a new database" $? 65
ok "which is not there" test ! -e "$T/new"
ctl_exits 0 rekey --yes --passphrase --new-key "$T/short" --short-passphrase
is "unless that is wanted" "$(said .kind)" passphrase
ctl_exits 0 rekey --yes --key "$DB.key" --passphrase --new-key "$T/phrase"
ctl_exits 0 verify s1 "$T/p1.ply" --key "$T/phrase"
ctl_exits 0 rekey --yes --key "$T/phrase" --plaintext
is "plaintext" "$(said .kind)" plaintext
ok "its file is gone" test ! -e "$T/phrase"
rm -f "$DB.key"
ctl_exits 0 verify s1 "$T/p1.ply" --plaintext-database
open=$(sql 'SELECT hex(plaintext) FROM root')
ok "the key is in the file" holds "$open" "$DB"
ctl_exits 0 rekey --yes --plaintext-database
is "its first key" "$(said .kind)" file
if holds "$open" "$DB" "$DB-wal"; then found=yes; else found=no; fi
is "the plaintext key is gone" "$found" no
ctl_exits 66 rekey --yes --key "$T/nowhere"
ctl_exits 0 check-database
is "all is well" "$(said .templates)" 1
finish
