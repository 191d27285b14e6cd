#!/bin/sh
# Goal: one system call of a command that writes fails, or the command is killed there, or may not
# write in a folder: no key and no database is lost, what was acknowledged is there, and the command,
# run again, completes.  How: faults.py.
# faults.sh [file|owner|server [CASE [LAYOUT [FAULT...]]]]: some of it; server: by scripts/with_postgres.
# FAULT_POINTS: faults of each case, or all; SEED: chooses them.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section test strace
command -v python3 >/dev/null || {
    echo "SKIP $0: python3 is not installed"
    exit 0
}
strace -o "$T/said" true 2>/dev/null || {
    echo "SKIP $0: strace may trace no process here"
    exit 0
}
unset LD_PRELOAD
export PYTHONDONTWRITEBYTECODE=1
if [ -n "${PGHOST:-}" ]; then engines=server; else engines='file owner'; fi
if [ $# -gt 0 ]; then
    engines=$1
    shift
fi
build=$(cd "$BUILD" && pwd -P)
T=$(cd "$T" && pwd -P)
chmod 711 "$T"
for engine in $engines; do
    mkdir -m 711 "$T/$engine"
    python3 tests/box/faults.py "$build" "$T/$engine" "$engine" "$@"
    is "faults, $engine" $? 0
done
finish
