#!/bin/sh
# Goal: where another process has locked the database, the daemon says so after a bounded wait, and
# reading goes on.  A file that cannot be written is in test_damaged.c, a log that cannot be appended
# to in test_admit.c.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

for s in 1 2 3 4 5 6; do
    scan "$s" 0 "$T/s$s.ply" --points 1500
    scan "$s" 1 "$T/p$s.ply" --points 1500
done

# ---- locked by another process
start_daemon --no-auth --workers 6
gives 201 "enrolled before" send POST /v1/subjects/s1/templates "$PLY" "$T/s1.ply"
hold_db 'BEGIN IMMEDIATE'
clients=
for s in 2 3 4 5 6; do # each waits as long as one: not for the others' waiting
    curl -sS -m 60 -o /dev/null -w '%{http_code} %{time_total}\n' -H "$PLY" \
        --data-binary "@$T/s$s.ply" "$URL/v1/subjects/s$s/templates" >"$T/b.$s" &
    clients="$clients $!"
done
gives 200 "reading goes on" req GET /v1/subjects/s1
gives 200 "so does /healthz" req GET /healthz
gives 200 "so does /readyz" req GET /readyz
# shellcheck disable=SC2086 # a list
wait $clients
is "enrolling does not" "$(cut -d ' ' -f 1 "$T"/b.* | tr '\n' ' ')" "503 503 503 503 503 "
# 5 s by the daemon's clock; the rest is for a machine that is busy.
ok "after a wait that is bounded ($(cut -d ' ' -f 2 "$T"/b.* | tr '\n' ' '))" \
    test "$(cut -d ' ' -f 2 "$T"/b.* | awk '$1 > 15' | wc -l)" -eq 0
gives "503 busy" "one more" send POST /v1/subjects/s2/templates "$PLY" "$T/s2.ply"
again "when" 1
gives "503 busy" "nor does deleting" req DELETE /v1/subjects/s1
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
problem "a verification that cannot be recorded is not told" 503 busy
release_db
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "and is after it" "$STATUS $(get .decision)" "200 match"
ctl audit show
is "one event, of the one that was told" \
    "$(said '[.entries[] | select(.kind == "verify") | .outcome] | join(" ")')" match
gives 201 "enrolled after it" send POST /v1/subjects/s2/templates "$PLY" "$T/s2.ply"
req GET '/v1/subjects?limit=100'
is "nothing of the refused is there" "$(get '[.subjects[].subject] | join(" ")')" "s1 s2"
errors() {
    metric "surfaced_database_errors_total{kind=\"$1\"}"
}
is "each refused request is counted" "$(errors busy) $(errors io) $(errors corrupt) $(errors other)" "8 0 0 0"

# ---- damaged
damage_faces 1
gives "500 internal" "a damaged template" send POST /v1/subjects/s2/verify "$PLY" "$T/p2.ply"
is "it is counted too" "$(errors busy) $(errors io) $(errors corrupt) $(errors other)" "8 0 1 0"

finish
