#!/bin/sh
# check_clean.sh [FILE]: list the files that git does not know of; given a list made before,
# complain about new ones: building and testing must leave nothing behind.
set -eu
cd "$(dirname "$0")/.."
git status --porcelain --untracked-files=all 2>/dev/null | grep '^??' >build/untracked || true
[ $# -eq 1 ] || exec cat build/untracked
! grep -vxF -f "$1" build/untracked
