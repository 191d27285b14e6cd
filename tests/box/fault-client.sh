#!/bin/sh
# Goal: without free descriptors, and with clients that close their half of the
# connection, the daemon responds where it can and works as before afterwards.
. tests/box/lib.sh

scan 1 0 "$T/a.ply" --points 1500
scan 1 1 "$T/p.ply" --points 1500
start_daemon --no-auth --workers 2 --timeout 3
gives 201 "enrolled" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"

# ---- a client that half-closes after its request gets the response
if command -v nc >/dev/null 2>&1 && nc -h 2>&1 | grep -q -- ' *-N'; then
    port=${URL##*:}
    # half REQUEST-FILE: is sent, then its half is closed; the response is in $T/answer.
    half() {
        timeout 60 nc -N 127.0.0.1 "$port" <"$1" >"$T/answer" 2>/dev/null
        STATUS=$(sed -n '1s/^HTTP\/1.1 \([0-9]*\).*/\1/p' "$T/answer")
    }
    printf 'GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n' >"$T/q"
    half "$T/q"
    is "half-closed after a GET" "$STATUS" 200
    for n in 1 2 3 4 5; do
        {
            printf 'POST /v1/subjects/alice/verify HTTP/1.1\r\nHost: localhost\r\n'
            printf '%s\r\nContent-Length: %d\r\n\r\n' "$PLY" "$(wc -c <"$T/p.ply")"
            cat "$T/p.ply"
        } >"$T/q"
        half "$T/q"
        is "half-closed after a scan ($n)" "$STATUS" 200
        ok "its response ($n)" grep -q '"decision":"match"' "$T/answer"
    done
    # Half a body is no request that could be responded to.
    head -c 2000 "$T/q" >"$T/half"
    half "$T/half"
    ok "half a body ($STATUS)" test "$STATUS" != 200
    printf 'GET /heal' >"$T/half"
    half "$T/half"
    ok "half a line ($STATUS)" test "$STATUS" != 200
    alive "clients that half-close"
else
    echo "SKIP half-closing: no nc with -N (Debian: netcat-openbsd)"
fi

# ---- no descriptor left
stop_daemon
start_daemon --no-auth --workers 2
used=$(find "/proc/$PID/fd" -mindepth 1 | wc -l)
prlimit --pid "$PID" --nofile="$((used + 6)):"
clients=
for n in $(seq 20); do # more connections than can be opened, held for as long as it takes
    curl -sS -m 60 --limit-rate 10 -o /dev/null -H "$PLY" --data-binary "@$T/p.ply" \
        "$URL/v1/subjects/alice/verify" 2>/dev/null &
    clients="$clients $!"
done
tries=0
until [ "$(find "/proc/$PID/fd" -mindepth 1 | wc -l)" -ge $((used + 5)) ] || [ "$tries" -ge 100 ]; do
    tries=$((tries + 1))
    sleep 0.1
done
req GET /healthz -m 3
ok "no descriptor: no response, or a right one ($STATUS)" matches "$STATUS" '^(000|200|503)$'
ok "it is still there" kill -0 "$PID"
# shellcheck disable=SC2086 # a list
kill $clients 2>/dev/null
# shellcheck disable=SC2086 # a list
wait $clients 2>/dev/null
tries=0
STATUS=
until [ "$STATUS" = 200 ] || [ "$tries" -ge 100 ]; do
    req GET /healthz
    tries=$((tries + 1))
    [ "$STATUS" = 200 ] || sleep 0.1
done
alive "no descriptors"
send POST /v1/subjects/alice/verify "$PLY" "$T/p.ply"
is "verifying afterwards" "$STATUS $(get .decision)" "200 match"
stop_daemon

# A database that cannot be opened another time for want of descriptors: 503, not 500.
start_daemon --no-auth --workers 1
used=$(find "/proc/$PID/fd" -mindepth 1 | wc -l)
prlimit --pid "$PID" --nofile="$((used + 1)):" # the connection itself
for n in 1 2 3; do
    send POST "/v1/subjects/bob/templates" "$PLY" "$T/a.ply"
    ok "one descriptor: $STATUS" matches "$STATUS" '^(200|201|503)$'
    [ "$STATUS" != 503 ] || again "when" 1
done
prlimit --pid "$PID" --nofile=1024:
send POST "/v1/subjects/bob/templates" "$PLY" "$T/a.ply"
ok "enough again: $STATUS" matches "$STATUS" '^20[01]$'
finish
