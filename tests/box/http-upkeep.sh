#!/bin/sh
# Goal: a daemon under verifications finds by itself that its database is not as it was written,
# within two of its verification periods: an older row, one that is hidden, and bytes that were
# changed in the file without SQLite.  From then on all of /v1 gives 503 with a clear line in the log.
# While a table cannot be read, which may hide a difference, no request is served; when it can, the
# difference is found.  Here the periods pass: 130 s, for four daemons at once.
. tests/box/lib.sh

PERIOD=60 # VERIFY_MS of server/upkeep.c
scan 1 0 "$T/s1.ply" --points 1000
scan 1 1 "$T/p1.ply" --points 1000
scan 2 0 "$T/s2.ply" --points 1000
ctl init
AUTH=$(new_token door)
new_token lost >/dev/null
ctl enroll alice "$T/s1.ply"
ctl enroll bob "$T/s2.ply"
sqlite3 "$DB" "VACUUM INTO '$T/old.db'"
ctl token list
ctl token revoke "$(said '.tokens[] | select(.name == "lost") | .id')"
sqlite3 "$DB" "PRAGMA wal_checkpoint(TRUNCATE)" >"$T/out"
cp "$DB" "$T/whole.db"
cp "$DB.key" "$T/key"

# in_file TEXT BY: these bytes are replaced in the database's file, behind SQLite's back.
in_file() {
    i_at=$(grep -abo -m 1 "$1" "$DB" | head -n 1 | cut -d: -f 1)
    printf %s "$2" | dd of="$DB" bs=1 seek="$i_at" conv=notrunc 2>"$T/out"
}

# Four daemons, which differ in what is done to their databases.
ways='older hidden unread bytes'
for way in $ways; do
    DB=$T/$way.db LOG=$T/$way.log
    cp "$T/whole.db" "$DB"
    cp "$T/key" "$DB.key"
    start_daemon
    echo "$PID" >"$T/$way.pid"
    echo "$URL" >"$T/$way.url"
    gives 200 "$way: before" req GET /v1/subjects
done
# ask WAY: a verification of alice by its daemon.
ask() {
    URL=$(cat "$T/$1.url")
    send POST /v1/subjects/alice/verify "$PLY" "$T/p1.ply"
}
began=$(date +%s)
for way in $ways; do
    DB=$T/$way.db
    case $way in
    older) sqlite3 "$DB" "ATTACH '$T/old.db' AS old; DELETE FROM main.tokens; INSERT INTO main.tokens
        SELECT * FROM old.tokens" ;;
    hidden) sql "DELETE FROM subjects WHERE subject_key = 2" ;;
    unread) sqlite3 "$DB" "ATTACH '$T/old.db' AS old; DELETE FROM main.tokens; INSERT INTO main.tokens
        SELECT * FROM old.tokens; ALTER TABLE devices RENAME TO others" ;;
    bytes)
        # Nothing is written meanwhile, so that its caches stay as they are.
        in_file 'surfaced/0' 'SURFACED/0'
        continue
        ;;
    esac
    gives 200 "$way: at once it cannot know" ask "$way"
done
# all_refuse: does each of them refuse a verification?
all_refuse() {
    for way in $ways; do
        [ -e "$T/$way.found" ] && continue
        [ "$way" = bytes ] && ! grep -q 'is refused' "$T/$way.log" && return 1
        ask "$way"
        [ "$STATUS" = 503 ] || { [ "$way" = unread ] && [ "$STATUS" = 500 ]; } || return 1
        date +%s >"$T/$way.found"
    done
}
until all_refuse || [ $(($(date +%s) - began)) -gt $((2 * PERIOD + 10)) ]; do
    sleep 1
done
for way in $ways; do
    URL=$(cat "$T/$way.url") PID=$(cat "$T/$way.pid")
    ok "$way: found within two periods" [ -e "$T/$way.found" ]
    if [ "$way" = unread ]; then
        for path in subjects subjects/alice; do
            gives "500 internal" "$way: GET $path" req GET "/v1/$path"
        done
        contains "$way: the log says why" "$T/unread.log" 'level=warn msg="the rows could not be verified" .*devices'
        is "$way: and nothing of a difference" "$(grep -c 'is refused until' "$T/unread.log")" 0
        sqlite3 "$T/unread.db" "ALTER TABLE others RENAME TO devices"
        ask "$way"
    fi
    for path in subjects subjects/alice templates/00000000000000000000000000000000; do
        gives "503 database_refused" "$way: GET $path" req GET "/v1/$path"
    done
    for path in subjects/alice/verify subjects/erin/templates check; do
        gives "503 database_refused" "$way: POST $path" send POST "/v1/$path" "$PLY" "$T/p1.ply"
    done
    gives "503 database_refused" "$way: DELETE" req DELETE /v1/subjects/alice
    gives "503 not_ready" "$way: not ready" req GET /readyz
    gives 200 "$way: alive" req GET /healthz
    is "$way: one line in the log" "$(grep -c 'level=error msg="the database is refused until' "$T/$way.log")" 1
    kill "$PID"
    wait "$PID"
    is "$way: it stops" $? 0
    PID=''
done
contains "older" "$T/older.log" 'is refused .*reason="the database is not as it was written: the rows are not those of the last change'
contains "hidden" "$T/hidden.log" 'reason="the database is not as it was written: the rows are not those'
contains "unread" "$T/unread.log" 'is refused .*reason="the database is not as it was written: '
contains "bytes" "$T/bytes.log" 'reason="the database is not as it was written: ' 
finish
