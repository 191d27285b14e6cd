#!/bin/sh
# lint.sh: run the checks of the project's rules on a finished build in $BUILD.
# shellcheck disable=SC2046,SC2086 # lists of file names of our own
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build}
export BUILD
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
checks=0
rooms=$(make -s layers | sed 's/ .*//')
code=$(find $rooms -name '*.[ch]')

# check TITLE COMMAND...: runs a check, which passes if the command exits 0.  All checks run at the same
# time; report() prints their results in order at the end.
check() {
    checks=$((checks + 1))
    title=$1 log=$out/$checks
    shift
    if ! command -v "$1" >/dev/null 2>&1; then
        echo "  SKIP  $title: $1 is not installed" >"$log.said"
        return
    fi
    {
        if "$@" >"$log" 2>&1; then
            echo "  ok    $title"
        else
            echo "  FAIL  $title"
            head -n 40 "$log" | sed 's/^/        | /'
        fi >"$log.said"
    } &
}

report() {
    wait
    n=0
    while [ $n -lt $checks ]; do
        n=$((n + 1))
        cat "$out/$n.said"
    done | tee "$out/report"
    passed=$(grep -c '^  ok ' "$out/report")
    failed=$((checks - passed - $(grep -c '^  SKIP' "$out/report")))
}

# Files of at most 700 lines, functions of at most 80: the aim is 600 and 60.
check_length() {
    awk 'FNR == 1 { start = 0 }
        FNR == 701 { print FILENAME ": more than 700 lines"; bad = 1 }
        /^{/ { start = FNR }
        /^}/ && start && FNR - start > 80 {
            print FILENAME ":" start ": a function of " FNR - start - 1 " lines"; bad = 1 }
        /^}/ { start = 0 }
        END { exit bad }' $(echo "$code" | grep 'c$')
}

check_unfinished() {
    ! grep -nE 'TODO|FIXME|XXX|HACK' $code scripts/demo \
        scripts/test scripts/setup README.md
}

# README.md quotes benchmarks of the run that docs/benchmarks.md shows.
check_quoted() {
    awk 'FNR == NR { run[$0] = 1; next }
        /^<!-- lines of docs\/benchmarks.md/ { inside = 1; next }
        inside && /^$/ { exit }
        inside { n++; if (!($0 in run)) { print FILENAME ": not in the run: " $0; bad = 1 } }
        END { exit bad || n == 0 }' docs/benchmarks.md README.md
}

# The core keeps nothing between its calls, so that threads need no lock: no object has writable data but
# model_digest.o, an atomic number.
check_state() {
    size -A $(find "$BUILD/core" -name '*.o' ! -name model_digest.o) | awk '
        /:$/ { file = $1 }
        $1 ~ /^\.t?(data|bss)$/ && $2 > 0 { print file " " $1 ": " $2 " bytes"; bad = 1 }
        END { exit bad }'
}

# The sanitizers' builds compile the other tests with clang.
clang_all() {
    make -s -j2 BUILD="$BUILD/clang" CC=clang OPT=-O0 EXTRA=-Wno-sign-conversion all \
        $(for t in tests/work/test_*.c; do echo "$BUILD/clang/${t%.c}"; done)
}

shell_all() {
    command -v shellcheck || return 1
    shellcheck -x -e SC3013,SC2119 $(grep -lrE '^#! ?/bin/(ba)?sh' scripts tests .ci packaging/examples)
}

check "each header compiles alone" scripts/check_headers.sh
check "symbols begin with their file's name" scripts/check_symbols.sh
check "dependencies: nothing points up" scripts/check_deps.sh
check "README quotes docs/benchmarks.md" check_quoted
check "no overlong file or function" check_length
check "nothing unfinished" check_unfinished
check "no state in the core" check_state
check "no warning from clang at -O0" clang_all
check "format (make format)" clang-format --dry-run -Werror \
    $code $(find tests -name '*.[ch]')
check "shell scripts (shellcheck)" shell_all
check "Lua (luacheck)" luacheck --quiet --std luajit --globals wrk setup init delay request \
    response 'done' good busy other -- scripts/wrk.lua
check "C (cppcheck)" cppcheck --quiet --std=c11 --error-exitcode=1 --inline-suppr \
    --enable=warning,portability --suppress=missingIncludeSystem \
    --suppress=ctuuninitvar -D_POSIX_C_SOURCE=200809L \
    $(for room in $rooms; do echo "-I$room"; done) $rooms
check "man pages (mandoc)" mandoc -T lint -W warning man/*.[158]
check "package: one version, the same libraries" scripts/check_packaging.sh
if command -v systemd-analyze >/dev/null 2>&1; then
    check "systemd units (systemd-analyze)" scripts/check_units.sh
else
    echo "  SKIP  systemd units: systemd-analyze is not installed"
fi
report

[ -z "${RESULTS:-}" ] || echo "$passed $failed" >>"$RESULTS"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
