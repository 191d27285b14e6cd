#!/bin/sh
# check_symbols.sh: foo.c exports names that begin with foo_ (or foo itself), no others.
# Runs on the objects of a finished build in $BUILD.
set -u
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
bad=0
for source in core/*.c db/*.c server/*.c tests/*.c studies/*.c; do
    object=$build/${source%.c}.o
    [ -f "$object" ] || continue
    module=$(basename "$source" .c)
    names="${module}_.*|$module"
    # store_sqlite_admin.c is a part of store_sqlite.c and may export store_sqlite_*.
    parent=${module%_*}
    while [ "$parent" != "$module" ]; do
        [ ! -f "$(dirname "$source")/$parent.c" ] || names="$names|${parent}_.*"
        module=$parent
        parent=${module%_*}
    done
    case $source in
    core/predicates.c) names="incircle_.*" ;; # named as in the literature
    core/mem.c) names="(mem|scratch)_.*" ;;
    server/main.c | db/surfacectl.c | tests/*_main.c | studies/*_main.c) names="main" ;;
    tests/test_* | tests/bench* | tests/fail_alloc.c) names="main|$names|__wrap_.*" ;;
    tests/fuzz_*) names="main|LLVMFuzzer.*" ;;
    esac
    nm -g --defined-only "$object" | awk '{ print $3 }' | grep -Ev "^($names)\$" |
        sed "s|^|check_symbols: $source exports |" | grep . && bad=1
done
exit $bad
