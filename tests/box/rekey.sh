#!/bin/sh
# Goal: rekey makes every secret anew in a copy that takes the database's place: nothing that was
# stolen before opens or forges anything, the old files are gone, and wherever it is killed, a key
# that is there opens the database, with all that is in it.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

for n in 1 2 3; do
    scan "$n" 0 "$T/s$n.ply" --points 1000
    scan "$n" 1 "$T/p$n.ply" --points 1000
done
ctl init
ctl enroll s1 "$T/s1.ply"
id=$(said '.templates[0].template_id')
ctl enroll s2 "$T/s2.ply"
ctl subject set s2 --consent C
ctl subject set s4 --consent D
ctl subject erase s4 --yes
cp "$T/ctl" "$T/receipt"
AUTH=$(new_token door)

# ---- not while another process has it open, and not unasked
start_daemon
ctl rekey --yes
is "not while the daemon runs" "$CODE" 75
ok "it says what to do" grep -q 'stop surfaced first' "$T/ctl.err"
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "the daemon goes on" "$STATUS $(get .decision)" "200 match"
stop_daemon
sum=$(sha256sum <"$DB")
ctl rekey
is "the old key is not lost unasked" "$CODE" 64
ok "it is said what it would cost" grep -q 'older backups' "$T/ctl.err"
is "nothing changed" "$(sha256sum <"$DB")" "$sum"

# ---- every secret anew
ctl audit verify
public=$(said .public_key)
cp "$DB" "$T/stolen.db"
cp "$DB.key" "$T/stolen.key"
secrets() {
    sqlite3 "$DB" "SELECT hex(key), hex(lookup), hex(about), hex(mac) FROM subjects UNION ALL
        SELECT hex(used), hex(about), hex(mac), hex(substr(face, 1, 40)) FROM templates
        JOIN faces USING (template_key)" | tr '|' '\n'
}
secrets >"$T/before"
ctl rekey --yes
is "rekey" "$CODE $(said '.kind, .key' | tr '\n' ' ')" "0 file $DB.key "
secrets >"$T/after"
is "nothing is encrypted, found or authenticated as it was" \
    "$(sort "$T/before" "$T/after" | uniq -d | wc -l)" 0
is "the key is its owner's" "$(stat -c %a "$DB.key")" 600
is "nothing is left beside it" "$(files "$T" | tr ' ' '\n' | grep '^faces' | paste -sd ' ')" \
    "faces.db faces.db.key"
ctl subject list --key "$T/stolen.key"
is "the old key opens nothing" "$CODE" 77
is "an entry says so" "$(sqlite3 "$DB" "SELECT outcome FROM change_log WHERE kind = 'rekey'")" file
ctl audit verify
is "the log is whole" "$CODE $(said .ok)" "0 true"
ok "another key signs it" [ "$(said .public_key)" != "$public" ]
new=$(said .public_key)
ctl audit show --subject s2
ok "who did what before is found" jq_true '[.entries[].kind] | index("set_subject")' "$T/ctl"
ctl audit export --out "$T/log.jsonl"
"$BUILD/surfacectl" audit verify "$T/log.jsonl" --public-key "$new" >"$T/text"
is "an export is verified by the new key" $? 0
"$BUILD/surfacectl" audit verify "$T/log.jsonl" --public-key "$public" >"$T/text"
is "and not by the old one" $? 1
ctl audit receipt "$T/receipt" --public-key "$public"
is "a receipt of before is true by the old key" "$CODE $(said .ok)" "0 true"
ctl check-database
is "every template is there" "$CODE $(said .templates)" "0 2"
ctl subject show s1
is "the same template" "$(said '.templates[0].template_id')" "$id"
start_daemon
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "the daemon serves it, and knows the token" "$STATUS $(get .decision)" "200 match"
stop_daemon

# ---- what the thief writes with the old key, put into the database
cp "$T/stolen.db" "$T/evil.db" && cp "$T/stolen.key" "$T/evil.db.key"
"$BUILD/surfacectl" --db "$T/evil.db" token create evil --scope "$ALL" >"$T/evil.token" 2>"$T/out"
"$BUILD/surfacectl" --db "$T/evil.db" enroll s1 "$T/s3.ply" --force >"$T/out"
cp "$DB" "$T/whole.db"
all=$(sqlite3 "$DB" "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%'
    AND name != 'root'")
for what in tokens 'templates faces' 'templates faces subjects' root "$all"; do
    # shellcheck disable=SC2086 # a list
    { echo "PRAGMA foreign_keys = OFF; ATTACH '$T/evil.db' AS evil; BEGIN;"
        printf 'DELETE FROM main.%s;\n' $what
        printf '%s\n' $what | sed 's/.*/INSERT INTO main.& SELECT * FROM evil.&;/'
        echo "COMMIT;"; } | sqlite3 "$DB" || ok "$what: it can be written" false
    start_fails "$what" 1 'surfaced: ' --db "$DB" --listen 127.0.0.1:0
    ctl verify s1 "$T/p3.ply"
    ok "$what: the thief's face: $CODE" [ "$CODE" -gt 1 ]
    ctl rekey --yes
    ok "$what: rekey does not cover it up: $CODE" [ "$CODE" != 0 ]
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/whole.db" "$DB"
done

# ---- the old ones kept, where that is asked for
cp "$DB.key" "$T/second"
ctl rekey --keep-old
is "kept" "$CODE" 0
ok "the key" cmp -s "$DB.key.old" "$T/second"
"$BUILD/surfacectl" --db "$DB.before-rekey" --key "$DB.key.old" check-database >"$T/out"
is "and the database" $? 0
ctl rekey --keep-old
is "no kept file is overwritten" "$CODE" 65
rm "$DB.key.old" "$DB.before-rekey"

# ---- other kinds: a key of one's own, a passphrase, none, and a first one
printf 'open sesame, open wide\n' >"$T/phrase"
printf 'tĥis ĥas 11\n' >"$T/short"
printf '%064d\n' 7 >"$T/own"
chmod 600 "$T/phrase" "$T/own" "$T/short"
ctl rekey --yes --new-key "$T/own"
is "a key of one's own" "$CODE" 0
ok "is in the key's place" cmp -s "$DB.key" "$T/own"
ctl rekey --yes --new-key "$T/phrase"
is "a passphrase is no key" "$CODE" 65
ok "nothing is left of that" test ! -e "$DB.key.new"
ctl rekey --yes --passphrase --new-key "$T/short"
is "a short passphrase" "$CODE" 65
ok "it says what to do" matches "$(said .error.detail)" '11 characters, fewer than 12.*--short-pass'
ctl rekey --yes --passphrase --new-key "$T/short" --short-passphrase
is "unless that is wanted" "$CODE $(said .kind)" "0 passphrase"
"$BUILD/surfacectl" --db "$T/new" init --passphrase --key "$T/short" >"$T/ctl" 2>&1
is "nor for a new database" $? 65
ok "which is not there" test ! -e "$T/new"
ctl export --key "$DB.key" --all --archive-key "$T/short" -o "$T/archive"
is "nor for an archive" "$CODE" 65
ctl rekey --yes --key "$DB.key" --passphrase --new-key "$T/phrase"
is "a passphrase" "$CODE $(said .kind)" "0 passphrase"
ctl verify s2 "$T/p2.ply" --key "$T/phrase"
is "opens it" "$CODE" 0
ctl rekey --yes --key "$T/phrase" --plaintext
is "plaintext" "$CODE $(said .kind)" "0 plaintext"
ok "its file is gone" test ! -e "$T/phrase"
rm -f "$DB.key"
ctl verify s2 "$T/p2.ply" --plaintext-database
is "needs no key" "$CODE" 0
open=$(sqlite3 "$DB" 'SELECT hex(plaintext) FROM root')
ok "since it is in the file" holds "$open" "$DB"
ctl rekey --yes --plaintext-database
is "its first key" "$CODE $(said .kind)" "0 file"
if holds "$open" "$DB" "$DB-wal"; then found=yes; else found=no; fi
is "the plaintext key is gone" "$found" no
ctl check-database
is "all is well" "$CODE $(said .templates)" "0 2"

# ---- what a rekey that was killed has left
echo nonsense >"$DB.key.new"
ctl rekey --yes
is "a key that nothing needs is in the way of none" "$CODE" 0
cp "$DB.key" "$DB.key.new"
cp "$T/stolen.key" "$DB.key"
ctl verify s2 "$T/p2.ply"
is "one that the database has is found where it is" "$CODE" 0
ctl rekey --yes
is "and settled by the next" "$CODE" 0
ok "for good" test ! -e "$DB.key.new"
ctl rekey --yes --key "$T/nowhere"
is "no key, no change" "$CODE" 66

# ---- killed at any moment
seed=${SEED:-$(date +%s)}
lost=''
awk -v s="$seed" 'BEGIN { srand(s); for (i = 0; i < 40; i++) printf "%.4f\n", rand() * 0.09 }' >"$T/when"
while read -r when; do
    "$BUILD/surfacectl" --db "$DB" rekey --yes >"$T/out" 2>&1 &
    killed=$!
    sleep "$when"
    kill -9 "$killed" 2>/dev/null
    wait "$killed" 2>/dev/null
    ctl check-database
    [ "$CODE $(said .templates)" = "0 2" ] || lost="$lost $when"
    rm -f "$DB.before-rekey"
done <"$T/when"
is "killed 40 times (seed $seed), never locked out" "$lost" ""
ctl verify s1 "$T/p1.ply"
is "s1 is s1" "$CODE" 0
ctl rekey --yes
is "and once more undisturbed" "$CODE" 0
finish
