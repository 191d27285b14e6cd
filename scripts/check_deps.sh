#!/bin/sh
# check_deps.sh: server -> db -> core and nothing the other way; core is libc and libm only,
# neither prints nor exits and takes memory in mem.c alone; SQLite stays in db/, JSON in one
# file of server/ and one of db/, libmicrohttpd in two files of server/.
# The studies see core and the tests' generators.
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
    for file in "$@"; do
        [ -f "$file" ] && grep -Elq "^# *include *[<\"](${pattern})[>\"]" "$file" && echo "$file"
    done
}

# own FOLDER ALLOWED...: a quoted include in FOLDER is found in one of ALLOWED
own() {
    folder=$1
    shift
    for file in "$folder"/*.c "$folder"/*.h; do
        [ -f "$file" ] || continue
        sed -n 's/^# *include *"\(.*\)".*/\1/p' "$file" >"$list"
        while read -r name; do
            found=
            for place in "$@"; do
                [ -f "$place/$name" ] && found=yes
            done
            [ -n "$found" ] || complain "$file includes $name, which is not in: $*"
        done <"$list"
    done
}
own core core
own db db core "$build/gen"
own server server db core "$build/gen"
own studies studies tests core

libc='assert|ctype|errno|float|inttypes|limits|math|stdarg|stdbool|stddef|stdint|stdio|stdlib|string'
for file in core/*.c core/*.h; do
    sed -n 's/^# *include *<\(.*\)\.h>.*/\1/p' "$file" | grep -Ev "^($libc)\$" |
        sed "s|^|check_deps: $file includes |" | grep . && bad=1
done

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
for object in "$build"/core/*.o; do
    used=$(nm -u "$object" | awk '{ print $2 }')
    if [ "$(basename "$object")" != mem.o ]; then
        for name in malloc calloc realloc aligned_alloc posix_memalign free strdup; do
            echo "$used" | grep -qx "$name" && complain "$object uses $name()"
        done
    fi
    for name in printf fprintf puts fputs fputc putchar fwrite perror exit _exit abort fopen \
        open read write time clock clock_gettime rand random setlocale getenv; do
        echo "$used" | grep -Eqx "(__)?$name(_chk)?" && complain "$object uses $name()"
    done
done
echo 'int main(void) { return 0; }' |
    ${CC:-gcc} -x c - -x none -o "$build/core_alone" -Wl,--whole-archive \
        "$build/libsurface.a" -Wl,--no-whole-archive -lm ||
    complain "core does not link with -lm alone"
exit $bad
