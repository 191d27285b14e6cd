#!/bin/sh
# Goal: the same input gives the same digits: on another run, with 1 or 4 workers, one request
# at a time or many, over HTTP or by surfacectl; except times and template ids.
. tests/box/lib.sh

subjects="1 2 3 4 5 6"
for s in $subjects; do
    scan "$s" 0 "$T/e$s.ply" --holes 0.02
    scan "$s" 1 "$T/p$s.ply" --pose 12 --shift 15 --points 2500
done

# responses DIR: sends all requests one after the other; DIR gets the responses without times.
responses() {
    mkdir -p "$1"
    for s in $subjects; do
        send POST "/v1/subjects/s$s/templates" "$PLY" "$T/e$s.ply"
        without_times "$T/body" >"$1/enroll$s"
    done
    for s in $subjects; do
        for p in "$s" $((s % 6 + 1)); do
            send POST "/v1/subjects/s$s/verify?detail=heatmap" "$PLY" "$T/p$p.ply"
            without_times "$T/body" >"$1/verify$s-$p"
        done
    done
}

start_daemon --no-auth --attempts 0 --workers 1
responses "$T/one"
stop_daemon
is "responses" "$(find "$T/one" -type f -size +100c | wc -l | tr -d ' ')" 18
rm -f "$DB"*
start_daemon --no-auth --attempts 0 --workers 4
responses "$T/four"
ok "1 and 4 workers" diff -r "$T/one" "$T/four"
stop_daemon
start_daemon --no-auth --attempts 0 --workers 4
responses "$T/again"
ok "another run, from the database" diff -r "$T/one" "$T/again"

# surfacectl's JSON is the daemon's, names and digits; of the times the names.
same() {
    named='if .timing_ms then .timing_ms |= keys else . end'
    is "$1" "$(jq -c "$named | del(.to_reencode)" "$T/ctl")" "$(jq -c "$named" "$T/body")"
}
send POST "/v1/subjects/s1/verify?detail=measure" "$PLY" "$T/p1.ply"
ctl verify s1 "$T/p1.ply"
same "verify"
id=$(get .template_id)
req GET "/v1/templates/$id"
ctl template show "$id"
same "a template"
ctl subject set s1 --consent C-17
req GET /v1/subjects/s1
ctl subject show s1 # which does not know the daemon's limits of attempts
jq 'del(.attempts)' "$T/body" >"$T/bare" && mv "$T/bare" "$T/body"
jq '.templates[] |= del(.to_reencode)' "$T/ctl" >"$T/bare" && mv "$T/bare" "$T/ctl"
same "a subject"
scan 1 0 "$T/a.xyz"
scan 1 0 "$T/a.json"
jq '{a: ., b: .}' "$T/a.json" >"$T/ab.json"
send POST '/v1/compare?detail=measure' "$JSON" "$T/ab.json"
"$BUILD/surfacectl" --json compare "$T/a.json" "$T/a.json" >"$T/ctl"
same "compare"

# Many requests at once, each several times.
for round in 1 2 3; do
    for s in $subjects; do
        for p in $s $((s % 6 + 1)); do
            beside "$round-$s-$p" POST "/v1/subjects/s$s/verify?detail=heatmap" -H "$PLY" \
                --data-binary "@$T/p$p.ply"
        done
    done
done
all_sent
differ=0
for f in "$T"/o.*; do
    name=${f##*/o.}
    without_times "$f" | cmp -s - "$T/one/verify${name#*-}" || differ=$((differ + 1))
done
is "responses that differ, of 36 at once" "$differ" 0
finish
