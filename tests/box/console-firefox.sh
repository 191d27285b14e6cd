#!/bin/sh
# Goal: the console in Firefox: each page opens, two scans are compared, nothing on its console.  What a person does
# there: console.sh, in Chromium.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser firefox-esr
AUTH=
start_daemon
MARIONETTE_PORT=$(scripts/free_ports 1)
export MARIONETTE_PORT
browser_tests 10 tests/box/console-firefox.py "$URL" "$T" "$(new_token console)"
finish
