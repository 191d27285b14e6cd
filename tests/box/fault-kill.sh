#!/bin/sh
# Goal: after kill -9 amid enrolments and a restart, each enrolment with a 201 response is
# there, any other is complete or absent, and templates and events belong to each other.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

for s in $(seq 8); do
    scan "$s" 0 "$T/s$s.ply" --points 1500
    scan "$s" 1 "$T/p$s.ply" --points 1500
done

# enroll_on ROUND CLIENT: subject after subject until there is no response; "STATUS
# SUBJECT" of each in a.CLIENT.
enroll_on() {
    n=0
    while [ "$n" -lt 1000 ]; do
        n=$((n + 1))
        subject=r$1-c$2-$n
        answer=$(curl -sS -m 60 -o /dev/null -w '%{http_code}' -H "$PLY" \
            --data-binary "@$T/s$2.ply" "$URL/v1/subjects/$subject/templates" 2>/dev/null)
        echo "$answer $subject" >>"$T/a.$2"
        [ "$answer" != 000 ] || break
    done
}

# answered: how many 201 responses there were so far in this round.
answered() {
    cat "$T"/a.* 2>/dev/null | grep -c '^201 '
}

total=0
for round in 1 2 3 4 5; do
    rm -f "$T"/a.*
    start_daemon --no-auth --workers 2
    clients=
    for c in $(seq 8); do
        enroll_on "$round" "$c" &
        clients="$clients $!"
    done
    tries=0
    until [ "$(answered)" -ge $((round * 4)) ] || [ "$tries" -ge 4000 ]; do
        tries=$((tries + 1))
        sleep 0.03
    done
    kill -9 "$PID"
    wait "$PID" 2>/dev/null
    PID=
    # shellcheck disable=SC2086 # a list
    wait $clients
    ok "round $round: some were answered" test "$(answered)" -ge 1
    total=$((total + $(answered)))

    start_daemon --no-auth
    lost=
    cat "$T"/a.* | sed -n 's/^201 //p' >"$T/kept"
    while read -r subject; do
        req GET "/v1/subjects/$subject"
        [ "$STATUS $(get '.templates | length')" = "200 1" ] || lost="$lost $subject"
    done <"$T/kept"
    is "round $round: nothing that was answered is lost" "$lost" ""
    first=$(head -n 1 "$T/kept") client=${first#*-c}
    send POST "/v1/subjects/$first/verify" "$PLY" "$T/p${client%-*}.ply"
    is "round $round: the first one verifies" "$STATUS $(get .decision)" "200 match"
    stop_daemon
    is "round $round: the database is whole" "$(sqlite3 "$DB" 'PRAGMA integrity_check')" ok
    ok "round $round: every template can be read" "$BUILD/surfacectl" --db "$DB" check-database >"$T/check"
    is "round $round: templates without event, events without template" "$(sqlite3 "$DB" \
        "SELECT (SELECT count(*) FROM templates WHERE id NOT IN
            (SELECT object FROM change_log WHERE kind = 'enroll')),
            (SELECT count(*) FROM change_log WHERE kind = 'enroll' AND object NOT IN
            (SELECT id FROM templates))")" "0|0"
    is "round $round: subjects without template" "$(sqlite3 "$DB" \
        'SELECT count(*) FROM subjects WHERE uid NOT IN (SELECT uid FROM templates)')" 0
done
ok "in all $total were answered" test "$total" -ge 40
finish
