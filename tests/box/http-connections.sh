#!/bin/sh
# Goal: the number of connections is limited in all and by address; the daemon closes
# connections of slow senders and readers, even if bytes keep coming, and serves others meanwhile.
. tests/box/lib.sh
# open_files: of the daemon.
open_files() {
    find "/proc/$PID/fd" -mindepth 1 | wc -l
}
# shellcheck disable=SC2317 # called by soon
open_files_at_most() {
    [ "$(open_files)" -le "$1" ]
}
# counts REASON: the metrics count connections closed for it.
# shellcheck disable=SC2317 # called by soon
counts() {
    req GET /metrics
    grep -Eq "^surfaced_connections_closed_total\\{reason=\"$1\"\\} [1-9]" "$T/body"
}
idle='GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n'
headers='GET /healthz HTTP/1.1\r\nHost: localhost\r\nA: '
body='POST /v1/subjects/a/verify HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/x-ply\r\nContent-Length: 99999\r\n\r\nply\n'
scan 1 0 "$T/a.ply"
scan 1 1 "$T/p.ply" --pose 8 --shift 10

# ---- a body as a whole: 20 KB/s earn more time than they take, but not for ever.  Beside all below.
"$BUILD/surfacectl" --db "$T/whole.db" init >"$T/out" 2>&1
"$BUILD/surfaced" --db "$T/whole.db" --no-auth --timeout 1 --listen "unix:$T/whole" >"$T/whole.log" 2>&1 &
whole=$!
ok "it listens" soon test -S "$T/whole"
python3 -c '
import socket, sys, time
s = socket.socket(socket.AF_UNIX)
s.connect(sys.argv[1])
s.sendall(b"POST /v1/check HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/x-ply\r\nContent-Length: 9999999\r\n\r\n")
begun = time.monotonic()
try:
    while time.monotonic() - begun < 60:
        s.sendall(2000 * b"x")
        time.sleep(0.1)
except OSError:
    pass
print(int(time.monotonic() - begun))' "$T/whole" >"$T/lasted" 2>&1 &
dripping=$!

# ---- how many
start_daemon --no-auth --max-connections-per-address 5
hold 5 "$idle"
held "five of one address" answered
gives 000 "a sixth" req GET /healthz
let_go
ok "served again after they are closed" soon serves
ok "the metrics count it" counts too_many_of_one_address
stop_daemon
start_daemon --no-auth --max-connections 8
hold 8 "$body"
held "eight in all, amid their bodies" sent
sleep 1.2
gives 000 "a ninth" req GET /healthz
let_go
ok "served again after they are closed" soon serves
hold 8 "$idle"
held "eight in all, idle" answered
sleep 1.2 # until then they are safe
gives 200 "a ninth takes the place of the one that is idle for longest" req GET /healthz
held "which is closed" 'closed 1'
let_go
ok "the metrics count it" counts crowded_out
req GET /metrics
ok "the metrics count it" counts too_many
ok "and the open ones" grep -Eq '^surfaced_connections [1-8]$' "$T/body"
hold 30 "$idle"
held "of thirty, those beyond eight are closed" 'closed 22'
let_go
ok "the log has their number" grep -q 'connections closed.* too_many=[1-9]' "$LOG"
stop_daemon

# ---- how long: each of these connections would stay open forever
start_daemon --no-auth --timeout 1
gives 201 "enrolled" send POST /v1/subjects/a/templates "$PLY" "$T/a.ply"
before=$(open_files) # later, some of a closed connection may not be closed here yet
for what in nothing headers body; do
    case $what in
    nothing) hold 20 '' ;;
    headers) hold 20 "$headers" --drip 100 ;;
    body) hold 20 "$body" --drip 100 ;;
    esac
    held "slow with its $what: closed" 'closed 20'
    let_go
done
hold 20 "$idle"
held "idle: served" answered
held "idle: closed after a while" 'closed 20'
let_go
large='GET /openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n'
many=
for _ in $(seq 200); do many=$many$large; done
hold 3 "$many" --deaf
held "many requests for large responses" sent
ok "the responses are not read: the metrics count them" soon counts slow_reader
ok "and they are closed" soon open_files_at_most "$before"
let_go
ok "the log counts them" grep -q 'connections closed.* late=[1-9]' "$LOG"
for reason in slow_headers slow_body; do
    ok "so do the metrics: $reason" counts "$reason"
done
alive "slow clients"
stop_daemon

# ---- what strangers do not read takes no room from others
start_daemon --timeout 30 --max-body 300000
AUTH=$(new_token me)
hold 25 "$many" --deaf # 25 times 135 KB are more than the room for all large bodies and responses
held "strangers who do not read the API's description" sent
sleep 1
is "they hold" "$(metric 'surfaced_held_bytes{size="large"}')" 0
send POST '/v1/subjects/a/verify?detail=heatmap' "$PLY" "$T/p.ply"
is "a heat map beside them" "$STATUS $(get .decision)" "200 match"
let_go
AUTH=
stop_daemon

# ---- time in the queue and the workers does not count; others are served beside slow clients
start_daemon --no-auth --timeout 60 --workers 2
hold 200 "$headers" --drip 20
held "two hundred slow clients" sent
for n in 1 2 3 4 5; do
    send POST /v1/subjects/a/verify "$PLY" "$T/p.ply"
    is "verified beside them ($n)" "$STATUS $(get .decision)" "200 match"
done
ok "they are still connected" test "$(open_files)" -gt 200
let_go
stop_daemon

wait $dripping
ok "a body of 20 KB/s lasted $(cat "$T/lasted") s, of 30 that it may" test "$(cat "$T/lasted")" -ge 29 -a "$(cat "$T/lasted")" -lt 45
kill $whole
wait $whole
finish
