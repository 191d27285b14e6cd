#!/bin/sh
# Goal: a PostgreSQL that falls silent holds nothing up for longer than a stated time: a command ends with
# exit status 75, and the daemon serves the next request.
if ! ldd "${BUILD:-build}/surfaced" | grep -q libpq; then
    echo "SKIP $0: built without PostgreSQL"
    exit
fi
[ -n "${PGHOST:-}" ] || exec scripts/with_postgres sh "$0"
. tests/box/lib.sh
needs faketime

# proxy ACTION WORD: DB is the database by way of a server_proxy.py, which acts once there is $T/armed.
DIRECT=$DB
proxy() {
    mkdir "$T/$1"
    python3 tests/box/server_proxy.py "$T/$1" "$PGHOST" "$1" "$2" "$T/armed" &
    proxies="${proxies:-} $!"
    DB="$DIRECT?host=$T/$1"
    ok "the proxy listens" soon test -S "$T/$1/.s.PGSQL.${PGPORT:-5432}"
}
trap 'kill $proxies 2>/dev/null; cleanup' EXIT

ctl_exits 0 init

# ---- while a connection is set up
proxy mute pg_advisory_lock_shared
ctl_exits 0 subject list
: >"$T/armed"
begin=$(date +%s)
ctl subject list
took=$(($(date +%s) - begin))
ctl_failed "silent as a connection is set up" 75 'did not answer within 10 s'
ok "it was silent" test ! -e "$T/armed"
ok "the command took $took s, at least 9 and at most 15" test "$took" -ge 9 -a "$took" -le 15
ctl_exits 0 subject list

# ---- amid a commit
proxy cut COMMIT
: >"$T/armed"
AUTH=$(new_token all)
ok "its reply was lost" test ! -e "$T/armed"
is "it was done, and once" "$(sql 'SELECT count(*) FROM tokens')" 1

# ---- for longer than a transaction may be idle, while the daemon verifies the rows
proxy hold 'NO SCROLL CURSOR'
psql -X -q -d "$DIRECT" -c "ALTER DATABASE \"${DIRECT##*/}\" SET idle_in_transaction_session_timeout = 500"
if ! sanitized; then
    UNDER="env LD_PRELOAD=$(faketime -f +0 printenv LD_PRELOAD)"
    export FAKETIME='+0 x20' # the rows are verified once a minute
    start_daemon
    gives 200 "before" req GET /v1/subjects
    : >"$T/armed"
    ok "the rows are verified again" soon test ! -e "$T/armed"
    sleep 1.2
    for i in 1 2 3; do
        gives 200 "request $i after it" req GET /v1/subjects
    done
fi
finish
