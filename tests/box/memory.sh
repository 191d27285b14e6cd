#!/bin/sh
# Goal: nothing of a face stays in the daemon's memory once its subject is erased, over HTTP or by
# the command, nor what large requests needed; another process of its user cannot read it; and no
# core file is written.  The scans have the scanner's axes: a template's points are those sent, to be looked for.
. tests/box/lib.sh

if sanitized; then
    echo "SKIP $0: a sanitizer has an allocator of its own"
    exit 0
fi

# in_memory FILE...: sets FOUND: the points of the scans that are in the daemon's memory, as
# float32, as double, and as integers.
in_memory() {
    FOUND=$("$BUILD/memory" "$PID" "$@" 2>"$T/out")
}

# gone TITLE FILE...: within a second; the rest is for a machine that is busy.
gone() {
    g_title=$1 tries=0
    shift
    in_memory "$@"
    while [ "$FOUND" != '0 0 0' ] && [ "$tries" -lt 30 ]; do
        tries=$((tries + 1))
        sleep 0.1
        in_memory "$@"
    done
    is "$g_title: points in memory" "$FOUND" '0 0 0'
    [ "$FOUND" = '0 0 0' ] || head "$T/out" # where
}

# resident: in KB.
resident() {
    sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$PID/status"
}

# shellcheck disable=SC2317 # called by soon
small_again() {
    [ "$(resident)" -lt $((before + 8000)) ]
}

scan 1 0 "$T/a.ply"
scan 1 1 "$T/b.ply" --pose 8 --shift 10
scan 1 1 "$T/b.json" --pose 8 --shift 10
scan 2 0 "$T/c.ply"

# erased HOW OPTION...: with a daemon of these options.
erased() {
    how=$1
    shift
    start_daemon --no-auth --workers 2 "$@"
    in_memory "$T/a.ply"
    if [ -z "$FOUND" ]; then # the daemon's own children cannot be looked into but by root
        echo "SKIP $0: not permitted to read the daemon's memory"
        finish
    fi
    gives 201 "$how: enrolled" send POST "/v1/subjects/alice/templates?axes=scanner" "$PLY" "$T/a.ply"
    for i in 1 2 3 4; do # both workers
        send POST "/v1/subjects/alice/verify?axes=scanner" "$PLY" "$T/b.ply"
        is "$how: verified ($i)" "$STATUS $(get .decision)" "200 match"
    done
    send POST /v1/subjects/alice/verify "$JSON" "$T/b.json"
    is "$how: as JSON" "$STATUS $(get .decision)" "200 match"
    send POST "/v1/subjects/alice/verify?axes=scanner&detail=heatmap" "$PLY" "$T/b.ply"
    is "$how: with a heat map" "$STATUS" 200
    gives 200 "$how: checked" send POST /v1/check "$PLY" "$T/b.gz" -H 'Content-Encoding: gzip'
    gone "$how: of the probes nothing is, after a second" "$T/b.ply"
    gone "$how: nor of the template" "$T/a.ply"
    gives 200 "$how: erased over HTTP" req DELETE /v1/subjects/alice
    gone "$how: erased over HTTP" "$T/a.ply" "$T/b.ply"

    for by in subject template; do
        gives 201 "$how: enrolled" send POST "/v1/subjects/carol/templates?axes=scanner" "$PLY" "$T/c.ply"
        id=$(get .template_id)
        send POST "/v1/subjects/carol/verify?axes=scanner" "$PLY" "$T/c.ply"
        case $by in
        subject) ctl_exits 0 --yes subject erase carol ;;
        template) ctl_exits 0 --yes template delete "$id" ;;
        esac
        gone "$how: erased by surfacectl $by" "$T/c.ply"
    done
    stop_daemon
}
gzip -c "$T/b.ply" >"$T/b.gz"
erased plaintext
if openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -noenc -days 2 -subj /CN=x \
    -addext subjectAltName=IP:127.0.0.1 -keyout "$T/tls.key" -out "$T/tls.pem" 2>"$T/out"; then
    chmod 600 "$T/tls.key"
    export CURL_CA_BUNDLE="$T/tls.pem"
    erased TLS --tls-cert "$T/tls.pem" --tls-key "$T/tls.key"
    matches "$URL" '^https:' || ok "TLS: the address is $URL" false
    unset CURL_CA_BUNDLE
else
    echo "SKIP TLS: no certificate is made: $(tail -n 1 "$T/out")"
fi

# ---- descriptors: the gallery has those who may be found, and nobody else's

# described TITLE WANTED FILE...: so many of the scans' descriptors are in the daemon's memory, within 3 s.
described() {
    d_title=$1 d_wanted=$2 tries=0
    shift 2
    while d_found=$("$BUILD/descriptor" "$PID" "$@") && [ "$d_found" != "$d_wanted" ] && [ "$tries" -lt 30 ]; do
        tries=$((tries + 1))
        sleep 0.1
    done
    is "$d_title: descriptors in memory" "$d_found" "$d_wanted"
}
start_daemon --no-auth --workers 2
for n in 4 5 6; do
    scan $n 0 "$T/d$n.ply"
    scan $n 1 "$T/q$n.ply"
    send POST "/v1/subjects/d$n/templates" "$PLY" "$T/d$n.ply"
    send POST /v1/identify "$PLY" "$T/q$n.ply"
    is "identified" "$STATUS $(get .subject)" "200 d$n"
done
described "enrolled" 3 "$T/d4.ply" "$T/d5.ply" "$T/d6.ply"
described "nor of a probe" 0 "$T/q4.ply" "$T/q5.ply"
req DELETE /v1/subjects/d4
ctl_exits 0 --yes subject erase d5
ctl_exits 0 subject set d6 --identify no
described "erased, and opted out" 0 "$T/d4.ply" "$T/d5.ply" "$T/d6.ply"
for file in "$T"/faces.db*; do
    is "in $(basename "$file")" "$("$BUILD/descriptor" "$file" "$T/d4.ply" "$T/d5.ply" "$T/d6.ply")" 0
done
stop_daemon

# ---- large requests
start_daemon --no-auth --workers 2
send POST "/v1/subjects/alice/templates?axes=scanner" "$PLY" "$T/a.ply"
send POST "/v1/subjects/alice/verify?axes=scanner" "$PLY" "$T/b.ply"
sleep 1 # what the worker had is given back
before=$(resident)
for points in 300000 1000000; do
    scan 1 2 "$T/large.ply" --points $points
    send POST "/v1/subjects/alice/verify?axes=scanner" "$PLY" "$T/large.ply"
    is "$points points" "$STATUS $(get .decision)" "200 match"
    scan 1 2 "$T/large.json" --points $points
    send POST "/v1/subjects/alice/verify?axes=scanner" "$JSON" "$T/large.json"
    is "$points points as JSON" "$STATUS $(get .decision)" "200 match"
    rm "$T/large.json"
    ok "memory afterwards: $(resident) KB, before $before KB" soon small_again
done
gone "of the large scan" "$T/large.ply"

stop_daemon

# ---- another process of the daemon's user
# shellcheck disable=SC2317 # called by ok
not() {
    ! "$@"
}
as=
if [ "$(id -u)" = 0 ]; then # who may read all
    as="setpriv --reuid 65534 --regid 65534 --clear-groups"
    chmod 711 "$T"
fi
mkdir "$T/own"
cp "$DB" "$DB.key" "$T/own"
[ -z "$as" ] || chown -R 65534:65534 "$T/own"
# shellcheck disable=SC2086 # a command and its options
reads() {
    $as head -c 0 "/proc/$1/$2" 2>"$T/out"
}
$as sleep 100 &
sleeper=$!
ok "it begins" soon grep -q sleep "/proc/$sleeper/comm"
if reads $sleeper mem && $as "$BUILD/surfaced" --version >"$T/out" 2>&1; then
    DB=$T/own/faces.db UNDER=$as start_daemon --no-auth
    is "the daemon's user" "$(stat -c %u "/proc/$sleeper")" "$(awk '/^Uid/ { print $2 }' "/proc/$PID/status")"
    for file in mem maps environ; do
        ok "it can read $file of its other processes" reads $sleeper $file
        ok "but not of the daemon" not reads "$PID" $file
    done
    stop_daemon
else
    echo "SKIP another process: none can be read here, or no user but root can run the daemon"
fi
kill $sleeper

# ---- core files
# dumps COMMAND: would a core file be written if it crashed now?  The kernel says so to its parent.
# shellcheck disable=SC3045 # dash and bash have ulimit -c
dumps() {
    (ulimit -c unlimited 2>/dev/null && cd "$T" && python3 -c '
import os, sys, time
pid = os.fork()
if pid == 0:
    os.execv(sys.argv[1], sys.argv[1:])
begun = "(%s) S" % os.path.basename(sys.argv[1])
for i in range(600):
    with open("/proc/%d/stat" % pid) as f:
        if begun in f.read():
            break
    time.sleep(0.05)
else:
    print("it does not run")
os.kill(pid, 11)
sys.exit(0 if os.WCOREDUMP(os.waitpid(pid, 0)[1]) else 1)' "$@" >"$T/ran" 2>/dev/null)
}
BUILD=$(cd "$BUILD" && pwd)
if ! command -v python3 >/dev/null 2>&1; then
    echo "SKIP core files: python3 is not installed"
elif dumps /bin/sleep 100; then # else the machine writes none anyway
    mkfifo "$T/fifo"
    for command in "surfaced --db $DB --listen 127.0.0.1:0" \
        "surfacelab simplify $T/fifo --tolerance 1 -o $T/out.ply"; do
        # shellcheck disable=SC2086 # a command and its arguments
        ok "none is written by $command" not dumps "$BUILD"/$command
        is "which ran" "$(cat "$T/ran")" ''
    done
fi
finish
