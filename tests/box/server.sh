#!/bin/sh
# Goal: a database on a PostgreSQL server: no password is said anywhere, a role without DDL is enough
# for the daemon, doctor looks at the server, the commands that work on a file say what to use
# instead, and a database moves from a file to a server and back with the same answers.
if ! ldd "${BUILD:-build}/surfaced" | grep -q libpq; then
    echo "SKIP $0: built without PostgreSQL"
    exit
fi
[ -n "${PGTLS:-}" ] || PGFSYNC=on PGTLS=1 exec scripts/with_postgres sh "$0"
. tests/box/lib.sh
needs openssl

# finds SEVERITY ABOUT PATTERN: doctor has one such finding.
finds() {
    # shellcheck disable=SC2016,SC2317 # jq's variables; ok calls it
    jq_true --arg s "$1" --arg a "$2" --arg p "$3" '[.findings[] | select(.severity == $s and
        .about == $a and (.what | test($p)))] | length == 1' "$T/ctl"
}
# what_is URL-OR-FILE: the end of its change log, its digest there, and the MACs of its rows.
what_is() {
    DB=$1 sql "SELECT lower(hex(hash)), lower(hex(digest)) FROM change_log ORDER BY seq DESC LIMIT 1"
    for table in subjects templates tokens devices calibrations; do
        DB=$1 sql "SELECT lower(hex(mac)) FROM $table ORDER BY lower(hex(mac))"
    done
}

# ---- no password
SECRET=pass-word-1
for url in "postgresql://surface:$SECRET@/x" "postgresql:///x?password=$SECRET"; do
    "$BUILD/surfacectl" --db "$url" subject list >"$T/out" 2>&1
    is "a URL with a password" $? 65
    contains "where it belongs" "$T/out" 'pgpass'
    start_fails "nor does the daemon take it" 64 pgpass --db "$url" --listen 127.0.0.1:0
    ok "nobody prints it" sh -c "! grep -q '$SECRET' '$T/out'"
done
SURFACED_KEY='' "$BUILD/surfacectl" --db "$DB" init >"$T/out" 2>&1
is "no key is named" $? 64
contains "it has to be" "$T/out" 'needs --key FILE'
"$BUILD/surfacectl" --db postgresql:///none-such stats >"$T/out" 2>&1
is "no such database" $? 75
contains "which one" "$T/out" none-such

# ---- a role that may change rows, and no tables
ANCHOR=$T/anchor
ctl_exits 0 init --anchor "$ANCHOR"
ctl_exits 0 init --anchor "$ANCHOR"
psql -X -q -d "$DB" >"$T/out" 2>&1 <<'END'
DROP ROLE IF EXISTS door;
CREATE ROLE door LOGIN;
ALTER ROLE door SET search_path = main, lib, public;
GRANT USAGE ON SCHEMA main TO door;
GRANT SELECT, INSERT, UPDATE, DELETE ON ALL TABLES IN SCHEMA main TO door;
END
door="postgresql://door@/$(basename "$T")"
scan 1 0 "$T/a0.ply"
scan 1 1 "$T/a1.ply" --pose 5 --shift 5
scan 1 5 "$T/a5.ply" --pose 5 --shift 5
scan 2 1 "$T/b1.ply" --pose 5 --shift 5
AUTH=$(new_token all --anchor "$ANCHOR")
OWNER=$DB DB=$door
SHIM=$(cd "$BUILD" && pwd)/record_shim.so
[ ! -f "$SHIM" ] || UNDER="env LD_PRELOAD=$SHIM RECORD_TRIPS=$T/trips"
mkdir "$T/later"
(sleep 1.5 && ln -s "$PGHOST/.s.PGSQL.${PGPORT:-5432}" "$T/later") &
DB="$door?host=$T/later"
start_daemon --anchor "$ANCHOR" --gallery-memory 0 # whose upkeep has no round trips then
contains "a start waits for the server" "$LOG" 'level=warn msg="the database server is waited for" reason=.*reached'
UNDER='' DB=$door
"$BUILD/surfaced" --db "$door?host=$T/none" --anchor "$ANCHOR" --listen 127.0.0.1:0 2>"$T/out" &
waits=$!
ok "another one waits" soon grep -q 'waited for' "$T/out"
kill $waits
wait $waits
is "until it is stopped" $? 1
gives 201 "enroll" send POST /v1/subjects/alice/templates "$PLY" "$T/a0.ply"
id=$(get .template_id)
verify() {
    gives 200 "verify $1" send POST "/v1/subjects/alice/verify" "$PLY" "$T/$1.ply"
    get '[.decision, .score, .threshold, .disparity_mm, .overlap, .template_id] | tojson'
}
ok "a match" matches "$(verify a1)" '^\["match",.*'"$id"
ok "a non-match" matches "$(verify b1)" '^\["no_match"'

# ---- what a request waits for
trips() {
    [ -f "$SHIM" ] || return
    n=$(grep -c '^trip;' "$T/trips")
    ok "$1: $n round trips, at most $2" test "$n" -ge 1 -a "$n" -le "$2"
}
for i in 2 3 4; do
    scan 1 $i "$T/a$i.ply" --pose 5 --shift 5
    scan $((i + 10)) 0 "$T/new$i.ply"
    : >"$T/trips"
    ok "a match" matches "$(verify a$i)" '^\["match"'
    trips "a match" $((i == 2 ? 4 : 6)) # of several templates the surface is read on its own
    : >"$T/trips"
    ok "a non-match" matches "$(verify b1)" '^\["no_match"'
    trips "a non-match" $((i == 2 ? 5 : 7))
    : >"$T/trips"
    gives 201 "enroll another" send POST "/v1/subjects/new$i/templates" "$PLY" "$T/new$i.ply"
    trips "an enrolment" 7
    : >"$T/trips"
    gives 201 "enroll again, after a comparison" send POST /v1/subjects/alice/templates "$PLY" "$T/a$i.ply"
    trips "one that is compared" 8
done
for _ in 1 2; do
    ok "a non-match" matches "$(verify b1)" '^\["no_match"'
done
: >"$T/trips"
gives "429 too_many_attempts" "locked out" send POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
trips "a refusal, with its entry" 7
ctl_exits 0 attempts reset alice
for i in 2 3 4; do
    gives 200 "erase new$i" req DELETE "/v1/subjects/new$i"
done

ctl doctor
is "doctor beside the daemon" "$CODE" 0
ok "the server" finds ok database '^PostgreSQL 1[5-9]'
ok "on this machine" finds ok network socket
ok "a commit is on the disk" finds ok server 'on its disk; no standby'
ok "no tables" finds ok role 'no tables'
ok "the daemon has it open" finds ok 'in use' '^by [1-9]'
ok "its key" finds ok key 'opens the database'
DB=$OWNER
ctl doctor
ok "the owner may do more" finds warning role 'make and drop tables'
ctl_exits 0 check-database

# ---- what works on a file
for command in "backup $T/b.db" "restore $T/b.db" "rekey --yes" vacuum; do
    # shellcheck disable=SC2086 # a command and its arguments
    ctl $command
    is "$command" "$CODE" 65
    ok "$command: what to use instead: $(said .error.detail)" matches "$(said .error.detail)" \
        'on a server: (pg_dump|restore it with|copy it into a file|its autovacuum)'
done
ok "nothing was made" test ! -e "$T/b.db"
match=$(verify a5) other=$(verify b1)
ctl accept-state --yes --anchor "$ANCHOR"
ctl_failed "accept-state beside the daemon" 75 'another process has it open'
ctl accept-state --dry-run --anchor "$ANCHOR"
is "nor a look at it" "$CODE" 75
gives 200 "the daemon goes on" req GET /readyz
stop_daemon
sql "UPDATE templates SET points = points - 1"
ctl check-database
is "a row was changed" "$CODE" 1
sql "UPDATE templates SET points = points + 1"
sql "CREATE TABLE aside.kept AS SELECT * FROM tokens; DELETE FROM tokens"
start_fails "rows are missing" 1 'not as it was written|not those of the last change' \
    --db "$DB" --anchor "$ANCHOR" --listen 127.0.0.1:0
ctl copy "$T/refused.db"
is "nor are they copied so" "$CODE" 77
ok "nothing was left" test -z "$(find "$T" -name 'refused.db*')"
sql "INSERT INTO tokens SELECT * FROM aside.kept"
ctl_exits 0 accept-state --yes --anchor "$ANCHOR"
ctl_exits 0 audit verify

# ---- over a network: the server proves its name, and the password is in a file
PASSWORD=secret-$(openssl rand -hex 8)
psql -X -q -d "$DB" -c "ALTER ROLE door PASSWORD '$PASSWORD'"
net="postgresql://door@localhost:$PGPORT/$(basename "$T")"
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=localhost \
    -addext subjectAltName=DNS:localhost -keyout "$T/other.key" -out "$T/other.crt" 2>"$T/out"
# over STATUS PATTERN URL: doctor of the database there.
over() {
    "$BUILD/surfacectl" --db "$3" --json doctor >"$T/ctl" 2>"$T/ctl.err"
    CODE=$?
    ok "$3: '$CODE $(cat "$T/ctl" "$T/ctl.err" | head -c 600)' like '$1' '$2'" \
        sh -c "[ $CODE -eq $1 ] && cat '$T/ctl' '$T/ctl.err' | grep -q '$2'"
}
export PGPASSFILE="$T/pgpass" HOME="$T"
over 1 'no password supplied' "$net?sslrootcert=$PGTLS"
echo "localhost:*:*:door:$PASSWORD" >"$PGPASSFILE"
echo "127.0.0.1:*:*:door:$PASSWORD" >>"$PGPASSFILE"
chmod 600 "$PGPASSFILE"
over 0 'encrypted by TLS' "$net?sslrootcert=$PGTLS"
over 1 'root certificate file' "$net"
over 1 'certificate verify failed' "$net?sslrootcert=$T/other.crt"
over 1 'does not match host name' "postgresql://door@127.0.0.1:$PGPORT/$(basename "$T")?sslrootcert=$PGTLS"
over 1 'is not encrypted' "$net?sslmode=disable"
DB="$net?sslrootcert=$PGTLS" start_daemon --anchor "$ANCHOR"
is "a match over the network" "$(verify a5)" "$match"
stop_daemon
ok "the password is nowhere" sh -c "! cat '$LOG' '$T/ctl' '$T/ctl.err' | grep -q '$PASSWORD'"

# ---- from the server to a file, and to another server
was=$(what_is "$DB")
ctl_exits 0 copy "$T/file.db"
is "as much as there is" "$(said '[.subjects, .templates] | tojson')" '[1,4]'
is "the file is the same database" "$(what_is "$T/file.db")" "$was"
is "nobody else may read it" "$(stat -c %a "$T/file.db")" 600
ctl copy "$T/file.db"
ctl_failed "a second time" 65 'already'
psql -X -q -d postgres -c "CREATE DATABASE \"$(basename "$T")-2\""
SECOND=postgresql:///$(basename "$T")-2
DB=$T/file.db
killed_after 0.02 --key "$KEY" copy "$SECOND"
ctl copy "$SECOND"
ok "begun again: $CODE" test "$CODE" -eq 0 -o "$(said .error.code)" = exists
is "the second server's is the same" "$(what_is "$SECOND")" "$was"
is "and this file as it was" "$(what_is "$T/file.db")" "$was"
for DB in "$T/file.db" "$SECOND"; do
    start_daemon --anchor "$ANCHOR"
    is "the same match" "$(verify a5)" "$match"
    is "the same non-match" "$(verify b1)" "$other"
    stop_daemon
    ctl_exits 0 check-database
done
"$BUILD/surfacectl" --db "$T/new.db" --key "$T/new.key" --json init >"$T/ctl"
openssl rand -hex 32 >"$T/archive.key"
chmod 600 "$T/archive.key"
ctl_exits 0 export --all -o "$T/archive" --archive-key "$T/archive.key"
DB=$T/new.db SURFACED_KEY=$T/new.key ctl_exits 0 import "$T/archive" --archive-key "$T/archive.key"
is "an archive from a server, into a file" "$(said '.added_templates // .templates')" 4
# What goes on leaves the others behind, by the anchor that they share.
AUTH='' ctl_exits 0 --anchor "$ANCHOR" token create new --scope verify
DB=$T/file.db start_fails "the copy is older now" 1 'older than its anchor' \
    --db "$T/file.db" --anchor "$ANCHOR" --listen 127.0.0.1:0
finish
