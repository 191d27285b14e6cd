#!/bin/sh
# Goal: connections of the proxies named by --proxy-protocol begin with a header, and the client in it
# is the one that is limited and logged; nobody else can name another address than their own; without
# a good header, in time, a proxy's connection is closed, at no cost to others.
. tests/box/lib.sh
needs openssl python3 prlimit
FROM=127.0.0.2

# via HEADER PATH [OPTION...]: what proxy.py prints, from 127.0.0.2.
via() {
    python3 tests/box/proxy.py "$URL" "$@" 2>&1
}
# logged CLIENT: the last request's client.  The line may be written after the response.
# shellcheck disable=SC2317 # called by soon
logged() {
    grep 'msg="request"' "$LOG" | tail -n 1 | grep -q " client=$1\( \|\$\)"
}
# refused TITLE: the metrics count one more connection of a proxy that was closed for its header.
headers=0
# shellcheck disable=SC2317 # called by soon
counted() {
    [ "$(metric 'surfaced_connections_closed_total{reason="proxy_header"}')" = "$headers" ]
}
refused() {
    headers=$((headers + 1))
    ok "$1: counted" soon counted
}
# ticks: of processor time that the daemon has taken.
ticks() {
    awk '{ print $14 + $15 }' "/proc/$PID/stat"
}
signature='\r\n\r\n\0\r\nQUIT\n'
S=0d0a0d0a000d0a515549540a # the same
idle='GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n'

# ---- whose connection it is
start_daemon --proxy-protocol 127.0.0.2,127.0.1.0/24
for header in 192.0.2.7 2001:db8::2a tlvs:192.0.2.7 tlvs:2001:db8::2a ::ffff:192.0.2.7; do
    is "$header" "$(via "$header" /healthz)" 200
    client=${header#tlvs:}
    ok "$header: logged" soon logged "${client#::ffff:}"
done
is "of a network" "$(via 192.0.2.9 /healthz --from 127.0.1.77)" 200
ok "of a network: logged" soon logged 192.0.2.9
for header in local unspec ${S}2000000b04000178030004deadbeef; do
    is "$header" "$(via "$header" /healthz)" 200
    ok "$header: its own address" soon logged 127.0.0.2
done
is "in parts" "$(via tlvs:192.0.2.8 /healthz --by 3)" 200
ok "in parts: logged" soon logged 192.0.2.8
gives 200 "from elsewhere, without a header" req GET /healthz
ok "from elsewhere: logged" soon logged 127.0.0.1
for client in 192.0.2.77 2001:db8::77 local; do
    is "from elsewhere, with a header, $client: no HTTP" "$(via $client /healthz --from 127.0.0.3)" closed
done
ok "from elsewhere, with a header: nobody is named" sh -c "! grep -q 'client=.*77' '$LOG'"

# ---- not a good header
is "no header" "$(via none /healthz)" closed
refused "no header"
is "version 1" "$(via "$(printf 'PROXY TCP4 192.0.2.7 198.51.100.1 50000 443\r\n' | od -An -v -tx1)" /healthz)" closed
refused "version 1"
is "an unknown command" "$(via ${S}2211000c /healthz)" closed
refused "an unknown command"
is "an unknown family" "$(via ${S}2141000c /healthz)" closed
refused "an unknown family"
is "shorter than its addresses" "$(via ${S}21110004c0000207 /healthz)" closed
refused "shorter"
is "too long" "$(via ${S}2111fff0 /healthz)" closed
refused "too long"
is "it never ends" "$(via 192.0.2.7 /healthz --cut 20)" 'closed 3'
refused "it never ends"
is "it never begins" "$(via none /healthz --cut 0)" 'closed 3'
refused "it never begins"
hold 1 "$signature"
soon grep -qx sent "$T/held"
let_go
refused "closed before its end"
hold 1 ''
soon grep -qx sent "$T/held"
let_go
sleep 0.2
ok "closed without a byte, as by a health check: not counted" counted
is "the log has one line of them" "$(grep -c 'connections of proxies closed' "$LOG")" 1
ok "with the first one's reason" grep -q 'closed" connections=1 proxy=127.0.0.2 reason="no PROXY protocol header"' "$LOG"

# ---- many that wait for their header: the oldest make room
hold 1500 "$signature"
held "of 1,500 waiting ones" sent
ok "no more than 1,024 are open" test "$(find "/proc/$PID/fd" -mindepth 1 | wc -l)" -lt 1100
is "another is served" "$(via 192.0.2.7 /healthz)" 200
gives 200 "and one from elsewhere" req GET /healthz
sanitized || ok "while they wait" test "$(find "/proc/$PID/fd" -mindepth 1 | wc -l)" -gt 900
held "the others are closed in time" 'closed 1500'
let_go
stop_daemon

# ---- limits by client
start_daemon --proxy-protocol 127.0.0.2 --rate-limit-tokens 3 --max-connections-per-address 5
good=$(new_token good)
is "wrong tokens" "$(via 192.0.2.7 /v1/stats --token wrong --times 5 | paste -sd ' ')" '401 401 401 429 429'
is "of another client" "$(via 192.0.2.8 /v1/stats --token wrong)" 401
is "of the same network of IPv6" "$(via 2001:db8::1 /v1/stats --token wrong --times 3 | paste -sd ' ') $(
    via 2001:db8::2 /v1/stats --token wrong)" '401 401 401 429'
is "of the proxy itself" "$(via local /v1/stats --token wrong)" 401
is "a good token of the first client" "$(via 192.0.2.7 /v1/stats --token "$good")" 429
is "a good token of another" "$(via 192.0.2.9 /v1/stats --token "$good")" 200
header="$signature"'\041\021\0\014\300\0\002\007\306\063\144\001\331\003\001\273' # 192.0.2.7
hold 8 "$header$idle"
held "of eight connections of one client three are closed" 'closed 3'
is "one more of it" "$(via 192.0.2.7 /healthz)" closed
is "one of another" "$(via 192.0.2.8 /healthz)" 200
let_go
stop_daemon
start_daemon --proxy-protocol 127.0.0.2 --max-connections 8 --no-auth
hold 30 "$header$idle"
held "of thirty in all, those beyond eight are closed" 'closed 22'
sleep 1.2 # until then they are safe
is "one of another client takes the place of one" "$(via 192.0.2.8 /healthz)" 200
let_go
stop_daemon

# ---- few files: what waits for them takes no time, and is served when there are some
UNDER="prlimit --nofile=60:60" start_daemon --proxy-protocol 127.0.0.2 --no-auth
hold 200 "$signature"
soon grep -qx sent "$T/held"
before=$(ticks)
sleep 2
ok "too many open files: $(($(ticks) - before)) ticks in 2 s" test $(($(ticks) - before)) -lt 20
let_go
ok "served again" soon serves
stop_daemon

# ---- a stop: what has begun is finished, what waits is closed
start_daemon --proxy-protocol 127.0.0.2 --no-auth
via 192.0.2.7 /healthz --wait "$T/go" >"$T/half" &
half=$!
hold 3 "$signature"
soon grep -qx sent "$T/held"
soon test -e "$T/go.half"
sleep 0.5 # until the daemon has read it
kill -TERM "$PID"
held "waiting ones are closed" 'closed 3'
touch "$T/go"
wait "$half"
is "the request that has begun" "$(cat "$T/half")" 200
wait "$PID"
is "exit status after SIGTERM" $? 0
PID=
let_go

# ---- TLS
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout "$T/tls.key" \
    -out "$T/tls.pem" -subj /CN=localhost -addext subjectAltName=DNS:localhost -days 2 >"$T/openssl" 2>&1
chmod 600 "$T/tls.key"
start_daemon --proxy-protocol 127.0.0.2 --no-auth --tls-cert "$T/tls.pem" --tls-key "$T/tls.key"
is "TLS" "$(via 192.0.2.7 /healthz --ca "$T/tls.pem")" 200
ok "TLS: logged" soon logged 192.0.2.7
is "TLS, IPv6, in parts" "$(via tlvs:2001:db8::2a /healthz --ca "$T/tls.pem" --by 5)" 200
ok "TLS, IPv6, in parts: logged" soon logged 2001:db8::2a
is "TLS without a header" "$(via none /healthz --ca "$T/tls.pem")" closed
is "TLS from elsewhere" "$(via none /healthz --ca "$T/tls.pem" --from 127.0.0.3)" 200
ok "TLS from elsewhere: logged" soon logged 127.0.0.3
stop_daemon

# ---- a Unix socket, a socket that was passed
LISTEN=unix:$T/socket start_daemon --proxy-protocol unix --no-auth
is "a Unix socket" "$(via 192.0.2.7 /healthz)" 200
ok "a Unix socket: logged" soon logged 192.0.2.7
is "a Unix socket, local" "$(via local /healthz)" 200
ok "a Unix socket, local: its own address" soon logged unix
is "a Unix socket without a header" "$(via none /healthz)" closed
stop_daemon
LISTEN=unix:$T/socket start_daemon --proxy-protocol 127.0.0.2 --no-auth
is "a Unix socket is no address" "$(via none /healthz)" 200
stop_daemon
UNDER="python3 tests/box/manager.py $T/notes --socket" start_daemon --no-auth --proxy-protocol 127.0.0.2
is "a socket that was passed" "$(via 192.0.2.7 /healthz)" 200
ok "a socket that was passed: logged" soon logged 192.0.2.7
stop_daemon

# ---- HAProxy
needs_section test haproxy
# shellcheck disable=SC2046 # two ports
set -- $(scripts/free_ports 2)
tcp=http://127.0.0.1:$1 http=http://127.0.0.1:$2
start_daemon --proxy-protocol 127.0.0.2 --rate-limit-tokens 3 --max-connections-per-address 5
AUTH=$(new_token another)
cat >"$T/haproxy.cfg" <<EOF
global
    maxconn 200
    nbthread 1
defaults
    timeout connect 5s
    timeout client 20s
    timeout server 20s
    source 127.0.0.2
listen tcp
    mode tcp
    bind ${tcp#http://}
    server one ${URL#http://} send-proxy-v2 check inter 100ms
listen http
    mode http
    bind ${http#http://}
    http-reuse always
    unique-id-format %ci:%cp_%Ts
    server one ${URL#http://} send-proxy-v2 proxy-v2-options crc32c,unique-id
EOF
haproxy -db -f "$T/haproxy.cfg" >"$T/haproxy.log" 2>&1 &
HAPROXY=$!
trap 'kill $HAPROXY 2>/dev/null; cleanup' EXIT
direct=$URL
# from CLIENT URL [CURL-OPTION...]: GET /v1/stats at URL, from CLIENT.
from() {
    client=$1 URL=$2
    shift 2
    req GET /v1/stats --interface "$client" "$@"
    URL=$direct
}
# shellcheck disable=SC2317 # called by soon
up() {
    from 127.0.0.3 "$1"
    [ "$STATUS" = 200 ]
}
n=3
for proxy in "$tcp" "$http"; do
    ok "HAProxy: served" soon up "$proxy"
    ok "HAProxy: its client is logged" soon logged 127.0.0.3
    n=$((n + 1))
    all=
    for i in 1 2 3 4 5; do
        AUTH='' from "127.0.0.$n" "$proxy" -H 'Authorization: Bearer wrong'
        all="$all $STATUS"
    done
    is "HAProxy: wrong tokens" "$all" ' 401 401 401 429 429'
    ok "HAProxy: its client is logged too" soon logged "127.0.0.$n"
    gives 200 "HAProxy: another client" from 127.0.0.10 "$proxy"
    AUTH='' from 127.0.0.10 "$proxy" -H 'Authorization: Bearer wrong'
    is "HAProxy: its first wrong token" "$STATUS" 401
    from 127.0.0.3 "$proxy" -H 'X-Forwarded-For: 192.0.2.1' -H 'Forwarded: for=192.0.2.1'
    ok "HAProxy: what a client says itself does not count" soon logged 127.0.0.3
done
is "HAProxy: a client's own header: no HTTP" "$(URL=$tcp via 192.0.2.77 /healthz --from 127.0.0.8)" closed
ok "HAProxy: a client's own header names nobody" sh -c "! grep -q 192.0.2.77 '$LOG'"
holders=
for i in $(seq 10); do
    printf 'GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n' |
        python3 tests/box/hold.py "${tcp#http://}" 4 --from "127.0.2.$i" >"$T/held.$i" 2>&1 &
    holders="$holders $!"
done
for i in $(seq 10); do
    ok "HAProxy: four connections of client $i" soon grep -qx answered "$T/held.$i"
done
is "HAProxy: none of forty is closed" "$(cat "$T"/held.* | grep -c closed)" 0
# shellcheck disable=SC2086 # a list
kill $holders && wait $holders 2>/dev/null
is "HAProxy: no header of its own is refused" "$(metric 'surfaced_connections_closed_total{reason="proxy_header"}')" 0
kill $HAPROXY
wait $HAPROXY 2>/dev/null
finish
