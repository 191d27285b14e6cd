#!/bin/sh
# check_clean.sh [FILE]: list the untracked files; given FILE, an earlier list, print the new
# ones and fail if there are any: building and testing must leave no files behind.
set -eu
cd "$(dirname "$0")/.."
git status --porcelain --untracked-files=all 2>/dev/null | grep '^??' >build/untracked || true
[ $# -eq 1 ] || exec cat build/untracked
! grep -vxF -f "$1" build/untracked
