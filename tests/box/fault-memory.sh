#!/bin/sh
# Goal: a daemon whose memory runs out while it starts says so and ends; one that starts has all that
# it needs to serve requests.
. tests/box/lib.sh
if sanitized; then
    echo "SKIP $0: the preloaded library would be loaded before the sanitizer's"
    exit 0
fi

scan 1 0 "$T/a.ply" --points 1500
# try N: starts the daemon, whose N-th allocation fails.  Either it ends with a message, or it serves
# what its worker and its memory of the latest requests are needed for.
try() {
    : >"$LOG"
    FAIL_ALLOC=$1 LD_PRELOAD=$BUILD/alloc_shim.so \
        "$BUILD/surfaced" --db "$DB" --no-auth --listen 127.0.0.1:0 2>"$LOG" &
    PID=$!
    soon sh -c "grep -q 'listening on' '$LOG' || ! kill -0 $PID 2>/dev/null"
    URL=$(sed -n 's/.*listening on \([^"]*\)".*/\1/p' "$LOG")
    if [ -z "$URL" ]; then
        wait "$PID"
        status=$?
        ok "allocation $1: exit status $status" matches $status '^(1|64)$'
        PID=
        contains "allocation $1" "$LOG" '^surfaced: .*(memory|worker)'
        ended=$((ended + 1))
        return
    fi
    send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
    # the last of those counted may be the first connection's own
    if [ "$STATUS" = 000 ]; then
        lost=$((lost + 1))
        send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
    fi
    ok "allocation $1: an enrolment: got '$STATUS'" matches "$STATUS" '^20[01]$'
    req GET /v1/recent
    is "allocation $1: the latest requests" "$STATUS $(get '.recent | length')" '200 1'
    stop_daemon
}

ctl_exits 0 init
FAIL_ALLOC_COUNT=$T/count UNDER="env LD_PRELOAD=$BUILD/alloc_shim.so" start_daemon --no-auth
stop_daemon
n=1 ended=0 lost=0
while [ "$n" -le "$(cat "$T/count")" ]; do
    try "$n"
    n=$((n + 1))
done
ok "at most one connection had none: $lost" test "$lost" -le 1
ok "$ended starts of $((n - 1)) ended" test "$ended" -gt 10
finish
