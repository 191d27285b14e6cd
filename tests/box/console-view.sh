#!/bin/sh
# Goal: the console's viewer in a real browser: two scans compared and one looked at, by pointer and by keys,
# wide and narrow, dark and light, with and without WebGL.  The other pages: console.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
start_daemon
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
scan 1 0 "$T/dense.ply" --points 7000
scan 1 1 "$T/dense2.ply" --points 7000
"$BUILD/headscan" --kind bust --seed 3 made-up:5 -o "$T/bust.ply"
browser_tests 40 tests/box/console-view.py "$URL" "$T" "$(new_token console)"
finish
