#!/bin/sh
# Goal: options are parsed strictly; the daemon does not listen if one is wrong, or if it cannot
# open the database or bind the address.
. tests/box/lib.sh

# ---- options
start_fails "no database" 64 '--db'
start_fails "an unknown option" 64 '--unknown' --db "$DB" --unknown
start_fails "a word" 64 'word' --db "$DB" word
start_fails "a missing value" 64 'missing' --db
start_fails "an option twice" 64 '--db is given twice' --db "$DB" --db "$DB"
start_fails "a flag twice" 64 'twice' --db "$DB" --no-auth --no-auth
for n in 0 -1 1x 257 '' 99999999999999999999; do
    start_fails "--workers '$n'" 64 '--workers .*from 1 to' --db "$DB" --workers "$n"
done
for n in 0 1073741825 1k; do
    start_fails "--max-body $n" 64 '--max-body' --db "$DB" --max-body "$n"
done
start_fails "--queue 0" 64 '--queue' --db "$DB" --queue 0
for a in 8787 127.0.0.1 127.0.0.1: 127.0.0.1:65536 127.0.0.1:x :1 '[::1' '[::1]' \
    example.org:1 1.2.3:1; do
    start_fails "--listen $a" 64 'not an address' --db "$DB" --listen "$a"
done
for a in 0.0.0.0:0 192.0.2.1:0 '[::]:0' '[2001:db8::1]:0'; do
    start_fails "--listen $a" 64 'loopback' --db "$DB" --listen "$a"
    start_fails "--no-auth --listen $a" 64 '--no-auth' --db "$DB" --no-auth --listen "$a"
done
SURFACED_NO_AUTH=yes start_fails "SURFACED_NO_AUTH=yes" 64 'SURFACED_NO_AUTH' --db "$DB"
SURFACED_WORKERS=x start_fails "SURFACED_WORKERS=x" 64 'SURFACED_WORKERS=x: not a number' --db "$DB"
ok "no database was made" test ! -e "$DB"
timeout 5 "$BUILD/surfaced" --help >"$T/out"
is "--help" $? 0
ok "--help names the options" grep -q -- --max-body "$T/out"
timeout 5 "$BUILD/surfaced" --version >"$T/out"
is "--version" $? 0
: >"$T/readonly.db"
chmod 444 "$T/readonly.db"
if [ "$(id -u)" -ne 0 ]; then
    start_fails "an unwritable database" 1 'readonly.db' --db "$T/readonly.db" --listen 127.0.0.1:0
fi
start_fails "an unwritable place" 1 '/proc/' --db /proc/surfaced.db --listen 127.0.0.1:0

# ---- the environment, and an option that overrides it
SURFACED_NO_AUTH=1 SURFACED_WORKERS=3 SURFACED_QUEUE=9 start_daemon --queue 7
ok "the environment sets options" grep -q 'workers=3 queue=7 .*auth=none' "$LOG"
ok "only its owner can read the database" test "$(stat -c %a "$DB")" = 600
port=${URL##*:}
start_fails "a busy port" 1 'cannot listen.*in use' --create --db "$T/other.db" \
    --listen "127.0.0.1:$port"
stop_daemon
# Not every machine has IPv6.
if [ -e /proc/net/if_inet6 ] && grep -q '^0*1 ' /proc/net/if_inet6; then
    LISTEN='[::1]:0' start_daemon --no-auth
    req GET /healthz -g
    is "IPv6 ($URL)" "$STATUS" 200
    stop_daemon
else
    echo "SKIP: no IPv6 on the loopback interface"
fi
finish
