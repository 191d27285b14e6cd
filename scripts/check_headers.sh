#!/bin/sh
# check_headers.sh: every header compiles alone, and twice in one file.
set -u
cd "$(dirname "$0")/.." || exit 1
cc=${CC:-gcc}
bad=0
for header in core/*.h db/*.h server/*.h tools/*.h tests/*.h studies/*.h; do
    [ -f "$header" ] || continue
    case $header in
    core/*) dirs="-Icore" ;;
    db/*) dirs="-Idb -Icore" ;;
    server/*) dirs="-Iserver -Idb -Icore" ;;
    tools/*) dirs="-Itools -Icore" ;;
    studies/*) dirs="-Istudies -Itests -Itools -Icore" ;;
    *) dirs="-Itests -Itools -Iserver -Idb -Icore" ;;
    esac
    # shellcheck disable=SC2086 # several -I
    printf '#include "%s"\n#include "%s"\n' "$header" "$header" |
        $cc -std=c11 -Wall -Wextra -Wpedantic -Werror -D_POSIX_C_SOURCE=200809L -I. $dirs \
            -fsyntax-only -x c - || { echo "check_headers: $header"; bad=1; }
done
exit $bad
