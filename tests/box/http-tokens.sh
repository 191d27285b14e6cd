#!/bin/sh
# Goal: every request but the public ones needs a token; a token allows what its scopes name,
# from its creation until it is rotated, expires or is revoked, while the daemon runs.
. tests/box/lib.sh

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a1.ply"
# shellcheck disable=SC2119 # without options
start_daemon
gives "401 unauthorized" "no token" req GET /v1/subjects
is "WWW-Authenticate" "$(field WWW-Authenticate)" 'Bearer realm="surfaced"'
for header in 'Basic YTpi' 'Bearer' 'Bearer ' "Bearer $(printf '%0500d' 1)" 'Bearer x y' \
    'Bearer 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef'; do
    gives "401 unauthorized" "Authorization: $header" req GET /v1/subjects -H "Authorization: $header"
done
is "WWW-Authenticate of a bad token" "$(field WWW-Authenticate)" \
    'Bearer realm="surfaced", error="invalid_token"'
# The token is checked before the id, the type and the size of the body.
gives "401 unauthorized" "whatever the id" send POST /v1/subjects/a%20b/templates "$PLY" "$T/a.ply"
gives "401 unauthorized" "whatever the type" send POST /v1/subjects/alice/templates 'Content-Type: x/y' "$T/a.ply"
head -c 70000000 /dev/zero >"$T/big"
gives "401 unauthorized" "whatever the size" send POST /v1/subjects/alice/templates "$BYTES" "$T/big"
rm "$T/big"
gives "404 no_such_route" "no such route" req GET /v1/nothing

ctl token create tests --scope "$ALL"
is "token create" $? 0
AUTH=$(jq -r .secret "$T/ctl")
token_id=$(jq -r '.id // .token_id' "$T/ctl")
gives 201 "enroll with a token" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
gives 200 "verify with it" send POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
mine=$AUTH AUTH= # a request has one such header
gives 200 "in lower case" req GET /v1/subjects -H "authorization: bearer $mine"
AUTH=$mine
req GET /v1/subjects -H "authorization: bearer $mine"
problem "two tokens" 400 malformed 'more than one Authorization'
is "the actor in the audit log" "$(sql "SELECT DISTINCT actor FROM $ENTRIES WHERE kind IN ('enroll', 'verify')")" \
    "$token_id"
ok "the token is not in the database" sh -c "! grep -aq '$AUTH' '$DB' '$DB-wal'"
ok "its last use is recorded" test -n "$(sql 'SELECT used FROM tokens')"

# ---- rotated
all=$AUTH
ctl token rotate "$token_id" --grace 1h
is "token rotate" "$? $(jq -r '.id' "$T/ctl")" "0 $token_id"
gives 200 "the old secret, within the grace period" req GET /v1/subjects
AUTH=$(jq -r .secret "$T/ctl")
gives 200 "the new secret" req GET /v1/subjects
ctl token rotate "$token_id"
gives "401 unauthorized" "a rotated secret, at once" req GET /v1/subjects
AUTH=$all
gives "401 unauthorized" "the secret before it" req GET /v1/subjects
AUTH=$(jq -r .secret "$T/ctl")
all=$AUTH
gives 200 "the newest secret" req GET /v1/subjects

# ---- scopes (http-scopes.sh)
AUTH=$(new_token narrow --scope enroll,verify)
# The scope is checked before the id, the type and the size.
gives 400 "a good scope, a malformed id" send POST /v1/subjects/a%20b/templates 'Content-Type: x/y' "$T/a.ply"
gives "403 insufficient_scope" "a wrong scope, a malformed id" req GET /v1/subjects/a%20b

# ---- expired
ctl token create --scope read --expires 1h short
AUTH=$(jq -r .secret "$T/ctl")
gives 200 "before it expires" req GET /v1/subjects
sql "UPDATE tokens SET expires = NULL WHERE name = 'short'"
gives "500 internal" "an expiry that was changed without the key" req GET /v1/subjects
"$BUILD/forge" "$DB" "$KEY" "UPDATE tokens SET expires = '2026-01-01T00:00:00.000Z' WHERE name = 'short'"
gives "401 unauthorized" "expired, at once" req GET /v1/subjects
ctl token rotate "$(jq -r .id "$T/ctl")" --expires 1h
AUTH=$(jq -r .secret "$T/ctl")
gives 200 "with a new expiry" req GET /v1/subjects

# ---- revoked
AUTH=$all
ctl token revoke "$token_id"
is "token revoke" $? 0
gives "401 unauthorized" "revoked, at once" req GET /v1/subjects
ctl token rotate "$token_id"
is "a revoked token cannot be rotated" $? 77
ok "the token is not in the log" sh -c "! grep -q '$AUTH' '$LOG'"

# ---- soon to end
AUTH=$(new_token watcher --scope audit)
is "none would end soon at the start" "$(metric surfaced_tokens_expiring)" 0
stop_daemon
ctl token revoke short
for life in 20d 29d 31d 400d never; do
    new_token "ends-$life" --scope verify --expires "$life" >"$T/$life"
done
new_token ends-revoked --scope verify --expires 3d >/dev/null
ctl token revoke ends-revoked
new_token ends-past --scope verify --expires 1d >/dev/null
"$BUILD/forge" "$DB" "$KEY" "UPDATE tokens SET expires = '2026-01-01T00:00:00.000Z' WHERE name = 'ends-past'"
ctl doctor
is "doctor names those that will, and it is no trouble" \
    "$CODE $(said '[.findings[] | select(.about == "token") | .what | sub("^[^(]*"; "") | sub(" expires.*"; "")] | join(" ")')" \
    "0 (ends-20d) (ends-29d)"
# shellcheck disable=SC2119 # without options
start_daemon
soon grep -q ends-29d "$LOG"
is "so does the log, once" "$(grep -o 'name=ends-[a-z0-9]*' "$LOG" | paste -sd ' ')" \
    "name=ends-20d name=ends-29d"
contains "and says what to do" "$LOG" 'level=warn msg="a token expires soon: surfacectl token rotate.*expires_at=20'
is "the metrics count them" "$(metric surfaced_tokens_expiring)" 2
first=$(metric surfaced_token_first_end_seconds)
ok "and tell when the first ends: $first" test "$((20 * 86400 - first))" -lt 3600
ok "not which it is" sh -c "! grep -q ends- '$T/body'"
# ---- a request that outlives its token
# late TITLE HOW METHOD PATH TYPE FILE: half of the body, the end of the token, the other half.
late() {
    AUTH=$(new_token late --scope verify,enroll,manage,delete --expires 1d)
    rm -f "$T/go"
    : >"$T/said"
    mkfifo "$T/go"
    python3 tests/box/late.py "${URL#*//}" "$3" "$4" "$AUTH" "$5" "$6" "$T/head" "$T/body" <"$T/go" >"$T/said" &
    exec 9>"$T/go"
    ok "$1, $2: the token was good" soon grep -q accepted "$T/said"
    case $2 in
    revoked) ctl token revoke "$(sql "SELECT id FROM tokens WHERE name = 'late' AND revoked IS NULL")" ;;
    expires) "$BUILD/forge" "$DB" "$KEY" "UPDATE tokens SET expires = '2026-01-01T00:00:00.000Z' WHERE name = 'late'" ;;
    esac
    echo >&9
    exec 9>&-
    wait $!
    STATUS=$(sed -n 's/^HTTP[^ ]* \([0-9]*\).*/\1/p' "$T/head")
    problem "$1, $2: refused" 401 unauthorized 'the token'
    is "$1, $2: why" "$(field WWW-Authenticate)" 'Bearer realm="surfaced", error="invalid_token"'
}
AUTH=$all
before=$(sql "SELECT count(*) FROM $ENTRIES WHERE outcome = 'match'") templates=$(sql 'SELECT count(*) FROM templates')
subjects=$(sql 'SELECT count(*) FROM subjects')
echo '{"hold": true}' >"$T/hold.json"
echo '{"subject": "late"}' >"$T/late.json"
for how in revoked expires; do
    late "verify" $how POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
    late "enroll" $how POST /v1/subjects/late/templates "$PLY" "$T/a.ply"
    late "a subject" $how POST /v1/subjects "$JSON" "$T/late.json"
    late "a change" $how PATCH /v1/subjects/alice 'Content-Type: application/merge-patch+json' "$T/hold.json"
done
is "nothing was done" "$(sql "SELECT count(*) FROM $ENTRIES WHERE outcome = 'match'") $(sql 'SELECT count(*) FROM templates') $(sql 'SELECT count(*) FROM subjects') $(sql "SELECT count(*) FROM subjects WHERE hold")" \
    "$before $templates $subjects 0"
finish
