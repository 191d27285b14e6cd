#!/bin/sh
# Goal: the master key is changed in one transaction: a running daemon goes on, the old
# key opens nothing any more, and wherever rekey is killed, a key file that is there opens
# the database.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# held FILE: how often the bytes of its line, in hexadecimal, are in the database or its
# WAL.
held() {
    cat "$DB" "$DB-wal" 2>/dev/null | od -An -v -tx1 | tr -d ' \n' | grep -oi "$(cat "$1")" | wc -l
}

for n in 1 2 3; do
    scan "$n" 0 "$T/s$n.ply" --points 1000
    scan "$n" 1 "$T/p$n.ply" --points 1000
done
ctl init
ctl enroll s1 "$T/s1.ply"
ctl enroll s2 "$T/s2.ply"
cp "$DB.key" "$T/first"

# ---- beside a daemon, which notices by itself
start_daemon --no-auth
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "before" "$STATUS $(get .decision)" "200 match"
before=$(sha256sum <"$DB.key")
ctl rekey
is "the old key is not lost unasked" "$CODE" 64
ok "it is said what it would cost" grep -q 'older backups' "$T/ctl.err"
is "nothing changed" "$(sha256sum <"$DB.key")" "$before"
ctl rekey --yes
is "rekey" "$CODE $(said '.kind, .key' | tr '\n' ' ')" "0 file $DB.key "
ok "it is another key" sh -c "! cmp -s '$DB.key' '$T/first'"
is "its owner's" "$(stat -c %a "$DB.key")" 600
ok "nothing is left beside it" test ! -e "$DB.key.new" -a ! -e "$DB.key.old"
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "the daemon goes on" "$STATUS $(get .decision)" "200 match"
send POST /v1/subjects/s3/templates "$PLY" "$T/s3.ply"
is "and enrolls" "$STATUS" 201
req GET /readyz
is "and is ready" "$STATUS" 200
ctl check
is "all is well" "$CODE $(said .templates)" "0 3"
ctl subject list --key "$T/first"
is "the old key opens nothing" $CODE 77
is "an event tells" "$(sqlite3 "$DB" "SELECT actor, outcome FROM events WHERE kind = 'rekey'")" \
    "surfacectl:$(id -un)|file"
stop_daemon

# ---- a daemon that has the key as a credential, which stays what it was
cp "$DB.key" "$T/credential"
start_daemon --no-auth --key "$T/credential"
cp "$DB.key" "$T/second"
ctl rekey --keep-old
is "the old one is kept where that is asked for" "$CODE" 0
ok "as it was" cmp -s "$DB.key.old" "$T/second"
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
problem "the daemon cannot go on" 503 database_refused
req GET /readyz
problem "and says why" 503 not_ready 'key was changed'
ok "the log too" grep -q "key was changed" "$LOG"
cp "$DB.key" "$T/credential"
# shellcheck disable=SC2317 # soon calls it
matches_again() {
    send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
    [ "$STATUS $(get .decision)" = "200 match" ]
}
ok "until it gets the new one, which its old key has authenticated" soon matches_again
stop_daemon
ctl rekey --keep-old
is "no kept key is overwritten" "$CODE" 65
rm "$DB.key.old"

# ---- after a theft: every secret anew, beside a daemon
id=$(ctl subject show s1; said '.templates[0].template_id')
ctl token create door --scope "$ALL"
AUTH=$(said .token)
ctl subject set s2 --consent C
ctl subject set s4 --consent D
ctl subject erase s4 --yes
cp "$T/ctl" "$T/receipt"
ctl audit verify
public=$(said .public_key)
cp "$DB" "$T/stolen.db"
cp "$DB.key" "$T/stolen.key"
secrets() {
    sqlite3 "$DB" "SELECT hex(key), hex(lookup), hex(about) FROM subjects UNION ALL
        SELECT hex(same), hex(about), hex(substr(model, 1, 40)) FROM templates" | tr '|' '\n'
}
secrets >"$T/before"
start_daemon
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "before the theft is answered" "$STATUS $(get .decision)" "200 match"
ctl rekey --yes --compromised
is "every secret anew" "$CODE" 0
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "the daemon goes on with it" "$STATUS $(get .decision)" "200 match"
secrets >"$T/after"
is "nothing is encrypted or found as it was" "$(sort "$T/before" "$T/after" | uniq -d | wc -l)" 0
ctl audit verify
is "the log is whole" "$CODE $(said .ok)" "0 true"
ok "another key signs it" [ "$(said .public_key)" != "$public" ]
new=$(said .public_key)
ctl audit show --subject s2
ok "who was called so before is found" jq_true '[.entries[].kind] | index("set_subject")' "$T/ctl"
ctl audit export --out "$T/log.jsonl"
"$BUILD/surfacectl" audit verify "$T/log.jsonl" --public-key "$new" >"$T/text"
is "an export is verified by the new key" $? 0
"$BUILD/surfacectl" audit verify "$T/log.jsonl" --public-key "$public" >"$T/text"
is "and by the old one not" $? 1
sed '/"kind":"renew_key"/s/"row":"....../"row":"000000/' "$T/log.jsonl" >"$T/forged.jsonl"
"$BUILD/surfacectl" audit verify "$T/forged.jsonl" --public-key "$new" >"$T/text"
is "which the old one has signed" $? 1
ctl audit receipt "$T/receipt"
is "a receipt of before is true" "$CODE $(said .ok)" "0 true"
ctl check
is "every template is there" "$CODE $(said .templates)" "0 3"
stop_daemon
ctl subject show s1
is "the same template" "$(said '.templates[0].template_id')" "$id"

# ---- what the thief writes with the old key, in a copy, and puts into the database: alone, with the
# entries that tell of it, after those that are there or instead of them, and all but the root.
cp "$T/stolen.db" "$T/evil.db" && cp "$T/stolen.key" "$T/evil.db.key"
evil() {
    "$BUILD/surfacectl" --db "$T/evil.db" "$@" 2>"$T/out"
}
evil accept-rollback --yes >"$T/text"
ok "it can: a token" evil token create evil --scope "$ALL" >"$T/evil.token"
ok "and a face" evil enroll s1 "$T/s3.ply" --force >"$T/text"
evil check >"$T/text"
is "they are what the old key writes" $? 0
tables=$(sqlite3 "$DB" "SELECT name FROM sqlite_schema WHERE type = 'table'
    AND name NOT LIKE 'sqlite_%' AND name != 'root'")
cp "$DB" "$T/renewed.db"
cp "$DB.key.anchor" "$T/renewed.anchor"
door=$AUTH
for what in tokens templates 'tokens templates subjects' 'tokens events events_end checkpoints' \
    "$tables" appended; do
    start_daemon
    if [ "$what" = appended ]; then
        cat <<'END'
INSERT INTO main.events SELECT event_key + 1000, chain,
    (SELECT max(seq) FROM main.events WHERE chain = 0) + row_number() OVER (ORDER BY seq), at, kind,
    actor, subject, template_id, outcome, object, row_mac, uses, uses_hash, hash FROM evil.events
    WHERE chain = 0 AND seq > (SELECT seq FROM evil.events WHERE kind = 'accept_rollback');
INSERT INTO main.tokens SELECT * FROM evil.tokens WHERE name = 'evil';
END
    else
        # shellcheck disable=SC2086 # a list
        printf 'DELETE FROM main.%s;\n' $what
        # shellcheck disable=SC2086 # a list
        printf '%s\n' $what | sed 's/.*/INSERT INTO main.& SELECT * FROM evil.&;/'
    fi >"$T/sql"
    { echo "PRAGMA foreign_keys = OFF; ATTACH '$T/evil.db' AS evil; BEGIN;"
        cat "$T/sql"
        echo "COMMIT;"; } | sqlite3 "$DB" || ok "$what: it can be written" false
    AUTH=$(cat "$T/evil.token")
    req GET /v1/subjects
    ok "$what: the thief's token: $STATUS" matches "$STATUS" '^(401|500|503)$'
    AUTH=$door
    send POST /v1/subjects/s1/verify "$PLY" "$T/p3.ply"
    ok "$what: the thief's face: $STATUS $(get .decision)" [ "$STATUS $(get .decision)" != "200 match" ]
    kill -9 "$PID"
    wait "$PID" 2>"$T/out"
    PID=
    ctl audit verify --anchor none # which would find the most of it alone
    ok "$what: at rest: $CODE" [ "$CODE" != 0 ]
    ctl verify s1 "$T/p3.ply"
    ok "$what: the thief's face, by the command: $CODE" [ "$CODE" != 0 ]
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/renewed.db" "$DB"
    cp "$T/renewed.anchor" "$DB.key.anchor"
done
AUTH=

# ---- what was stolen opens nothing and forges nothing: rows as they were are not what was written.
ctl subject list --key "$T/stolen.key"
is "the stolen key opens nothing" "$CODE" 77
sqlite3 "$DB" "ATTACH '$T/stolen.db' AS old; UPDATE main.subjects SET key =
    (SELECT key FROM old.subjects o WHERE o.uid = main.subjects.uid)"
ctl subject show s1
is "nor do its subjects' keys" "$CODE" 65
sqlite3 "$DB" "ATTACH '$T/stolen.db' AS old; DELETE FROM main.root; INSERT INTO main.root
    SELECT * FROM old.root"
ctl subject list --key "$T/stolen.key"
ok "nor the record with it" [ "$CODE" != 0 ]
rm -f "$DB"* && cp "$T/stolen.db" "$DB" && cp "$T/stolen.key" "$DB.key"
ctl accept-rollback --yes
ctl audit verify
is "as it was" "$CODE" 0

# ---- many subjects: it goes on where it ended, but not the next day
one=$DB
DB=$T/many.db
mkdir "$T/many"
"$BUILD/facegen" --subject 1 --count 130 --points 1000 -o "$T/many/p%_e.ply"
ctl init
ctl enroll "$T/many"
is "130 people" "$CODE" 0
renewed() { # how often it was begun, and how many subjects have a new key since
    sqlite3 "$DB" "SELECT (SELECT count(*) FROM events WHERE kind = 'renew_subjects') || ' ' ||
        count(*) FROM events WHERE kind = 'renew_subject' AND template_id = '' AND seq >
        (SELECT max(seq) FROM events WHERE kind = 'renew_subjects')"
}
late='template_key = (SELECT max(template_key) - 1 FROM templates)'
sqlite3 "$DB" "ATTACH '$T/kept.db' AS kept; CREATE TABLE kept.models AS
    SELECT template_key, model FROM templates WHERE $late"
mend() {
    sqlite3 "$DB" "ATTACH '$T/kept.db' AS kept; UPDATE main.templates SET model =
        (SELECT model FROM kept.models) WHERE $late"
}
start_daemon --no-auth
damage_models "$late"
public=$(sqlite3 "$DB" 'SELECT hex(public) FROM root')
ctl rekey --yes --compromised
is "a model is damaged" "$CODE" 65
ok "it says which" matches "$(said .error.detail)" 'template [0-9a-f]{32}: its model is damaged'
is "two batches are done" "$(renewed)" "1 128"
is "the key is the same" "$(sqlite3 "$DB" 'SELECT hex(public) FROM root')" "$public"
send POST /v1/subjects/p5/verify "$PLY" "$T/many/p6_e.ply"
is "a daemon goes on with both" "$STATUS" 200
ctl rekey --yes --compromised
is "again" "$CODE $(renewed)" "65 1 128"
mend
if command -v faketime >/dev/null && ! grep -q __asan_init "$BUILD/surfacectl"; then
    damage_models "$late"
    faketime -f +61m "$BUILD/surfacectl" --db "$DB" rekey --yes --compromised >"$T/ctl" 2>&1
    is "an hour later it is begun anew" "$(renewed)" "2 128"
    mend
    ctl rekey --yes --compromised
    is "so is one of the future" "$CODE $(renewed)" "0 3 130"
else
    ctl rekey --yes --compromised
    is "mended, the rest follows" "$CODE $(renewed)" "0 1 130"
fi
send POST /v1/subjects/p5/verify "$PLY" "$T/many/p6_e.ply"
is "a daemon goes on" "$STATUS" 200
ctl check
is "all are there" "$CODE $(said .templates)" "0 130"
ctl rekey --yes --compromised
ok "the next one is another" matches "$(renewed)" ' 130$'
stop_daemon
DB=$one

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
rm "$DB.key"
ctl verify s2 "$T/p2.ply" --plaintext-database
is "needs no key" "$CODE" 0
sqlite3 "$DB" 'SELECT hex(plaintext) FROM root' >"$T/open"
is "since it is in the file" "$(held "$T/open")" 1
ctl rekey --yes --plaintext-database
is "its first key" "$CODE $(said .kind)" "0 file"
is "the plaintext key is gone" "$(held "$T/open")" 0
ctl check
is "all is well" "$CODE $(said .templates)" "0 3"

# ---- in the way: nothing is changed
cp "$DB.key" "$T/kept"
echo nonsense >"$DB.key.new"
ctl rekey --yes
is "a change that was not made" "$CODE" 65
ok "it says what to do" matches "$(said .error.detail)" 'key.new.*remove it'
ok "and leaves all as it was" cmp -s "$DB.key" "$T/kept"
rm "$DB.key.new"
ctl rekey --yes --key "$T/nowhere/key"
is "no key, no change" "$CODE" 66

# ---- between the commit and the new key's place
mv "$DB.key" "$DB.key.new"
cp "$T/first" "$DB.key"
chmod 600 "$DB.key"
ctl verify s2 "$T/p2.ply"
is "it is found where it is" "$CODE" 0
ctl rekey --yes
is "and settled by the next change" "$CODE" 0
ok "for good" test ! -e "$DB.key.new"
ctl verify s2 "$T/p2.ply"
is "with all that is in it" "$CODE" 0

# ---- killed at any moment
seed=${SEED:-$(date +%s)}
echo "seed $seed"
lost=''
awk -v s="$seed" 'BEGIN { srand(s); for (i = 0; i < 60; i++) printf "%.4f\n", rand() * 0.06 }' \
    >"$T/when"
while read -r when; do
    "$BUILD/surfacectl" --db "$DB" rekey --yes >/dev/null 2>&1 &
    killed=$!
    sleep "$when"
    kill -9 "$killed" 2>/dev/null
    wait "$killed" 2>/dev/null
    ctl check
    [ "$CODE $(said .templates)" = "0 3" ] || lost="$lost $when"
    # What was not committed is not the key; what was is in use until the next change.
    "$BUILD/surfacectl" --db "$DB" --key "$DB.key.new" subject list >/dev/null 2>&1 ||
        rm -f "$DB.key.new"
done <"$T/when"
is "killed 60 times (seed $seed), never locked out" "$lost" ""
ctl verify s1 "$T/p1.ply"
is "s1 is s1" "$CODE" 0
ctl rekey --yes
is "and once more undisturbed" "$CODE" 0
finish
