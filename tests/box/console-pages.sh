#!/bin/sh
# Goal: what the console's pages say and do where a person is stopped: a scan of any format, a person who is locked
# out, erased or of a strange id, a daemon that is slow or gone, a narrow window, a printer, forced colours.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
start_daemon
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
scan 2 0 "$T/other.ply"
"$BUILD/surfacelab" simplify "$T/a2.ply" --tolerance 0.0005 -o "$T/mesh.ply" >/dev/null
for i in 1 2 3 4 5 6 7 8 9 10 11 12; do scan $i 0 "$T/s$i.ply" --points 1500; done
mkdir "$T/in"
python3 tests/box/formats.py "$T/mesh.ply" "$T/in" || exit 1
browser_tests 60 tests/box/console-pages.py "$URL" "$T" "$(new_token console)" "$PID" \
    "$BUILD/surfacectl --db $DB"
finish
