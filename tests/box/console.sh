#!/bin/sh
# Goal: the console in a real browser: what a person sees and does, by pointer and by keys, wide and
# narrow, dark and light, with and without scopes and WebGL; nothing on its console, no request to
# anywhere else, the token gone after locking.  What the pages are: http-console.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
AUTH=
start_daemon
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
scan 2 0 "$T/other.ply"
scan 2 1 "$T/other2.ply"
scan 2 2 "$T/other3.ply"
scan 1 0 "$T/dense.ply" --points 7000
scan 1 1 "$T/dense2.ply" --points 7000
"$BUILD/headscan" --kind bust --seed 3 made-up:5 -o "$T/bust.ply"
mkdir -p "$T/home"
HOME=$T/home /usr/bin/python3 tests/box/console.py "$URL" "$T" "$(new_token console)" >"$T/out" 2>"$T/err"
cat "$T/err"
grep -v '^ok ' "$T/out"
passed=$((passed + $(grep -c '^ok ' "$T/out")))
failed=$((failed + $(grep -c '^FAIL ' "$T/out")))
ok "the browser's tests ran" test "$passed" -gt 150
# what was saved
ctl_exits 0 audit verify "$T/receipt.json"
ok "the log that was saved is whole" "$BUILD/surfacectl" audit verify "$T/audit.jsonl" \
    --public-key "$(jq -r .public_key "$T/receipt.json")" >"$T/verified"
mkdir -p "$BUILD/console"
cp "$T"/*.png "$BUILD/console"
finish
