#!/bin/sh
# Goal: an older state of the whole database, or its change log cut off, is found at once by a
# daemon that runs: it serves nobody any more, whatever the file says then, until it is started
# again.  What differs at rest, and how it is found, is in store-attacks.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

scan 1 0 "$T/s1.ply" --points 1000
scan 1 1 "$T/p1.ply" --points 1000
scan 2 0 "$T/s2.ply" --points 1000
ctl init
AUTH=$(new_token door)
ctl enroll alice "$T/s1.ply"
ctl enroll bob "$T/s2.ply"
sqlite3 "$DB" "VACUUM INTO '$T/old.db'"
ctl subject disable alice
ctl subject erase bob --yes
cp "$DB" "$T/whole.db"

# as_it_was TABLE...: SQL that gives these tables, or all but the root, their old rows.
as_it_was() {
    # shellcheck disable=SC2046 # a list
    [ $# -gt 0 ] || set -- $(sqlite3 "$DB" "SELECT name FROM sqlite_schema WHERE type = 'table'
        AND name NOT LIKE 'sqlite_%' AND name != 'root'")
    printf 'DELETE FROM main.%s;\n' "$@"
    printf '%s\n' "$@" | sed 's/.*/INSERT INTO main.& SELECT * FROM old.&;/'
}

end="(SELECT max(seq) FROM old.change_log)"
for what in all log cut empty forged other; do
    case $what in
    all) sql=$(as_it_was) ;;
    log) sql=$(as_it_was change_log) ;;
    cut) sql="DELETE FROM main.change_log WHERE seq = (SELECT max(seq) FROM main.change_log)" ;;
    empty) sql="DELETE FROM main.change_log" ;;
    forged) sql="INSERT INTO main.change_log SELECT seq + 1, at, kind, actor, uid, object, outcome, digest,
        access_seq, access_hash, zeroblob(32), mac, signature FROM main.change_log ORDER BY seq DESC LIMIT 1" ;;
    other) sql="UPDATE main.change_log SET outcome = 'enabled', hash = zeroblob(32) WHERE seq = $end + 1;
        DELETE FROM main.change_log WHERE seq > $end + 1" ;;
    esac
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/whole.db" "$DB"
    start_daemon
    req GET /v1/subjects/alice
    is "$what: before" "$STATUS $(get .disabled)" "200 true"
    sqlite3 "$DB" "PRAGMA foreign_keys = OFF; ATTACH '$T/old.db' AS old; BEGIN; $sql; COMMIT" ||
        ok "$what: it can be written" false
    for path in subjects subjects/alice templates/00000000000000000000000000000000; do
        req GET "/v1/$path"
        problem "$what: $path" 503 database_refused
    done
    send POST /v1/subjects/bob/verify "$PLY" "$T/s2.ply"
    problem "$what: the erased" 503 database_refused
    req GET /readyz
    problem "$what: not ready" 503 not_ready 'not the one that was opened, or not as it was written'
    is "$what: one line in the log" \
        "$(grep -c 'level=error msg="the database is refused until the daemon is started again"' "$LOG")" 1
    sqlite3 "$DB" "PRAGMA foreign_keys = OFF; ATTACH '$T/whole.db' AS old; BEGIN; $(as_it_was); COMMIT"
    req GET /v1/subjects/alice
    problem "$what: put right, until a restart" 503 database_refused
    stop_daemon
    start_daemon
    req GET /v1/subjects/alice
    is "$what: started again" "$STATUS $(get .disabled)" "200 true"
    stop_daemon
done
finish
