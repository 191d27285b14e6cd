#!/bin/sh
# Goal: an attacker who can write the database file and has older copies of it, but no key, gets
# nothing back: no revoked token, no subject that is enabled again, no deleted template, nobody
# who was erased; and cannot remove, copy or move rows, or cut the audit log, unnoticed.  With
# the daemon stopped and while it runs.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# people: alice is disabled, two templates of hers, one deleted since; bob was erased; the token
# "lost" was revoked.  $T/old.db is from before all that.
for i in 1 2 3; do
    scan "$i" 0 "$T/s$i.ply"
    scan "$i" 1 "$T/p$i.ply"
done
ctl init
ctl token create door --scope "$ALL"
AUTH=$(said .token)
ctl token create lost --scope "$ALL"
LOST=$(said .token) LOST_ID=$(said .id)
ctl enroll alice "$T/s1.ply"
kept=$(said '.templates[0].template_id')
ctl enroll alice "$T/s2.ply" --force
gone=$(said '.templates[0].template_id')
ctl enroll carol "$T/s3.ply"
ctl enroll bob "$T/s3.ply"
bobs=$(said '.templates[0].template_id')
sqlite3 "$DB" "VACUUM INTO '$T/old.db'"
ctl token revoke "$LOST_ID"
ctl subject disable alice
is "disabled" "$CODE" 0
ctl template delete "$gone" --yes
ctl subject erase bob --yes
ctl audit verify
is "all as it was written" "$CODE $(said .ok)" "0 true"
sqlite3 "$DB" "PRAGMA wal_checkpoint(TRUNCATE)" >"$T/out"
cp "$DB" "$T/whole.db"
cp "$DB.key.anchor" "$T/anchor"

# back: as it was, and no daemon
back() {
    [ -z "$PID" ] || kill -9 "$PID"
    [ -z "$PID" ] || wait "$PID" 2>"$T/out"
    PID=''
    rm -f "$DB-wal" "$DB-shm"
    cp "$T/whole.db" "$DB"
    # The anchor may be newer than this copy by what daemons wrote meanwhile.
    [ ! -e "$T/anchor" ] || cp "$T/anchor" "$DB.key.anchor"
}

# safe TITLE: what must not be had is not had.
safe() {
    s_was=$AUTH
    AUTH=$LOST
    req GET /v1/subjects/carol
    ok "$1: the revoked token" [ "$STATUS" != 200 ]
    AUTH=$s_was
    send POST /v1/subjects/alice/verify "$PLY" "$T/p1.ply"
    ok "$1: alice, disabled" [ "$STATUS" != 200 ]
    req GET "/v1/templates/$gone"
    ok "$1: the deleted template" [ "$STATUS" != 200 ]
    req GET "/v1/templates/$bobs"
    ok "$1: a template of the erased" [ "$STATUS" != 200 ]
    send POST /v1/subjects/bob/verify "$PLY" "$T/p3.ply"
    ok "$1: the erased" [ "$STATUS" != 200 ]
}

# attack TITLE SQL: with the daemon running, and stopped.
attack() {
    back
    start_daemon
    sqlite3 "$DB" "ATTACH '$T/old.db' AS old; $2" || ok "$1: it can be written" false
    safe "$1, running"
    back
    sqlite3 "$DB" "ATTACH '$T/old.db' AS old; $2"
    ctl audit verify
    is "$1: audit verify" "$CODE $(said .ok)" "1 false"
    ctl check
    ok "$1: check" [ "$CODE" != 0 ]
    ctl doctor
    ok "$1: doctor" jq_true '.findings[] | select(.about == "state" and .level == "trouble")' "$T/ctl"
    ctl backup "$T/backup"
    is "$1: no backup of it" "$CODE" 65
    start_daemon
    safe "$1, before the start"
    ok "$1: the log says so" grep -q 'the database is not what was written' "$T/log"
}

attack "token" "DELETE FROM main.tokens; INSERT INTO main.tokens SELECT * FROM old.tokens"
attack "a column of a token" "UPDATE tokens SET revoked = NULL"
attack "subject" "DELETE FROM main.subjects WHERE subject_key = 1;
    INSERT INTO main.subjects SELECT * FROM old.subjects WHERE subject_key = 1"
attack "template" "INSERT INTO main.templates SELECT * FROM old.templates WHERE id = '$gone'"
attack "the erased" "INSERT INTO main.subjects SELECT * FROM old.subjects
        WHERE uid NOT IN (SELECT uid FROM main.subjects);
    INSERT INTO main.templates SELECT * FROM old.templates WHERE id = '$bobs'"
attack "a template of another" "UPDATE templates SET subject_key =
    (SELECT subject_key FROM subjects ORDER BY subject_key LIMIT 1)"
attack "removed" "DELETE FROM subjects WHERE subject_key = 1"
attack "twice" "INSERT INTO templates SELECT 99, '0123456789abcdef0123456789abcdef', subject_key,
    zeroblob(32), created, engine, points, triangles, about, model FROM templates LIMIT 1"

# ---- removed: not 404
back
start_daemon
sqlite3 "$DB" "DELETE FROM subjects WHERE subject_key = 1"
req GET /v1/subjects/alice
is "who is missing was not erased" "$STATUS" 500
sqlite3 "$DB" "UPDATE events SET row_mac = x'' WHERE kind = 'disable_subject'"
req GET /v1/subjects/alice
is "nor when the log says so now" "$STATUS" 500
req GET "/v1/templates/$kept"
is "nor the template deleted" "$STATUS" 500
req GET /v1/subjects/nobody
is "nobody is nobody" "$STATUS" 404
req GET /v1/subjects/bob
is "the erased are" "$STATUS" 404

# ---- tables that put something into rows by themselves: another's secret into a new token
guess=$(printf '%064d' 7)
hash=$(printf %s "$guess" | b2sum -l 256 | cut -d' ' -f1)
for at in rest work; do
    back
    [ "$at" = rest ] || start_daemon
    sqlite3 "$DB" "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET
        sql = replace(replace(sql, 'old_hash  BLOB', 'old_hash  BLOB DEFAULT x''$hash'''),
        'old_until TEXT', 'old_until TEXT DEFAULT ''2099-01-01T00:00:00.000Z''')
        WHERE name = 'tokens'"
    is "altered tables, at $at" "$(sqlite3 "$DB" .schema | grep -c 2099)" 1
    ctl token create admin --scope "$ALL"
    is "altered tables, at $at: a new token" "$CODE" 77
    contains "altered tables, at $at" "$T/ctl.err" 'tables are not those of this program'
    ctl check
    contains "altered tables, at $at: check" "$T/ctl" 'the tables are not those of this program'
    if [ "$at" = work ]; then
        AUTH=$guess req GET /v1/subjects
        is "altered tables, at $at: the secret" "$STATUS" 401
        stop_daemon
    fi
    start_fails "altered tables, at $at" 1 'tables are not those of this program' \
        --db "$DB" --listen 127.0.0.1:0
done

# ---- a template that is missing from a subject's list; a token that is there twice, the same:
# its table is altered, so that nothing is written any more
for what in missing twice; do
    back
    scan 3 2 "$T/again.ply"
    ctl enroll carol "$T/again.ply"
    second=$(said '.templates[0].template_id')
    start_daemon
    case $what in
    missing)
        wanted='500 null'
        sqlite3 "$DB" "DELETE FROM templates WHERE id = '$second'"
        req GET "/v1/templates/$second"
        is "$what: asked for by its id" "$STATUS" 500
        ctl verify carol "$T/p3.ply"
        is "$what: by the command" "$CODE" 65
        ;;
    twice)
        wanted='503 null'
        sqlite3 "$DB" "PRAGMA foreign_keys = OFF; CREATE TABLE twin AS SELECT * FROM tokens;
            DROP TABLE tokens; ALTER TABLE twin RENAME TO tokens;
            INSERT INTO tokens SELECT * FROM tokens"
        ;;
    esac
    send POST /v1/subjects/carol/verify "$PLY" "$T/p3.ply"
    is "$what: a verification" "$STATUS $(get .templates_compared)" "$wanted"
    ctl check
    ok "$what: check" [ "$CODE" != 0 ]
    ctl audit verify
    is "$what: audit verify" "$CODE $(said .ok)" "1 false"
    stop_daemon
    if [ "$what" = missing ]; then
        start_daemon
        ok "$what: the log of the start" grep -q 'the database is not what was written' "$T/log"
    else
        start_fails "$what: the start" 1 'tables are not those of this program' \
            --db "$DB" --listen 127.0.0.1:0
    fi
done

# ---- with the entries that tell of it: the daemon does not start
back
sqlite3 "$DB" "ATTACH '$T/old.db' AS old; DELETE FROM main.tokens;
    INSERT INTO main.tokens SELECT * FROM old.tokens; DELETE FROM main.events
    WHERE kind = 'revoke_token'"
ctl audit verify
is "an entry removed" "$CODE $(said .first_chain)" "1 changes"
start_fails "an entry removed" 1 'the audit log of changes is not what was written' \
    --db "$DB" --listen 127.0.0.1:0

# ---- the same under a running daemon, which knows what it has seen
for what in token subject template; do
    case $what in
    token) sql="DELETE FROM main.tokens; INSERT INTO main.tokens SELECT * FROM old.tokens;
        DELETE FROM main.events WHERE kind = 'revoke_token'" ;;
    subject) sql="DELETE FROM main.subjects; INSERT INTO main.subjects SELECT * FROM old.subjects;
        DELETE FROM main.events WHERE kind IN ('disable_subject', 'delete_subject')" ;;
    template) sql="DELETE FROM main.templates; INSERT INTO main.templates
        SELECT * FROM old.templates WHERE subject_key = 1;
        DELETE FROM main.events WHERE kind = 'delete_template'" ;;
    esac
    back
    start_daemon
    sqlite3 "$DB" "PRAGMA foreign_keys = OFF; ATTACH '$T/old.db' AS old; $sql" ||
        ok "$what and its entry: it can be written" false
    safe "$what and its entry"
    # What was done while it runs is known to it too.
    back
    start_daemon
    ctl subject enable alice
    ctl subject disable alice
    req GET /v1/subjects/alice
    is "$what: disabled again" "$(get .disabled)" true
    sqlite3 "$DB" "ATTACH '$T/old.db' AS old; UPDATE main.subjects SET disabled = 0,
        about = (SELECT about FROM old.subjects o WHERE o.uid = main.subjects.uid)
        WHERE subject_key = 1; DELETE FROM main.events WHERE kind = 'disable_subject'"
    safe "$what: disabled again"
done

# ---- older rows, and the entries that left them: copied behind the end of a running daemon's log,
# instead of what the later ones say, or instead of its last entry
columns="at, kind, actor, subject, template_id, outcome, object, row_mac, uses, uses_hash, hash"
for what in copied changed last; do
    case $what in
    copied) sql="INSERT INTO main.events SELECT 1000 + event_key, chain, row_number() OVER
            (ORDER BY seq) + (SELECT max(seq) FROM main.events WHERE chain = 0), $columns
        FROM main.events WHERE chain = 0 AND object IN (SELECT object FROM main.events
            WHERE kind IN ('revoke_token', 'disable_subject', 'delete_template', 'delete_subject'))
        AND seq <= (SELECT max(seq) FROM old.events WHERE chain = 0)" ;;
    changed) sql="UPDATE main.events SET row_mac = (SELECT row_mac FROM old.events o
            WHERE o.object = main.events.object ORDER BY seq DESC LIMIT 1)
        WHERE kind IN ('revoke_token', 'disable_subject', 'delete_template', 'delete_subject')" ;;
    last) sql="UPDATE main.events SET (object, row_mac) = (SELECT object, row_mac FROM main.events
            WHERE kind = 'create_token' ORDER BY seq DESC LIMIT 1)
        WHERE chain = 0 AND seq = (SELECT seq FROM events_end WHERE chain = 0)" ;;
    esac
    back
    start_daemon
    sqlite3 "$DB" "PRAGMA foreign_keys = OFF; ATTACH '$T/old.db' AS old; BEGIN; $sql;
        DELETE FROM main.tokens; INSERT INTO main.tokens SELECT * FROM old.tokens;
        DELETE FROM main.subjects; INSERT INTO main.subjects SELECT * FROM old.subjects;
        DELETE FROM main.templates; INSERT INTO main.templates SELECT * FROM old.templates;
        COMMIT" || ok "$what: it can be written" false
    safe "entries $what"
done

# ---- the whole file, or the audit log's end, under a running daemon: 503 until it is started again
for what in file end; do
    back
    start_daemon
    req GET /v1/subjects/carol
    is "$what: before" "$STATUS" 200
    if [ $what = file ]; then
        tables=$(sqlite3 "$DB" "SELECT name FROM sqlite_schema WHERE type = 'table'
            AND name NOT LIKE 'sqlite_%'")
        { echo "PRAGMA foreign_keys = OFF; ATTACH '$T/old.db' AS old; BEGIN;"
            for table in $tables; do
                echo "DELETE FROM main.$table; INSERT INTO main.$table SELECT * FROM old.$table;"
            done
            echo "COMMIT;"; } | sqlite3 "$DB"
    else
        sqlite3 "$DB" "ATTACH '$T/old.db' AS old; DELETE FROM main.events_end;
            INSERT INTO main.events_end SELECT * FROM old.events_end;
            DELETE FROM main.events WHERE event_key > (SELECT max(event_key) FROM old.events)"
    fi
    for route in subjects subjects/carol "templates/$kept"; do
        req GET "/v1/$route"
        is "$what: $route" "$STATUS $(get .code)" "503 database_refused"
    done
    safe "$what"
    req GET /readyz
    is "$what: readyz" "$STATUS" 503
    is "$what: one line in the log" "$(grep -c 'is refused until' "$T/log")" 1
    cp "$T/whole.db" "$T/again.db"
    sqlite3 "$DB" "ATTACH '$T/again.db' AS new; DELETE FROM main.events_end;
        INSERT INTO main.events_end SELECT * FROM new.events_end"
    req GET /v1/subjects/carol
    is "$what: until a restart" "$STATUS" 503
done
back
start_daemon
req GET /v1/subjects/carol
is "all is well with the database as it was" "$STATUS" 200
stop_daemon
finish
