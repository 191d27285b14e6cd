#!/bin/sh
# Goal: the daemon notifies a service manager when it is ready, reloads and stops, and sends
# watchdog keep-alives; SIGHUP does not end it.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
NOTES=$T/notes

# notified TITLE PATTERN: a notification matches PATTERN soon.
notified() {
    ok "$1" soon grep -Eqs -- "$2" "$NOTES"
}

# kinds: the notifications' names, repeated ones once.
kinds() {
    sed 's/[ =].*//' "$NOTES" | uniq | tr '\n' ' '
}

# ---- without a watchdog
UNDER="python3 tests/box/manager.py $NOTES" start_daemon
notified "ready, and where" "^READY=1 STATUS=listening on $URL\$"
kill -HUP "$PID"
notified "reloading, and when" '^RELOADING=1 MONOTONIC_USEC=[0-9]+$'
notified "ready again" '^READY=1$'
alive "SIGHUP"
stop_daemon
notified "stopping" '^STOPPING=1$'
is "all notifications in order" "$(kinds)" "READY RELOADING READY STOPPING "

# ---- with a watchdog
rm -f "$NOTES"
UNDER="python3 tests/box/manager.py $NOTES --watchdog 300000" start_daemon
for n in 1 2 3; do
    notified "keep-alive $n" '^WATCHDOG=1$'
    : >"$NOTES"
done
kill -HUP "$PID"
notified "reloading" '^RELOADING=1'
notified "keep-alive after the reload" '^WATCHDOG=1$'
alive "a reload"
stop_daemon
notified "stopping" '^STOPPING=1$'

# ---- a failed start sends no notification
rm -f "$NOTES"
timeout 60 python3 tests/box/manager.py "$NOTES" "$BUILD/surfaced" --db /proc/x --listen 127.0.0.1:0 \
    2>"$T/err"
is "no database" $? 1
ok "nothing was notified" test ! -s "$NOTES"
finish
