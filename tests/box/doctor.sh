#!/bin/sh
# Goal: surfacectl doctor finds the problems around a database, says what to do, and
# changes nothing.
. tests/box/lib.sh

doctor() {
    "$BUILD/surfacectl" --db "$DB" --json doctor "$@" >"$T/ctl" 2>"$T/ctl.err"
    CODE=$?
}

# finds TITLE SEVERITY ABOUT PATTERN: there is such a finding, and an error ends with 1.
finds() {
    found=$(jq -r --arg l "$2" --arg a "$3" \
        '.findings[] | select(.severity == $l and .about == $a) | .what' "$T/ctl")
    ok "$1: '$found' like '$4'" matches "$found" "$4"
    [ "$2" != error ] || is "$1: exit" "$CODE" 1
    is "$1: each that is not fine says what to do" \
        "$(jq '[.findings[] | select(.severity != "ok" and (.do | length) == 0)] | length' \
            "$T/ctl")" 0
}

doctor
finds "no database" error database 'no file'
"$BUILD/surfacectl" --db "$DB" init >"$T/ctl"
scan 1 0 "$T/s1.ply" --points 1000
"$BUILD/surfacectl" --db "$DB" enroll s1 "$T/s1.ply" >"$T/ctl"
doctor
is "all is well" "$CODE $(jq -r .ok "$T/ctl")" "0 true"
finds "templates" ok templates '^1, made by'
"$BUILD/surfacectl" --db "$DB" doctor >"$T/text"
is "as text" "$?" 0
ok "a line each" grep -q '^ok  *key  *.*opens the database' "$T/text"

# ---- as root, of another user's database: never to take the files from the daemon
nobody="setpriv --reuid 65534 --regid 65534 --clear-groups"
if [ "$(id -u)" = 0 ] && $nobody "$BUILD/surfacectl" --version >"$T/text" 2>&1; then
    mkdir "$T/other"
    cp "$DB" "$DB.key" "$T/other"
    chown -R 65534:65534 "$T/other"
    own=$DB
    DB=$T/other/$(basename "$own")
    doctor
    finds "another user's" error key 'belongs to user 65534'
    is "what to do" "$(jq -r '.findings[] | select(.about == "key").do' "$T/ctl")" \
        "run this as its owner: runuser -u $(id -nu 65534) -- surfacectl ..."
    chmod 755 "$T"
    $nobody "$BUILD/surfacectl" --db "$DB" --json doctor >"$T/ctl" 2>"$T/ctl.err"
    CODE=$?
    is "then all is well" "$CODE $(jq -r .ok "$T/ctl")" "0 true"
    DB=$own
else
    echo "SKIP $0: another user's database needs root, and a build that others can run"
fi

# ---- guessing and lock-outs
sql "INSERT INTO attempts SELECT subject_key, 'thief', 4, 1000 * unixepoch(), 12 FROM subjects"
doctor
is "failures are no trouble" "$CODE" 0
finds "a lock-out" warning attempts '^1 times in the last day'
sql "DELETE FROM attempts; INSERT INTO attempts
    SELECT subject_key, 'thief ' || value, 4, 1000 * unixepoch(), 12 FROM subjects, generate_series(1, 1204) LIMIT 1204"
doctor
finds "large numbers, to be read" warning attempts '^1,204 times in the last day'
sql "DELETE FROM attempts"
i=0
while [ $i -lt 10 ]; do
    "$BUILD/surfacectl" --db "$DB" enroll "tried-$i" "$T/s1.ply" >"$T/text"
    i=$((i + 1))
done
sql "DELETE FROM attempts; INSERT INTO attempts
    SELECT subject_key, 'thief', 1, 1000 * unixepoch(), 3 FROM subjects LIMIT 9"
doctor
ok "9 subjects are not yet many" jq_true '[.findings[] | select(.about == "attempts")] == []' "$T/ctl"
sql "DELETE FROM attempts; INSERT INTO attempts
    SELECT subject_key, 'thief', 1, 1000 * unixepoch(), 3 FROM subjects LIMIT 10"
doctor
finds "one face on many" warning attempts 'token thief tried 10 subjects'
sql "DELETE FROM attempts"
i=0
while [ $i -lt 10 ]; do
    "$BUILD/surfacectl" --db "$DB" subject erase --yes "tried-$i" >"$T/text" 2>&1
    i=$((i + 1))
done
sum=$(cksum <"$DB")

# ---- what was left
: >"$DB.part"
"$BUILD/surfacectl" --db "$DB" backup "$DB.before-restore" >"$T/text"
doctor
is "that is no trouble" "$CODE" 0
finds "what was left" warning left 'faces.db.part was left by a restore'
finds "what a restore put aside" warning left 'from before a restore'
rm "$DB.part" "$DB.before-restore"

# ---- permissions
chmod 644 "$DB"
doctor
finds "others may read it" error database 'mode 644'
chmod 600 "$DB"
chmod 644 "$DB.key"
doctor
finds "others may read the key" error key 'mode 644.*chmod 600'
chmod 600 "$DB.key"
chmod 777 "$T"
doctor
finds "others may write the folder" error folder 'mode 777'
chmod 700 "$T"

# ---- keys
mv "$DB.key" "$T/aside"
doctor
finds "no key" error key 'No such file'
doctor --key "$T/aside"
is "elsewhere" "$CODE" 0
mv "$T/aside" "$DB.key.new"
doctor
finds "a change of the key that was interrupted" error key 'interrupted.*key.new'
mv "$DB.key.new" "$DB.key"
printf '%064d\n' 7 >"$DB.key.new"
chmod 600 "$DB.key.new"
doctor
is "one that nothing needs" "$CODE" 0
doctor --key "$DB.key.new"
finds "the wrong key" error key 'not the key'
rm "$DB.key.new"
is "nothing was changed by all that" "$(cksum <"$DB")" "$sum"

# ---- a daemon, and one that was killed
start_daemon --no-auth
doctor
is "beside a daemon" "$CODE" 0
finds "which it sees" ok 'in use' "process $PID"
send POST /v1/subjects/s2/templates "$PLY" "$T/s1.ply"
kill -9 "$PID"
wait "$PID" 2>/dev/null
PID=
doctor
is "a WAL that is left is no trouble" "$CODE" 0
finds "but reported" warning WAL 'was killed'

# ---- schema, engine, kinds of keys
sqlite3 "$DB" 'PRAGMA user_version = 99'
doctor
finds "a newer program's" error schema 'version 99'
sqlite3 "$DB" 'PRAGMA user_version = 1'
cp "$DB" "$T/kept"
echo nonsense >"$DB"
doctor
finds "no database at all" error schema 'not a database'
cp "$T/kept" "$DB"
"$BUILD/surfacectl" --db "$DB" rekey --yes --plaintext >"$T/text"
doctor
finds "plaintext, and not said so" error key 'plaintext'
export SURFACED_PLAINTEXT_DATABASE=1
doctor
finds "plaintext" warning key 'has no key'
sql "UPDATE templates SET points = points - 1"
doctor
finds "damaged" error state 'not as it was written'
finish
