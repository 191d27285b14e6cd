#!/bin/sh
# check_digits.sh [NAME]: build/digits (tests/core/digits_main.c) prints the digits of tests/golden/digits.txt when it
# was built by gcc and clang, at -O0 and -O3, and for aarch64 and s390x, where qemu runs it: other vectors than
# x86-64's, fused multiplication, unsigned chars; s390x has the most significant byte first.  NAME: one of these alone.
# Each is built in $BUILD/digits-NAME; gcc's at -O3 is $BUILD itself.  Prints SKIP for a compiler that is not
# installed; with CI=true that is a failure.  Exit: 0 if all digits agree, 1 otherwise.
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build}

# digits NAME DIR RUN VARIABLE...: builds it in DIR by make's VARIABLEs, and compares what RUN, an emulator or
# nothing, prints of it.
digits() {
    name=$1 dir=$2 run=$3
    shift 3
    if ! make -s BUILD="$dir" WERROR= EXTRA= "$@" "$dir/digits"; then
        echo "FAIL $name: does not build"
    elif ! $run "$dir/digits" >"$dir/digits.txt"; then
        echo "FAIL $name: does not run"
    elif ! diff tests/golden/digits.txt "$dir/digits.txt"; then
        echo "FAIL $name: the digits differ"
    else
        echo "ok   $name"
        return
    fi
    return 1
}

# has NAME PROGRAM...
has() {
    name=$1
    shift
    for tool in "$@"; do
        command -v "$tool" >/dev/null 2>&1 || {
            echo "SKIP $name: $tool is not installed: scripts/setup foreign"
            return 1
        }
    done
}

one() {
    case $1 in
    *-O?)
        cc=${1%-O?} opt=-O${1#*-O}
        dir=$BUILD/digits-$1
        [ "$1" != gcc-O3 ] || dir=$BUILD
        if has "$1" "$cc"; then digits "$1" "$dir" '' CC="$cc" OPT="$opt"; else [ "${CI:-}" != true ]; fi
        ;;
    *)
        to=$1-linux-gnu
        if has "$1" "$to-gcc" "qemu-$1"; then
            digits "$1" "$BUILD/digits-$1" "qemu-$1 -L /usr/$to" HOSTCC=gcc CC="$to-gcc" AR="$to-ar"
        else
            [ "${CI:-}" != true ]
        fi
        ;;
    esac
}
[ $# -eq 0 ] || {
    one "$1"
    exit
}
# The longest first.
printf '%s\n' s390x aarch64 clang-O3 gcc-O3 gcc-O0 clang-O0 | xargs -P "$(nproc)" -n 1 "$0" || exit 1
