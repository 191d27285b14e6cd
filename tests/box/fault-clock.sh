#!/bin/sh
# Goal: when the wall clock steps back or forward, requests are served, waits end, and
# lists stay in the order of keys, not of times.  Only reported times show the step.
. tests/box/lib.sh
needs faketime
if sanitized; then
    echo "SKIP $0: faketime's library and a sanitizer's do not go together"
    exit 0
fi

for n in 0 1 2; do
    scan 1 "$n" "$T/a$n.ply" --points 1500
done
start_clocked --no-auth
gives 201 "before the step" send POST /v1/subjects/alice/templates "$PLY" "$T/a0.ply"
first=$(get .created)
for step in -3d +3d -400d; do
    clock "$step"
    send POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
    is "$step: verify" "$STATUS $(get .decision)" "200 match"
    gives 200 "$step: ready" req GET /readyz
done
gives 201 "a sample after the step back" send POST /v1/subjects/alice/templates "$PLY" "$T/a1.ply"
ok "its time ($(get .created)) is the clock's, before the first's ($first)" \
    test "$(printf '%s\n' "$first" "$(get .created)" | sort | head -n 1)" = "$(get .created)"
second=$(get .template_id)
gives 201 "another" send POST /v1/subjects/alice/templates "$PLY" "$T/a2.ply"
req GET /v1/subjects/alice
is "samples are in the order of enrolment" "$(get '.templates | length, .[1].template_id' |
    tr '\n' ' ')" "3 $second "
stop_daemon
is "the database is whole" "$(sqlite3 "$DB" 'PRAGMA integrity_check')" ok
finish
