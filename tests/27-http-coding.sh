#!/bin/sh
# Goal: what a client may say of how it sends and what it wants back: compressed bodies are
# read within the limit, and damaged or unknown ones refused.
cd "$(dirname "$0")/.." || exit 1
. tests/lib.sh

GZ='Content-Encoding: gzip' ZST='Content-Encoding: zstd'
LIMIT=1000000
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.json" --pose 8 --shift 10
scan 2 0 "$T/b.ply"
for file in a.ply a2.json b.ply; do
    gzip -k "$T/$file"
    zstd -q "$T/$file"
done
start_daemon --no-auth --max-body $LIMIT

# ---- the same answers as to the plain bodies
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
is "enroll" "$STATUS" 201
cp "$T/body" "$T/plain"
for coding in gz:gzip gz:x-gzip gz:GZIP zst:zstd; do
    send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply.${coding%:*}" \
        -H "Content-Encoding: ${coding#*:}"
    is "the same cloud, ${coding#*:}" "$STATUS" 200
    ok "the same template" cmp -s "$T/body" "$T/plain"
done
send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json"
without_times "$T/body" >"$T/plain"
send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json" -H 'Content-Encoding: identity'
is "identity" "$STATUS" 200
for coding in gz:gzip zst:zstd; do
    for how in 'Expect:' 'Transfer-Encoding: chunked'; do
        send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json.${coding%:*}" \
            -H "Content-Encoding: ${coding#*:}" -H "$how"
        is "verify, ${coding#*:}, $how" "$STATUS" 200
        without_times "$T/body" >"$T/packed"
        ok "the same answer" cmp -s "$T/plain" "$T/packed"
    done
done
{
    head -c 40000 "$T/a2.json" | gzip
    tail -c +40001 "$T/a2.json" | gzip
} >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$GZ"
is "two members" "$STATUS" 200
{
    head -c 40000 "$T/a2.json" | zstd -q
    tail -c +40001 "$T/a2.json" | zstd -q
} >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$ZST"
is "two frames" "$STATUS" 200
printf '{"a": %s, "b": %s}' "$(cat "$T/a2.json")" "$(cat "$T/a2.json")" | gzip >"$T/x"
send POST /v1/compare "$JSON" "$T/x" -H "$GZ"
is "compare" "$STATUS $(get .decision)" "200 match"

# ---- damaged
# bad TITLE CODING [DETAIL]: $T/x must be refused.
bad() {
    send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "Content-Encoding: $2"
    problem "$1" 400 damaged_content_encoding "${3:-}"
}
for coding in gz:gzip zst:zstd; do
    name=${coding#*:} whole=$T/a2.json.${coding%:*}
    cp "$T/a2.json" "$T/x"
    bad "not $name" "$name" "$name"
    head -c 20000 "$whole" >"$T/x"
    bad "$name cut short" "$name" "ends too early"
    head -c 3 "$whole" >"$T/x"
    bad "$name cut very short" "$name"
    { head -c 9000 "$whole"; printf XXXX; tail -c +9005 "$whole"; } >"$T/x"
    bad "$name damaged" "$name"
    { cat "$whole"; echo behind; } >"$T/x"
    bad "$name and something behind" "$name"
    : | case $name in gzip) gzip ;; *) zstd -q ;; esac >"$T/x"
    send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "Content-Encoding: $name"
    problem "$name of nothing" 400 malformed 'empty'
    : >"$T/x"
    send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "Content-Encoding: $name"
    problem "nothing as $name" 400 malformed 'empty'
done
cp "$T/a2.json.zst" "$T/x"
bad "zstd sent as gzip" gzip
cp "$T/a2.json.gz" "$T/x"
bad "gzip sent as zstd" zstd
printf '\050\265\057\375\000\210\011\000\000a' >"$T/x"
bad "a window of 128 MB" zstd 'memory'
gzip -c "$T/a2.json.gz" >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$GZ"
problem "packed twice, said once" 400 malformed

# ---- not read here
for coding in br deflate compress 'gzip, gzip' 'zstd,gzip' 'gzip;q=1' aes128gcm '*'; do
    send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json" -H "Content-Encoding: $coding"
    problem "$coding" 415 unsupported_content_encoding 'gzip or zstd'
    is "Accept-Encoding" "$(field Accept-Encoding)" "gzip, zstd"
done
send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json.gz" -H "$GZ" -H "$GZ"
problem "gzip in two lines" 415 unsupported_content_encoding
send GET /healthz "$JSON" "$T/a2.json.gz" -H 'Content-Encoding: br'
is "no matter where no body belongs" "$STATUS" 200

# ---- bombs: refused early, and without the memory they ask for
peak() {
    awk '/^VmHWM/ { print $2 }' "/proc/$PID/status"
}
before=$(peak)
head -c 300000000 /dev/zero | gzip >"$T/bomb.gz"
head -c 300000000 /dev/zero | zstd -q >"$T/bomb.zst"
for coding in gz:gzip zst:zstd; do
    send POST /v1/subjects/alice/verify "$BYTES" "$T/bomb.${coding%:*}" \
        -H "Content-Encoding: ${coding#*:}"
    problem "a bomb, ${coding#*:}" 413 body_too_large "$LIMIT bytes when unpacked"
done
gzip -c "$T/bomb.zst" >"$T/x"
send POST /v1/subjects/alice/verify "$BYTES" "$T/x" -H "$GZ"
is "a bomb in a packet" "$STATUS" 400
if ! grep -aq __asan_init "$BUILD/surfaced"; then
    ok "no more than 40 MB for them" test $(($(peak) - before)) -lt 40000
fi
send POST /v1/subjects/alice/verify "$BYTES" "$T/bomb.zst"
is "not said to be one" "$STATUS" 400
head -c $LIMIT /dev/zero | tr '\0' ' ' | gzip >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$GZ"
problem "exactly the limit" 400 malformed
head -c $((LIMIT + 1)) /dev/zero | tr '\0' ' ' | gzip >"$T/x"
send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$GZ"
problem "a byte over the limit" 413 body_too_large
alive "bombs"
req GET /v1/subjects/alice
is "nothing changed" "$(get '.templates | length')" 1
finish
