#!/bin/sh
# Goal: on a full disk requests that write get 503 and store nothing, while the others are
# served; with room again all are served.  A verification writes too: its decision is told only
# once it is recorded.
# A limit on the size of files stands for the full disk.
. tests/box/lib.sh

for s in $(seq 12); do
    scan "$s" 0 "$T/s$s.ply"
done
scan 1 1 "$T/probe.ply"
"$BUILD/facegen" --subject 1 --points 1000 --format json | jq '{a: ., b: .}' >"$T/two.json"
start_daemon --no-auth
gives 201 "enroll with room" send POST /v1/subjects/s1/templates "$PLY" "$T/s1.ply"
prlimit --pid "$PID" --fsize=600000 # only now: a sanitizer's files at the start are larger
stored=1
STATUS=201
for s in $(seq 2 12); do
    send POST "/v1/subjects/s$s/templates" "$PLY" "$T/s$s.ply"
    [ "$STATUS" = 201 ] || break
    stored=$((stored + 1))
done
problem "the disk is full (after $stored)" 503 storage
again "when" 1
ok "the log says why" grep -Eq 'status=503 .*fault="' "$LOG"
gives "404 not_found" "the failed enrolment stored nothing" req GET "/v1/subjects/s$s"
req GET '/v1/subjects?limit=100'
is "all enrolments before it are stored" "$(get '.subjects | length')" "$stored"
told=0 # entries take less room than a template: some of them still have it
for n in $(seq 40); do
    send POST /v1/subjects/s1/verify "$PLY" "$T/probe.ply"
    [ "$STATUS" = 200 ] || break
    told=$n
done
problem "verification needs room for its event" 503 storage
is "it is not counted" "$(metric 'surfaced_decisions_total{decision="match"}')" "$told"
for _ in $(seq 40); do # an event alone takes less room than a verification
    send POST /v1/compare "$JSON" "$T/two.json"
    is "a comparison is served" "$STATUS $(get .decision)" "200 match"
    [ "$(metric surfaced_lost_events_total)" = 0 ] || break
done
is "without its event" "$(metric surfaced_lost_events_total)" 1
ok "as the log says" grep -q 'msg="event lost".*event=compare' "$LOG"
is "as errors of the database: an enrolment, a verification, an event" \
    "$(metric 'surfaced_database_errors_total{kind="io"}')" 3
alive "a full disk"
stop_daemon

start_daemon --no-auth
gives 201 "enroll with room again" send POST "/v1/subjects/s$s/templates" "$PLY" "$T/s$s.ply"
send POST /v1/subjects/s1/verify "$PLY" "$T/probe.ply"
is "and a verification" "$STATUS $(get .decision)" "200 match"
is "the database is intact" "$(sqlite3 "$DB" 'PRAGMA integrity_check')" ok
finish
