#!/bin/sh
# check_digits.sh: a few fixed comparisons (tests/core/test_golden.c) give the digits of
# tests/golden/digits.txt, with gcc and clang, at -O0 and -O3.  Builds in $BUILD, which is
# gcc's at -O3 itself; prints SKIP for a compiler that is not installed.  Exit: 0 if all digits
# agree, 1 otherwise.
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build}
rc=0
test=tests/core/test_golden
for cc in gcc clang; do
    if ! command -v "$cc" >/dev/null 2>&1; then
        echo "SKIP $cc: not installed"
        continue
    fi
    for opt in -O0 -O3; do
        dir=$BUILD/digits-$cc$opt
        [ "$cc$opt" != gcc-O3 ] || dir=$BUILD
        if ! make -s -j2 BUILD="$dir" CC="$cc" OPT="$opt" WERROR= EXTRA= "$dir/$test"; then
            echo "FAIL $cc $opt: does not build"
            rc=1
        elif ! "$dir/$test" >"$dir/diff" 2>&1; then
            echo "FAIL $cc $opt: the digits differ"
            cat "$dir/diff"
            rc=1
        else
            echo "ok   $cc $opt"
        fi
    done
done
exit $rc
