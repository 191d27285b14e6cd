#!/bin/sh
# Goal: the same bytes in give the same digits out: on another run, with 1 or 4 workers,
# alone or in a crowd, over HTTP or by surfacectl; apart from times and the ids of templates.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

people="1 2 3 4 5 6"
for s in $people; do
    scan "$s" 0 "$T/e$s.ply" --holes 0.02
    scan "$s" 1 "$T/p$s.ply" --pose 12 --shift 15 --points 2500
done

# answers DIR: everything asked one after the other, the answers without times in DIR.
answers() {
    mkdir -p "$1"
    for s in $people; do
        send POST "/v1/subjects/s$s/templates" "$PLY" "$T/e$s.ply"
        without_times "$T/body" >"$1/enroll$s"
    done
    for s in $people; do
        for p in "$s" $((s % 6 + 1)); do
            send POST "/v1/subjects/s$s/verify?detail=heatmap" "$PLY" "$T/p$p.ply"
            without_times "$T/body" >"$1/verify$s-$p"
        done
    done
}

start_daemon --no-auth --attempts 0 --workers 1
answers "$T/one"
stop_daemon
is "answers" "$(find "$T/one" -type f -size +100c | wc -l | tr -d ' ')" 18
rm -f "$DB"*
start_daemon --no-auth --attempts 0 --workers 4
answers "$T/four"
ok "1 and 4 workers" diff -r "$T/one" "$T/four"
answers "$T/cached"
ok "again, from memory" diff -r "$T/one" "$T/cached"
stop_daemon
start_daemon --no-auth --attempts 0 --workers 4
answers "$T/again"
ok "another run, from the database" diff -r "$T/one" "$T/again"

# What surfacectl says in JSON is what the daemon says, names and digits.
ctl() { "$BUILD/surfacectl" --json "$@" >"$T/said" 2>"$T/err"; }
same() { is "$1" "$(jq -cS 'del(.timing_ms, .to_reencode)' "$T/said")" "$(jq -cS 'del(.timing_ms)' "$T/body")"; }
send POST "/v1/subjects/s1/verify?detail=measure" "$PLY" "$T/p1.ply"
ctl --db "$DB" verify s1 "$T/p1.ply"
same "verify"
id=$(get .template_id)
req GET "/v1/templates/$id"
ctl --db "$DB" template show "$id"
same "a template"
ctl --db "$DB" subject set s1 --consent C-17
req GET /v1/subjects/s1
ctl --db "$DB" subject show s1
jq '.templates[] |= del(.to_reencode)' "$T/said" >"$T/bare" && mv "$T/bare" "$T/said"
same "a subject"
scan 1 0 "$T/a.xyz"
scan 1 0 "$T/a.json"
jq '{a: ., b: .}' "$T/a.json" >"$T/ab.json"
send POST '/v1/compare?detail=measure' "$JSON" "$T/ab.json"
ctl compare "$T/a.xyz" "$T/a.xyz"
same "compare"
send POST /v1/asymmetry 'Content-Type: text/plain' "$T/a.xyz"
ctl asymmetry "$T/a.xyz"
same "asymmetry"

# All at once, several times over.
mkdir "$T/crowd"
clients=
for round in 1 2 3; do
    for s in $people; do
        p=$((s % 6 + 1))
        curl -sS -m 60 -o "$T/crowd/$round-$s-$s" -H "$PLY" --data-binary "@$T/p$s.ply" \
            "$URL/v1/subjects/s$s/verify?detail=heatmap" &
        clients="$clients $!"
        curl -sS -m 60 -o "$T/crowd/$round-$s-$p" -H "$PLY" --data-binary "@$T/p$p.ply" \
            "$URL/v1/subjects/s$s/verify?detail=heatmap" &
        clients="$clients $!"
    done
done
# shellcheck disable=SC2086 # a list
wait $clients
differ=0
for f in "$T"/crowd/*; do
    name=$(basename "$f")
    without_times "$f" | cmp -s - "$T/one/verify${name#*-}" || differ=$((differ + 1))
done
is "36 at once, of which differ" "$differ" 0
finish
