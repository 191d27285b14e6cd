#!/bin/sh
# Goal: the headers by which a client chooses how a request is sent and answered.  Compressed
# bodies are accepted up to the limit, damaged or unknown ones rejected; return=minimal gives no
# body.
. tests/box/lib.sh

GZ='Content-Encoding: gzip'
LIMIT=1000000
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.json" --pose 8 --shift 10
scan 2 0 "$T/b.ply"
for file in a.ply a2.json b.ply; do
    gzip -k "$T/$file"
    zstd -q "$T/$file"
done
start_daemon --no-auth --max-body $LIMIT

# ---- the same responses as to plain bodies
gives 201 "enroll" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
cp "$T/body" "$T/plain"
for coding in gz:gzip gz:x-gzip gz:GZIP zst:zstd; do
    send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply.${coding%:*}" \
        -H "Content-Encoding: ${coding#*:}"
    is "the same cloud, ${coding#*:}" "$STATUS" 200
    ok "the same template" cmp -s "$T/body" "$T/plain"
done
send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json"
without_times "$T/body" >"$T/plain"
gives 200 "identity" send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json" -H 'Content-Encoding: identity'
for coding in gz:gzip zst:zstd; do
    for how in 'Expect:' 'Transfer-Encoding: chunked'; do
        send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json.${coding%:*}" \
            -H "Content-Encoding: ${coding#*:}" -H "$how"
        is "verify, ${coding#*:}, $how" "$STATUS" 200
        without_times "$T/body" >"$T/packed"
        ok "the same response" cmp -s "$T/plain" "$T/packed"
    done
done
printf '{"a": %s, "b": %s}' "$(cat "$T/a2.json")" "$(cat "$T/a2.json")" | gzip >"$T/x"
send POST /v1/compare "$JSON" "$T/x" -H "$GZ"
is "compare" "$STATUS $(get .decision)" "200 match"

# ---- damaged
# bad TITLE CODING [DETAIL-PATTERN]: $T/x is rejected as damaged.
bad() {
    send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "Content-Encoding: $2"
    problem "$1" 400 damaged_content_encoding "${3:-}"
}
for coding in gz:gzip zst:zstd; do
    name=${coding#*:} whole=$T/a2.json.${coding%:*}
    cp "$T/a2.json" "$T/x"
    bad "not $name" "$name" "$name"
    head -c 20000 "$whole" >"$T/x"
    bad "$name truncated" "$name" "ends too early"
    : | case $name in gzip) gzip ;; *) zstd -q ;; esac >"$T/x"
    send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "Content-Encoding: $name"
    problem "$name of an empty body" 400 malformed 'empty'
    : >"$T/x"
    send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "Content-Encoding: $name"
    problem "an empty body as $name" 400 malformed 'empty'
done
printf '\050\265\057\375\000\210\011\000\000a' >"$T/x"
bad "a window of 128 MB" zstd 'memory'
gzip -c "$T/a2.json.gz" >"$T/x"
gives 200 "a .gz file, compressed once more" send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$GZ"
gzip -c "$T/x" >"$T/y"
send POST /v1/subjects/alice/verify "$JSON" "$T/y" -H "$GZ"
problem "compressed three times, declared once" 400 malformed

# ---- unsupported codings
for coding in br deflate compress 'gzip, gzip' 'zstd,gzip' 'gzip;q=1' aes128gcm '*'; do
    send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json" -H "Content-Encoding: $coding"
    problem "$coding" 415 unsupported_content_encoding 'gzip or zstd'
    is "Accept-Encoding" "$(field Accept-Encoding)" "gzip, zstd"
done
send POST /v1/subjects/alice/verify "$JSON" "$T/a2.json.gz" -H "$GZ" -H "$GZ"
problem "gzip in two lines" 415 unsupported_content_encoding
gives 200 "ignored for a GET request" req GET /healthz -H 'Content-Encoding: br'

# ---- bombs: rejected early and without using much memory
# peak: the daemon's largest resident memory so far, KiB.
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
gives 400 "a compressed bomb" send POST /v1/subjects/alice/verify "$BYTES" "$T/x" -H "$GZ"
if ! grep -aq __asan_init "$BUILD/surfaced"; then
    ok "no more than 40 MB for them" test $(($(peak) - before)) -lt 40000
fi
gives 400 "a bomb without Content-Encoding" send POST /v1/subjects/alice/verify "$BYTES" "$T/bomb.zst"
head -c $LIMIT /dev/zero | tr '\0' ' ' | gzip >"$T/x"
gives "400 malformed" "exactly the limit" send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$GZ"
head -c $((LIMIT + 1)) /dev/zero | tr '\0' ' ' | gzip >"$T/x"
gives "413 body_too_large" "a byte over the limit" send POST /v1/subjects/alice/verify "$JSON" "$T/x" -H "$GZ"
alive "bombs"
req GET /v1/subjects/alice
is "nothing changed" "$(get '.templates | length')" 1
rm "$T"/bomb.*
stop_daemon

# ---- Prefer: return=minimal
MIN='Prefer: return=minimal'
TOKEN=$(new_token one)
AUTH=$TOKEN
start_daemon
# minimal TITLE STATUS: the last response has no body and reports that the preference is applied.
minimal() {
    is "$1" "$STATUS $(field Preference-Applied)" "$2 return=minimal"
    ok "$1: no body" test ! -s "$T/body"
}
send POST /v1/subjects/min/templates "$PLY" "$T/a.ply" -H "$MIN"
minimal "enroll" 201
first=$(field Location)
req GET "$first"
is "Location leads to it" "$STATUS $(get .subject)" "200 min"
send POST /v1/subjects/min/templates "$PLY" "$T/a.ply" -H 'prefer: wait=5, return="minimal"'
minimal "the same again" 204
is "Location" "$(field Location)" "$first"
send POST /v1/subjects/min/templates "$PLY" "$T/a.ply" -H 'Prefer: return=representation'
is "representation" "$STATUS $(get .subject) $(field Preference-Applied)" "200 min "
gives "409 sample_mismatch" "an error has its body" send POST /v1/subjects/min/templates "$PLY" "$T/b.ply" -H "$MIN"
is "no preference is applied" "$(field Preference-Applied)" ""
send POST /v1/subjects/min/verify "$JSON" "$T/a2.json"
id=$(get .template_id)
# only TITLE DECISION SUBJECT TEMPLATE-ID: the last response has the decision and the ids alone.
only() {
    is "$1" "$STATUS $(field Preference-Applied) $(jq -c . "$T/body")" \
        "200 return=minimal $(printf '{"decision":"%s","subject":%s,"template_id":%s}' "$2" "$3" "$4")"
}
minima() { metric 'surfaced_stage_duration_seconds_count{stage="minimal"}'; }
before=$(minima)
send POST /v1/subjects/min/verify "$JSON" "$T/a2.json" -H "$MIN"
only "verify" match '"min"' "\"$id\""
send POST "/v1/templates/$id/verify" "$PLY" "$T/b.ply" -H "$MIN"
only "verify against one template" no_match '"min"' "\"$id\""
jq -c -n --slurpfile a "$T/a2.json" '{a: $a[0], b: $a[0]}' >"$T/aa.json"
send POST /v1/compare "$JSON" "$T/aa.json" -H "$MIN"
only "compare" match null null
is "the minimal disparity is not computed" "$(minima)" "$before"
is "each is recorded" "$(sql "SELECT group_concat(kind || ' ' || outcome) FROM
    (SELECT * FROM $ENTRIES ORDER BY at DESC, seq DESC LIMIT 3)")" 'compare match,verify no_match,verify match'
send POST /v1/subjects/min/verify "$JSON" "$T/a2.json" -H 'Prefer: return=representation'
is "representation" "$STATUS $(get '.disparity_mm > 0') $(field Preference-Applied)" "200 true "
is "it is computed" "$(minima)" $((before + 1))
send POST '/v1/subjects/min/verify?detail=measure' "$JSON" "$T/a2.json" -H "$MIN"
is "detail is asked for all the same" \
    "$STATUS $(get '.minimal.volume_mm3 > 0') $(field Preference-Applied)" "200 true "
scan 1 1 "$T/part.json" --pose 0 --shift 0
jq -c '.points |= map(select(.[1] < 0))' "$T/part.json" >"$T/forehead.json"
send POST /v1/subjects/min/verify "$JSON" "$T/forehead.json" -H "$MIN"
only "a part of the face" inconclusive '"min"' "\"$id\""
gives "404 not_found" "an error has its body" send POST /v1/subjects/nobody/verify "$JSON" "$T/a2.json" -H "$MIN"
is "no preference is applied" "$(field Preference-Applied)" ""
req DELETE "$first" -H "$MIN"
minimal "delete the template" 204
req DELETE /v1/subjects/min -H "$MIN"
minimal "erase" 204
gives 404 "it is erased" req GET /v1/subjects/min

finish
