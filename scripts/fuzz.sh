#!/bin/sh
# fuzz.sh BUILD SECONDS: run each fuzzer of BUILD for SECONDS, $JOBS (one per core) at a time,
# starting from its corpus in tests/fuzz.  Inputs that reach new code are kept in BUILD/corpus,
# an input that crashes in BUILD/crash.
set -u

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

if [ "$1" = --one ]; then
    run_one "$4" "$2" "$3"
    exit 0
fi
build=$1 seconds=$2
mkdir -p "$build/crash" "$build/log"
rm -f "$build"/log/*.failed
find "$build/tests/fuzz" -name 'fuzz_*' ! -name '*.*' | sort |
    xargs -P "${JOBS:-$(nproc)}" -n 1 "$0" --one "$build" "$seconds"
total=$(find "$build/tests/fuzz" -name 'fuzz_*' ! -name '*.*' | wc -l)
failed=$(find "$build/log" -name '*.failed' | wc -l)
[ -z "${RESULTS:-}" ] || echo "$((total - failed)) $failed" >>"$RESULTS"
echo "$((total - failed)) passed, $failed failed"
[ "$failed" -eq 0 ]
