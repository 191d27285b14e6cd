#!/bin/sh
# Goal: the console in a real browser: what a person sees and does, by pointer and by keys, wide and
# narrow, dark and light, with and without scopes and WebGL; nothing on its console, no request to
# anywhere else, the token gone after locking.  What the pages are: http-console.sh.  The
# viewer: console-view.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
start_daemon
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
scan 2 0 "$T/other.ply"
scan 2 1 "$T/other2.ply"
scan 2 2 "$T/other3.ply"
browser_tests 150 tests/box/console.py "$URL" "$T" "$(new_token console)"
# what was saved
ctl_exits 0 audit verify "$T/receipt.json"
ok "the log that was saved is whole" "$BUILD/surfacectl" audit verify "$T/audit.jsonl" \
    --public-key "$(jq -r .public_key "$T/receipt.json")" >"$T/verified"
finish
