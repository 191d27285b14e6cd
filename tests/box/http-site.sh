#!/bin/sh
# Goal: a page of another site, opened in a browser on the machine where surfaced runs with --no-auth, can
# neither enrol, export, force nor make a token: not by forms and requests without a preflight, and not
# by a name of its own that means this machine.  By curl, and in a real browser.
. tests/box/lib.sh

start_daemon --no-auth
scan 1 0 "$T/a.ply"
port=${URL##*:}

# ---- what a browser would send
# site TITLE STATUS HEADER...: enrols, and asks for what there is.
site() {
    title=$1 wanted=$2
    shift 2
    for header; do
        set -- "$@" -H "$header"
        shift
    done
    send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply" "$@"
    is "$title: enrol" "$STATUS" "$wanted"
    [ "$wanted" != 403 ] || problem "$title: why" 403 other_site
    req GET /v1/subjects "$@"
    is "$title: list" "$STATUS" "$(echo "$wanted" | sed 's/201/200/')"
}
site "a program" 201
for host in "localhost:$port" "LOCALHOST" "127.0.0.1" "127.8.9.1:$port" "[::1]:$port" "[::1]"; do
    site "Host $host" 200 "Host: $host"
done
site "the console" 200 "Origin: http://127.0.0.1:$port" "Sec-Fetch-Site: same-origin"
for host in "attacker.example:$port" "localhost.attacker.example" "127.0.0.1.attacker.example" "xlocalhost" \
    "127.0.0.1x" "127.0.0" "1127.0.0.1" "[::2]:$port" "[::1" "192.0.2.1" "127.0.0.1.1" "localhost."; do
    site "Host $host" 403 "Host: $host"
    site "Host $host, as of its own page" 403 "Host: $host" "Origin: http://$host" "Sec-Fetch-Site: same-origin"
done
site "a very long Host" 403 "Host: $(printf '%0300d' 1)"
for origin in http://attacker.example null "http://127.0.0.1:1" "http://localhost:$port" "http://127.0.0.1:$port.attacker.example" \
    "$(printf 'http://%0300d' 1)"; do
    site "Origin $origin" 403 "Origin: $origin"
done
site "no Origin, as of a picture" 403 "Sec-Fetch-Site: cross-site"
for body in "$JSON" 'Content-Type: text/plain'; do
    req POST /v1/tokens -H "$body" -d '{"name": "evil", "scopes": ["verify"]}'
    problem "a token, $body" 403 insufficient_scope 'surfacectl token'
done
req GET /v1/token
is "what may be done" "$(get '.scopes | join(",")')" "$(echo "$ALL" | sed 's/tokens,//')"
gives "403 insufficient_scope" "nor a list of tokens" req GET /v1/tokens
req GET /healthz -H 'Host: attacker.example' -H 'Sec-Fetch-Site: cross-site'
is "what needs no token is for everybody" "$STATUS" 200
is "nothing of it was done" "$(sql 'SELECT count(*) FROM subjects') $(sql 'SELECT count(*) FROM templates') $(sql 'SELECT count(*) FROM tokens')" "1 1 0"

# ---- in a browser
if needs_section browser chromedriver; then
    mkdir -p "$T/site" "$T/home"
    cp "$T/a.ply" "$T/site"
    HOME=$T/home /usr/bin/python3 tests/box/site.py "$URL" "$T/site" >"$T/out" 2>"$T/err"
    cat "$T/err"
    grep -v '^ok ' "$T/out"
    passed=$((passed + $(grep -c '^ok ' "$T/out")))
    failed=$((failed + $(grep -c '^FAIL ' "$T/out")))
    is "the browser's tests ran" "$(wc -l <"$T/out")" 9
    is "nothing was done" "$(sql 'SELECT count(*) FROM subjects') $(sql 'SELECT count(*) FROM tokens')" "1 0"
fi
stop_daemon

# ---- the origins that are named; a daemon with tokens; a Unix socket
start_daemon --no-auth --cors-origin https://desk.example.org
site "an origin that is named" 200 "Origin: https://desk.example.org" "Sec-Fetch-Site: cross-site"
site "another" 403 "Origin: https://desk.example.net" "Sec-Fetch-Site: cross-site"
stop_daemon
start_daemon
AUTH=$(new_token desk)
site "with a token" 200 "Host: surfaced.example" "Origin: https://desk.example.net" "Sec-Fetch-Site: cross-site"
AUTH=
stop_daemon
"$BUILD/surfaced" --db "$DB" --no-auth --listen "unix:$T/socket" >"$T/log" 2>&1 &
unix=$!
ok "it listens" soon test -S "$T/socket"
is "no browser connects to a Unix socket" "$(curl -sS -o "$T/body" -w '%{http_code}' --unix-socket "$T/socket" \
    -H 'Host: surfaced.example' http://x/v1/subjects)" 200
kill $unix
wait $unix
finish
