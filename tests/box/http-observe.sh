#!/bin/sh
# Goal: metrics, health and log show what the daemon does and contain no personal data; a deleted
# template is never used, whichever process deleted it.
. tests/box/lib.sh

scan 1 0 "$T/a.ply"
scan 1 1 "$T/p.ply" --pose 8 --shift 10
scan 1 1 "$T/p.xyz" --pose 8 --shift 10
scan 2 0 "$T/b.ply" --pose 8 --shift 10
scan 1 2 "$T/large.ply" --points 120000 --noise 0.05


# ---- some of everything, with tokens
ctl init
ctl token create operator --scope "$ALL"
AUTH=$(jq -r .secret "$T/ctl")
token_id=$(jq -r .id "$T/ctl")
ok "a token" matches "$AUTH $token_id" '^[^ ]{20,} [0-9a-f]{32}$'
start_daemon --workers 2
gives 201 "enrolled" send POST '/v1/subjects/alice/templates?label=secretlabel' "$PLY" "$T/a.ply"
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
gives 409 "a mismatch" send POST /v1/subjects/alice/templates "$PLY" "$T/b.ply"
send POST /v1/subjects/alice/verify "$PLY" "$T/p.ply" -H 'X-Request-Id: traced-1'
is "a match" "$(get .decision)" match
get .score >"$T/private"
send POST /v1/subjects/alice/verify "$PLY" "$T/b.ply"
is "a non-match" "$(get .decision)" no_match
get .score >>"$T/private"
send POST /v1/subjects/alice/verify "$BYTES" "$T/p.xyz"
echo '{"points": [[12.3456789, 1, "oops"]]}' >"$T/bad.json"
gives 400 "malformed" send POST /v1/subjects/alice/verify "$JSON" "$T/bad.json"
printf '12.3456789 1 nan\n3 4 5e999\n' >"$T/bad.xyz"
gives 422 "not finite" send POST /v1/subjects/alice/verify 'Content-Type: text/plain' "$T/bad.xyz"
req GET "/v1/subjects/alice?probe=12.3456789"
good=$AUTH
AUTH=0123456789abcdef-wrong-token
gives 401 "a wrong token" req GET /v1/subjects/alice
AUTH=$good
for hostile in 'x" level="error' 'x level=error' 'a\nb' "$(printf 'a\tb')" '","x":"'; do
    req GET "/v1/subjects/al%22%0aice?x=$AUTH" -H "X-Request-Id: $hostile"
done

# ---- metrics
is "created" "$(metric 'surfaced_enrollments_total{outcome="created"}')" 1
is "known" "$(metric 'surfaced_enrollments_total{outcome="known"}')" 1
is "mismatch" "$(metric 'surfaced_enrollments_total{outcome="mismatch"}')" 1
is "match" "$(metric 'surfaced_decisions_total{decision="match"}')" 2
is "no match" "$(metric 'surfaced_decisions_total{decision="no_match"}')" 1
is "scores" "$(metric 'surfaced_score_bucket{le="0"}') $(metric surfaced_score_count)" '1 3'
is "their sum, which would tell each, is not there" "$(metric surfaced_score_sum)" ''
is "wrong tokens" "$(metric surfaced_wrong_tokens_total)" 1
is "scored" "$(metric 'surfaced_stage_duration_seconds_count{stage="score"}')" 5
is "minimised" "$(metric 'surfaced_stage_duration_seconds_count{stage="minimal"}')" 3
is "parsed" "$(metric 'surfaced_stage_duration_seconds_count{stage="parse"}')" 6
is "total" "$(metric 'surfaced_stage_duration_seconds_count{stage="total"}')" 6
is "counted by route, method and status" "$(metric \
    'surfaced_http_requests_total{route="/v1/subjects/{subject}/verify",method="POST",status="422"}')" 1
is "the database is served" "$(metric surfaced_database_refused)" 0
is "no certificate has an end" "$(metric surfaced_certificate_end_seconds)" ''
ok "the start time" test "$(metric process_start_time_seconds)" -gt 1000000000
ok "resident memory" test "$(metric process_resident_memory_bytes)" -gt 1000000
req GET /metrics
ok "no subject, label or token in the metrics" \
    sh -c "! grep -q -e alice -e secretlabel -e operator -e $token_id -e $AUTH '$T/body'"
# The exposition format: HELP and TYPE before the samples of a family, each family once, names
# by the conventions, cumulative buckets whose last is the count.
# shellcheck disable=SC2016 # awk's
ok "the metrics' format" awk '
    function bad(why) { print why ": " $0; failed = 1 }
    /^# HELP / { if (NF < 4 || ($3 in help)) bad("help"); help[$3] = 1; next }
    /^# TYPE / {
        if (!($3 in help) || ($3 in type)) bad("type")
        if ($4 !~ /^(counter|gauge|histogram)$/) bad("type")
        if (($4 == "counter") != ($3 ~ /_total$/)) bad("name of a counter")
        if ($3 ~ /(_ms|_milliseconds|_kb)(_|$)/) bad("unit")
        type[$3] = $4; last = $3; next }
    /^#/ { bad("comment"); next }
    !/^[a-z_]+(\{([a-z]+="[^"\\]*",?)+\})? [0-9.e+-]+$/ { bad("sample"); next }
    {   name = $1; sub(/\{.*/, "", name); family = name
        if (!(family in type)) sub(/_(bucket|sum|count)$/, "", family)
        if (family != last) bad("family")
        if ($1 " " in seen) bad("twice")
        seen[$1 " "] = 1
        if (name ~ /_bucket$/ && type[family] == "histogram") {
            series = $1; sub(/,?le="[^"]*"/, "", series); sub(/\{\}/, "", series)
            if ($2 < bucket[series]) bad("not cumulative")
            bucket[series] = $2 }
        if (name ~ /_count$/ && type[family] == "histogram") {
            series = $1; sub(/_count/, "_bucket", series)
            if ($2 != bucket[series]) bad("count") } }
    END { exit failed }' "$T/body"
if command -v promtool >/dev/null 2>&1; then
    ok "promtool" promtool check metrics <"$T/body"
fi

# ---- the dashboard and the alerts: every query uses existing metrics and labels
board=scripts/grafana-dashboard.json
# shellcheck disable=SC2016 # $__rate_interval is Grafana's
jq -r '.panels[].targets[].expr' "$board" | sed 's/\$__rate_interval/5m/g' >"$T/queries"
jq -r '.templating.list[].query | .query? // empty' "$board" >>"$T/queries"
ok "the dashboard has queries" test "$(wc -l <"$T/queries")" -gt 20
ok "each of its panels has an id of its own and says what it is for" jq_true '
    (.panels | map(.id) | unique | length) == (.panels | length) and all(.panels[]; .description)' "$board"
ok "none covers another" jq_true '[.panels[].gridPos | range(.x; .x + .w) + 100 * range(.y; .y + .h)]
    | (unique | length) == length' "$board"
{
    echo surfaced_certificate_end_seconds # with TLS alone: http-tls.sh
    sed -n 's/^\([a-z_]*\)[{ ].*/\1/p' "$T/body"
} | sort -u >"$T/names"
grep -oE '(surfaced|process)_[a-z_]+' "$T/queries" | sort -u >"$T/asked"
rules=scripts/prometheus-rules.yml
sed -n 's/^    expr: //p' $rules >"$T/alerts"
grep -oE 'surfaced_[a-z_]+' "$T/alerts" | sort -u >"$T/watched"
is "unknown metrics" "$(sort -u "$T/asked" "$T/watched" | comm -13 "$T/names" -)" ''
is "each alert has its parts" "$(grep -cE '^  - alert: Surfaced[A-Za-z]+$' $rules) $(wc -l <"$T/alerts") $(
    grep -cE '^    labels: \{severity: (page|ticket)\}$' $rules) $(grep -cE '^      summary: "' $rules)" '18 18 18 18'
is "and is explained" "$(sed -n 's/^  - alert: //p' $rules | while read -r alert; do
    grep -q "$alert" docs/operation.md || echo "$alert"
done)" ''
is "all metrics are used" "$(grep -c '^surfaced_' "$T/asked")" \
    "$(grep '^surfaced_' "$T/names" | grep -Evc '^surfaced_(http_request_duration_seconds_[sc]|score_count)')"
{ # the first two are Prometheus's own
    printf 'instance=\njob=\n'
    grep -oE '[a-z]+=' "$T/body"
} | sort -u >"$T/labels"
grep -v node_systemd "$T/alerts" | cat - "$T/queries" | grep -oE '[a-z]+(=|!|~)' | tr '!~' '==' | sort -u >"$T/filters"
is "unknown labels" "$(comm -13 "$T/labels" "$T/filters")" ''
if command -v promtool >/dev/null 2>&1; then
    {
        printf 'groups:\n- name: board\n  rules:\n'
        # shellcheck disable=SC2016
        grep -v label_values "$T/queries" |
            awk '{ gsub(/\047/, "\047\047"); printf "  - {record: q%d, expr: \047%s\047}\n", NR, $0 }'
    } >"$T/rules.yml"
    ok "the queries are PromQL" promtool check rules "$T/rules.yml" >"$T/promtool"
    ok "and the alerts are rules" promtool check rules $rules >"$T/promtool"
fi

# ---- the log
stop_daemon
ok "one line a request, with id, times and the token's id" grep -Eq \
    "^ts=[^ ]+ level=info msg=\"request\" request_id=traced-1 method=POST route=/v1/subjects/\{subject\}/verify status=200 ms=[0-9.]+ queue_ms=[0-9.]+ parse_ms=[0-9.]+ prepare_ms=[0-9.]+ score_ms=[0-9.]+ align_ms=[0-9.]+ minimal_ms=[0-9.]+ client=127\.0\.0\.1 token=$token_id\$" "$LOG"
tr ' ' '\n' <"$T/p.xyz" | grep -E '.{7}' >>"$T/private"
printf '%s\n' "$AUTH" 0123456789abcdef-wrong 12.3456789 5e999 oops alice secretlabel \
    operator disparity decision 'level=error' al%22 >>"$T/private"
ok "coordinates to look for" test "$(wc -l <"$T/private")" -gt 3000
# private_in_log: the log lines with one of these; without the times, which may have a score's
# digits.
private_in_log() {
    sed -E 's/"?(ts|ms|[a-z]+_ms)"?[=:]"?[-0-9.:TZ]+//g' "$LOG" | grep -F -f "$T/private"
}
is "no coordinate, score, token or subject in the log" "$(private_in_log)" ''

start_daemon --log-format json
send POST /v1/subjects/alice/verify "$PLY" "$T/p.ply" -H 'X-Request-Id: traced-2'
send POST /v1/subjects/alice/verify "$JSON" "$T/bad.json"
req GET "/v1/subjects/al%22%0aice" -H 'X-Request-Id: x","level":"error'
stop_daemon
ok "every line is JSON" jq_true -s 'all(has("ts") and has("level") and has("msg"))' "$LOG"
# shellcheck disable=SC2016
ok "numbers are JSON numbers" jq_true -s --arg token "$token_id" \
    'map(select(.request_id == "traced-2"))
    | length == 1 and (.[0] | .status == 200 and .ms > .score_ms + .minimal_ms and .token == $token)' "$LOG"
is "nothing private in JSON either" "$(private_in_log)" ''
AUTH=

# ---- health
start_daemon --no-auth --workers 2
req GET /healthz
is "alive" "$STATUS $(get .status)" "200 ok"
mv "$DB" "$T/elsewhere"
req GET /readyz
problem "the database is gone" 503 not_ready 'not the one that was opened'
again "when" 1
gives 200 "still alive" req GET /healthz
is "the metric says so" "$(metric surfaced_database_refused)" 1
mv "$T/elsewhere" "$DB"
gives "503 not_ready" "and back again, until the daemon is started again" req GET /readyz
stop_daemon
start_daemon --no-auth --workers 2

# Another process deletes a subject during verifications: none succeeds after the deletion.
lost=0 i=0
while [ $i -lt 10 ]; do
    ctl enroll "s$i" "$T/a.ply"
    send POST "/v1/subjects/s$i/verify" "$PLY" "$T/p.ply"
    [ "$STATUS" = 200 ] || lost=$((lost + 1))
    for n in 1 2 3; do
        beside "$n" POST "/v1/subjects/s$i/verify" -H "$PLY" --data-binary "@$T/p.ply"
    done
    ctl --yes subject erase "s$i"
    send POST "/v1/subjects/s$i/verify" "$PLY" "$T/p.ply"
    [ "$STATUS" = 404 ] || lost=$((lost + 1))
    all_sent
    grep -Evq '^(200|404)$' "$T/s.1" "$T/s.2" "$T/s.3" && lost=$((lost + 1))
    i=$((i + 1))
done
is "errors before surfacectl deletes it, or successes after" "$lost" 0

# While the daemon stops, /readyz on an open connection gives 503.
for n in 1 2 3 4 5 6 7 8; do
    curl -sS -m 60 -o /dev/null -H "$PLY" --data-binary "@$T/large.ply" \
        "$URL/v1/subjects/alice/verify" 2>/dev/null &
done
working 2
host=${URL#http://}
(
    printf 'GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n'
    tries=0
    while [ "$tries" -lt 3000 ] && ! grep -q 'stopping' "$LOG"; do
        sleep 0.01
        tries=$((tries + 1))
    done
    printf 'GET /readyz HTTP/1.1\r\nHost: x\r\n\r\n'
    sleep 5
) | curl -sSN -m 60 "telnet://$host" >"$T/telnet" 2>/dev/null &
telnet=$!
soon grep -q '"ok"' "$T/telnet"
stop_daemon
wait "$telnet"
ok "not ready while it stops" grep -q 'the daemon is stopping' "$T/telnet"
ok "with 503" grep -q 'HTTP/1.1 503 ' "$T/telnet"
finish
