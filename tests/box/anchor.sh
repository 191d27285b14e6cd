#!/bin/sh
# Goal: an older copy of the whole database is found, by a file outside of it: at the start, by each
# command, and while the daemon runs.  So is an anchor that was removed or exchanged.  What is put
# back on purpose is accepted once, by a command that leaves an entry in the audit log.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
ANCHOR=$DB.key.anchor

# denied TITLE DETAIL-PATTERN: the last command failed with 77 and this detail.
denied() {
    is "$1" "$CODE" 77
    ok "$1: '$(said .error.detail)' like '$2'" matches "$(said .error.detail)" "$2"
}

# refused TITLE PATTERN: the daemon does not start, no command opens the database, and nothing of
# it changes.
refused() {
    r_sum=$(said_by_both)
    for r_option in '' --create; do
        # shellcheck disable=SC2086 # an option or none
        start_fails "$1$r_option" 1 "$2" $r_option --db "$DB" --listen 127.0.0.1:0 --no-auth
    done
    for r_command in "subject list" stats check "audit verify" "audit show" "backup $T/b" \
        "token create x --scope verify" "verify alice $T/p1.ply" "subject erase alice --yes" \
        "rekey --yes" "export --all --archive-key $T/akey -o $T/a"; do
        # shellcheck disable=SC2086 # a command and its arguments
        ctl $r_command
        denied "$1: $r_command" "$2"
    done
    ctl doctor
    is "$1: doctor" "$CODE $(said '.findings[] | select(.about == "anchor") | .level')" "1 trouble"
    is "$1: nothing was changed" "$(said_by_both)" "$r_sum"
}

# said_by_both: what database and anchor say.
said_by_both() { { sqlite3 "$DB" .dump && cat "$ANCHOR" 2>/dev/null; } | sha256sum; }

# keep NAME, back NAME: the database as it is, and put back.
keep() { rm -f "$T/$1.db" && sqlite3 "$DB" "VACUUM INTO '$T/$1.db'" && cp "$ANCHOR" "$T/$1.anchor"; }
back() {
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/$1.db" "$DB"
}

# events KIND: outcomes of the entries.
events() { sqlite3 "$DB" "SELECT outcome FROM events WHERE kind = '$1' ORDER BY seq"; }

# killed: the daemon is.
killed() {
    kill -9 "$PID"
    wait "$PID" 2>/dev/null
    PID=''
}

for s in 1 2 3; do
    scan "$s" 0 "$T/s$s.ply" --points 1000
    scan "$s" 1 "$T/p$s.ply" --points 1000
done
openssl rand -hex 32 >"$T/akey"
chmod 600 "$T/akey"
ctl init
ok "init makes the anchor" test -s "$ANCHOR"
is "for its owner alone" "$(stat -c '%a %s' "$ANCHOR")" "600 8192"
ctl enroll alice "$T/s1.ply"
ctl enroll bob "$T/s2.ply"
ctl token create gate --scope verify
id=$(said '.id // .token_id')
keep 'then'
ctl subject erase bob --yes
ctl token revoke "$id"
keep now

# ---- a rollback of the whole file, at rest
back 'then'
refused "an older database" 'is older than its anchor .*surfacectl accept-rollback'
ctl subject list --anchor none
is "it can be looked at as a copy" "$CODE" 0
ctl subject erase alice --yes --anchor none
is "which is not changed" "$CODE" 64
back now
ctl check
is "the newest is good" "$CODE" 0

# ---- a rollback that goes on: others' entries under the same numbers
back 'then'
cp "$T/then.anchor" "$ANCHOR"
ctl token create mallory --scope verify
ctl token create mallory2 --scope verify
ctl token create mallory3 --scope verify
cp "$T/now.anchor" "$ANCHOR"
refused "another history" 'does not have change [0-9]* of its anchor'
back now

# ---- the anchor removed, damaged, exchanged, older
rm "$ANCHOR"
refused "no anchor" 'the anchor of .* is missing'
for bytes in 0 100 4096 8192; do
    head -c "$bytes" /dev/zero >"$ANCHOR"
    refused "an anchor of $bytes zeros" 'damaged, or another database'
done
"$BUILD/surfacectl" --db "$T/other.db" init >/dev/null
cp "$T/other.db.key.anchor" "$ANCHOR"
refused "another database's anchor" 'damaged, or another database'
ctl init
is "init does not make a new one" "$CODE" 77
rm "$ANCHOR"
mkfifo "$ANCHOR"
start_fails "a FIFO, which nobody writes to" 1 'damaged, or another database' \
    --db "$DB" --listen 127.0.0.1:0
rm "$ANCHOR"
mkdir "$ANCHOR"
refused "a folder" 'anchor'
rmdir "$ANCHOR"
cp "$T/then.anchor" "$ANCHOR"
ctl check
is "an anchor that lags is good" "$CODE" 0
ctl token create after --scope verify
ok "and goes on with the next change" sh -c "! cmp -s '$ANCHOR' '$T/then.anchor'"
keep now
back 'then'
refused "which counts again" 'is older than its anchor'

# ---- accepted, once
ctl accept-rollback
is "it has to be confirmed" "$CODE" 64
ctl accept-rollback --yes
is "accepted" "$CODE" 0
ok "the entry tells: '$(events accept_rollback)'" \
    matches "$(events accept_rollback)" '^anchor: change [0-9]+; last: [0-9]+$'
ctl check
is "it is the newest now" "$CODE" 0
ctl accept-rollback --yes
is "there is nothing more to accept" "$CODE $(events accept_rollback | wc -l)" "65 1"
back 'then'
refused "the same once more" 'is older than its anchor|does not have change'
back now
refused "nor the one that was the newest" 'does not have change|is older than its anchor'
rm "$ANCHOR"
ctl accept-rollback --yes
is "a lost anchor" "$CODE $(events accept_rollback)" "0 the anchor was missing"
cp "$T/other.db.key.anchor" "$ANCHOR"
ctl accept-rollback --yes
is "another one" "$CODE $(events accept_rollback | tail -n 1)" "0 the anchor was not its own"
for wait in 0.002 0.004 0.006 0.008 0.012 0.016; do # killed, and run again
    back 'then'
    "$BUILD/surfacectl" --db "$DB" accept-rollback --yes >/dev/null 2>&1 &
    pid=$!
    sleep "$wait"
    kill -9 "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
    ctl accept-rollback --yes
    ok "killed after $wait s: exit $CODE" [ "$CODE" = 0 -o "$CODE" = 65 ]
    ctl check
    is "and accepted" "$CODE" 0
done
ok "accept-rollback is nothing for the daemon" sh -c \
    "! '$BUILD/surfaced' --db '$DB' --accept-rollback >/dev/null 2>&1"

# ---- a rollback while the daemon runs
keep before
start_daemon --no-auth
req DELETE /v1/subjects/alice
is "alice is erased" "$STATUS" 200
tables=$(sqlite3 "$DB" "SELECT name FROM sqlite_schema WHERE type = 'table'
    AND name NOT LIKE 'sqlite_%'")
printf '%s\n' "$tables" | awk -v with="$T/before.db" '
    BEGIN { print "ATTACH \047" with "\047 AS mine; PRAGMA foreign_keys = OFF; BEGIN;" }
    { print "DELETE FROM main." $1 "; INSERT INTO main." $1 " SELECT * FROM mine." $1 ";" }
    END { print "COMMIT;" }' | sqlite3 "$DB" || ok "the attacker can write" false
send POST /v1/subjects/alice/verify "$PLY" "$T/p1.ply"
problem "alice is not back" 503 database_refused
req GET /v1/subjects
problem "nor anything else" 503 database_refused
req GET /readyz
problem "not ready" 503 not_ready
is "one line in the log" \
    "$(grep -c 'the database is refused until the daemon is started again' "$LOG")" 1
killed
refused "nor does it start again" 'is older than its anchor'

# ---- an anchor that is removed while the daemon runs is made again with the next change
ctl accept-rollback --yes
start_daemon --no-auth
rm "$ANCHOR"
send POST /v1/subjects/carol/templates "$PLY" "$T/s3.ply"
is "a change" "$STATUS" 201
ok "it is there again" test -s "$ANCHOR"
rm "$ANCHOR"
mkdir "$ANCHOR"
req DELETE /v1/subjects/carol
is "a change goes on where it cannot be written" "$STATUS" 200
contains "the log warns" "$LOG" "anchor is not up to date"
rmdir "$ANCHOR"
stop_daemon
refused "and its end is not told" 'the anchor of .* is missing'
ctl accept-rollback --yes

# ---- stops that were not clean
start_daemon --no-auth
stop_daemon
is "a clean stop leaves no entry" "$(events unclean_stop | tail -n 1)" ""
contains "the log has the last change" "$LOG" 'last change of the database" seq=[0-9]+ hash=[0-9a-f]{64}'
is "at the start and at the stop" "$(grep -c 'last change of the database' "$LOG")" 2
start_daemon --no-auth
killed
ctl stats
is "a command leaves none either" "$(events unclean_stop)" ""
start_daemon --no-auth
ok "the next start does: '$(events unclean_stop)'" \
    matches "$(events unclean_stop)" '^known [0-9]+/[0-9]+, found [0-9]+/[0-9]+ \(changes/uses\)$'
one=$PID
start_daemon --no-auth
is "a second daemon beside it does not" "$(events unclean_stop | wc -l)" 1
stop_daemon
PID=$one
killed
start_daemon --no-auth
is "the one that was killed beside it does" "$(events unclean_stop | wc -l)" 2
stop_daemon
start_daemon --no-auth
stop_daemon
is "a clean stop does not" "$(events unclean_stop | wc -l)" 2

# ---- both of them rolled back: here the anchor ends, and the log begins
keep both
was=$(sed -n 's/.*last change of the database" seq=\([0-9]*\).*/\1/p' "$LOG" | tail -n 1)
ctl token create later --scope verify
start_daemon --no-auth
stop_daemon
logged=$(sed -n 's/.*last change of the database" seq=\([0-9]*\).*/\1/p' "$LOG" | tail -n 1)
ok "the log has gone on ($was, $logged)" test "$logged" -gt "$was"
back both
cp "$T/both.anchor" "$ANCHOR"
start_daemon --no-auth
stop_daemon
again=$(sed -n 's/.*last change of the database" seq=\([0-9]*\).*/\1/p' "$LOG" | head -n 1)
ok "the log shows the rollback ($again)" test "$again" -lt "$logged"

# ---- restore and rekey
ctl backup "$T/backup"
ctl enroll dave "$T/s1.ply"
ctl restore "$T/backup"
is "restore" "$CODE" 0
ctl check
is "is told the anchor" "$CODE" 0
cp "$DB.before-restore" "$T/put-back.db"
back put-back
refused "what was there before is older" 'does not have change|is older'
rm "$DB.before-restore"
ctl restore "$T/backup"
is "restored over it" "$CODE" 0
ctl rekey --yes
is "rekey" "$CODE" 0
keep rekeyed
ctl check
is "is told the anchor too" "$CODE" 0
rm -f "$DB"* # but the anchor, below
cp "$T/rekeyed.anchor" "$ANCHOR"
ctl init
is "no new database where one was" "$CODE" 65
ok "it says what to do" matches "$(said .error.detail)" 'an anchor .*, but not its database'
start_fails "nor by the daemon" 1 'no database .*, but its anchor .* restore a backup' \
    --create --db "$DB" --listen 127.0.0.1:0

# ---- the drill of docs/database.md
mkdir -m 700 "$T/drill"
"$BUILD/surfacectl" --db "$T/d.db" init >/dev/null
"$BUILD/surfacectl" --db "$T/d.db" enroll alice "$T/s1.ply" >/dev/null
"$BUILD/surfacectl" --db "$T/d.db" backup "$T/drill/backup.db" >/dev/null
cp "$T/d.db.key" "$T/drill/faces.db.key"
DB=$T/drill/faces.db ANCHOR=$DB.key.anchor
ctl restore "$T/drill/backup.db"
is "the drill: restore" "$CODE" 0
ok "it has an anchor of its own" test -s "$ANCHOR"
for command in check "audit verify" "verify alice $T/p1.ply"; do
    # shellcheck disable=SC2086 # a command and its arguments
    ctl $command
    is "the drill: $command" "$CODE" 0
done

# ---- where it is
mkdir -m 700 "$T/keys" "$T/credentials"
cp "$DB.key" "$T/keys/key"
ctl stats --key "$T/keys/key"
is "a key elsewhere: where it was" "$CODE" 0
mv "$ANCHOR" "$T/keys/key.anchor"
ctl stats --key "$T/keys/key"
is "or beside the key" "$CODE" 0
ctl stats --anchor "$T/keys/key.anchor"
is "or where it is said to be" "$CODE" 0
SURFACED_ANCHOR=$T/keys/key.anchor ctl stats
is "by the environment" "$CODE" 0
ctl stats
denied "else it is missing" "missing: there is no $ANCHOR"
DB=$T/drill/new.db
ctl init --key "$T/keys/key" --anchor "$T/keys/mine"
ok "init makes it there" test -s "$T/keys/mine" -a ! -e "$DB.key.anchor"
DB=$T/drill/newer.db
cp "$T/keys/key" "$T/credentials/key"
CREDENTIALS_DIRECTORY=$T/credentials ctl init --key "$T/credentials/key"
is "a credential" "$CODE $(files "$T/credentials")" "0 key"
ok "its anchor is beside the database" test -s "$DB.key.anchor"
DB=$T/drill/newest.db
if [ "$(id -u)" != 0 ]; then
    chmod 500 "$T/credentials"
    ctl init --key "$T/credentials/key"
    is "a folder that cannot be written" "$CODE $(files "$T/credentials")" "0 key"
    ok "its anchor is beside the database too" test -s "$DB.key.anchor"
    chmod 700 "$T/credentials"
fi
finish
