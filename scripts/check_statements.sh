#!/bin/sh
# check_statements.sh: every statement of the store was prepared by a test, and PostgreSQL can
# prepare it too, against tables of its own (schema_postgres.sed).  After `make check`,
# whose programs add the statements that they prepare to $BUILD/log/statements (tests/box/record_shim.c).
# Skipped if PostgreSQL 15 is not installed; with CI=true that is a failure.
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build}
least=60 # statements: there are some more
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' INT TERM

fail() {
    echo "check_statements: $*"
    exit 1
}

# ---- which there are, and which were prepared
for room in db rows log admin; do strings -n 8 "$BUILD/lib$room.a"; done |
    grep -E '^(SELECT|INSERT|UPDATE|DELETE|WITH) ' |
    grep -v "^SELECT current_setting('server_version')" | # which is for a server alone
    LC_ALL=C sort -u >"$dir/written"
[ -s "$BUILD/log/statements" ] || fail "no test has recorded a statement: make check"
# Not those with a quoted 'main': a module of SQLite's that an attacker's schema names prepares them.
sed -n "/'main'\./d; s/;\$//p" "$BUILD/log/statements" | LC_ALL=C sort -u >"$dir/prepared"
n=$(wc -l <"$dir/written")
[ "$n" -ge "$least" ] || fail "only $n statements in the libraries of $BUILD"
LC_ALL=C comm -23 "$dir/written" "$dir/prepared" >"$dir/never"
[ ! -s "$dir/never" ] || fail "prepared by no test:
$(cat "$dir/never")"

# ---- PostgreSQL
awk '{ print "PREPARE s" NR " AS " $0 ";" }' "$dir/prepared" >"$dir/prepare.sql"
# shellcheck disable=SC2016 # a command for another shell
scripts/with_postgres sh -c 'psql -X -q -v ON_ERROR_STOP=1 -f "$1" -f "$2"' \
    sh "$BUILD/gen/schema_postgres.sql" "$dir/prepare.sql" >"$dir/said" 2>&1
st=$?
sed 's/^psql:[^:]*://' "$dir/said"
[ "$st" -eq 0 ] || fail "PostgreSQL does not prepare them all"
grep -q ^SKIP "$dir/said" ||
    echo "$(wc -l <"$dir/prepared") statements, as PostgreSQL prepares them too"
