#!/bin/sh
# Goal: the pictures of README can be made again from the console as it is: build/console/readme-dark.webp and
# readme-light.webp, to be copied to docs/ if the console has changed.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
start_daemon
browser_tests 3 tests/box/console-readme.py "$URL" "$T" "$(new_token visitor)"
cp "$T"/readme-*.webp "$BUILD/console"
for picture in docs/*.webp; do
    ok "$picture is shown in README" grep -q "$picture" README.md
done
ok "all pictures have 300 KB at most" test "$(cat docs/*.webp | wc -c)" -le 307200
finish
