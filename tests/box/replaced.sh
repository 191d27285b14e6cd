#!/bin/sh
# Goal: an attacker who can write the database file but has no key cannot replace it: neither by a
# plaintext one, nor by one with another key, nor by an older state or a shorter change log,
# neither before a program opens it nor while the daemon runs.  A daemon that has met another
# database serves nobody any more, whatever the file says then, until it is started again.
# Single rows are in store-attacks.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# denied TITLE DETAIL-PATTERN: the last command failed with 77 and this detail.
denied() { ctl_failed "$1" 77 "$2"; }

# as_in FILE [TABLE...]: SQL that gives these tables, or all but the key record, the rows of FILE.
as_in() {
    r_from=$1
    shift
    # shellcheck disable=SC2046 # a list
    [ $# -gt 0 ] || set -- $(sqlite3 "$r_from" "SELECT name FROM sqlite_schema
        WHERE type = 'table' AND name NOT LIKE 'sqlite_%' AND name != 'root'")
    printf 'DELETE FROM main.%s;\n' "$@"
    printf '%s\n' "$@" | sed 's/.*/INSERT INTO main.& SELECT * FROM mine.&;/'
}

# write FILE SQL: the attacker runs it on the database, with FILE attached as `mine`.
write() {
    sqlite3 "$DB" "PRAGMA foreign_keys = OFF; ATTACH '$1' AS mine; BEGIN; $2; COMMIT" ||
        ok "the attacker can write" false
}

# back: the daemon is killed, and the database is what it was.
back() {
    kill_daemon
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
    while read -r r_method r_path r_type; do
        req "$r_method" "$r_path" ${r_type:+-H "Content-Type: $r_type" --data-binary "@$T/mallory.ply"}
        is "$1: $r_method $r_path" "$STATUS $(get .code)" "503 database_refused"
    done <<END
GET /v1/subjects
GET /v1/subjects/alice
GET /v1/templates/00000000000000000000000000000000
POST /v1/subjects/alice/verify model/x-ply
POST /v1/subjects/mallory/templates model/x-ply
POST /v1/check model/x-ply
POST /v1/compare application/json
PATCH /v1/subjects/alice application/merge-patch+json
DELETE /v1/subjects/alice
END
    req GET /readyz
    problem "$1: not ready" 503 not_ready 'not the one that was opened, or was altered'
    alive "$1"
    is "$1: one line in the log" \
        "$(grep -c 'level=error msg="the database is refused until the daemon is restarted"' "$LOG")" 1
}

scan 1 0 "$T/alice.ply" --points 1000
scan 1 1 "$T/again.ply" --points 1000
scan 2 0 "$T/mallory.ply" --points 1000
ctl_exits 0 init
ctl_exits 0 enroll alice "$T/alice.ply"
ctl_exits 0 subject set bob --consent C
token=$(new_token gate)
sqlite3 "$DB" "VACUUM INTO '$T/old.db'"
ctl_exits 0 subject set alice --consent D
ctl_exits 0 subject erase bob --yes
cp "$DB" "$T/whole.db"
cp "$DB.key" "$T/credential"

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

# ---- while the daemon runs: the whole of another database, an older state, the change log cut short.
# What else may become of the log is in test_log_txn.c.
newest="seq = (SELECT max(seq) FROM main.change_log)"
for what in evil keyed phrase given older cut; do
    from=$T/old.db given=--no-auth AUTH=''
    case $what in
    given) from=$T/evil.db given="--key $T/credential" AUTH=$token sql="$(as_in "$from"); $(as_in "$from" root)" ;;
    evil | keyed | phrase) from=$T/$what.db sql="$(as_in "$from"); $(as_in "$from" root)" ;;
    older) sql=$(as_in "$from") ;;
    cut) sql="DELETE FROM main.change_log WHERE $newest" ;;
    esac
    # shellcheck disable=SC2086 # an option and its value
    start_daemon $given
    send POST /v1/subjects/alice/verify "$PLY" "$T/again.ply"
    is "$what: alice, before" "$STATUS $(get .decision)" "200 match"
    write "$from" "$sql"
    refused "$what"
    write "$T/whole.db" "$(as_in "$T/whole.db"); $(as_in "$T/whole.db" root)"
    gives "503 database_refused" "$what: put right, until a restart" req GET /v1/subjects/alice
    back
    start_daemon --no-auth
    req GET /v1/subjects/alice
    is "$what: started again" "$STATUS $(get .consent)" "200 D"
    stop_daemon
done
AUTH=''

# ---- another file of that name, or none: no change may be lost
for what in moved removed replaced; do
    start_daemon --no-auth
    case $what in
    moved) mv "$DB" "$T/away" ;;
    removed) rm "$DB" ;;
    replaced) cp "$T/old.db" "$T/other" && mv "$T/other" "$DB" ;;
    esac
    gives "503 database_refused" "$what: an enrolment" send POST /v1/subjects/erin/templates "$PLY" "$T/mallory.ply"
    gives "503 database_refused" "$what: an erasure" req DELETE /v1/subjects/alice
    back
done

# ---- the key record alone: a daemon has its keys, and takes no other ones; nothing starts with it
for with in evil keyed phrase; do
    start_daemon --no-auth
    write "$T/$with.db" "$(as_in "$T/$with.db" root)"
    send POST /v1/subjects/alice/verify "$PLY" "$T/again.ply"
    is "alice, by the keys of before ($with)" "$STATUS $(get .decision)" "200 match"
    send POST /v1/subjects/alice/verify "$PLY" "$T/mallory.ply"
    is "mallory ($with)" "$STATUS $(get .decision)" "200 no_match"
    kill_daemon
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
for command in "subject list" check-database "verify alice $T/mallory.ply" "backup $T/copy" "rekey --yes"; do
    # shellcheck disable=SC2086 # a command and its arguments
    ctl $command
    denied "$command" "$DB is plaintext: restore a backup; or, .*--plaintext-database"
done
ctl subject list --key "$T/credential"
denied "a key is given to the command" "is plaintext: restore a backup"
ctl doctor
is "doctor reports it" "$CODE $(said '.findings[] | select(.about == "key") | .severity')" "1 error"
cp "$T/keyed.db" "$DB"
ctl subject list
denied "a database of another key" "$DB.key: not the key of this database: give its own, or"
cp "$T/whole.db" "$DB"
ctl restore "$T/evil.db"
denied "restoring a plaintext copy" "is plaintext: restore a backup"
ctl_exits 0 verify alice "$T/again.ply" # nothing was changed

# ---- a rekey that seems to have been interrupted: the true database as what is to be discarded
for kind in evil keyed; do
    cp "$T/$kind.db" "$DB"
    cp "$T/whole.db" "$DB.discard"
    ctl rekey --yes
    ok "rekey, with a planted $kind database: $CODE" [ "$CODE" = 77 -o "$CODE" = 65 ]
    ok "the key and the true database are there" cmp -s "$DB.key" "$T/credential"
    ok "as they were" cmp -s "$DB.discard" "$T/whole.db"
    mv "$DB.discard" "$DB"
done
cp "$DB.key" "$DB.key.old" # kept, with its database; a second copy of that is planted
cp "$DB" "$DB.before-rekey"
cp "$DB" "$DB.discard"
ctl rekey --yes
ok "nor does a kept key go" cmp -s "$DB.key.old" "$T/credential"
rm -f "$DB.key.old" "$DB.before-rekey" "$DB.discard"

# ---- a database that the operator makes plaintext
ctl_exits 0 rekey --plaintext --yes
ok "removes the key" test ! -e "$DB.key" -a ! -e "$DB.key.new"
ctl rekey --yes
denied "what it is must be said" 'say so with --plaintext-database'
no_start "it must be said to the daemon"
start_daemon --no-auth --plaintext-database
send POST /v1/subjects/alice/verify "$PLY" "$T/again.ply"
is "it serves a plaintext database" "$STATUS $(get .decision)" "200 match"
stop_daemon
export SURFACED_PLAINTEXT_DATABASE=1
ctl_exits 0 check-database
ctl_exits 0 backup "$T/plain"
unset SURFACED_PLAINTEXT_DATABASE
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
done
: >"$T/new.db"
start_fails "and an empty file" 1 'no database .*, but its key .* restore a backup' \
    --create --db "$T/new.db" --listen 127.0.0.1:0
DB=$T/fresh.db
start_daemon --no-auth
stop_daemon
ok "--create makes database and key" test -s "$DB" -a -s "$DB.key"
conf 'create = 1'
start_fails "no setting of the file" 64 'create' --config "$T/conf" --db "$T/none.db"
finish
