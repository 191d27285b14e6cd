#!/bin/sh
# Goal: trying faces or tokens is rate-limited; others are not affected, a restart forgets nothing,
# and many tries at once are no way round it.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# verify SUBJECT FILE [QUERY]
verify() {
    send POST "/v1/subjects/$1/verify${3:-}" "$PLY" "$2"
}

# told TITLE DECISION: the last verification was answered.
told() {
    is "$1" "$STATUS $(get .decision)" "200 $2"
}

# waits TITLE SECONDS: it was not, for at most so long and hardly less.
waits() {
    problem "$1" 429 too_many_attempts
    wait_s=$(field Retry-After)
    ok "$1: waits $wait_s s of $2" test "${wait_s:-0}" -le "$2" -a "${wait_s:-0}" -gt $(($2 - 100))
    ok "$1: tells nothing" sh -c "! grep -q disparity '$T/body'"
}

# later SECONDS: so long ago the last failure was, for all subjects.
later() {
    sqlite3 "$DB" "UPDATE attempts SET at_ms = at_ms - $1 * 1000"
}

failures() {
    "$BUILD/surfacectl" --db "$DB" --json attempts list |
        jq --arg who "$1" '[.attempts[] | select(.subject == $who).failures] | add // 0'
}

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a1.ply"
scan 2 0 "$T/b.ply"

# ---- attempts
start_daemon --no-auth --attempt-wait 300
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
alice=$(get .template_id)
send POST /v1/subjects/bob/templates "$PLY" "$T/b.ply"
for i in 1 2; do
    verify alice "$T/b.ply"
    told "failure $i" no_match
done
verify alice "$T/a1.ply"
told "a match" match
is "begins the count anew" "$(failures alice)" 0
verify alice "$T/b.ply"
told "a failure" no_match
verify alice "$T/b.ply" '?threshold_mm=1000'
is "a threshold of the request's own" "$STATUS" 400
is "is no attempt" "$(failures alice)" 1
verify alice "$T/a1.ply"
told "another match" match
is "begins it anew too" "$(failures alice)" 0
printf 'ply\n' >"$T/bad"
verify alice "$T/bad"
is "what is no scan" "$STATUS" 400
is "is no attempt" "$(failures alice)" 0
for i in 1 2; do
    verify alice "$T/b.ply"
    told "failure $i again" no_match
done
send POST "/v1/templates/$alice/verify" "$PLY" "$T/b.ply"
told "the third, by template" no_match
verify alice "$T/a1.ply"
waits "the right face" 300
verify alice "$T/bad"
waits "before the body is looked at" 300
send POST "/v1/templates/$alice/verify" "$PLY" "$T/a1.ply"
waits "by template" 300
verify alice "$T/a1.ply" '?units=mm'
waits "by another query" 300
is "waiting is no failure" "$(failures alice)" 3
verify bob "$T/b.ply"
told "somebody else does not wait" match
verify nobody "$T/b.ply"
problem "nor who is not there" 404 not_found

stop_daemon
start_daemon --no-auth --attempt-wait 300
verify alice "$T/a1.ply"
waits "after a restart" 300
later 301
verify alice "$T/b.ply"
told "when the time is over" no_match
verify alice "$T/a1.ply"
waits "twice as long" 600
later 601
verify alice "$T/b.ply"
verify alice "$T/a1.ply"
waits "four times" 1200
sqlite3 "$DB" "UPDATE attempts SET failures = 60"
verify alice "$T/a1.ply"
waits "a day at most" 86400
sqlite3 "$DB" "UPDATE attempts SET failures = 3, at_ms = at_ms + 86400000"
verify alice "$T/a1.ply"
waits "after the clock was set back" 300
later 301
verify alice "$T/a1.ply"
told "a match after waiting" match
is "ends it" "$(failures alice)" 0
for i in 1 2 3; do
    verify alice "$T/b.ply"
done
verify alice "$T/a1.ply"
waits "again" 300
ctl attempts list
is "surfacectl attempts list" "$(jq -c '.attempts | map([.subject, .failures])' "$T/ctl")" \
    '[["alice",3]]'
ctl attempts reset alice
verify alice "$T/a1.ply"
told "surfacectl attempts reset, at once" match
for i in 1 2 3; do
    verify alice "$T/b.ply"
done
req DELETE /v1/subjects/alice
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
verify alice "$T/a1.ply"
told "a new subject of that name" match

# ---- many at once
i=0
: >"$T/urls"
while [ $i -lt 24 ]; do
    printf 'next\nurl = "%s/v1/subjects/alice/verify"\nheader = "%s"\ndata-binary = "@%s"\nwrite-out = "%%{http_code}\\n"\noutput = "%s"\n' \
        "$URL" "$PLY" "$T/b.ply" "$T/many.$i" >>"$T/urls"
    i=$((i + 1))
done
sed -i 1d "$T/urls"
curl -sS -m 120 --parallel --parallel-max 24 -K "$T/urls" >"$T/codes" 2>"$T/curl"
is "24 tries at once" "$(sort "$T/codes" | uniq -c | tr -s ' ' | tr '\n' ';')" ' 3 200; 21 429;'
is "are 3" "$(failures alice)" 3
stop_daemon

# ---- otherwise, and off
start_daemon --no-auth --attempts 1 --attempt-wait 2000
ctl attempts reset alice
verify alice "$T/b.ply"
told "--attempts 1" no_match
verify alice "$T/a1.ply"
waits "--attempts 1 --attempt-wait 2000" 2000
stop_daemon
start_daemon --no-auth --attempts 0
for i in 1 2 3 4 5 6; do
    verify alice "$T/b.ply"
    told "--attempts 0: failure $i" no_match
done
verify alice "$T/a1.ply"
told "--attempts 0" match
stop_daemon

# ---- tokens
# wrong N: so many different ones.
wrong() {
    i=0
    while [ $i -lt "$1" ]; do
        tried=$((tried + 1))
        AUTH=$(printf '%064x' "$tried")
        req GET /v1/subjects
        i=$((i + 1))
    done
}
tried=0
ctl token create known
known=$(jq -r .token "$T/ctl")
ctl token create unknown
unknown=$(jq -r .token "$T/ctl")
start_daemon --rate-limit-tokens 1 # so that the test has a minute
AUTH=$known
req GET /v1/subjects
is "a right token" "$STATUS" 200
wrong 1
problem "a wrong one" 401 unauthorized
wrong 1
problem "another" 429 too_many_wrong_tokens
ok "Retry-After: $(field Retry-After)" matches "$(field Retry-After)" '^([1-9]|[1-5][0-9]|60)$'
is "no WWW-Authenticate" "$(field WWW-Authenticate)" ''
AUTH=$unknown
req GET /v1/subjects
problem "a right one that was not seen before" 429 too_many_wrong_tokens
AUTH=$known
req GET /v1/subjects
is "one that was" "$STATUS" 200
AUTH=''
req GET /v1/subjects
problem "none" 401 unauthorized
req GET /healthz
is "where none is asked for" "$STATUS" 200
ctl token revoke "$(sqlite3 "$DB" "SELECT id FROM tokens WHERE name = 'known'")"
AUTH=$known
req GET /v1/subjects
problem "revoked meanwhile" 401 unauthorized
req GET /v1/subjects
problem "and then a wrong one" 429 too_many_wrong_tokens
stop_daemon
start_daemon --rate-limit-tokens 0
wrong 40
problem "--rate-limit-tokens 0" 401 unauthorized
finish
