#!/bin/sh
# run_tests.sh TEST...: runs each test, $JOBS at a time (default: three times the number of cores,
# because tests of the daemon wait much), and adds up the results.  A test is a cmocka program or a
# black-box script; a script that counts for itself ends with "N passed, N failed".  A test's
# output goes to $BUILD/log/NAME.log and is shown if it fails; a line that begins with SKIP is
# always shown.  The totals are appended to the file $RESULTS, if set.  Exit: 0 if all passed,
# 1 otherwise.
set -u
BUILD=${BUILD:-build}
export BUILD

# run_one TEST: run it, print its report, and write its counts to $BUILD/log/NAME.counts.
run_one() {
    name=$(basename "$1" .sh)
    log=$BUILD/log/$name.log
    start=$(date +%s)
    case $1 in
    *.sh) set -- sh "$1" ;;
    esac
    # timeout gives the test a process group of its own, and passes a signal on to all of that group.
    timeout 900 "$@" >"$log" 2>&1 &
    # shellcheck disable=SC2064 # this test's
    trap "kill $!; wait $!; exit 1" HUP INT TERM
    wait $!
    rc=$?
    times >"$log.cpu"
    cpu=$(sed '1d; s/[ms]/ /g' "$log.cpu" | awk '{ print int($1 * 60 + $2 + $3 * 60 + $4 + 0.5) }')
    counts=$(sed -n \
        -e 's/^\[  PASSED  \] \([0-9]*\) test(s).*/\1 0/p' \
        -e 's/^\[  FAILED  \] \([0-9]*\) test(s), listed.*/0 \1/p' \
        -e 's/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 \2/p' "$log" |
        awk '{ p += $1; f += $2 } END { print p + 0, f + 0 }')
    p=${counts% *} f=${counts#* }
    skips=$(grep '^SKIP' "$log" | sed 's/^/        /')
    if [ "$rc" -eq 0 ] && [ "$f" -eq 0 ]; then
        [ "$p" -gt 0 ] || [ -n "$skips" ] || p=1
        report=$(printf '  ok    %-24s %4d passed %4d s, %3d of CPU' "$name" "$p" \
            $(($(date +%s) - start)) "$cpu")
    else
        [ "$f" -gt 0 ] || f=1
        report=$(printf '  FAIL  %-24s %4d passed, %d failed (exit %d); %s:\n' \
            "$name" "$p" "$f" "$rc" "$log"
            tail -n 60 "$log" | sed 's/^/        | /')
    fi
    echo "$p $f" >"$BUILD/log/$name.counts"
    printf '%s\n' "$report${skips:+
$skips}"
}

if [ "${1:-}" = --one ]; then
    run_one "$2"
    exit 0
fi
twice=$(printf '%s\n' "$@" | sed 's|.*/||; s|\.sh$||' | sort | uniq -d)
if [ -n "$twice" ]; then
    echo "two tests have one name, and so one log: $twice"
    exit 1
fi
mkdir -p "$BUILD/log"
rm -f "$BUILD"/log/*.counts "$BUILD/log/statements"
if [ -f "$BUILD/record_shim.so" ]; then # for scripts/check_statements.sh
    LD_PRELOAD=$(cd "$BUILD" && pwd)/record_shim.so
    RECORD_STATEMENTS=$(cd "$BUILD" && pwd)/log/statements
    export LD_PRELOAD RECORD_STATEMENTS
fi
[ $# -eq 0 ] || printf '%s\n' "$@" | xargs -P "${JOBS:-$(($(nproc) * 3))}" -n 1 "$0" --one
counts=$(cat "$BUILD"/log/*.counts /dev/null |
    awk '{ p += $1; f += $2; n++ } END { print p + 0, f + 0, n + 0 }')
done=${counts##* } counts=${counts% *}
passed=${counts% *} failed=${counts#* }
failed=$((failed + $# - done)) # a test that left no counts
[ -z "${RESULTS:-}" ] || echo "$passed $failed" >>"$RESULTS"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
