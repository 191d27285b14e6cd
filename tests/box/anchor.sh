#!/bin/sh
# Goal: with --anchor FILE an older copy of the whole database is found: at the start and by each
# command.  So is an anchor that was removed or exchanged.  What is put back on purpose is accepted
# once, by a command that leaves an entry in the change log.  Without one the daemon's log shows it.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
ANCHOR=$T/elsewhere/anchor
mkdir "$T/elsewhere"

# said_by_both: what database and anchor say.
said_by_both() { { sqlite3 "$DB" .dump && cat "$ANCHOR" 2>/dev/null; } | sha256sum; }

# refused TITLE PATTERN: the daemon does not start, no command opens the database, and nothing of
# it changes.
refused() {
    r_sum=$(said_by_both)
    start_fails "$1" 1 "$2" --db "$DB" --anchor "$ANCHOR" --listen 127.0.0.1:0 --no-auth
    for r_command in "subject list" check-database "audit verify" "backup $T/b" \
        "token create x --scope verify" "verify alice $T/p1.ply" "subject erase alice --yes" \
        "rekey --yes"; do
        # shellcheck disable=SC2086 # a command and its arguments
        ctl --anchor "$ANCHOR" $r_command
        ctl_failed "$1: $r_command" 77 "$2"
    done
    is "$1: nothing was changed" "$(said_by_both)" "$r_sum"
}

# keep NAME, back NAME: the database as it is, and put back.
keep() { rm -f "$T/$1.db" && sqlite3 "$DB" "VACUUM INTO '$T/$1.db'" && cp "$ANCHOR" "$T/$1.anchor"; }
back() {
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/$1.db" "$DB"
}

# accepted: how often a state was.
accepted() { sql "SELECT count(*) FROM change_log WHERE kind = 'accept_state'"; }

# last_logged: the numbers of the last change that the daemon's log tells, at its start and stop.
last_logged() { sed -n 's/.*last change of the database" seq=\([0-9]*\) hash=[0-9a-f]*$/\1/p' "$LOG" | paste -sd ' '; }

scan 1 0 "$T/s1.ply" --points 1000
scan 1 1 "$T/p1.ply" --points 1000
scan 2 0 "$T/s2.ply" --points 1000
export SURFACED_ANCHOR="$ANCHOR"
ctl_exits 0 init
ok "init makes the anchor" test -s "$ANCHOR"
is "for its owner alone" "$(stat -c %a "$ANCHOR")" 600
ctl_exits 0 enroll alice "$T/s1.ply"
ctl_exits 0 enroll bob "$T/s2.ply"
ctl_exits 0 token create gate --scope verify
id=$(said .id)
keep 'then'
ctl subject erase bob --yes
ctl token revoke "$id"
keep now

# ---- a rollback of the whole file, at rest
back 'then'
refused "an older database" 'is older than its anchor says.*surfacectl accept-state'
back now
ctl_exits 0 check-database # the newest is good

# ---- a rollback that goes on: others' entries under the same numbers
back 'then'
cp "$T/then.anchor" "$ANCHOR"
for name in a b c d e; do
    ctl token create "$name" --scope verify
done
cp "$T/now.anchor" "$ANCHOR"
refused "another history" 'is older than its anchor says, or another one'
sqlite3 "$DB" "ATTACH '$T/now.db' AS now; CREATE TEMP TABLE was AS SELECT * FROM now.change_log ORDER BY seq DESC LIMIT 1;
    DELETE FROM main.change_log WHERE seq = (SELECT seq FROM was); INSERT INTO main.change_log SELECT * FROM was"
refused "another history, and in it the anchor's own entry" 'is older than its anchor says, or another one'
back 'then'
env -u LD_PRELOAD python3 tests/box/attack_store.py anchor_entry "$DB" "$T/now.db" || ok "the entry is planted" false
refused "the older one, and before its first entry the anchor's" 'is older than its anchor says, or another one'
back now

# ---- the anchor removed, damaged, exchanged, older
rm "$ANCHOR"
refused "no anchor" 'there is no anchor'
"$BUILD/surfacectl" --db "$T/other.db" --anchor "$T/other.anchor" init >"$T/out"
cp "$T/other.anchor" "$ANCHOR"
refused "another database's anchor" "damaged, or another database's"
rm "$ANCHOR"
mkfifo "$ANCHOR"
start_fails "a FIFO, which nobody writes to" 1 'anchor' --db "$DB" --listen 127.0.0.1:0
rm "$ANCHOR"
cp "$T/then.anchor" "$ANCHOR"
ctl_exits 0 check-database # an anchor that lags is good
ctl token create after --scope verify
ok "and goes on with the next change" sh -c "! cmp -s '$ANCHOR' '$T/then.anchor'"
keep now
back 'then'
refused "which counts again" 'is older than its anchor'

# ---- an anchor that cannot be read for now is none of another: an older part does not take its place
back now
cp "$T/then.anchor" "$ANCHOR.part"
mv "$ANCHOR" "$T/aside"
mkdir "$ANCHOR"
for command in "subject list" "token create z --scope verify" "accept-state --yes"; do
    # shellcheck disable=SC2086 # a command and its arguments
    ctl $command
    ctl_failed "$command: the anchor cannot be read" 74 'cannot read the anchor'
done
rmdir "$ANCHOR"
mkdir "$ANCHOR"
mv "$ANCHOR.part" "$T/part"
ctl_exits 0 backup "$T/backup" --anchor none
for command in "restore $T/backup" "accept-state --yes"; do # nothing tells whose it is
    # shellcheck disable=SC2086 # a command and its arguments
    ctl $command
    ctl_failed "$command: the anchor cannot be read, and has no part" 74 'cannot read the anchor'
done
rm "$T/backup"
mv "$T/part" "$ANCHOR.part"
rmdir "$ANCHOR"
mv "$T/aside" "$ANCHOR"
ctl_exits 0 subject list
ok "the part is still one" cmp -s "$ANCHOR.part" "$T/then.anchor"
rm "$ANCHOR" # the part names a change that the database has
ctl_exits 0 subject list
ok "to read changes nothing" test ! -e "$ANCHOR"
ctl_exits 0 token create z --scope verify
ok "to write gives it its name" test -s "$ANCHOR" -a ! -e "$ANCHOR.part"
keep now
back 'then'
refused "which counts again" 'is older than its anchor'

# ---- accepted, once
ctl_exits 64 accept-state # it has to be confirmed
ctl_exits 0 accept-state --dry-run
is "tried" "$(accepted)" 0
ctl_exits 0 accept-state --yes
is "accepted" "$(accepted)" 1
ctl_exits 0 check-database # it is the newest now
back now
refused "nor the one that was the newest" 'is older than its anchor'
rm "$ANCHOR"
ctl_exits 0 accept-state --yes
ok "a lost anchor is made" test -s "$ANCHOR"
for wait in 0.002 0.004 0.008 0.016; do # killed, and run again
    back 'then'
    killed_after "$wait" accept-state --yes
    ctl_exits 0 accept-state --yes
    ctl_exits 0 check-database
done

# ---- while the daemon runs the anchor follows each change, and is made again
start_daemon --no-auth
rm "$ANCHOR"
gives 201 "a change" send POST /v1/subjects/carol/templates "$PLY" "$T/s2.ply"
ok "it is there again" test -s "$ANCHOR"
rm "$ANCHOR"
mkdir "$ANCHOR"
gives 200 "a change goes on where it cannot be written" req DELETE /v1/subjects/carol
contains "the log warns" "$LOG" "anchor is not up to date"
rmdir "$ANCHOR"
send POST /v1/subjects/carol/templates "$PLY" "$T/s2.ply"
is "the log tells the recovery, once" "$(grep -c 'anchor is up to date again' "$LOG")" 1
rm "$ANCHOR"
mkdir "$ANCHOR"
for _ in 1 2; do
    req DELETE /v1/subjects/carol
    send POST /v1/subjects/carol/templates "$PLY" "$T/s2.ply"
done
is "and the second outage, once" "$(grep -c 'anchor is not up to date' "$LOG")" 2
rmdir "$ANCHOR"
stop_daemon
ok "it is made up for" test -s "$ANCHOR"
rm "$ANCHOR"
refused "and is missed" 'there is no anchor'
ctl accept-state --yes

# ---- restore and rekey go on with it
ctl backup "$T/backup"
ctl enroll dave "$T/s2.ply"
for command in "restore $T/backup" "rekey --yes"; do
    # shellcheck disable=SC2086 # a command and its arguments
    ctl_exits 0 $command
    ctl_exits 0 check-database
done
# ---- an older database is replaced by a backup: nobody knows what was erased since, which is not kept quiet
rm -f "$DB.before-restore" "$T/backup"
keep 'then'
ctl_exits 0 backup "$T/backup"
for way in newer older; do
    ctl subject set erin --consent "$way"
    ctl subject erase erin --yes
    if [ $way = newer ]; then wanted=0 outcome=restored; else
        wanted=$(sqlite3 "$DB" "SELECT max(seq) FROM change_log") outcome='restored, older than the anchor'
        back 'then'
    fi
    for dry in --dry-run ''; do
        # shellcheck disable=SC2086 # an option or none
        ctl_exits 0 restore "$T/backup" $dry
        is "$way ($dry): the change that is missed" "$(said .missed_change)" "$wanted"
    done
    is "$way: the log has it" "$(sqlite3 "$DB" "SELECT outcome FROM change_log ORDER BY seq DESC LIMIT 1")" "$outcome"
    ctl_exits 0 check-database
    rm "$DB.before-restore"
done
rm -f "$DB"
ctl init
ctl_failed "no new database where one was" 65 'an anchor .*, but not its database'

# ---- without one: the daemon's log begins with a lower number than it has ended with
unset SURFACED_ANCHOR
DB=$T/alone.db
ctl init
sqlite3 "$DB" "VACUUM INTO '$T/first.db'"
ctl token create later --scope verify
start_daemon --no-auth
stop_daemon
is "the last change, at start and stop" "$(last_logged)" "2 2"
back first
start_daemon --no-auth
stop_daemon
is "the rollback shows" "$(last_logged)" "1 1"
finish
