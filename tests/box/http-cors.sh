#!/bin/sh
# Goal: a page of another origin may read responses where that origin is named to the daemon, and
# nowhere else; never all origins, never with what a browser sends by itself.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
DESK=https://desk.example.org LOCAL=http://localhost:3000

# from ORIGIN METHOD PATH [OPTION...]
from() {
    f_origin=$1
    shift
    req "$@" -H "Origin: $f_origin"
}
cors() { grep -ci '^access-control-' "$T/head"; }

# ---- off
start_daemon
from "$DESK" OPTIONS /v1/subjects -H 'Access-Control-Request-Method: POST'
is "without the option" "$STATUS $(cors) $(field Vary)" '204 0 '
is "what there is" "$(field Allow)" 'GET, HEAD, POST, OPTIONS'
gives "404 no_such_route" "no such path" req OPTIONS /nowhere
gives 204 "with a body" req OPTIONS /v1/subjects -H "$JSON" -d '{}'
alive "that"
stop_daemon

# ---- two origins
start_daemon --cors-origin "$DESK,$LOCAL" --max-body 100000
ME=$(new_token me)
for origin in "$DESK" "$LOCAL"; do
    AUTH=
    from "$origin" OPTIONS /v1/subjects -H 'Access-Control-Request-Method: POST' -H 'Access-Control-Request-Headers: authorization'
    is "$origin may ask" "$STATUS $(field Access-Control-Allow-Origin)" "204 $origin"
    is "for what the path has" "$(field Access-Control-Allow-Methods)" 'GET, HEAD, POST, OPTIONS'
    ok "with a token" matches "$(field Access-Control-Allow-Headers)" '^Authorization, Content-Type,'
    gives "401 unauthorized" "without one" from "$origin" GET /v1/subjects
    is "it reads the problem" "$(field Access-Control-Allow-Origin) $(field Vary)" "$origin Origin"
    AUTH=$ME
    from "$origin" GET /v1/subjects
    is "and the response" "$STATUS $(field Access-Control-Allow-Origin) $(field Vary)" "200 $origin Origin"
    ok "with its headers" matches "$(field Access-Control-Expose-Headers)" 'X-Request-Id, Location, Retry-After'
    is "never with credentials" "$(field Access-Control-Allow-Credentials)" ''
done
head -c 200000 /dev/zero >"$T/zeros"
from "$DESK" POST /v1/check -H "$BYTES" -H 'Transfer-Encoding: chunked' --data-binary "@$T/zeros"
is "amid a body" "$STATUS $(field Access-Control-Allow-Origin) $(field Vary)" "413 $DESK Origin"
for other in https://desk.example.org.evil.test https://desk.example.or https://DESK.example.org \
    http://desk.example.org "$DESK:443" "$DESK/" "$DESK,$LOCAL" null '*' '' "$(printf 'https://%0300d' 1)" ; do
    from "$other" GET /v1/subjects
    is "not '$other'" "$STATUS $(cors) $(field Vary)" '200 0 Origin'
    from "$other" OPTIONS /v1/subjects -H 'Access-Control-Request-Method: POST'
    is "nor beforehand" "$STATUS $(cors)" '204 0'
done
req GET /v1/subjects
is "a client that is no page" "$STATUS $(cors) $(field Vary)" '200 0 Origin'
req GET /console -H "Origin: $DESK"
is "a page that browsers keep" "$(field Vary | paste -sd ' ')" 'Accept-Encoding Origin'
stop_daemon

# ---- what is no origin
for wrong in '*' null https:// desk.example.org https://desk.example.org/ 'https://a.test, https://b.test' https://A.test \
    'https://a.test,' 'https://*.test' "https://$(printf '%0300d' 1)"; do
    start_fails "--cors-origin '$wrong'" 64 'cors-origin.*not origins like' --db "$DB" --cors-origin "$wrong"
done
finish
