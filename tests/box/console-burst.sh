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
for k in 0 1; do # without one side each: left.xyz has the person's left, which is the picture's right
    scan 3 $k "$T/whole.xyz" --noise 0.5
    awk -v by=$((1 - 2 * k)) '$1 * by > -22' "$T/whole.xyz" >"$T/side$k.xyz"
done
mv "$T/side0.xyz" "$T/left.xyz"
mv "$T/side1.xyz" "$T/right.xyz"
cp "$T/right.xyz" "$T/copy.xyz"
echo 'no scan' >"$T/none.ply"
awk 'BEGIN { for (i = 0; i < 2000; i++) print i % 50 * 3, int(i / 50) * 4, 0 }' >"$T/plane.xyz"
browser_tests 45 tests/box/console-burst.py "$URL" "$T" "$(new_token console)"
finish
