#!/bin/sh
# Goal: repeated failed verifications lock a subject out, and repeated failed authentication is
# rate-limited per address; others are not affected, the lock-out survives a restart, and
# parallel requests cannot exceed the limits.
. tests/box/lib.sh

# verify SUBJECT FILE [QUERY]
verify() {
    send POST "/v1/subjects/$1/verify${3:-}" "$PLY" "$2"
}

# decides TITLE DECISION [SUBJECT FILE]: the last verification, or this one, gives this decision.
decides() {
    [ $# -eq 2 ] || verify "$3" "$4"
    is "$1" "$STATUS $(get .decision)" "200 $2"
}

# locked_out TITLE SECONDS [SUBJECT FILE [QUERY]]: the last verification, or this one, is rejected
# because of a lock-out, of which at most SECONDS are left, and more than SECONDS - 100.
locked_out() {
    [ $# -eq 2 ] || verify "$3" "$4" "${5:-}"
    problem "$1" 429 too_many_attempts
    again "$1" $(($2 > 100 ? $2 - 99 : 1)) "$2"
    ok "$1: no disparity" sh -c "! grep -q disparity '$T/body'"
}

# later SECONDS: moves all subjects' last failures that far into the past.
later() {
    sql "UPDATE attempts SET at_ms = at_ms - $1 * 1000"
}

# failures SUBJECT: the number that counts towards its lock-out.
failures() {
    "$BUILD/surfacectl" --db "$DB" --json attempts list |
        jq --arg who "$1" '[.attempts[] | select(.subject == $who).failures] | add // 0'
}

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a1.ply"
scan 2 0 "$T/b.ply"
scan 2 1 "$T/b1.ply"
scan 1 1 "$T/a1.xyz"
awk '{ print -$1, $2, $3 }' "$T/a1.xyz" >"$T/swapped.xyz"

# ---- attempts
start_daemon --no-auth --attempt-wait 300
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
alice=$(get .template_id)
send POST /v1/subjects/bob/templates "$PLY" "$T/b.ply"
for i in 1 2; do
    decides "failure $i" no_match alice "$T/b.ply"
done
decides "a match" match alice "$T/a1.ply"
is "it resets the count" "$(failures alice)" 0
decides "a failure" no_match alice "$T/b.ply"
send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/swapped.xyz"
problem "its own, left and right swapped" 422 mirrored
is "it is an attempt" "$(failures alice)" 2
is "and an event" "$(sql "SELECT kind, outcome FROM $ENTRIES ORDER BY at DESC, seq DESC LIMIT 1")" 'verify|no_match'
decides "its own" match alice "$T/a1.ply"
decides "a failure" no_match alice "$T/b.ply"
gives 400 "a threshold in the request" verify alice "$T/b.ply" '?threshold=-1000'
is "it is not an attempt" "$(failures alice)" 1
decides "another match" match alice "$T/a1.ply"
is "it resets the count too" "$(failures alice)" 0
printf 'ply\n' >"$T/bad"
gives 400 "a malformed scan" verify alice "$T/bad"
is "it is not an attempt either" "$(failures alice)" 0
for i in 1 2; do
    decides "failure $i again" no_match alice "$T/b.ply"
done
send POST "/v1/templates/$alice/verify" "$PLY" "$T/b.ply"
decides "the third, by template" no_match
locked_out "a mated probe" 300 alice "$T/a1.ply"
locked_out "before the body is parsed" 300 alice "$T/bad"
send POST "/v1/templates/$alice/verify" "$PLY" "$T/a1.ply"
locked_out "by template" 300
locked_out "with another query" 300 alice "$T/a1.ply" '?units=mm'
is "rejected requests are not failures" "$(failures alice)" 3
decides "another subject is not locked out" match bob "$T/b1.ply"
gives "404 not_found" "an unknown subject" verify nobody "$T/b.ply"

stop_daemon
start_daemon --no-auth --attempt-wait 300
locked_out "after a restart" 300 alice "$T/a1.ply"
later 301
decides "after the lock-out" no_match alice "$T/b.ply"
locked_out "twice as long (and so on: tests/server/test_limits.c)" 600 alice "$T/a1.ply"
later 601
decides "a match after the lock-out" match alice "$T/a1.ply"
is "it ends the lock-out" "$(failures alice)" 0
for i in 1 2 3; do
    verify alice "$T/b.ply"
done
locked_out "again" 300 alice "$T/a1.ply"
ctl attempts reset alice
decides "surfacectl attempts reset, at once" match alice "$T/a1.ply"
for i in 1 2 3; do
    verify alice "$T/b.ply"
done
req DELETE /v1/subjects/alice
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
decides "a new subject of that name" match alice "$T/a1.ply"

# ---- parallel attempts
at_once 24 POST /v1/subjects/alice/verify -H "$PLY" --data-binary "@$T/b.ply"
is "24 attempts at once" "$TALLY" "200x3 429x21"
is "only 3 are decided" "$(failures alice)" 3
stop_daemon

# ---- other limits, and none
start_daemon --no-auth --attempts 1 --attempt-wait 2000
ctl attempts reset alice
decides "--attempts 1" no_match alice "$T/b.ply"
locked_out "--attempts 1 --attempt-wait 2000" 2000 alice "$T/a1.ply"
stop_daemon
start_daemon --no-auth --attempts 0
for i in 1 2 3 4 5 6; do
    decides "--attempts 0: failure $i" no_match alice "$T/b.ply"
done
decides "--attempts 0" match alice "$T/a1.ply"
stop_daemon

# ---- tokens
# send_wrong N: sends N requests, each with another wrong token.
send_wrong() {
    i=0
    while [ $i -lt "$1" ]; do
        tried=$((tried + 1))
        AUTH=$(printf '%064x' "$tried")
        req GET /v1/subjects
        i=$((i + 1))
    done
}
tried=0
known=$(new_token known)
unused=$(new_token unused)
start_daemon --rate-limit-tokens 1 # one a minute: the test has a minute
AUTH=$known
gives 200 "a valid token" req GET /v1/subjects
send_wrong 1
problem "a wrong one" 401 unauthorized
send_wrong 1
problem "another" 429 too_many_wrong_tokens
again "when" 1 60
is "no WWW-Authenticate" "$(field WWW-Authenticate)" ''
AUTH=$unused
gives "429 too_many_wrong_tokens" "a valid one that this address has not used before" req GET /v1/subjects
AUTH=$known
gives 200 "one that it has used" req GET /v1/subjects
AUTH=''
gives "401 unauthorized" "no token" req GET /v1/subjects
gives 200 "a path that needs none" req GET /healthz
ctl token revoke "$(sql "SELECT id FROM tokens WHERE name = 'known'")"
AUTH=$known
gives "401 unauthorized" "a revoked token" req GET /v1/subjects
gives "429 too_many_wrong_tokens" "after that it is a wrong one" req GET /v1/subjects
stop_daemon
start_daemon --rate-limit-tokens 0
send_wrong 40
problem "--rate-limit-tokens 0" 401 unauthorized
finish
