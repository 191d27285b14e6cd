#!/bin/sh
# Goal: only TLS 1.2 and 1.3 with strong ciphers; SIGHUP reads the certificates again; client
# certificates are verified; and where the daemon listens: beyond loopback only with TLS or
# --plaintext, on a Unix socket, on a socket that was passed to it.
. tests/box/lib.sh
needs openssl

# ---- certificates: issue NAME CA PURPOSE [DAYS] makes $T/NAME.pem and $T/NAME.key
new_key() {
    openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out "$T/$1.key" &&
        chmod 600 "$T/$1.key"
}
authority() {
    new_key "$1"
    openssl req -x509 -new -key "$T/$1.key" -out "$T/$1.pem" -subj "/CN=$1" -days 20
}
issue() {
    new_key "$1"
    printf 'subjectAltName=DNS:localhost,IP:127.0.0.1\nextendedKeyUsage=%s\n' "$3" >"$T/ext"
    openssl req -new -key "$T/$1.key" -out "$T/csr" -subj "/CN=$1"
    openssl x509 -req -in "$T/csr" -CA "$T/$2.pem" -CAkey "$T/$2.key" -CAcreateserial \
        -extfile "$T/ext" -days "${4:-10}" -out "$T/$1.pem"
}
{
    authority ca
    authority other
    issue one ca serverAuth
    issue two ca serverAuth 5
    issue old ca serverAuth -1
    issue client ca clientAuth
    issue impostor other clientAuth
} >"$T/openssl" 2>&1 || {
    cat "$T/openssl"
    ok "certificates are made" false
    finish
}
tls="--tls-cert $T/one.pem --tls-key $T/one.key"

# ---- bad options and files
# refuse TITLE STATUS PATTERN OPTION...: the daemon does not start.
refuse() {
    r_title=$1 r_status=$2 r_pattern=$3
    shift 3
    start_fails "$r_title" "$r_status" "$r_pattern" --create --db "$DB" "$@"
}
timeout 60 "$BUILD/surfaced" --create --db "$DB" --tls-cert "$T/one.pem" --tls-key "$T/two.key" \
    --check-config >"$T/out" 2>&1
is "--check-config, another certificate's key: exit status" $? 64
ok "--check-config reports it" grep -q 'tls-cert .*two.key: not the key' "$T/out"
any='--listen 0.0.0.0:0'
# shellcheck disable=SC2086 # lists of options
{
    refuse "a key alone" 64 'go together' --tls-key "$T/one.key"
    refuse "--no-auth beyond loopback" 64 'no-auth is for loopback' $any $tls --no-auth
    l='--listen 127.0.0.1:0'
    refuse "no such certificate" 1 'cannot read .*/none' $l --tls-cert "$T/none" --tls-key "$T/one.key"
    refuse "another certificate's key" 1 'not the key' $l --tls-cert "$T/one.pem" --tls-key "$T/two.key"
    refuse "no certificate in it" 1 'not a certificate' $l --tls-cert "$T/one.key" --tls-key "$T/one.key"
    cp "$T/one.pem" "$T/nokey"
    chmod 600 "$T/nokey"
    refuse "no key in it" 1 'not the key' $l --tls-cert "$T/one.pem" --tls-key "$T/nokey"
    refuse "expired" 1 'old.pem: .*expired at' $l --tls-cert "$T/old.pem" --tls-key "$T/old.key"
    refuse "a folder" 1 'not a file' $l --tls-cert "$T" --tls-key "$T/one.key"
    refuse "no CA in it" 1 'not a certificate' $l $tls --tls-client-ca "$T/one.key"
    chmod 644 "$T/one.key"
    refuse "a key that everybody can read" 1 'others can read' $l $tls
    chmod 640 "$T/one.key"
}

# ---- requests over TLS
cp "$T/one.pem" "$T/now.pem"
cp "$T/one.key" "$T/now.key"
start_daemon --no-auth --tls-cert "$T/now.pem" --tls-key "$T/now.key" --max-body 1M
matches "$URL" '^https://' || ok "the URL is $URL" false
port=${URL##*:}
ca="--cacert $T/ca.pem"
scan 1 0 "$T/a.ply"
scan 1 1 "$T/p.ply" --pose 8 --shift 10
# shellcheck disable=SC2086 # options
{
    gives 201 "enrolled" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply" $ca
    send POST /v1/subjects/alice/verify "$PLY" "$T/p.ply" $ca
    is "verified" "$STATUS $(get .decision)" "200 match"
    gives 000 "a CA that the client does not trust: no response" req GET /healthz
    head -c 1500000 /dev/zero >"$T/big"
    gives "413 body_too_large" "too large, with a length" send POST /v1/subjects/alice/verify "$BYTES" "$T/big" $ca
    send POST /v1/subjects/alice/verify "$BYTES" "$T/big" $ca -H 'Transfer-Encoding: chunked' -H 'Expect:'
    problem "too large, in chunks" 413 body_too_large
    rm -f "$T/body"
    curl -sS -m 60 -o "$T/body" "http://127.0.0.1:$port/healthz" 2>"$T/curl"
    ok "plain HTTP gets no response" test ! -s "$T/body"
    gives 200 "alive after it" req GET /healthz $ca
}

# ---- versions and ciphers
# handshake OPTION...: prints the version and cipher that were negotiated, if any.
handshake() {
    openssl s_client -connect "127.0.0.1:$port" -CAfile "$T/ca.pem" "$@" </dev/null 2>&1 |
        sed -n 's/^New, \(TLSv[0-9.]*\), Cipher is \(.*\)/\1 \2/p' | head -n 1
}
ok "TLS 1.3" matches "$(handshake -tls1_3)" '^TLSv1.3 TLS_'
ok "TLS 1.2" matches "$(handshake -tls1_2)" '^TLSv1.2 ECDHE-'
ok "no TLS 1.1" test -z "$(handshake -tls1_1 -cipher 'ALL@SECLEVEL=0')"
ok "no TLS 1.0" test -z "$(handshake -tls1 -cipher 'ALL@SECLEVEL=0')"
for cipher in $(openssl ciphers -tls1_2 'ALL:COMPLEMENTOFALL@SECLEVEL=0' | tr ':' ' '); do
    got=$(handshake -tls1_2 -cipher "$cipher@SECLEVEL=0")
    case $got in
    '' | *ECDHE-ECDSA-AES*-GCM-* | *ECDHE-ECDSA-CHACHA20-*) ;;
    *) case $cipher in
        TLS_*) ;; # a cipher of TLS 1.3: the option does not restrict those of 1.2
        *) ok "cipher $cipher: $got" false ;;
        esac ;;
    esac
    [ -z "$got" ] || echo "$got" >>"$T/ciphers"
done
ok "some cipher of TLS 1.2 was negotiated" test -s "$T/ciphers"

# ---- SIGHUP reads the files again
# serves NAME: new connections get this certificate.
# shellcheck disable=SC2317 # called by soon
serves() {
    openssl s_client -connect "127.0.0.1:$port" </dev/null 2>/dev/null |
        openssl x509 -noout -subject 2>/dev/null | grep -q "CN = $1\$"
}
# shellcheck disable=SC2317 # called by ok and soon
logged() {
    grep -q -- "$1" "$LOG"
}
# shellcheck disable=SC2317 # called by ok
# ends DAYS: the metric says that the certificate ends after so many days.
ends() {
    curl -sS --cacert "$T/ca.pem" "https://127.0.0.1:$port/metrics" |
        awk -v days="$1" '$1 == "surfaced_certificate_end_seconds" {
            found = $2 > (days - 0.1) * 86400 && $2 <= days * 86400 } END { exit !found }'
}
ok "the first certificate" serves one
ok "and its end" ends 10
{
    printf 'GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n'
    soon test -e "$T/go"
    printf 'GET /healthz HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n'
    soon test -e "$T/done"
} | openssl s_client -quiet -connect "127.0.0.1:$port" >"$T/open" 2>/dev/null &
client=$!
soon grep -q '{"status' "$T/open"
cp "$T/two.pem" "$T/now.pem"
cp "$T/two.key" "$T/now.key"
serves one || ok "without SIGHUP the certificate stays" false
kill -HUP "$PID"
ok "the second certificate after SIGHUP" soon serves two
: >"$T/go"
# shellcheck disable=SC2016 # sh's own
ok "a connection from before stays usable" soon sh -c '[ "$(grep -c "{.status" "$1")" -eq 2 ]' - "$T/open"
: >"$T/done"
wait "$client"
echo junk >"$T/now.pem"
kill -HUP "$PID"
ok "the log reports bad files" soon logged 'the TLS certificate stays as it was'
ok "and the second certificate stays" serves two
ok "with its end" ends 5

# ---- a stream of events: what happens is delivered, a reader that takes nothing is cut off, and the rest ends with the daemon
# shellcheck disable=SC2086 # options
{
    curl -sSN $ca -m 400 -H 'Accept: text/event-stream' "$URL/v1/events?last=1" >"$T/stream" 2>"$T/curl" &
    reader=$!
    # shellcheck disable=SC2317 # called by soon
    delivered() { [ "$(grep -c '^event: ' "$T/stream")" = "$1" ]; }
    ok "the last event" soon delivered 1
    send POST /v1/subjects/alice/verify "$PLY" "$T/p.ply" $ca
    ok "the next one" soon delivered 2
    is "is what happened" "$(sed -n 's/^data: //p' "$T/stream" | tail -n 1 | jq -r '"\(.type) \(.outcome) \(.subject)"')" 'verify match alice'
    long=$(printf '%0128d' 0)
    req POST /v1/subjects $ca -H "$JSON" -d "{\"subject\": \"$long\"}"
    for _ in $(seq 200); do printf 'url = "%s/v1/subjects/%s"\noutput = /dev/null\n' "$URL" "$long"; done >"$T/changes"
    curl -sS $ca -K "$T/changes" -X PATCH -H 'Content-Type: application/merge-patch+json' \
        -d '{"consent": "x", "hold": false, "disabled": false, "groups": ["a"], "identify": true}'
    mkfifo "$T/hold"
    exec 8<>"$T/hold"
    CA=$T/ca.pem python3 tests/box/events.py hold "$URL" 5 '?after=0-0' none <"$T/hold" >"$T/held" 2>&1 &
    holder=$!
    ok "5 that take nothing" soon grep -qx 'open 5 refused 0' "$T/held"
    # shellcheck disable=SC2317 # called by soon
    cut_off() {
        req GET /metrics $ca
        grep -qx 'surfaced_connections_closed_total{reason="slow_events"} 5' "$T/body"
    }
    ok "are cut off" soon cut_off
    before=$(grep -c '^event: ' "$T/stream")
    send POST /v1/subjects/alice/verify "$PLY" "$T/p.ply" $ca
    ok "who reads goes on" soon delivered $((before + 1))
    kill $holder
    wait $holder 2>/dev/null
    exec 8>&-
}
stop_daemon
wait $reader
is "and its stream ends with the daemon, whole" "$? $(tail -c 1 "$T/stream" | od -An -c | tr -d ' ')" '0 \n'

# ---- client certificates
# shellcheck disable=SC2086 # options
{
    start_daemon --no-auth $tls --tls-client-ca "$T/ca.pem"
    port=${URL##*:}
    gives 000 "no certificate" req GET /healthz $ca
    gives 000 "a certificate of another CA" req GET /healthz $ca --cert "$T/impostor.pem" --key "$T/impostor.key"
    gives 000 "a server's certificate" req GET /healthz $ca --cert "$T/one.pem" --key "$T/one.key"
    gives 000 "no certificate, TLS 1.2" req GET /healthz $ca --tls-max 1.2
    gives 200 "a client's certificate" req GET /healthz $ca --cert "$T/client.pem" --key "$T/client.key"
    gives 200 "the same with TLS 1.2" req GET /healthz $ca --cert "$T/client.pem" --key "$T/client.key" --tls-max 1.2
    ok "the log has the reason" logged 'client certificates refused" certificates=1 '
    is "once a minute" "$(grep -c 'certificates refused' "$LOG")" 1
    stop_daemon
}

# ---- beyond loopback
# shellcheck disable=SC2086 # options
{
    LISTEN=0.0.0.0:0 start_daemon --plaintext
    URL=http://127.0.0.1:${URL##*:}
    gives 401 "--plaintext: tokens are required" req GET /v1/subjects/alice
    stop_daemon
    LISTEN=0.0.0.0:0 start_daemon $tls
    URL=https://127.0.0.1:${URL##*:}
    gives 401 "TLS: tokens are required" req GET /v1/subjects/alice $ca
    stop_daemon
}

# ---- a Unix socket
s=$T/socket
LISTEN=unix:$s start_daemon --no-auth
is "its name" "$URL" "unix:$s"
is "its mode" "$(stat -c %a "$s")" 660
URL=http://localhost
gives 200 "a request" req GET /v1/subjects/alice --unix-socket "$s"
ok "the log has whence" grep -q 'route=/v1/subjects/{subject} status=200 .* client=unix' "$LOG"
refuse "another process listens there" 1 'cannot listen on unix:.*in use' --listen "unix:$s"
kill -9 "$PID"
wait "$PID" 2>/dev/null
ok "a killed daemon leaves its socket" test -S "$s"
LISTEN=unix:$s start_daemon --no-auth
URL=http://localhost
gives 200 "it is replaced" req GET /healthz --unix-socket "$s"
stop_daemon
ok "it is removed at the end" test ! -e "$s"
echo mine >"$s"
refuse "a file is there" 1 'in use' --listen "unix:$s"
is "the file stays" "$(cat "$s")" mine
refuse "too long a path" 64 'not an address' --listen "unix:/$(printf '%0110d' 0)"

# ---- a socket that was passed
UNDER="python3 tests/box/manager.py $T/notes --socket" start_daemon --no-auth
gives 200 "a socket that was passed ($URL)" req GET /healthz
stop_daemon
finish
