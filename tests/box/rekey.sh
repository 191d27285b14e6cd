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
ctl_exits 0 audit verify "$T/receipt" --public-key "$public" # true by the old key
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

# ---- where the files are: links lead to them, and stay
L=$T/links
mkdir "$L" "$L/keys" "$L/data" "$L/anchors"
linked() { "$BUILD/surfacectl" --db "$L/db" --key "$L/key" --anchor "$L/anchor" "$@" >"$T/ctl" 2>"$T/ctl.err"; }
linked init
mv "$L/db" "$L/data/real"
mv "$L/key" "$L/keys/real"
mv "$L/anchor" "$L/anchors/real"
ln -s data/real "$L/db"
ln -s keys/real "$L/key"
ln -s anchors/real "$L/anchor"
linked enroll s1 "$T/s1.ply"
for way in --yes --keep-old; do
    linked rekey $way
    is "rekey $way through links" $? 0
    linked verify s1 "$T/p1.ply"
    is "and it opens" $? 0
done
is "the links are there" "$(readlink "$L/db") $(readlink "$L/key") $(readlink "$L/anchor")" "data/real keys/real anchors/real"
is "what is kept is beside the files" "$(files "$L/data") $(files "$L/keys")" "real real.before-rekey real real.old"

# ---- whose they are
mkfifo "$T/pipe"
cat "$DB.key" >"$T/pipe" &
ctl_exits 65 rekey --yes --key "$T/pipe"
contains "a pipe" "$T/ctl.err" 'is not a file, so another cannot be put in its place'
kill $! 2>/dev/null
if [ "$(id -u)" = 0 ]; then
    W=$T/owned
    mkdir "$W" "$W/d"
    chmod 711 "$T" "$W"
    chown 65534:65534 "$W/d"
    cp "$BUILD/surfacectl" "$W/"
    as() {
        # shellcheck disable=SC2086 # a command and its options
        setpriv --reuid "$1" --regid "$1" --clear-groups "$W/surfacectl" --db "$W/d/db" --anchor "$W/d/anchor" \
            $2 >"$T/ctl" 2>"$T/ctl.err"
    }
    as 65534 init
    chown 0:65534 "$W/d/db.key"
    chmod 640 "$W/d/db.key"
    as 65534 "rekey --yes"
    is "a key that cannot be overwritten" "$?" 77
    contains "it is said whose it is" "$T/ctl.err" 'belongs to user 0, and this user may not replace and overwrite it.*--keep-old'
    is "nothing was changed" "$(files "$W/d")" "anchor db db.key"
    as 0 "rekey --yes"
    is "root may" $? 0
    is "owners and groups stay" "$(stat -c %u:%g:%a "$W/d/db" "$W/d/db.key" "$W/d/anchor" | paste -sd ' ')" \
        "65534:65534:600 0:65534:640 65534:65534:600"
    as 65534 "rekey --keep-old"
    is "and with --keep-old its reader" $? 0
    as 65534 check-database
    is "it opens" $? 0
    rm "$W/d/db.before-rekey" "$W/d/db.key.old"
    for mode in 0300 0500; do # it cannot be flushed; nothing can be made in it
        chmod $mode "$W/d"
        as 65534 "rekey --keep-old"
        is "a folder of mode $mode" $? 77
    done
    chmod 0700 "$W/d"
    if unshare -m true 2>/dev/null; then # as a credential
        unshare -m sh -c "mkdir '$W/c' && mount -t tmpfs none '$W/c' && cp -p '$W/d/db.key' '$W/c/key' &&
            mount -o remount,ro '$W/c' && '$W/surfacectl' --db '$W/d/db' --anchor '$W/d/anchor' --key '$W/c/key' \
            rekey --yes" >"$T/ctl" 2>"$T/ctl.err"
        is "a credential" $? 77
        contains "it is said what to name" "$T/ctl.err" 'read-only file system.*name the file that it comes from'
    fi
    chmod 1777 "$W/d" # sticky, another's key
    chown 0:0 "$W/d"
    chown 0:65534 "$W/d/db.key"
    chmod 640 "$W/d/db.key"
    as 65534 "rekey --keep-old"
    is "a sticky folder" $? 77
    is "nothing was changed" "$(files "$W/d")" "anchor db db.key"
    as 65534 check-database
    is "it opens" $? 0
fi
ctl_exits 0 check-database
is "all is well" "$(said .templates)" 1
finish
