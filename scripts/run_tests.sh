#!/bin/sh
# run_tests.sh TEST...: run each test and add up.  A test is a cmocka program or a
# black-box script; a script that counts for itself ends with "N passed, N failed".
# What a test prints goes to $BUILD/log/NAME.log and is shown when the test fails; a line
# that begins with SKIP is always shown.  The totals are added to the file $RESULTS, if set.
# Exit: 0 all passed, 1 otherwise.
set -u
BUILD=${BUILD:-build}
export BUILD
mkdir -p "$BUILD/log"
passed=0 failed=0

for test in "$@"; do
    name=$(basename "$test" .sh)
    log=$BUILD/log/$name.log
    case $test in
    *.sh) timeout 600 sh "$test" >"$log" 2>&1 ;;
    *) timeout 600 "$test" >"$log" 2>&1 ;;
    esac
    rc=$?
    counts=$(sed -n \
        -e 's/^\[  PASSED  \] \([0-9]*\) test(s).*/\1 0/p' \
        -e 's/^\[  FAILED  \] \([0-9]*\) test(s), listed.*/0 \1/p' \
        -e 's/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 \2/p' "$log" |
        awk '{ p += $1; f += $2 } END { print p + 0, f + 0 }')
    p=${counts% *} f=${counts#* }
    if [ "$rc" -eq 0 ] && [ "$f" -eq 0 ]; then
        [ "$p" -gt 0 ] || p=1
        printf '  ok    %-24s %4d passed\n' "$name" "$p"
    else
        [ "$f" -gt 0 ] || f=1
        printf '  FAIL  %-24s %4d passed, %d failed (exit %d); %s:\n' \
            "$name" "$p" "$f" "$rc" "$log"
        tail -n 60 "$log" | sed 's/^/        | /'
    fi
    grep '^SKIP' "$log" | sed 's/^/        /'
    passed=$((passed + p)) failed=$((failed + f))
done

[ -z "${RESULTS:-}" ] || echo "$passed $failed" >>"$RESULTS"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
