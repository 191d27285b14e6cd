#!/bin/sh
# Goal: options are read strictly, and nothing listens when one is wrong or the database or
# the address cannot be had.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# ---- options: refuse TITLE STATUS PATTERN OPTION...
refuse() {
    r_title=$1 r_status=$2 r_pattern=$3
    shift 3
    timeout 20 "$BUILD/surfaced" "$@" >"$T/out" 2>&1
    is "$r_title: exit status" $? "$r_status"
    ok "$r_title: '$(head -n 1 "$T/out")' like '$r_pattern'" grep -Eq -- "$r_pattern" "$T/out"
    ok "$r_title: does not listen" sh -c "! grep -q listening '$T/out'"
}
refuse "no database" 2 '--db'
refuse "an unknown option" 2 '--unknown' --db "$DB" --unknown
refuse "a word" 2 'word' --db "$DB" word
refuse "a missing value" 2 'missing' --db
refuse "an option twice" 2 '--db is given twice' --db "$DB" --db "$DB"
refuse "a flag twice" 2 'twice' --db "$DB" --no-auth --no-auth
for n in 0 -1 1x 257 '' 99999999999999999999; do
    refuse "--workers '$n'" 2 '--workers .*from 1 to' --db "$DB" --workers "$n"
done
for n in 0 1073741825 1k; do
    refuse "--max-body $n" 2 '--max-body' --db "$DB" --max-body "$n"
done
refuse "--queue 0" 2 '--queue' --db "$DB" --queue 0
for a in 8787 127.0.0.1 127.0.0.1: 127.0.0.1:65536 127.0.0.1:x :1 '[::1' '[::1]' \
    example.org:1 1.2.3:1; do
    refuse "--listen $a" 2 'not an address' --db "$DB" --listen "$a"
done
for a in 0.0.0.0:0 192.0.2.1:0 '[::]:0' '[2001:db8::1]:0'; do
    refuse "--listen $a" 2 'loopback' --db "$DB" --listen "$a"
    refuse "--no-auth --listen $a" 2 '--no-auth' --db "$DB" --no-auth --listen "$a"
done
SURFACED_NO_AUTH=yes refuse "SURFACED_NO_AUTH=yes" 2 'SURFACED_NO_AUTH' --db "$DB"
SURFACED_WORKERS=x refuse "SURFACED_WORKERS=x" 2 'SURFACED_WORKERS=x: not a number' --db "$DB"
ok "no database was made" test ! -e "$DB"
timeout 5 "$BUILD/surfaced" --help >"$T/out"
is "--help" $? 0
ok "--help names the options" grep -q -- --max-body "$T/out"
timeout 5 "$BUILD/surfaced" --version >"$T/out"
is "--version" $? 0
: >"$T/readonly.db"
chmod 444 "$T/readonly.db"
if [ "$(id -u)" -ne 0 ]; then
    refuse "an unwritable database" 1 'readonly.db' --db "$T/readonly.db" --listen 127.0.0.1:0
fi
refuse "an unwritable place" 1 '/proc/' --db /proc/surfaced.db --listen 127.0.0.1:0

# ---- the environment, and an option that wins over it
SURFACED_NO_AUTH=1 SURFACED_WORKERS=3 SURFACED_QUEUE=9 start_daemon --queue 7
ok "the environment counts" grep -q 'workers=3 queue=7 .*auth=none' "$LOG"
ok "the database is its owner's alone" test "$(stat -c %a "$DB")" = 600
port=${URL##*:}
refuse "a busy port" 1 'cannot listen.*in use' --db "$T/other.db" --listen "127.0.0.1:$port"
stop_daemon
# Not on every machine is there IPv6.
if [ -e /proc/net/if_inet6 ] && grep -q '^0*1 ' /proc/net/if_inet6; then
    "$BUILD/surfaced" --db "$DB" --no-auth --listen '[::1]:0' 2>"$T/log6" &
    PID=$!
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        grep -q listening "$T/log6" && break
        sleep 0.3
    done
    URL=$(sed -n 's/.*listening on \(http[^"]*\)".*/\1/p' "$T/log6")
    req GET /healthz -g
    is "IPv6 ($URL)" "$STATUS" 200
    stop_daemon
else
    echo "SKIP: no IPv6 on the loopback interface"
fi
finish
