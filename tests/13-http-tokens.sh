#!/bin/sh
# Goal: nobody gets in without a token, and a token counts from when it is made to when it
# is revoked, whatever the daemon is doing meanwhile.
cd "$(dirname "$0")/.." || exit 1
. tests/lib.sh

ctl() {
    "$BUILD/surfacectl" --db "$DB" --json "$@" >"$T/ctl" 2>"$T/ctl.err"
}

scan 1 0 "$T/a.ply"
# shellcheck disable=SC2119 # without options
start_daemon
for path in /healthz /readyz /version /metrics /openapi.json; do
    req GET "$path"
    is "$path asks for no token" "$STATUS" 200
done
req GET /v1/subjects
problem "no token" 401 unauthorized
is "WWW-Authenticate" "$(field WWW-Authenticate)" 'Bearer realm="surfaced"'
for header in 'Basic YTpi' 'Bearer' 'Bearer ' "Bearer $(printf '%0500d' 1)" 'Bearer x y' \
    'Bearer 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef'; do
    req GET /v1/subjects -H "Authorization: $header"
    problem "Authorization: $header" 401 unauthorized
done
is "WWW-Authenticate of a bad token" "$(field WWW-Authenticate)" \
    'Bearer realm="surfaced", error="invalid_token"'
# The token is asked for before the id, the type and the size of the body are looked at.
send POST /v1/subjects/a%20b/templates "$PLY" "$T/a.ply"
problem "enroll without" 401 unauthorized
send POST /v1/subjects/alice/templates 'Content-Type: x/y' "$T/a.ply"
problem "whatever the type" 401 unauthorized
head -c 70000000 /dev/zero >"$T/big"
send POST /v1/subjects/alice/templates "$BYTES" "$T/big"
problem "whatever the size" 401 unauthorized
rm "$T/big"
req GET /v1/nothing
problem "what is not there" 404 no_such_route

ctl token create tests
is "token create" $? 0
AUTH=$(jq -r '.secret // .token' "$T/ctl")
token_id=$(jq -r '.id // .token_id' "$T/ctl")
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
is "enroll with a token" "$STATUS" 201
send POST /v1/subjects/alice/verify "$PLY" "$T/a.ply"
is "verify with it" "$STATUS" 200
req GET /v1/subjects -H "authorization: bearer $AUTH"
is "in lower case" "$STATUS" 200
req GET /v1/subjects/a%20b
problem "a malformed id, with a token" 400 invalid_parameter
is "who did it" "$(sqlite3 "$DB" "SELECT DISTINCT actor FROM events WHERE kind IN ('enroll', 'verify')")" \
    "$token_id"
ok "the token is not in the database" sh -c "! grep -aq '$AUTH' '$DB' '$DB-wal'"
ctl token revoke "$token_id"
is "token revoke" $? 0
req GET /v1/subjects
problem "revoked, at once" 401 unauthorized
ok "the token is not in the log" sh -c "! grep -q '$AUTH' '$LOG'"
finish
