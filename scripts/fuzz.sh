#!/bin/sh
# fuzz.sh BUILD SECONDS: run each fuzzer of BUILD for SECONDS, starting from its corpus.
# What it finds on the way is kept in BUILD/corpus; a crash leaves its input in BUILD/crash.
set -u
build=$1 seconds=$2
passed=0 failed=0
mkdir -p "$build/crash" "$build/log"
for fuzzer in "$build"/tests/fuzz_*; do
    case $fuzzer in *.o | *.d) continue ;; esac
    name=$(basename "$fuzzer")
    mkdir -p "$build/corpus/$name"
    if "$fuzzer" -max_total_time="$seconds" -seed=1 -timeout=20 -rss_limit_mb=2048 \
        -print_final_stats=1 -artifact_prefix="$build/crash/$name-" \
        "$build/corpus/$name" "tests/corpus/${name#fuzz_}" >"$build/log/$name" 2>&1; then
        runs=$(sed -n 's/.*number_of_executed_units: *//p' "$build/log/$name")
        printf '  ok    %-20s %s runs\n' "$name" "$runs"
        passed=$((passed + 1))
    else
        printf '  FAIL  %s: %s\n' "$name" "$build/log/$name"
        tail -n 40 "$build/log/$name" | sed 's/^/        | /'
        failed=$((failed + 1))
    fi
done
[ -z "${RESULTS:-}" ] || echo "$passed $failed" >>"$RESULTS"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
