#!/bin/sh
# Goal: a person's page compares the templates with each other, and names the one that does not fit, for
# a reader at any width, on paper, by keys and without eyes.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
start_daemon
scan 1 0 "$T/a0.ply"
scan 1 1 "$T/a1.ply"
scan 1 2 "$T/a2.ply"
scan 2 0 "$T/b0.ply"
for i in $(seq 0 18); do scan 3 "$i" "$T/m$i.ply" --points 1500; done
browser_tests 30 tests/box/console-pairs.py "$URL" "$T" "$(new_token console)"
finish
