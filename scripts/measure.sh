# shellcheck shell=sh
# measure.sh -- sourced by load, large and attack: a folder $work, a daemon, and a table of targets.
# shellcheck disable=SC2034 # used by these
set -eu
BUILD=${BUILD:-build}
export SURFACED_CONFIG=/dev/null # not this machine's own
work=$(mktemp -d)
pid=
trap '[ -z "$pid" ] || kill "$pid"; rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

# needs_wrk: ends the script if wrk is not installed.
needs_wrk() {
    command -v wrk >/dev/null || {
        echo "$(basename "$0"): wrk is not installed (scripts/setup bench)" >&2
        exit 2
    }
}

# machine: prints what the figures depend on.
machine() {
    echo "date      $(date -u +%Y-%m-%d)"
    echo "commit    $(git describe --always --dirty 2>/dev/null || echo unknown)"
    echo "cpu       $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores"
    echo "load      $(cut -d' ' -f1-3 /proc/loadavg) before"
}

# start OPTION...: starts the daemon; sets pid and url.
start() {
    "$BUILD/surfaced" --listen 127.0.0.1:0 "$@" 2>"$work/log" &
    pid=$! url=
    while [ -z "$url" ]; do
        if ! kill -0 "$pid" 2>/dev/null; then
            cat "$work/log" >&2
            exit 1
        fi
        sleep 0.02
        url=$(sed -n 's|.*listening on \(http://[0-9.:]*\).*|\1|p' "$work/log" | head -n 1)
    done
}

# stop: stops the daemon; fails if its exit status is not 0.
stop() {
    kill "$pid"
    wait "$pid"
    pid=
}

# drive SECONDS CONNECTIONS ARGUMENT...: prints wrk.lua's figures.
drive() {
    d_seconds=$1 d_connections=$2
    shift 2
    wrk -t 1 -c "$d_connections" -d "${d_seconds}s" --timeout 60s -s scripts/wrk.lua "$url" -- "$@" >"$work/wrk"
    sed -n 's/^result //p' "$work/wrk" | grep . || {
        cat "$work/wrk" >&2
        exit 1
    }
}

# calc FORMAT EXPRESSION
calc() {
    awk "BEGIN { printf \"$1\", $2 }"
}

# target TITLE GOT RELATION WANTED: a row of the last table; RELATION is <= or >=.
target() {
    awk -v what="$1" -v got="$2" -v rel="$3" -v want="$4" 'BEGIN {
        held = rel == ">=" ? got + 0 >= want : got + 0 <= want
        printf "  %-58s %8s  %s %-6s %s\n", what, got, rel, want, held ? "yes" : "NO" }' \
        >>"$work/targets"
}

# targets: prints that table; fails if one was missed.
targets() {
    printf '\n== targets\n'
    cat "$work/targets"
    echo "load      $(cut -d' ' -f1-3 /proc/loadavg) after"
    ! grep -q ' NO$' "$work/targets"
}
