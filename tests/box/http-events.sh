#!/bin/sh
# Goal: a client learns of every decision and change, in order, once, over cut connections, a killed daemon and, on a
# server, another daemon; only what its token may see, as long as it may; and no client that does not read holds up
# the others.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
needs python3
N=20
! sanitized || N=5
MERGE='Content-Type: application/merge-patch+json'

# events ARGUMENT...: of tests/box/events.py
events() {
    TOKEN=$AUTH timeout 100 python3 tests/box/events.py "$@"
}

verify() {
    req POST "/v1/subjects/$1/verify" -H "$PLY" --data-binary "@$T/$2.ply"
}

patch() {
    req PATCH "/v1/subjects/$1" -H "$MERGE" -d "$2"
}

# types QUERY: of the events of a page
types() {
    req GET "/v1/events?$1"
    get '[.events[] | "\(.type):\(.outcome):\(.subject)"] | join(" ")'
}

for n in 0 1 2; do scan 1 $n "$T/a$n.ply"; done
scan 2 0 "$T/b0.ply"
# Its own address, so that it can be had again.
LISTEN=127.0.0.1:$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
start_daemon --attempt-subjects 1000
ONE=$PID URL1=$URL DAEMONS=$URL
AUTH=$(new_token all)
ALL_TOKEN=$AUTH
if [ -n "${PGHOST:-}" ]; then
    ctl_exits 0 join --anchor "$T/anchor2"
    LISTEN='' LOG=$T/log2 start_daemon --anchor "$T/anchor2" --attempt-subjects 1000
    TWO=$PID URL2=$URL DAEMONS="$URL1 $URL"
    trap 'kill -9 $ONE $TWO $FOLLOWER 2>/dev/null; cleanup' EXIT
    PID=$ONE URL=$URL1 LOG=$T/log
else
    URL2=$URL1
    trap 'kill -9 $FOLLOWER 2>/dev/null; cleanup' EXIT
fi

# shellcheck disable=SC2086 # a list
TOKEN=$AUTH python3 tests/box/events.py follow "$T/followed" $DAEMONS 2>"$T/follow.log" &
FOLLOWER=$!
ok "a client follows" soon grep -q ready "$T/follow.log"

# streams N: that many are open
# shellcheck disable=SC2317 # called by soon
streams() {
    [ "$(metric surfaced_event_streams)" = "$1" ]
}
ok "its stream is open" soon streams 1

# ---- what there is, and what it says
req POST /v1/subjects/alice/templates -H "$PLY" --data-binary "@$T/a0.ply"
verify alice a1
verify alice b0
patch alice '{"disabled": true}'
patch alice '{"disabled": false, "consent": "form 7", "groups": ["east"]}'
req POST /v1/identify -H "$PLY" --data-binary "@$T/b0.ply"
verify alice b0
verify alice b0
req DELETE /v1/subjects/alice/attempts
req DELETE "/v1/templates/$(sql 'SELECT id FROM templates')"
is "all of it, in order" "$(types last=100)" "subject_added:created:alice enroll:enrolled:alice verify:match:alice verify:no_match:alice\
 subject_disabled:disabled:alice consent_changed:set:alice subject_enabled:enabled:alice groups_changed:set:alice\
 identify:no_match:null verify:no_match:alice verify:no_match:alice locked_out:locked_out:alice attempts_reset:reset:alice\
 template_deleted:deleted:alice"
ok "no number of a comparison" sh -c "! grep -Eq 'score|overlap|threshold| of ' '$T/body'"
is "who" "$(get '[.events[] | "\(.token) \(.token_id)"] | unique | join(", ")')" "all $(sql 'SELECT id FROM tokens')"
is "a lock-out's end" "$(get '[.events[] | select(.until) | .until > .at] | tostring')" '[true]'
is "where it goes on" "$(get '.next_cursor == .events[-1].cursor')" true
req POST /v1/subjects/alice/templates -H "$PLY" --data-binary "@$T/a0.ply"
verify alice a1
ok "from any event on the rest" events resumed "$URL"
[ "$URL2" = "$URL1" ] || ok "at the other daemon, too" events resumed "$URL2"

# ---- refusals: an entry each, of what has none yet
refusals=$(new_token refusals --scope verify,enroll,identify)
AUTH=$refusals
printf '0 0 0\n90 0 5\n0 90 5\n' >"$T/few.txt"
verify nobody a1
send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/few.txt"
send POST /v1/subjects/alice/templates "$BYTES" "$T/few.txt"
send POST /v1/identify "$BYTES" "$T/few.txt"
req POST '/v1/subjects/alice/verify?units=inch' -H "$PLY" --data-binary "@$T/a1.ply"
verify alice a0
send POST /v1/subjects/alice/templates "$PLY" "$T/b0.ply"
verify alice b0
verify alice b0
verify alice b0
send POST /v1/subjects/bert/templates "$PLY" "$T/b0.ply"
send POST '/v1/subjects/bea/templates?unique=true' "$PLY" "$T/b0.ply"
AUTH=$ALL_TOKEN
is "each once" "$(types last=14)" "refused:not_found:null refused:too_few_points:alice refused:too_few_points:alice refused:too_few_points:null\
 refused:invalid_parameter:alice refused:replayed:alice enroll_mismatch:no_match:alice verify:no_match:alice locked_out:locked_out:alice\
 refused:too_many_attempts:alice refused:too_many_attempts:alice subject_added:created:bert enroll:enrolled:bert refused:already_enrolled:bert"
is "of which request" "$(sql "SELECT DISTINCT outcome FROM access_log WHERE kind = 'refused' ORDER BY outcome" | paste -sd ,)" \
    'invalid_parameter verify,not_found verify,too_few_points enroll,too_few_points identify,too_few_points verify,too_many_attempts verify'
# A refusal costs a client less than a verification: its log must not grow faster.
AUTH=$(new_token flood --scope verify)
for _ in $(seq 300); do printf 'url = "%s/v1/subjects/nobody/verify?units=inch"\noutput = /dev/null\n' "$URL"; done >"$T/flood"
curl -sS -K "$T/flood" -H "Authorization: Bearer $AUTH" -H "$PLY" --data-binary "@$T/few.txt"
AUTH=$ALL_TOKEN
logged=$(sql "SELECT count(*) FROM access_log WHERE kind = 'refused' AND actor = '$(sql "SELECT id FROM tokens WHERE name = 'flood'")'")
ok "of 300 at once $logged are logged, two a second more" test "$logged" -ge 120 -a "$logged" -lt 200
req DELETE /v1/subjects/alice/attempts
req DELETE /v1/subjects/bert

# ---- a page that waits
cursor=$(req GET '/v1/events?last=0' && get .next_cursor)
for to in "$URL1" "$URL2"; do
    curl -sS -m 60 -H "Authorization: Bearer $AUTH" -o "$T/waited" -w '%{time_total}\n' "$to/v1/events?after=$cursor&wait=50" >"$T/wait" &
    waiter=$!
    ok "it waits" soon streams "$([ "$to" = "$URL1" ] && echo 2 || echo 1)"
    verify alice a2
    wait $waiter
    is "for the next event" "$(jq -r '.events[] | "\(.type) \(.outcome)"' "$T/waited")" "verify match"
    cursor=$(jq -r .next_cursor "$T/waited")
done
req GET "/v1/events?after=$cursor&wait=1"
is "in vain" "$STATUS $(jq -c . "$T/body")" "200 {\"events\":[],\"next_cursor\":\"$cursor\"}"

# ---- the speed
echo "an own event: $(events latency "$URL1" "$URL1" "$T/a2.ply" alice $N)"
[ "$URL2" = "$URL1" ] || echo "the other daemon's: $(events latency "$URL1" "$URL2" "$T/a2.ply" alice $N)"

# ---- groups
east=$(new_token east --scope events,verify,enroll,identify,manage,delete --group east)
west=$(new_token west --scope events --group west)
patch alice '{"groups": ["east"]}'
req POST /v1/subjects -H "$JSON" -d '{"subject": "bob", "groups": ["west"]}'
req POST /v1/subjects -H "$JSON" -d '{"subject": "nobody"}'
AUTH=$west
is "one's own groups" "$(types last=100)" 'subject_added:created:bob'
AUTH=$east
verify alice a1
req POST /v1/identify -H "$PLY" --data-binary "@$T/b0.ply"
is "and what the token did itself, without a subject" "$(types last=2)" 'verify:match:alice identify:no_match:null'
AUTH=$west
is "which others do not see" "$(types last=100)" 'subject_added:created:bob'
AUTH=$ALL_TOKEN
patch alice '{"groups": ["west"]}'
AUTH=$west
ok "of the groups that a subject has now: $(types last=100)" test "$(types last=100 | grep -c alice)" = 1
AUTH=$east
ok "and no more of those that it had" sh -c "! grep -q alice '$T/body'" "$(types last=100)"
AUTH=$ALL_TOKEN

# ---- erased
req DELETE /v1/subjects/bob
is "an erased subject has no name" "$(types last=1)" subject_erased:erased:null
ok "nowhere" sh -c "! grep -q bob '$T/body'" "$(types last=100)"
AUTH=$west
ok "nor is there anything of it for a bound token" sh -c "! grep -Eq 'bob|erased' '$T/body'" "$(types last=100)"
AUTH=$ALL_TOKEN

# ---- as long as the token is valid
# ended TITLE COMMAND...: a stream of the token $one ends soon after the command
ended() {
    e_title=$1
    shift
    ok "$e_title: none but the follower's" soon streams 1
    TOKEN=$one timeout 60 python3 tests/box/events.py ends "$URL1" 40 >"$T/opened" 2>"$T/ends" &
    ender=$!
    ok "$e_title: open" soon streams 2
    "$@"
    ok "$e_title: ends" soon streams 1
    wait $ender
    is "$e_title: $(cat "$T/ends")" $? 0
}
id_of() {
    sql "SELECT id FROM tokens WHERE name = '$1' AND revoked IS NULL"
}
one=$(new_token revoked --scope events)
ended "a revoked token" req DELETE "/v1/tokens/$(id_of revoked)"
one=$(new_token rotated --scope events)
# shellcheck disable=SC2317 # called by ended
rotate() {
    req POST "/v1/tokens/$(id_of rotated)/rotate" -H "$JSON" -d '{"grace_s": 2}'
    next=$(get .secret)
}
ended "a rotated one" rotate
one=$next
ok "its new secret" test -n "$one"
ended "rotated by another program, without grace" ctl token rotate "$(id_of rotated)"
one=$(new_token ending --scope events --expires 8s)
ended "one that expires" true
req GET '/v1/events?last=0' -H "Authorization: Bearer $one"
AUTH=$one
gives "401 unauthorized" "and opens none" req GET /v1/events
AUTH=$ALL_TOKEN

# ---- a killed daemon
for round in 1 2 3; do
    for _ in 1 2 3; do verify alice a1; done
    kill_daemon
    if [ "$URL2" != "$URL1" ]; then
        URL=$URL2
        gives 200 "the other goes on" verify alice a2
        URL=$URL1
    fi
    start_daemon --attempt-subjects 1000
    ONE=$PID
    gives 200 "round $round" verify alice a2
done
# shellcheck disable=SC2317 # called by soon
all_came() {
    events pages "$URL1" >"$T/pages"
    [ "$(wc -l <"$T/followed")" -ge "$(wc -l <"$T/pages")" ]
}
ok "all have come" soon all_came
sort "$T/followed" | jq -c '[.cursor, .at, .type, .outcome]' >"$T/had"
is "each once" "$(sort "$T/had" | uniq -d)" ''
key='[.at, .type, .outcome, .token_id] | @tsv' # clocks of two daemons order the pages otherwise
jq -r "$key" "$T/followed" | sort >"$T/f"
jq -r "$key" "$T/pages" | sort >"$T/p"
ok "nothing is lost: $(diff "$T/f" "$T/p" | head -5)" cmp -s "$T/f" "$T/p"
is "as many verifications as in the log" "$(jq -r .type "$T/followed" | grep -c '^verify$')" \
    "$(sql "SELECT count(*) FROM access_log WHERE kind = 'verify' AND outcome NOT LIKE 'replayed%'")"

# ---- clients that do not read
kill $FOLLOWER
wait $FOLLOWER 2>/dev/null
ok "none is open" soon streams 0
echo "a verification without streams: $(events speed "$URL1" "$T/a1.ply" alice $((5 * N)))"
for n in 1 2 3 4; do eval "t$n=\$(new_token t$n --scope events)"; done
mkfifo "$T/hold"
# shellcheck disable=SC2154 # by eval
python3 tests/box/events.py hold "$URL1" 220 '?after=0-0' "$t1" "$t2" "$t3" "$t4" <"$T/hold" >"$T/held" 2>&1 &
holder=$!
exec 8>"$T/hold"
ok "200 are open" soon grep -q open "$T/held"
is "and no more" "$(cat "$T/held")" "open 200 refused 20"
gives "503 too_many_streams" "nor a page" req GET '/v1/events?last=1'
ok "which says when" test "$(field Retry-After)" -ge 10
rss() {
    awk '$1 == "VmRSS:" { print $2 }' "/proc/$PID/status"
}
before=$(rss)
echo "with 200 of them: $(events speed "$URL1" "$T/a1.ply" alice $((5 * N)))"
echo "memory with 200 streams: $before KB, after these verifications $(rss) KB"
exec 8>&-
wait $holder
ok "they are gone" soon streams 0
python3 tests/box/events.py hold "$URL1" 60 '' "$t1" </dev/null >"$T/held" 2>&1
is "a token has a share" "$(cat "$T/held")" "open 50 refused 10"
ok "nothing but its streams" soon streams 0

# ---- one that reads, and hears nothing for a while; then the end of the daemon
ok "a heartbeat" events beats "$URL1"
ok "it is closed" soon streams 0
TOKEN=$AUTH python3 tests/box/events.py ends "$URL1" 60 >"$T/opened" 2>"$T/ends" &
ender=$!
curl -sS -m 60 -H "Authorization: Bearer $AUTH" -o "$T/waited" "$URL1/v1/events?wait=50" &
waiter=$!
ok "both are open" soon streams 2
begin=$(date +%s%N)
stop_daemon
echo "a stop with open streams: $((($(date +%s%N) - begin) / 1000000)) ms"
wait $ender
is "the stream ends: $(cat "$T/ends")" $? 0
wait $waiter
is "the page is empty" "$(jq -c .events "$T/waited")" '[]'

# ---- entries that were cut off
sql 'DELETE FROM access_log WHERE daemon = 0 AND seq <= 3'
start_daemon --attempt-subjects 1000 --timeout 2
ONE=$PID
req GET '/v1/events?after=0-0&limit=1000'
is "events are missing, and this is said" "$(get '[.events[] | select(.type == "gap") | "\(.outcome) \(.subject)"] | join(" ")')" 'trimmed null'
after=$(get '.events[] | select(.type == "gap") | .cursor')
req GET "/v1/events?after=$after"
is "and once" "$STATUS $(get '[.events[] | select(.type == "gap")] | length')" '200 0'

# ---- more than fits between: who takes nothing is cut off, and a client that reads has all
long=$(printf '%0128d' 0)
req POST /v1/subjects -H "$JSON" -d "{\"subject\": \"$long\"}"
for _ in $(seq 200); do printf 'url = "%s/v1/subjects/%s"\noutput = /dev/null\n' "$URL" "$long"; done >"$T/changes"
curl -sS -w '%{http_code}\n' -K "$T/changes" -X PATCH -H "Authorization: Bearer $AUTH" -H "$MERGE" \
    -d '{"consent": "x", "hold": false, "disabled": false, "groups": ["a"], "identify": true}' >"$T/patched"
exec 8<>"$T/hold"
python3 tests/box/events.py hold "$URL1" 20 '?after=0-0' "$t1" <"$T/hold" >"$T/held" 2>&1 &
holder=$!
ok "20 are open" soon grep -qx 'open 20 refused 0' "$T/held"
events pages "$URL1" 1000 >"$T/pages"
ok "all is read beside them: $(wc -l <"$T/pages")" test "$(wc -l <"$T/pages")" -ge $(($(grep -c 200 "$T/patched") * 5))
# shellcheck disable=SC2317 # called by soon
cut_off() {
    [ "$(metric 'surfaced_connections_closed_total{reason="slow_events"}')" = 20 ]
}
ok "each is cut off" soon cut_off
ok "and closed" soon streams 0
kill $holder
wait $holder 2>/dev/null
exec 8>&-
if [ -n "${TWO:-}" ]; then
    kill -TERM "$TWO"
    wait "$TWO"
    is "the other daemon's exit status" $? 0
fi
finish
