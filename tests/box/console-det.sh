#!/bin/sh
# Goal: the page of the calibration draws how often the right person is refused against how often others match, of
# the own people; or says how many it takes.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
thirty_people
scan 40 0 "$T/foreign.ply" --points 1500
start_daemon
browser_tests 20 tests/box/console-det.py "$URL" "$T" "$(new_token console)" "$BUILD/surfacectl --db $DB"
finish
