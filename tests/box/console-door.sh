#!/bin/sh
# Goal: the console's screen at a door: what was decided, within half a second, over lost connections and a day
# without a key or a pointer; lock-outs and their end; what it may do when nobody is there.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
start_daemon
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
scan 2 0 "$T/other.ply"
browser_tests 40 tests/box/console-door.py "$URL" "$T" "$(new_token north)"
finish
