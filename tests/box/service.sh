#!/bin/sh
# Goal: a service manager is told when the daemon is ready, reloads and stops, and that it is
# well, again and again; SIGHUP does not end it.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
NOTES=$T/notes

# noted PATTERN: comes to be in the notes within some seconds.
# shellcheck disable=SC2317 # called by ok
noted() {
    tries=0
    until grep -Eq -- "$1" "$NOTES" 2>/dev/null; do
        tries=$((tries + 1))
        [ "$tries" -lt 100 ] || return 1
        sleep 0.1
    done
}

# kinds: the notes' first words, each once where it is repeated.
kinds() {
    sed 's/[ =].*//' "$NOTES" | uniq | tr '\n' ' '
}

# ---- without a watchdog
UNDER="$BUILD/service $NOTES" start_daemon
ok "ready, and where" noted "^READY=1 STATUS=listening on $URL\$"
kill -HUP "$PID"
ok "reloading, and when" noted '^RELOADING=1 MONOTONIC_USEC=[0-9]+$'
ok "ready again" noted '^READY=1$'
alive "SIGHUP"
stop_daemon
ok "stopping" noted '^STOPPING=1$'
is "all notes in order" "$(kinds)" "READY RELOADING READY STOPPING "

# ---- with one
rm -f "$NOTES"
UNDER="$BUILD/service $NOTES --watchdog 300000" start_daemon
for n in 1 2 3; do
    ok "the watchdog is told ($n)" noted '^WATCHDOG=1$'
    : >"$NOTES"
done
kill -HUP "$PID"
ok "reloading" noted '^RELOADING=1'
ok "and the watchdog after it" noted '^WATCHDOG=1$'
alive "a reload"
stop_daemon
ok "stopping" noted '^STOPPING=1$'

# ---- what cannot start is not ready
rm -f "$NOTES"
timeout 20 "$BUILD/service" "$NOTES" "$BUILD/surfaced" --db /proc/x --listen 127.0.0.1:0 \
    2>"$T/err"
is "no database" $? 1
ok "nothing was notified" test ! -s "$NOTES"
finish
