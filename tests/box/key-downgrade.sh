#!/bin/sh
# Goal: an attacker who can write the database file but has no key cannot replace the database:
# neither by a plaintext one nor by one with another key, neither before a program opens it nor
# while the daemon runs.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# denied TITLE DETAIL-PATTERN: the last command failed with 77 and this detail.
denied() {
    is "$1" "$CODE" 77
    ok "$1: '$(said .error.detail)' like '$2'" matches "$(said .error.detail)" "$2"
}

# replace WITH: replaces all rows of the database by those of WITH, in place.
replace() {
    sqlite3 "$1" "SELECT name FROM sqlite_schema WHERE type = 'table'
        AND name NOT LIKE 'sqlite_%'" | awk -v with="$1" '
        BEGIN { print "ATTACH \047" with "\047 AS mine; BEGIN;" }
        { print "DELETE FROM main." $1 "; INSERT INTO main." $1 " SELECT * FROM mine." $1 ";" }
        END { print "COMMIT;" }' | sqlite3 "$DB" || ok "the attacker can write" false
}

# no_start TITLE OPTION...: the daemon does not start with this database.
no_start() {
    n_title=$1
    shift
    start_fails "$n_title" 1 'plaintext, but .* restore a backup' --db "$DB" \
        --listen 127.0.0.1:0 --no-auth "$@"
}

scan 1 0 "$T/alice.ply" --points 1000
scan 2 0 "$T/mallory.ply" --points 1000
ctl init
ctl enroll alice "$T/alice.ply"
is "alice is enrolled" "$CODE" 0

# The attacker's databases, in which alice's template is of the attacker.  rekey changes the key
# record a second time, so that it has a version that the daemon has not read yet.
for kind in evil keyed; do
    plain=
    [ "$kind" = keyed ] || plain=--plaintext
    for command in "init $plain" "enroll alice $T/mallory.ply" "rekey --yes $plain"; do
        # shellcheck disable=SC2086 # a command and its arguments
        "$BUILD/surfacectl" --db "$T/$kind.db" $command >"$T/out" 2>&1 ||
            ok "$kind: $command" false
    done
done

# ---- while the daemon runs, with its default key and with a given one
cp "$DB.key" "$T/credential"
for given in '' "--key $T/credential"; do
    for with in evil keyed; do
        cp "$DB" "$T/whole.db"
        # shellcheck disable=SC2086 # an option and its value, or none
        start_daemon --no-auth $given
        send POST /v1/subjects/alice/verify "$PLY" "$T/alice.ply"
        is "alice, before ($with$given)" "$STATUS $(get .decision)" "200 match"
        replace "$T/$with.db"
        send POST /v1/subjects/alice/verify "$PLY" "$T/mallory.ply"
        problem "the attacker does not match ($with$given)" 500 internal
        req GET /readyz
        problem "not ready ($with$given)" 503 not_ready 'key was changed'
        [ "$with" = keyed ] ||
            ok "the log names the remedy ($with$given)" \
                grep -q 'plaintext, but .* restore a backup' "$LOG"
        kill -9 "$PID"
        wait "$PID" 2>/dev/null
        PID=''
        rm -f "$DB-wal" "$DB-shm"
        cp "$T/whole.db" "$DB"
    done
done

# ---- before it is opened
cp "$T/evil.db" "$DB"
no_start "the default key"
no_start "a given key" --key "$T/credential"
mv "$DB.key" "$T/away"
no_start "a given key that does not exist" --key "$T/nowhere"
mv "$T/away" "$DB.key"
for command in "subject list" check "verify alice $T/mallory.ply" "backup $T/copy" "rekey --yes"; do
    # shellcheck disable=SC2086 # a command and its arguments
    ctl $command
    denied "$command" "$DB is plaintext, but there is a key $DB.key: restore a backup, or"
done
ctl subject list --key "$T/credential"
denied "a key is given to the command" "the key $T/credential is given: restore a backup, or"
ctl doctor
is "doctor reports it" "$CODE $(said '.findings[] | select(.about == "key") | .level')" "1 trouble"
cp "$T/keyed.db" "$DB"
ctl subject list
denied "a database of another key" "$DB.key: not the key of this database: give its own, or"

# ---- by restore
cp "$T/whole.db" "$DB"
ctl restore "$T/evil.db"
denied "restoring a plaintext copy" "is plaintext, but there is a key $DB.key"
ctl verify alice "$T/alice.ply"
is "nothing was changed" "$CODE" 0

# ---- a database that the operator makes plaintext
start_daemon --no-auth
ctl rekey --plaintext --yes
is "rekey to plaintext" "$CODE" 0
ok "removes the key" test ! -e "$DB.key" -a ! -e "$DB.key.new"
send POST /v1/subjects/alice/verify "$PLY" "$T/alice.ply"
is "the daemon still verifies" "$STATUS $(get .decision)" "200 match"
ctl rekey
is "rekey to a new key" "$CODE" 0
send POST /v1/subjects/alice/verify "$PLY" "$T/alice.ply"
is "the daemon still verifies, encrypted" "$STATUS $(get .decision)" "200 match"
ctl rekey --plaintext --keep-old
is "to plaintext, keeping the key" "$CODE" 0
ok "under another name" test ! -e "$DB.key" -a -e "$DB.key.old"
send POST /v1/subjects/alice/verify "$PLY" "$T/alice.ply"
is "the daemon still verifies, plaintext again" "$STATUS $(get .decision)" "200 match"
stop_daemon
ctl check
is "so does the command" "$CODE" 0
ctl backup "$T/plain"
is "its backup" "$CODE" 0
rm -f "$T/new.db"*
cp "$T/credential" "$T/new.db.key"
"$BUILD/surfacectl" --db "$T/new.db" init --plaintext >"$T/ctl" 2>&1
is "init --plaintext fails if there is a key" $? 77
ok "nothing is left of it" test ! -e "$T/new.db"
finish
