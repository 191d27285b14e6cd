#!/bin/sh
# check_deps.sh: a room includes only headers of its own and of the rooms that the Makefile
# lists for it (SEES_*); the modules of a room include one another in no circle, and each .c has
# a .h of its name.  core uses libc and libm only, of these no function whose last digit may be another one
# elsewhere (core/basic/series.h), does not print or exit, and allocates memory only in mem.c.  SQLite, cJSON and libmicrohttpd are included only where the calls of
# only() below allow it.
set -u
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
bad=0
list=$(mktemp)
trap 'rm -f "$list"' EXIT

complain() {
    echo "check_deps: $*"
    bad=1
}

# including PATTERN FILE...: those of the files that include a header matching the pattern
including() {
    pattern=$1
    shift
    grep -El "^# *include *[<\"](${pattern})[>\"]" "$@"
}

# own FOLDER ALLOWED...: each quoted include in FOLDER is a file of one of the ALLOWED folders
own() {
    folder=$1
    shift
    grep -H '^# *include *"' "$folder"/*.[ch] |
        sed 's/^\([^:]*\):[^"]*"\(.*\)".*/\1 \2/' >"$list"
    while read -r file name; do
        found=
        for place in "$@"; do
            [ -f "$place/$name" ] && found=yes
        done
        [ -n "$found" ] || complain "$file includes $name, which is not in: $*"
    done <"$list"
}

# circles FOLDER: its modules (a .c and .h of one name) that include one another in a circle
circles() {
    grep -H '^# *include *"' "$1"/*.[ch] |
        sed -n 's|^[^:]*/\([a-z_0-9]*\)\.[ch]:[^"]*"\([a-z_0-9]*\)\.h".*|\1 \2|p' |
        while read -r module name; do
            if [ "$module" != "$name" ] && [ -f "$1/$name.h" ]; then
                echo "$module $name"
            fi
        done | tsort 2>&1 >/dev/null | sed 's/^tsort: //' | tr '\n' ' '
}

# alone FOLDER: its files without a header of their name: a program's main file, and those
# that each hold one command or the handlers of some routes and are declared by the table of these,
# or one form of a report, one study, one noun of the store, or the reader of one format
alone() {
    for source in "$1"/*.c; do
        case $source in
        core/basic/calibration.c | core/face/search_*.c) ;; # surface_*.h declares it
        */main.c | */*_main.c | ctl/ctl_* | db/store_* | db/sql/sql_*_conn.c | db/sql/sql_postgres_wait.c | lab/lab_* | lab/report_* | lab/study/* | scan/read_* | server/api/*) ;;
        *) [ -f "${source%.c}.h" ] || echo "$source" ;;
        esac
    done
}

rooms=''
make -s layers >"$list.rooms"
while read -r room sees; do
    rooms="$rooms $room"
    # shellcheck disable=SC2086 # rooms
    own "$room" "$room" $sees "$build/gen"
    circle=$(circles "$room")
    [ -z "$circle" ] || complain "a circle of modules in $room/: $circle"
    headless=$(alone "$room")
    [ -z "$headless" ] || complain "no header of its name: $headless"
done <"$list.rooms"
rm -f "$list.rooms"

libc='assert|ctype|errno|float|inttypes|limits|malloc|math|stdarg|stdatomic|stdbool|stddef|stdint|stdio|stdlib|string'
grep -H '^# *include *<' core/*.[ch] core/*/*.[ch] | grep -Ev "<($libc)\.h>" |
    grep -v '^core/face/search_index.c:.*<emmintrin.h>' | sed 's|^|check_deps: |' | grep . && bad=1

# only PATTERN NUMBER ROOMS NAME: at most NUMBER files of each of ROOMS include a header matching
# the pattern, and no file of another room does
only() {
    for room in $rooms; do
        files=$(including "$1" "$room"/*.[ch])
        case " $3 " in
        *" $room "*)
            [ "$(echo "$files" | wc -w)" -le "$2" ] ||
                complain "$4 in more than $2 files:" "$files"
            ;;
        *) [ -z "$files" ] || complain "$4 outside of $3:" "$files" ;;
        esac
    done
}
only 'sqlite3.*' 99 db/sql SQLite
only 'libpq.*' 1 db/sql libpq
only '(cjson/)?cJSON.*' 1 base JSON
only 'microhttpd.*' 3 server/http libmicrohttpd

# The libc functions that the compiled core uses.
memory='malloc|calloc|realloc|aligned_alloc|posix_memalign|free|strdup'
world='printf|fprintf|puts|fputs|fputc|putchar|fwrite|perror|exit|_exit|abort|fopen|open|read'
world="$world|write|time|clock|clock_gettime|rand|random|setlocale|getenv"
world="$world|(a?(sin|cos|tan)h?|atan2|sincos|exp(2|10|m1)?|log(2|10|1p)?|pow|cbrt|hypot|erfc?|[lt]gamma)[fl]?"
for object in "$build"/core/*.o "$build"/core/*/*.o; do
    case $object in
    */mem.o) never=$world ;;
    *) never="$world|$memory" ;;
    esac
    for name in $(nm -u "$object" | awk '{ print $2 }' | grep -Ex "(__)?($never)(_chk)?"); do
        complain "$object uses $name()"
    done
done
echo 'int main(void) { return 0; }' |
    ${CC:-gcc} -x c - -x none -o "$build/core_alone" -Wl,--whole-archive \
        "$build/libsurface.a" -Wl,--no-whole-archive -lm ||
    complain "core does not link with -lm alone"
exit $bad
