#!/bin/sh
# Goal: nothing of a face stays in the daemon's memory once its subject is erased, over HTTP or by
# the command, nor what large requests needed; and no core file is written.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

if nm "$BUILD/surfaced" 2>/dev/null | grep -Eq '__(asan|tsan|ubsan)_'; then
    echo "SKIP $0: a sanitizer has an allocator of its own"
    exit 0
fi
command -v python3 >/dev/null 2>&1 || {
    echo "SKIP $0: python3 is not installed"
    exit 0
}

# in_memory FILE...: sets FOUND: the points of the scans that are in the daemon's memory, as
# float32, as double, and as integers.
in_memory() {
    FOUND=$(python3 tests/box/memory.py "$PID" "$@")
}

# gone TITLE FILE...
gone() {
    g_title=$1
    shift
    in_memory "$@"
    is "$g_title: points in memory" "$FOUND" '0 0 0'
}

# resident: in KB.
resident() {
    sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$PID/status"
}

scan 1 0 "$T/a.ply"
scan 1 1 "$T/b.ply" --pose 8 --shift 10
scan 1 1 "$T/b.json" --pose 8 --shift 10
scan 2 0 "$T/c.ply"

# ---- erased; the daemon's own children cannot be looked into but by root
start_daemon --no-auth --workers 2
in_memory "$T/a.ply"
if [ -z "$FOUND" ]; then
    echo "SKIP $0: not permitted to read the daemon's memory"
    finish
fi
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply" -H 'Idempotency-Key: "1"'
is "enrolled" "$STATUS" 201
for i in 1 2 3 4; do # both workers
    send POST /v1/subjects/alice/verify "$PLY" "$T/b.ply"
    is "verified ($i)" "$STATUS $(get .decision)" "200 match"
done
send POST /v1/subjects/alice/verify "$JSON" "$T/b.json"
is "as JSON" "$STATUS $(get .decision)" "200 match"
send POST "/v1/subjects/alice/verify?detail=heatmap" "$PLY" "$T/b.ply"
is "with a heat map" "$STATUS" 200
gzip -c "$T/b.ply" >"$T/b.gz"
send POST /v1/check "$PLY" "$T/b.gz" -H 'Content-Encoding: gzip'
is "checked" "$STATUS" 200
sleep 1
in_memory "$T/a.ply"
is "the template is in the cache" "${FOUND##* }" 3000
gone "of the probes nothing is, after a second" "$T/b.ply"
req DELETE /v1/subjects/alice
is "erased over HTTP" "$STATUS" 200
sleep 1
gone "erased over HTTP" "$T/a.ply" "$T/b.ply"

for how in subject template; do
    send POST /v1/subjects/carol/templates "$PLY" "$T/c.ply"
    is "enrolled" "$STATUS" 201
    id=$(get .template_id)
    send POST /v1/subjects/carol/verify "$PLY" "$T/c.ply"
    in_memory "$T/c.ply"
    is "the template is in the cache" "${FOUND##* }" 3000
    case $how in
    subject) ctl_exits 0 --yes subject erase carol ;;
    template) ctl_exits 0 --yes template delete "$id" ;;
    esac
    sleep 1
    gone "erased by surfacectl $how" "$T/c.ply"
done
stop_daemon

# ---- large requests
start_daemon --no-auth --workers 2
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
send POST /v1/subjects/alice/verify "$PLY" "$T/b.ply"
sleep 1
before=$(resident)
for points in 300000 1000000; do
    scan 1 2 "$T/large.ply" --points $points
    send POST /v1/subjects/alice/verify "$PLY" "$T/large.ply"
    is "$points points" "$STATUS $(get .decision)" "200 match"
    scan 1 2 "$T/large.json" --points $points
    send POST /v1/subjects/alice/verify "$JSON" "$T/large.json"
    is "$points points as JSON" "$STATUS $(get .decision)" "200 match"
    rm "$T/large.json"
    sleep 1
    ok "memory afterwards: $(resident) KB, before $before KB" \
        test "$(resident)" -lt $((before + 8000))
done
gone "of the large scan" "$T/large.ply"

# ---- core files
stop_daemon
# shellcheck disable=SC2317 # called by ok
not() {
    ! "$@"
}
# dumps COMMAND: would a core file be written if it crashed now?  The kernel says so to its parent.
# shellcheck disable=SC3045 # dash and bash have ulimit -c
dumps() {
    (ulimit -c unlimited 2>/dev/null && cd "$T" && python3 -c '
import os, sys, time
pid = os.fork()
if pid == 0:
    os.execv(sys.argv[1], sys.argv[1:])
time.sleep(1.5)
os.kill(pid, 11)
sys.exit(0 if os.WCOREDUMP(os.waitpid(pid, 0)[1]) else 1)' "$@" 2>/dev/null)
}
BUILD=$(cd "$BUILD" && pwd)
if dumps /bin/sleep 100; then # else the machine writes none anyway
    ok "the daemon writes none" not dumps "$BUILD/surfaced" --db "$DB" --listen 127.0.0.1:0
    mkfifo "$T/fifo"
    ok "nor surfacectl" not dumps "$BUILD/surfacectl" simplify "$T/fifo" -o "$T/out.ply"
fi
finish
