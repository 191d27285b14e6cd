#!/bin/sh
# Goal: many clients at once are all served; a full queue gives 503 at once; a stop finishes the
# running requests and accepts no new ones.
. tests/box/lib.sh

scan 1 0 "$T/a.ply"
scan 1 1 "$T/p.ply" --pose 8 --shift 10
scan 2 0 "$T/b.ply"
scan 1 2 "$T/large.ply" --points 120000 --noise 0.05
scan 1 3 "$T/probe.ply" --points 120000 --noise 0.05

# parallel N PATH FILE: N clients send FILE at once.
parallel() {
    at_once "$1" POST "$2" -H "$PLY" --data-binary "@$3"
}

# count STATUS: the number of these among the last parallel requests.
count() {
    cat "$T"/s.* | grep -c "^$1\$"
}

# ---- all are served, and parallel enrolments leave one template
start_daemon --no-auth --workers 4 --attempts 0 # no lock-out after three that do not fit
parallel 12 /v1/subjects/alice/templates "$T/a.ply"
is "the same cloud in parallel: enrolled" "$(count 201)" 1
is "the same cloud in parallel: known" "$(count 200)" 11
parallel 60 /v1/subjects/alice/verify "$T/p.ply"
is "verified in parallel" "$(count 200)" 60
parallel 20 /v1/subjects/alice/templates "$T/b.ply"
is "another subject's in parallel: all rejected" "$(count 409)" 20
req GET /v1/subjects/alice
is "one template is left" "$(get '.templates | length')" 1

# Two faces at once as the first sample of a new subject: one is enrolled.
rm -f "$T"/s.*
for f in a b; do
    beside "$f" POST /v1/subjects/new/templates -H "$PLY" --data-binary "@$T/$f.ply"
done
all_sent
is "two faces as one subject" "$TALLY" "201x1 409x1"

# Six faces, three samples each, at once as samples of a new subject: whichever is first, only
# its samples are enrolled.
rm -f "$T"/s.*
for who in 11 12 13 14 15 16; do
    for n in 0 1 2; do
        scan $who $n "$T/m.$who.$n" --points 1500
    done
done
for n in 0 1 2; do
    for who in 11 12 13 14 15 16; do
        beside "$who.$n" POST "/v1/subjects/mixed/templates?label=$who" -H "$PLY" \
            --data-binary "@$T/m.$who.$n"
    done
done
all_sent
is "18 samples of six faces at once: three of them" "$TALLY" "201x3 409x15"
is "and of one face" "$(grep -l 201 "$T"/s.* | sed 's/.*s\.\(..\).*/\1/' | uniq | wc -l)" 1

# Deleting and enrolling while others verify gives nothing but 200 and 404.
rm -f "$T"/w.*
writer() {
    for i in 1 2 3 4 5 6; do
        curl -sS -o /dev/null -X DELETE "$URL/v1/subjects/alice"
        curl -sS -o /dev/null -H "$PLY" --data-binary "@$T/a.ply" \
            "$URL/v1/subjects/alice/templates"
    done
}
writer &
writing=$!
parallel 40 /v1/subjects/alice/verify "$T/p.ply"
wait "$writing"
is "verifying during erasures" "$(($(count 200) + $(count 404)))" 40
stop_daemon

# ---- a full queue
start_daemon --no-auth --workers 1 --queue 1
parallel 12 /v1/subjects/x/templates "$T/large.ply"
busy=$(count 503)
ok "a full queue rejects some ($busy)" test "$busy" -ge 1 -a "$busy" -le 11
is "and the others are served" "$((busy + $(count 201) + $(count 200)))" 12
rejected=$(grep -lx 503 "$T"/s.* | head -n 1)
cp "$T/o.${rejected##*.}" "$T/body"
cp "$T/h.${rejected##*.}" "$T/head"
STATUS=503
problem "a full queue" 503 overloaded 'queue is full'
again "when" 1
is "a warning for all of them" \
    "$(grep -c 'level=warn msg="requests refused: overloaded" requests=1 last="the queue is full"' "$LOG")" 1
is "and no error" "$(grep -c 'level=error' "$LOG")" 0
alive "a full queue"
stop_daemon

# ---- a stop while requests run
start_daemon --no-auth --workers 1
rm -f "$T"/s.*
for i in 1 2 3 4; do
    beside "$i" POST /v1/subjects/x/verify -H "$PLY" --data-binary "@$T/probe.ply"
done
working 3
stop_daemon
all_sent
ok "running requests are finished ($(cat "$T"/s.* | tr '\n' ' '))" test "$(count 200)" -ge 3
ok "the stop is logged" grep -q 'msg="stopped"' "$LOG"
gives 000 "the daemon does not listen" req GET /healthz

# A client that connects just then has the I/O thread look at the socket as it is closed.
UNDER="env LD_PRELOAD=$BUILD/slow_shim.so" start_daemon --no-auth
kill -TERM "$PID"
sleep 0.1
gives 000 "a client during a stop" req GET /healthz
stop_daemon

# SIGINT stops it too, even while a client sends its body.
start_daemon --no-auth
curl -sS -m 20 --limit-rate 3000 -o /dev/null -H "$PLY" --data-binary "@$T/probe.ply" \
    "$URL/v1/subjects/x/verify" 2>/dev/null &
slow=$!
sleep 0.3
kill -INT "$PID"
wait "$PID"
is "exit status after SIGINT" $? 0
PID=
kill "$slow" 2>/dev/null
finish
