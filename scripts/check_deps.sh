#!/bin/sh
# check_deps.sh: server -> db -> core and nothing the other way; core is libc and libm only,
# neither prints nor exits and takes memory in mem.c alone; SQLite stays in db/, JSON in one
# file of server/ and one of db/, libmicrohttpd in two files of server/.
# The face generator sees core alone, the studies core and the tests' generators.
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

# including FILE-PATTERN...: the files that include a header matching $1
including() {
    pattern=$1
    shift
    grep -El "^# *include *[<\"](${pattern})[>\"]" "$@"
}

# own FOLDER ALLOWED...: a quoted include in FOLDER is found in one of ALLOWED
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
own core core
own db db core "$build/gen"
own server server db core "$build/gen"
own tools tools core
own studies studies tests tools core

libc='assert|ctype|errno|float|inttypes|limits|math|stdarg|stdbool|stddef|stdint|stdio|stdlib|string'
grep -H '^# *include *<' core/*.[ch] | grep -Ev "<($libc)\.h>" |
    sed 's|^|check_deps: |' | grep . && bad=1

files=$(including 'sqlite3.*' server/*.[ch] core/*.[ch])
[ -z "$files" ] || complain "SQLite outside db/:" "$files"
files=$(including '(cjson/)?cJSON.*' server/*.[ch] | grep -v '^server/json')
[ -z "$files" ] || complain "JSON outside server/json*.c:" "$files"
files=$(including '(cjson/)?cJSON.*' db/*.[ch])
[ "$(echo "$files" | wc -w)" -le 1 ] || complain "JSON in more than one file of db/:" "$files"
files=$(including 'microhttpd.*' core/*.[ch] db/*.[ch])
[ -z "$files" ] || complain "libmicrohttpd outside server/:" "$files"
files=$(including 'microhttpd.*' server/*.[ch])
[ "$(echo "$files" | wc -w)" -le 2 ] || complain "libmicrohttpd in more than two files:" "$files"

# What the compiled core asks of libc.
memory='malloc|calloc|realloc|aligned_alloc|posix_memalign|free|strdup'
world='printf|fprintf|puts|fputs|fputc|putchar|fwrite|perror|exit|_exit|abort|fopen|open|read'
world="$world|write|time|clock|clock_gettime|rand|random|setlocale|getenv"
for object in "$build"/core/*.o; do
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
