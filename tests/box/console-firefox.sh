#!/bin/sh
# Goal: the console, and the page of a file, in Firefox: each page opens, two scans are compared and cut, nothing on
# its console.  What a person does there: console.sh and console-view.sh, in Chromium.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser firefox-esr
start_daemon
scan 1 0 "$T/a.ply"
scan 2 0 "$T/other.ply"
lab=$(cd "$BUILD" && pwd)/surfacelab
(cd "$T" && "$lab" explain a.ply other.ply >"$T/out")
MARIONETTE_PORT=$(scripts/free_ports 1)
export MARIONETTE_PORT
browser_tests 10 tests/box/console-firefox.py "$URL" "$T" "$(new_token console)"
finish
