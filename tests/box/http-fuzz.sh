#!/bin/sh
# Goal: whatever bytes it receives, the daemon sends well-formed HTTP, but never 500, or closes
# the connection; it keeps running, stops cleanly, and its database is intact.
# Usage: http-fuzz.sh [REQUESTS [SEED]]: each of four clients sends REQUESTS; the seed is printed.
# Most useful on a build with sanitizers (make sanitize): their reports and leaks fail the test.
. tests/box/lib.sh
REQUESTS=${1:-600} SEED=${2:-33}

# record NAME METHOD TARGET [HEADER...] <BODY: writes the bytes of a request to $T/req.NAME.
# With a Transfer-Encoding the body is sent in chunks.
record() {
    r_name=$1 r_line="$2 $3 HTTP/1.1"
    shift 3
    cat >"$T/raw"
    {
        printf '%s\r\nHost: localhost\r\n' "$r_line"
        [ -z "$AUTH" ] || printf 'Authorization: Bearer %s\r\n' "$AUTH"
        for r_header; do
            printf '%s\r\n' "$r_header"
        done
        case " $* " in
        *chunked*)
            split -b 1500 "$T/raw" "$T/chunk."
            printf '\r\n'
            for r_chunk in "$T"/chunk.*; do
                printf '%x\r\n' "$(wc -c <"$r_chunk")"
                cat "$r_chunk"
                printf '\r\n'
            done
            rm "$T"/chunk.*
            printf '0\r\n\r\n'
            ;;
        *)
            printf 'Content-Length: %d\r\n\r\n' "$(wc -c <"$T/raw")"
            cat "$T/raw"
            ;;
        esac
    } >"$T/req.$r_name"
}

# corpus: a request of each kind.
corpus() {
    for path in /healthz /readyz /metrics /openapi.json /docs /version \
        '/v1/subjects?limit=2&cursor=a' /v1/subjects/alice "/v1/templates/$id"; do
        record "get$(echo "$path" | tr -c 'a-z\n' _)" GET "$path" 'X-Request-Id: abc.1' </dev/null
    done
    record head HEAD /v1/subjects/b%40x 'Accept: */*' 'User-Agent: fuzz' </dev/null
    record erase DELETE /v1/subjects/b%40x 'Prefer: return=minimal, wait=5' </dev/null
    record delete DELETE "/v1/templates/$(printf '%032d' 0)" </dev/null
    record enroll POST '/v1/subjects/b%40x/templates?label=a%20b&force=true&units=mm' "$PLY" \
        <"$T/s.ply"
    record ply POST /v1/subjects/alice/verify "$PLY" 'Expect: 100-continue' <"$T/s.ply"
    record json POST '/v1/subjects/alice/verify?units=mm&detail=heatmap' \
        "$JSON; charset=utf-8" <"$T/s.json"
    record obj POST "/v1/templates/$id/verify" 'Content-Type: model/obj' \
        'Transfer-Encoding: chunked' <"$T/s.obj"
    record xyz POST /v1/subjects/alice/verify 'Content-Type: text/plain' <"$T/s.xyz"
    record check POST '/v1/check?axes=scanner&units=auto' "$PLY" <"$T/s.ply"
    {
        printf -- '--b-1\r\nContent-Disposition: form-data; name="file"; filename="s.ply"\r\n'
        printf 'Content-Type: model/ply\r\n\r\n'
        cat "$T/s.ply"
        printf -- '\r\n--b-1--\r\n'
    } >"$T/form"
    record form POST /v1/check 'Content-Type: multipart/form-data; boundary="b-1"' <"$T/form"
    record bytes POST /v1/subjects/alice/verify "$BYTES" 'Transfer-Encoding: chunked' <"$T/s.xyz"
    gzip -c "$T/s.json" | record gzip POST /v1/subjects/alice/verify "$JSON" \
        'Content-Encoding: gzip'
    zstd -qc "$T/s.ply" | record zstd POST /v1/subjects/alice/verify "$PLY" \
        'Content-Encoding: zstd' 'Transfer-Encoding: chunked'
    jq -c '{a: ., b: .}' "$T/s.json" | record compare POST /v1/compare "$JSON"
    cat "$T/req.get_healthz" "$T/req.xyz" "$T/req.head" >"$T/req.pipelined"
}

# fuzz TITLE SEED: runs four clients at once.
fuzz() {
    clients=
    for i in 0 1 2 3; do
        python3 tests/box/http_fuzz.py "${URL##*:}" "$REQUESTS" $(($2 + i)) "$T"/req.* >"$T/fuzz.$i" 2>&1 &
        clients="$clients $!"
    done
    for client in $clients; do
        wait "$client"
        is "$1: exit status of a client" $? 0
    done
    cat "$T"/fuzz.?
    ok "$1: some requests succeeded" grep -q ' 200: ' "$T"/fuzz.?
    ok "$1: some requests failed" grep -q ' 400: ' "$T"/fuzz.?
}

for form in ply json xyz; do
    scan 1 1 "$T/s.$form" --points 400 --pose 5
done
sed 's/^/v /' "$T/s.xyz" >"$T/s.obj"
scan 1 0 "$T/a.ply"
start_daemon --no-auth --max-body 300000
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
id=$(get .template_id)
corpus
fuzz "without tokens" "$SEED"
alive "malformed requests"
stop_daemon

AUTH=$(new_token fuzz)
start_daemon
corpus
fuzz "with a token" $((SEED + 4))
alive "malformed requests"
ok "the log is printable" sh -c "! LC_ALL=C grep -q '[^ -~]' '$LOG'"
stop_daemon
is "the database is intact" "$(sqlite3 "$DB" 'PRAGMA integrity_check')" ok
finish
