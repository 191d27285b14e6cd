#!/bin/sh
# Goal: connections are limited in all and by address; who sends or reads too slowly is
# closed, however often a byte comes; and others are served meanwhile.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
HOLD=''

# hold N TEXT [OPTION...]: connections that stay; TEXT as printf's format.  What it says is in
# $T/held.
hold() {
    h_n=$1
    # shellcheck disable=SC2059 # with \r\n in it
    printf "$2" >"$T/text"
    shift 2
    : >"$T/held"
    "$BUILD/hold" "${URL#http://}" "$h_n" "$@" <"$T/text" >"$T/held" 2>&1 &
    HOLD=$!
}
let_go() {
    kill "$HOLD" 2>/dev/null
    wait "$HOLD" 2>/dev/null
}
# shellcheck disable=SC2317 # called by soon
held() {
    grep -qx "$1" "$T/held"
}
# shellcheck disable=SC2317
answers() {
    req GET /healthz
    [ "$STATUS" = 200 ]
}
# shellcheck disable=SC2317
files() {
    [ "$(find "/proc/$PID/fd" -mindepth 1 | wc -l)" -le "$1" ]
}
idle='GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n'
headers='GET /healthz HTTP/1.1\r\nHost: x\r\nA: '
body='POST /v1/subjects/a/verify HTTP/1.1\r\nHost: x\r\nContent-Type: model/x-ply\r\nContent-Length: 99999\r\n\r\nply\n'
scan 1 0 "$T/a.ply"
scan 1 1 "$T/p.ply" --pose 8 --shift 10

# ---- how many
start_daemon --no-auth --max-connections-per-address 5
hold 5 "$idle"
ok "five of one address" soon held answered
req GET /healthz
is "a sixth" "$STATUS" 000
let_go
ok "and again when they are gone" soon answers
stop_daemon
start_daemon --no-auth --max-connections 8
hold 8 "$idle"
ok "eight in all" soon held answered
req GET /healthz
is "a ninth" "$STATUS" 000
let_go
ok "and again when they are gone" soon answers
req GET /metrics
ok "the metrics count it" grep -Eq '^surfaced_connections_closed_total\{reason="too_many"\} [1-9]' "$T/body"
ok "and those that are open" grep -Eq '^surfaced_connections [1-8]$' "$T/body"
hold 30 "$idle"
ok "of thirty, those beyond eight are closed" soon held 'closed 22'
let_go
ok "the log says how many" grep -q 'connections closed.* too_many=[1-9]' "$LOG"
stop_daemon

# ---- how long: each of them would stay for ever
start_daemon --no-auth --timeout 1
send POST /v1/subjects/a/templates "$PLY" "$T/a.ply"
is "enrolled" "$STATUS" 201
for what in nothing headers body; do
    case $what in
    nothing) hold 20 '' ;;
    headers) hold 20 "$headers" --drip 100 ;;
    body) hold 20 "$body" --drip 100 ;;
    esac
    ok "slow with its $what: closed" soon held 'closed 20'
    let_go
done
hold 20 "$idle"
ok "idle: answered" soon held answered
ok "idle: closed after a while" soon held 'closed 20'
let_go
before=$(find "/proc/$PID/fd" -mindepth 1 | wc -l)
answer='GET /openapi.json HTTP/1.1\r\nHost: x\r\n\r\n'
many=
for _ in $(seq 200); do many=$many$answer; done
hold 3 "$many" --deaf
ok "asked for a lot" soon held sent
ok "takes no answer: closed" soon files "$before"
let_go
ok "the log counts them" grep -q 'connections closed.* late=[1-9]' "$LOG"
req GET /metrics
for reason in slow_headers slow_body slow_reader; do
    ok "so do the metrics: $reason" grep -Eq \
        "^surfaced_connections_closed_total\\{reason=\"$reason\"\\} [1-9]" "$T/body"
done
alive "the slow"
stop_daemon

# ---- work is not the client's time, and others are served beside the slow
start_daemon --no-auth --timeout 60 --workers 2
hold 200 "$headers" --drip 20
ok "two hundred slow ones" soon held sent
for n in 1 2 3 4 5; do
    send POST /v1/subjects/a/verify "$PLY" "$T/p.ply"
    is "verified beside them ($n)" "$STATUS $(get .decision)" "200 match"
done
ok "they are still there" test "$(find "/proc/$PID/fd" -mindepth 1 | wc -l)" -gt 200
let_go
stop_daemon
finish
