#!/bin/sh
# Goal: an attacker who can write the database file but has no key cannot replace the database or
# its key record: neither by a plaintext one nor by one with another key, neither before a program
# opens it nor while the daemon runs.  A daemon that has met another database serves nobody any
# more, whatever the file says then.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# denied TITLE DETAIL-PATTERN: the last command failed with 77 and this detail.
denied() {
    is "$1" "$CODE" 77
    ok "$1: '$(said .error.detail)' like '$2'" matches "$(said .error.detail)" "$2"
}

# replace WITH [TABLE...]: replaces the rows of these tables, or of all, by those of WITH, in place.
replace() {
    r_with=$1
    shift
    # shellcheck disable=SC2046 # a list
    [ $# -gt 0 ] || set -- $(sqlite3 "$r_with" "SELECT name FROM sqlite_schema
        WHERE type = 'table' AND name NOT LIKE 'sqlite_%'")
    printf '%s\n' "$@" | awk -v with="$r_with" '
        BEGIN { print "ATTACH \047" with "\047 AS mine; BEGIN;" }
        { print "DELETE FROM main." $1 "; INSERT INTO main." $1 " SELECT * FROM mine." $1 ";" }
        END { print "COMMIT;" }' | sqlite3 "$DB" || ok "the attacker can write" false
}

# back: the daemon is killed, and the database is what it was.
back() {
    kill -9 "$PID"
    wait "$PID" 2>/dev/null
    PID=''
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/whole.db" "$DB"
}

# no_start TITLE OPTION...: the daemon does not start with this database.
no_start() {
    n_title=$1
    shift
    start_fails "$n_title" 1 'plaintext: restore a backup' --db "$DB" \
        --listen 127.0.0.1:0 --no-auth "$@"
}

# refused TITLE: every route of /v1 gives 503, /readyz too, and the log has one line about it.
refused() {
    for r_path in subjects subjects/alice templates/00000000000000000000000000000000; do
        req GET "/v1/$r_path"
        is "$1: GET $r_path" "$STATUS $(get .code)" "503 database_refused"
    done
    for r_path in subjects/alice/verify subjects/mallory/templates check asymmetry; do
        send POST "/v1/$r_path" "$PLY" "$T/mallory.ply"
        is "$1: POST $r_path" "$STATUS $(get .code)" "503 database_refused"
    done
    printf '{"a": [], "b": []}' >"$T/pair"
    send POST /v1/compare "$JSON" "$T/pair"
    is "$1: compare" "$STATUS $(get .code)" "503 database_refused"
    printf '{"hold": false}' >"$T/patch"
    send PATCH /v1/subjects/alice 'application/merge-patch+json' "$T/patch"
    is "$1: PATCH" "$STATUS $(get .code)" "503 database_refused"
    req DELETE /v1/subjects/alice
    is "$1: DELETE" "$STATUS $(get .code)" "503 database_refused"
    req GET /readyz
    problem "$1: not ready" 503 not_ready 'not the one that was opened'
    req GET /healthz
    is "$1: alive" "$STATUS" 200
    is "$1: one line in the log" \
        "$(grep -c 'the database is refused until the daemon is started again' "$LOG")" 1
}

scan 1 0 "$T/alice.ply" --points 1000
scan 1 1 "$T/again.ply" --points 1000
scan 2 0 "$T/mallory.ply" --points 1000
ctl init
ctl enroll alice "$T/alice.ply"
is "alice is enrolled" "$CODE" 0
token=$(new_token gate --scope enroll,verify,read,delete,manage)

cp "$DB" "$T/whole.db"

# The attacker's databases, in which alice's template is of the attacker: plaintext, with a key, and
# with a passphrase, which takes 128 MB and 0.3 s of Argon2id with each opening.
printf 'correct horse battery\n' >"$T/phrase"
chmod 600 "$T/phrase"
for kind in evil keyed phrase; do
    o='' rekey=''
    case $kind in
    evil) o=--plaintext-database rekey='rekey --yes --plaintext' ;;
    phrase) rekey="rekey --yes --passphrase --new-key $T/phrase" ;;
    esac
    for command in init "enroll alice $T/mallory.ply" "${rekey:-stats}"; do
        # shellcheck disable=SC2086 # a command and its arguments
        "$BUILD/surfacectl" --db "$T/$kind.db" $o $command >"$T/out" 2>&1 ||
            ok "$kind: $command: $(cat "$T/out")" false
    done
done

# ---- while the daemon runs, with its default key and with a given one, with and without tokens
cp "$DB.key" "$T/credential"
for given in '--no-auth' "--key $T/credential"; do
    for with in evil keyed phrase; do
        # shellcheck disable=SC2086 # an option and its value
        start_daemon $given
        AUTH=''
        [ "$given" = --no-auth ] || AUTH=$token
        send POST /v1/subjects/alice/verify "$PLY" "$T/again.ply"
        is "alice, before ($with $given)" "$STATUS $(get .decision)" "200 match"
        replace "$T/$with.db"
        send POST /v1/subjects/alice/verify "$PLY" "$T/mallory.ply"
        problem "the attacker does not match ($with $given)" 503 database_refused
        refused "$with $given"
        rm -f "$DB-wal" "$DB-shm"
        cp "$T/whole.db" "$DB"
        send POST /v1/subjects/alice/verify "$PLY" "$T/again.ply"
        problem "not before the daemon is started again ($with $given)" 503 database_refused
        back
    done
done
AUTH=''

# ---- the key record alone: a daemon has its keys, and takes no other ones; nothing starts with it
for with in evil keyed phrase; do
    start_daemon --no-auth
    replace "$T/$with.db" root
    send POST /v1/subjects/alice/verify "$PLY" "$T/again.ply"
    is "alice, by the keys of before ($with)" "$STATUS $(get .decision)" "200 match"
    send POST /v1/subjects/alice/verify "$PLY" "$T/mallory.ply"
    is "mallory ($with)" "$STATUS $(get .decision)" "200 no_match"
    kill -9 "$PID"
    wait "$PID" 2>/dev/null
    PID=''
    start_fails "the key record ($with)" 1 'plaintext: restore|not the key of' --db "$DB" --listen 127.0.0.1:0
    ctl rekey --yes
    ok "nor a command ($with): $CODE" [ "$CODE" = 77 -o "$CODE" = 65 ]
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/whole.db" "$DB"
done

# ---- before it is opened
cp "$T/evil.db" "$DB"
no_start "the default key"
no_start "a given key" --key "$T/credential"
no_start "a given key that does not exist" --key "$T/nowhere"
mv "$DB.key" "$T/away"
no_start "no key"
mv "$T/away" "$DB.key"
for command in "subject list" check "verify alice $T/mallory.ply" "backup $T/copy" "rekey --yes"; do
    # shellcheck disable=SC2086 # a command and its arguments
    ctl $command
    denied "$command" "$DB is plaintext: restore a backup; or, .*--plaintext-database"
done
ctl subject list --key "$T/credential"
denied "a key is given to the command" "is plaintext: restore a backup"
ctl doctor
is "doctor reports it" "$CODE $(said '.findings[] | select(.about == "key") | .level')" "1 trouble"
cp "$T/keyed.db" "$DB"
ctl subject list
denied "a database of another key" "$DB.key: not the key of this database: give its own, or"

# ---- by restore
cp "$T/whole.db" "$DB"
ctl restore "$T/evil.db"
denied "restoring a plaintext copy" "is plaintext: restore a backup"
ctl verify alice "$T/again.ply"
is "nothing was changed" "$CODE" 0

# ---- a database that the operator makes plaintext
ctl rekey --plaintext --yes
is "rekey to plaintext" "$CODE" 0
ok "removes the key" test ! -e "$DB.key" -a ! -e "$DB.key.new"
ctl rekey --yes
denied "what it is must be said" 'say so with --plaintext-database'
no_start "it must be said to the daemon"
start_daemon --no-auth --plaintext-database
send POST /v1/subjects/alice/verify "$PLY" "$T/again.ply"
is "it serves a plaintext database" "$STATUS $(get .decision)" "200 match"
stop_daemon
export SURFACED_PLAINTEXT_DATABASE=1
ctl check-database
is "so does the command, by the environment" "$CODE" 0
ctl backup "$T/plain"
is "its backup" "$CODE" 0
unset SURFACED_PLAINTEXT_DATABASE
rm -f "$T/new.db"*
cp "$T/credential" "$T/new.db.key"
"$BUILD/surfacectl" --db "$T/new.db" init --plaintext-database >"$T/ctl" 2>&1
is "init --plaintext-database fails if there is a key" $? 77
ok "nothing is left of it" test ! -e "$T/new.db"

# ---- a missing database: the daemon makes none unless told, and none where there is a key
start_fails "no database" 1 'surfacectl init makes one' --db "$T/none.db" --listen 127.0.0.1:0
ok "none was made" test ! -e "$T/none.db"
for create in '' --create; do
    # shellcheck disable=SC2086 # an option or none
    start_fails "only the key is left$create" 1 'no database .*, but its key .* restore a backup' \
        $create --db "$T/new.db" --listen 127.0.0.1:0
    ok "none was made$create" test ! -e "$T/new.db"
    : >"$T/new.db"
    # shellcheck disable=SC2086 # an option or none
    start_fails "and an empty file$create" 1 'no database .*, but its key .* restore a backup' \
        $create --db "$T/new.db" --listen 127.0.0.1:0
    rm -f "$T/new.db"
done
DB=$T/fresh.db
start_daemon --no-auth
stop_daemon
ok "--create makes database and key" test -s "$DB" -a -s "$DB.key"
conf 'create = 1'
start_fails "no setting of the file" 64 'create' --config "$T/conf" --db "$T/none.db"
finish
