#!/bin/sh
# Goal: several scans of one sitting on the console's pages: what each is good for before it is sent, what became of it,
# what they give together, and how many are taken.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
start_daemon
for k in 0 1 2 3 4 5 6 7 8 9; do
    scan 1 $k "$T/a$k.ply" --pose 5 --shift 5 --noise 0.8
done
scan 2 0 "$T/other.ply" --pose 5 --shift 5 --noise 0.8
echo 'no scan' >"$T/none.ply"
awk 'BEGIN { for (i = 0; i < 2000; i++) print i % 50 * 3, int(i / 50) * 4, 0 }' >"$T/plane.xyz"
browser_tests 45 tests/box/console-burst.py "$URL" "$T" "$(new_token console)"
finish
