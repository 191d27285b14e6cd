#!/bin/sh
# fuzz.sh BUILD SECONDS: runs each fuzzer of BUILD for SECONDS, $JOBS (one per core) at a time,
# starting from its corpus in tests/fuzz and, if it has a minute or more, from the inputs that
# earlier runs have found.  Inputs that reach new code are kept in BUILD/corpus, an input that
# crashes in BUILD/crash.
# fuzz.sh --keep BUILD: writes the fewest inputs that reach all code that was found to
# tests/fuzz/found.tar.xz, from which the next runs continue.
set -u
found=tests/fuzz/found.tar.xz

run_one() { # FUZZER BUILD SECONDS
    name=$(basename "$1")
    log=$2/log/$name
    mkdir -p "$2/corpus/$name"
    if "$1" -max_total_time="$3" -seed=1 -timeout=60 -rss_limit_mb=2048 \
        -print_final_stats=1 -artifact_prefix="$2/crash/$name-" \
        "$2/corpus/$name" "tests/fuzz/corpus/${name#fuzz_}" >"$log" 2>&1; then
        printf '  ok    %-20s %s runs\n' "$name" \
            "$(sed -n 's/.*number_of_executed_units: *//p' "$log")"
        return 0
    fi
    printf '  FAIL  %s: %s\n%s\n' "$name" "$log" "$(tail -n 40 "$log" | sed 's/^/        | /')"
    echo failed >"$log.failed"
}

keep() { # BUILD
    kept=$(mktemp -d)
    for fuzzer in $(fuzzers "$1"); do
        name=$(basename "$fuzzer")
        mkdir "$kept/$name"
        "$fuzzer" -merge=1 -rss_limit_mb=2048 "$kept/$name" "$1/corpus/$name" >"$1/log/$name.merge" 2>&1 ||
            exit 1
        printf '  %-20s %s inputs\n' "$name" "$(find "$kept/$name" -type f | wc -l)"
    done
    tar -C "$kept" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX \
        -cJf "$found" .
    rm -r "$kept"
}

fuzzers() { # BUILD
    find "$1/tests/fuzz" -name 'fuzz_*' ! -name '*.*' | sort
}

case $1 in
--one)
    run_one "$4" "$2" "$3"
    exit 0
    ;;
--keep)
    keep "$2"
    exit 0
    ;;
esac
build=$1 seconds=$2
mkdir -p "$build/crash" "$build/log" "$build/corpus"
[ "$seconds" -lt 60 ] || [ ! -e "$found" ] || tar -C "$build/corpus" -xJf "$found"
rm -f "$build"/log/*.failed
fuzzers "$build" |
    xargs -P "${JOBS:-$(nproc)}" -n 1 "$0" --one "$build" "$seconds"
total=$(fuzzers "$build" | wc -l)
failed=$(find "$build/log" -name '*.failed' | wc -l)
[ -z "${RESULTS:-}" ] || echo "$((total - failed)) $failed" >>"$RESULTS"
echo "$((total - failed)) passed, $failed failed"
[ "$failed" -eq 0 ]
