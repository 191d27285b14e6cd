#!/bin/sh
# Goal: at SIGTERM under load, accepted connections get a complete response; others are
# refused before the client has sent anything.
. tests/box/lib.sh

scan 1 0 "$T/a.ply" --points 1500
scan 1 1 "$T/p.ply" --points 1500

# verify_on CLIENT: again and again, each time by a connection of its own, until refused;
# "CURL-EXIT-STATUS HTTP-STATUS" of each in c.CLIENT.
verify_on() {
    n=0
    while [ "$n" -lt 2000 ]; do
        n=$((n + 1))
        http=$(curl -sS -m 60 -o "$T/o.$1" -w '%{http_code}' -H "$PLY" \
            --data-binary "@$T/p.ply" "$URL/v1/subjects/alice/verify" 2>/dev/null)
        code=$?
        [ "$code" != 0 ] || jq -e .request_id "$T/o.$1" >/dev/null 2>&1 ||
            jq -e .decision "$T/o.$1" >/dev/null 2>&1 || http=broken
        echo "$code $http" >>"$T/c.$1"
        [ "$code" = 0 ] || break
    done
}

for round in 1 2 3 4 5; do
    rm -f "$T"/c.*
    start_daemon --no-auth --workers 2
    send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
    clients=
    for c in $(seq 12); do
        verify_on "$c" &
        clients="$clients $!"
    done
    tries=0
    until [ "$(cat "$T"/c.* 2>/dev/null | wc -l)" -ge 30 ] || [ "$tries" -ge 600 ]; do
        tries=$((tries + 1))
        sleep 0.05
    done
    stop_daemon
    # shellcheck disable=SC2086 # a list
    wait $clients
    # 7: refused to connect; 56: connected to the system, and reset before the daemon took it
    is "round $round: 200 or 503 or refused, nothing else" \
        "$(cat "$T"/c.* | grep -Ev '^(0 (200|503)|(7|56) 000)$' | sort | uniq -c)" ""
    is "round $round: the stop was by itself" "$(grep -c 'msg="stopped"' "$LOG")" 1
done
finish
