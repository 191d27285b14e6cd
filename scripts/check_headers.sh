#!/bin/sh
# check_headers.sh: every header compiles alone, and twice in one file.
set -u
cd "$(dirname "$0")/.." || exit 1
cc=${CC:-gcc}
bad=0

# alone FOLDER SEES...: its headers, with the folders that it sees
alone() {
    folder=$1
    dirs=
    for seen in "$@"; do dirs="$dirs -I$seen"; done
    for header in "$folder"/*.h; do
        [ -f "$header" ] || continue
        # shellcheck disable=SC2086 # several -I
        printf '#include "%s"\n#include "%s"\ntypedef int unit;\n' "$header" "$header" |
            $cc -std=c11 -Wall -Wextra -Wpedantic -Werror -D_POSIX_C_SOURCE=200809L \
                -isystem "$(pg_config --includedir)" -I. $dirs \
                -fsyntax-only -x c - || { echo "check_headers: $header"; bad=1; }
    done
}

layers=$(make -s layers)
while read -r room sees; do
    # shellcheck disable=SC2086 # rooms
    alone "$room" $sees
done <<END
$layers
END
sees() {
    echo "$layers" | sed -n "s|^$1 ||p"
}
# shellcheck disable=SC2046 # rooms
alone tests/lib sim db/admin $(sees db/admin) $(sees core)
# shellcheck disable=SC2046
alone tests/fuzz $(sees sim)
exit $bad
