#!/bin/sh
# Goal: a verification over HTTP reads the database twice (the token; the subject, its attempts,
# the calibration, the templates and what models are not in memory) and writes it once (attempts,
# event, last seen), be it a match or not; who is refused writes nothing; an enrolment reads
# twice and writes once.
. tests/box/lib.sh

[ -f "$BUILD/record_shim.so" ] || {
    echo "SKIP $0: there is no record_shim.so in a build with sanitizers"
    exit 0
}
scan 1 0 "$T/a.ply"
scan 1 1 "$T/again.ply"
scan 1 2 "$T/third.ply"
scan 1 3 "$T/fourth.ply"
scan 2 0 "$T/other.ply"

# begins: what was begun since the last call, "READS WRITES".
begins() {
    awk 'NF { n[$0]++; all++ } END { w = n["BEGIN IMMEDIATE;"]; print all - w, w + 0 }' \
        "$T/begins"
    : >"$T/begins"
}

# counted TITLE FILE RESULT BEGINS [PATH]: a verification of alice.
counted() {
    send POST "${5:-/v1/subjects/alice/verify}" "$PLY" "$T/$2"
    is "$1" "$STATUS $(get '.decision // .code')" "$3"
    is "$1: reads and writes" "$(begins)" "$4"
}

UNDER="env LD_PRELOAD=$(cd "$BUILD" && pwd)/record_shim.so RECORD_BEGINS=$T/begins"
for cache in 0 64; do
    start_daemon --attempts 2 --attempt-wait 3600 --cache-mb "$cache"
    [ -n "$AUTH" ] || ctl token create --scope enroll,verify,read test
    [ -n "$AUTH" ] || AUTH=$(said .secret)
    send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply" # notes the token's use
    template=$(get .template_id)
    begins >/dev/null
    counted "cache of $cache MB: match" again.ply "200 match" "2 1"
    counted "cache of $cache MB: match again" again.ply "200 match" "2 1"
    counted "cache of $cache MB: non-match" other.ply "200 no_match" "2 1"
    counted "cache of $cache MB: match after it" again.ply "200 match" "2 1"
    counted "cache of $cache MB: one template" again.ply "200 match" "2 1" \
        "/v1/templates/$template/verify"
    counted "cache of $cache MB: one template, non-match" other.ply "200 no_match" "2 1" \
        "/v1/templates/$template/verify"
    counted "cache of $cache MB: the last that is allowed" other.ply "200 no_match" "2 1"
    counted "cache of $cache MB: locked out" again.ply "429 too_many_attempts" "2 0"
    "$BUILD/surfacectl" --db "$DB" attempts reset alice >"$T/out"
    stop_daemon
    : >"$T/begins"
done

start_daemon
req GET /v1/subjects/alice
begins >/dev/null
for size in two three; do # templates, none of them in memory at first
    case $size in two) file=again.ply ;; *) file=third.ply ;; esac
    send POST /v1/subjects/alice/templates "$PLY" "$T/$file"
    is "enrolled: $size" "$STATUS" 201
    is "enrolled: $size: reads and writes" "$(begins)" "2 1"
done
send POST /v1/subjects/alice/templates "$PLY" "$T/other.ply"
is "does not fit" "$STATUS" 409
is "does not fit: reads and writes" "$(begins)" "2 1"
counted "three templates" fourth.ply "200 match" "2 1"
echo rubbish >"$T/rubbish"
send POST /v1/subjects/alice/verify "$PLY" "$T/rubbish"
is "a bad body: reads and writes" "$STATUS $(begins)" "400 2 0"
finish
