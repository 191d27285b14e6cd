#!/bin/sh
# check_statements.sh: every statement of the store was prepared by a test, and PostgreSQL can
# prepare it too, against tables of its own (db/sql/schema_postgres.sql).  After `make check`,
# whose programs add what they prepare to $BUILD/log/statements (tests/box/record_shim.c).
# Skipped where PostgreSQL 15 is not installed, but not with CI=true.
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build}
bin=/usr/lib/postgresql/15/bin
least=60 # statements: there are some more
dir=$(mktemp -d)
trap 'stop; rm -rf "$dir"' EXIT
trap 'exit 1' INT TERM

# It refuses to run as root.
as_user() {
    if [ "$(id -u)" -eq 0 ]; then runuser -u nobody -- "$@"; else "$@"; fi
}

stop() {
    [ ! -f "$dir/data/postmaster.pid" ] ||
        as_user "$bin/pg_ctl" -D "$dir/data" -m immediate stop >/dev/null 2>&1
}

fail() {
    echo "check_statements: $*"
    exit 1
}

# ---- which there are, and which were prepared
for room in db rows log admin; do strings -n 8 "$BUILD/lib$room.a"; done |
    grep -E '^(SELECT|INSERT|UPDATE|DELETE|WITH) ' | LC_ALL=C sort -u >"$dir/written"
[ -s "$BUILD/log/statements" ] || fail "no test has recorded a statement: make check"
# Not those with a quoted 'main': a module of SQLite's that an attacker's schema names prepares them.
sed -n "/'main'\./d; s/;\$//p" "$BUILD/log/statements" | LC_ALL=C sort -u >"$dir/prepared"
n=$(wc -l <"$dir/written")
[ "$n" -ge "$least" ] || fail "only $n statements in the libraries of $BUILD"
LC_ALL=C comm -23 "$dir/written" "$dir/prepared" >"$dir/never"
[ ! -s "$dir/never" ] || fail "prepared by no test:
$(cat "$dir/never")"

# ---- PostgreSQL
if [ ! -x "$bin/postgres" ]; then
    [ "${CI:-}" != true ] || fail "$bin/postgres is not installed"
    echo "SKIP statements: PostgreSQL 15 is not installed"
    exit 0
fi
chmod 711 "$dir"
as_user true || fail "no user to run PostgreSQL as"
[ "$(id -u)" -ne 0 ] || chown nobody "$dir"
start_postgres() {
    as_user "$bin/initdb" -D "$dir/data" -U surface --locale=C -E UTF8 -A trust &&
        as_user "$bin/pg_ctl" -D "$dir/data" -w -l "$dir/data/log" \
            -o "-c listen_addresses= -c unix_socket_directories=$dir -c fsync=off" start
}

start_postgres >"$dir/log" 2>&1 || fail "PostgreSQL does not start:
$(cat "$dir/log")"
sql() {
    "$bin/psql" -X -q -h "$dir" -U surface -d postgres "$@" 2>&1
}

sql -v ON_ERROR_STOP=1 -f db/sql/schema_postgres.sql || fail "its tables cannot be made"
awk '{ print "PREPARE s" NR " AS " $0 ";" }' "$dir/prepared" >"$dir/prepare.sql"
sql -f "$dir/prepare.sql" >"$dir/said"
sed 's/^psql:[^:]*://' "$dir/said"
[ ! -s "$dir/said" ] || fail "PostgreSQL does not prepare them all"
echo "$(wc -l <"$dir/prepared") statements, as PostgreSQL prepares them too"
