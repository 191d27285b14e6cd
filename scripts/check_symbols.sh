#!/bin/sh
# check_symbols.sh: foo.c exports only foo and names that begin with foo_; what a header bar.h
# gathers is in bar_*.c and may begin with bar_.  Checks the objects of a finished build in
# $BUILD.  Static functions and private structs of one name in more than three of the program's files
# bear the file's name too: or who greps for one finds all of them.
set -u
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
sources=
objects=
for source in $(make -s layers | sed 's|^\([^ ]*\).*|\1/*.c|') tests/*/*.c; do
    object=$build/${source%.c}.o
    [ ! -f "$object" ] || objects="$objects $object"
    sources="$sources ${source%.c}"
done
for header in $(make -s layers | sed 's|^\([^ ]*\).*|\1/*.h|'); do
    sources="$sources ${header%.h}"
done

# shellcheck disable=SC2086 # file names of our own
nm -gA --defined-only $objects | awk -v build="$build/" -v sources="$sources" \
    -v public="$(tr '\n' '|' <"$build/libsurface.names")none" '
    BEGIN {
        for (n = split(sources, each, " "); n > 0; n--)
            is_source[each[n]]
    }

    # allowed(SOURCE): a pattern of the names that the file SOURCE.c may export.
    function allowed(source, folder, module, names) {
        if (source == "core/mesh/predicates")
            return "incircle_.*" # named as in the literature
        if (source == "core/basic/mem")
            return "(mem|scratch)_.*"
        if (source == "server/http/peer")
            return "peer_.*|MHD_queue_response" # takes the place of the library\047s
        if (source == "tests/lib/work")
            return "work_.*|__sanitizer_cov_trace_pc" # which the compiler calls
        if (source ~ /^(server|ctl|lab)\/main$|^(sim|tests)\/.*_main$/)
            return "main"
        if (source ~ /^tests\/fuzz\//)
            return "main|LLVMFuzzer.*"
        folder = module = source
        sub(/[^\/]*$/, "", folder)
        sub(/.*\//, "", module)
        names = module "_.*|" module
        if (source ~ /^core\//)
            names = names "|" public # what libsurface.h declares
        if (source ~ /^tests\/([a-z]*\/test_|bench\/|lib\/(fail_alloc|fail_sql|unit)$)/)
            names = "main|__wrap_.*|" names
        # A room below db/ has names of its own: db/log/log_txn.c exports log_*.
        if (folder ~ /^db\/[a-z]+\/$/)
            names = names "|" substr(folder, 4, length(folder) - 4) "_.*"
        # store_token.c is a part of what store.h gathers and may export store_*.
        while (sub(/_[^_]*$/, "", module))
            if (folder module in is_source)
                names = names "|" module "_.*"
        return names
    }

    {
        source = substr($1, length(build) + 1)
        sub(/\.o:.*/, "", source)
        if (!(source in may))
            may[source] = "^(" allowed(source) ")$"
        if ($3 !~ may[source]) {
            print "check_symbols: " source ".c exports " $3
            bad = 1
        }
    }
    END { exit bad || NR == 0 }' || exit # NR is 0 without a build

# shellcheck disable=SC2046 # file names of our own
awk '
    function private(name, stem) {
        stem = FILENAME
        gsub(/.*\/|\.c$/, "", stem)
        if (name ~ "^" stem "(_|$)" || (name, FILENAME) in seen)
            return
        seen[name, FILENAME] = 1
        where[name] = where[name] " " FILENAME
        if (++files[name] == 4)
            shared[name]
    }
    /^static .*\(/ && !/;$/ { sub(/\(.*/, ""); private($NF ~ /^\*/ ? substr($NF, 2) : $NF) }
    /^struct [a-z_0-9]+ \{$/ { private($2) }
    END {
        for (name in shared) {
            print "check_symbols: " name " is private to" where[name]
            bad = 1
        }
        exit bad
    }' $(make -s layers | sed 's|^\([^ ]*\).*|\1/*.c|')
