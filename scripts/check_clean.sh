#!/bin/sh
# check_clean.sh: building and testing left no file behind that git does not know of.
set -eu
cd "$(dirname "$0")/.."
if ! git rev-parse --git-dir >/dev/null 2>&1; then
    echo "SKIP check_clean: not a git checkout"
    exit 0
fi
left=$(git status --porcelain --untracked-files=all | grep '^??' || true)
[ -z "$left" ] || { echo "$left"; exit 1; }
