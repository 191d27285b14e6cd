#!/bin/sh
# Goal: a verification asks the database no more often than it has to.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
[ -f "$BUILD/record_shim.so" ] || {
    echo "SKIP $0: a sanitized build has no record_shim.so"
    exit 0
}

# store_admit() and store_settle() make it 2 and 1.
READS=6 WRITES=1

begun() {
    grep -cx "$1;" "$T/begins"
}

scan 1 0 "$T/s1.ply"
scan 1 1 "$T/s2.ply"
ctl init
ctl enroll alice "$T/s1.ply"
ctl token create gate --scope verify
AUTH=$(said .token)
RECORD_BEGINS=$T/begins UNDER="env LD_PRELOAD=$BUILD/record_shim.so"
export RECORD_BEGINS
start_daemon
for n in 1 2 3; do # the first loads the template, and notes that the token is in use
    : >"$T/begins"
    send POST /v1/subjects/alice/verify "$PLY" "$T/s2.ply"
    is "verified" "$STATUS $(get .decision)" "200 match"
    echo "$n: $(begun BEGIN) reads, $(begun 'BEGIN IMMEDIATE') writes"
done
ok "at most $READS reads" test "$(begun BEGIN)" -le "$READS"
ok "at most $WRITES writes" test "$(begun 'BEGIN IMMEDIATE')" -le "$WRITES"
stop_daemon
finish
