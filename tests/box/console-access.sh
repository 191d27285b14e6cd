#!/bin/sh
# Goal: everybody can use the console: WCAG 2.2 AA, as far as axe-core can tell, on each page, dark, light and in
# forced colours, from 320 to 1,440 px and at 200 %; nothing needs sideways scrolling; nothing moves for those who
# asked for that.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs_section browser chromedriver
npm_packages axe-core@4.10.3
start_daemon
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8 --shift 10
scan 2 0 "$T/other.ply"
AUTH=$(new_token console)
for name in a other; do
    req POST "/v1/subjects/person-$name/templates" -H "$PLY" --data-binary "@$T/$name.ply"
    req POST "/v1/subjects/person-$name/verify" -H "$PLY" --data-binary "@$T/a2.ply"
done
req POST "/v1/subjects/person-a/templates?force=true&label=foreign" -H "$PLY" --data-binary "@$T/other.ply"
browser_tests 100 tests/box/console-access.py "$URL" "$T" "$AUTH"
finish
