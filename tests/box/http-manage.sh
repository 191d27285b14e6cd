#!/bin/sh
# Goal: what the console's pages People, Audit and Health ask for: a search that decrypts is bounded,
# both logs come in one order, nobody gets a token that may do more than his own, and command and
# daemon say the same.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 8
scan 2 0 "$T/b.ply"
start_daemon --attempts 2 --attempt-wait 50
AUTH=$(new_token me)
me=$AUTH

# ids: the subjects of the last response, with spaces between them.
ids() { get '[.subjects[].subject] | join(" ")'; }
# patch ID JSON
patch() { req PATCH "/v1/subjects/$1" -H "$JSON" -d "$2"; }

# ---- people
send POST /v1/subjects/Alice@home/templates "$PLY" "$T/a.ply"
quality=$(get .quality.score)
for one in bob -- =cmd alice.2 ..alice; do
    req POST /v1/subjects -H "$JSON" -d "{\"subject\": \"$one\", \"consent\": \"=1+1\"}"
done
req GET /v1/subjects
is "all, in order of creation" "$(ids)" 'Alice@home bob -- alice.2 ..alice'
is "the members of the first" "$(get '.subjects[0] | [.templates, .quality, .hold, .disabled, .expires_at, .consent] | tojson')" \
    "[1,$quality,false,false,null,null]"
is "of one without templates" "$(get '.subjects[1] | [.templates, .quality, .last_seen, .consent] | tojson')" '[0,null,null,"=1+1"]'
req GET '/v1/subjects?q=ALICE'
is "a part of the id, in any case" "$(ids) $(get .next_cursor)" 'Alice@home alice.2 ..alice null'
req GET '/v1/subjects?q=alice&limit=2'
is "a page of it" "$(ids)" 'Alice@home alice.2'
req GET "/v1/subjects?q=alice&limit=2&cursor=$(get .next_cursor)"
is "the next" "$(ids) $(get .next_cursor)" '..alice null'
for q in '%25' '%27%20OR%201' '*' '_'; do
    req GET "/v1/subjects?q=$q"
    is "q=$q is text" "$STATUS $(ids)" '200 '
done
patch bob '{"disabled": true}'
patch alice.2 "{\"hold\": true, \"expires_at\": \"$(date -u -d '+29 days' +%F)\"}"
patch Alice@home "{\"expires_at\": \"$(date -u -d '+40 days' +%F)\"}"
patch ..alice "$(ending)"
sleep 1.1
for state in 'active Alice@home -- alice.2' 'disabled bob' 'hold alice.2' 'expired ..alice' 'ending alice.2' \
    'no_consent Alice@home'; do
    req GET "/v1/subjects?state=${state%% *}"
    is "${state%% *}" "${state%% *} $(ids)" "$state"
    ctl subject list --state "${state%% *}"
    # but lock-outs, which a daemon's limits make
    is "the command says the same" "$(said '.subjects | tojson')" "$(get '.subjects | map(del(.locked_until)) | tojson')"
done
req GET '/v1/subjects?state=hold&q=ALI'
is "both" "$(ids)" alice.2
ctl subject list --match ALI --state hold
is "by the command" "$(said '[.subjects[].subject] | join(" ")')" alice.2
ctl_exits 64 subject list --state gone
# a damaged template is one without a quality: the list still comes
sqlite3 "$DB" "CREATE TABLE saved AS SELECT mac FROM templates; UPDATE templates SET mac = zeroblob(32)"
req GET '/v1/subjects?limit=1'
is "a damaged template" "$STATUS $(get '.subjects[0].quality')" '200 null'
sql "UPDATE templates SET mac = (SELECT mac FROM saved); DROP TABLE saved"

# ---- attempts
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/b.ply"
req GET /v1/subjects/Alice@home
is "one failure" "$(get '.attempts | tojson')" '{"failures":1,"locked_until":null}'
AUTH=$(new_token door --scope verify)
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/b.ply"
sql "UPDATE attempts SET at_ms = at_ms - 51000"
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/b.ply"
AUTH=$me
req GET /v1/subjects/Alice@home
ok "failures of two tokens add up" jq_true '.attempts | .failures == 2
    and (.locked_until | sub("\\.[0-9]*"; "") | fromdate | . > now + 90 and . < now + 101)' "$T/body"
req DELETE /v1/subjects/Alice@home/attempts
req GET /v1/subjects/Alice@home
is "forgotten" "$(get '.attempts | tojson')" '{"failures":0,"locked_until":null}'

# ---- the audit log
# kinds: of the last response's entries.
kinds() { get '[.entries[].kind] | join(" ")'; }
req DELETE /v1/subjects/bob
req GET '/v1/audit?limit=1000'
cp "$T/body" "$T/whole"
is "newest first" "$(get '[.entries[:3][].kind] | join(" ")')" 'delete_subject reset_attempts locked_out'
is "all of it" "$(get '.entries | length') $(get .next_cursor)" "$(sql "SELECT count(*) FROM $ENTRIES") null"
ctl audit show --limit 1000
is "the command says the same" "$(said '.entries | reverse | tojson')" "$(get '.entries | tojson')"
is "who is erased has no name" "$(get '.entries[] | select(.kind == "delete_subject") | [.subject, .erased, (.subject_uid | length), .actor_name] | tojson')" '[null,true,32,"me"]'
is "who is here has" "$(get '[.entries[] | select(.kind == "verify") | .subject] | unique | tojson')" '["Alice@home"]'
# a page of each size has the same entries, whatever the log
for limit in 1 2 5; do
    : >"$T/pages"
    for way in before after; do
        cursor=
        [ "$way" = before ] || cursor=0-0
        while :; do
            req GET "/v1/audit?limit=$limit${cursor:+&$way=$cursor}"
            get '.entries[] | tojson' >>"$T/pages"
            [ "$(get '.entries | length')" -gt 0 ] || break
            cursor=$(get .next_cursor)
            [ "$cursor" != null ] || break
        done
        [ "$way" = after ] || mv "$T/pages" "$T/back"
    done
    is "pages of $limit" "$(cat "$T/back")" "$(jq -r '.entries[] | tojson' "$T/whole")"
    is "pages of $limit, forward" "$(tac "$T/pages")" "$(cat "$T/back")"
done
is "after the last one can ask again" "$(echo "$cursor" | sed 's/\.[0-9a-f]*//g')" "$(sql 'SELECT (SELECT max(seq) FROM change_log) || "-" || (SELECT max(seq) FROM access_log)')"
req GET '/v1/audit?kind=verify,reset_attempts&subject=Alice@home'
is "two kinds of a subject" "$(kinds)" 'reset_attempts verify verify verify'
req GET "/v1/audit?actor=$(sql "SELECT id FROM tokens WHERE name = 'door'")"
is "of an actor" "$(get '[.entries[] | .kind + " " + .actor_name] | join(" ")')" 'locked_out door verify door locked_out door verify door'
day=$(date -u +%F)
req GET "/v1/audit?since=$day&until=$day&limit=1000"
is "of a day" "$(get '.entries | length')" "$(jq '.entries | length' "$T/whole")"
req GET '/v1/audit?until=2020'
is "until long ago" "$(kinds) $(get .next_cursor)" ' null'
req GET "/v1/audit?since=$(date -u -d tomorrow +%F)"
is "since tomorrow" "$(kinds)" ''
# what is looked at in a request is bounded, and the cursor goes on behind it
sql "INSERT INTO access_log SELECT daemon, seq + value, at, 'filler', actor, uid, object, outcome, hash, mac, NULL
    FROM generate_series(1, 30000), (SELECT * FROM access_log ORDER BY seq DESC LIMIT 1)"
req GET '/v1/audit?kind=create_token'
is "nothing yet" "$(kinds)" ''
req GET "/v1/audit?kind=create_token&before=$(get .next_cursor)"
is "behind it" "$(kinds) $(get .next_cursor)" 'create_token create_token null'
sql "DELETE FROM access_log WHERE kind = 'filler'"

# ---- tokens
post() { req POST "$1" -H "$JSON" -d "$2"; }
post /v1/tokens '{"name": "<b>=cmd|x", "scopes": ["verify", "read"]}'
is "made" "$STATUS $(get '[.name, .scopes, .last_used, .revoked_at, .state] | tojson')" \
    '201 ["<b>=cmd|x",["verify","read"],null,null,"valid"]'
id=$(get .id) secret=$(get .secret)
is "its place" "$(field Location)" "/v1/tokens/$id"
ok "it ends in a year" jq_true '(.expires_at | sub("\\.[0-9]*"; "") | fromdate) - now | . > 364 * 86400 and . < 366 * 86400' "$T/body"
is "not kept by anybody" "$(field Cache-Control)" no-store
AUTH=$secret
gives 200 "it is good" req GET /v1/subjects
req GET /v1/tokens
problem "but not for this" 403 insufficient_scope tokens
AUTH=$me
post /v1/tokens "{\"name\": \"day\", \"scopes\": [\"verify\"], \"expires_at\": \"$(date -u -d '+9 days' +%F)\"}"
is "an end" "$(get '.expires_at[:10]')" "$(date -u -d '+9 days' +%F)"
post /v1/tokens '{"name": "moment", "scopes": ["verify"], "expires_at": "2031-01-31T12:00:00.007+01:00"}'
is "an end is kept to the millisecond" "$STATUS $(get .expires_at)" '201 2031-01-31T11:00:00.007Z'
req DELETE "/v1/tokens/$(get .id)"
post /v1/tokens '{"name": "ever", "scopes": ["verify", "verify"], "expires_at": null}'
is "none, which was asked for" "$STATUS $(get '[.expires_at, .scopes] | tojson')" '201 [null,["verify"]]'
req GET /v1/tokens
ctl token list
is "the list is the command's" "$(get '.tokens | map(del(.last_used)) | tojson')" "$(said '.tokens | map(del(.last_used)) | tojson')"
is "without a secret" "$(get '[.tokens[] | has("secret")] | any')" false
# nobody gives, or gets, what he has not
manager=$(new_token manager --scope tokens,verify)
managing=$(sql "SELECT id FROM tokens WHERE name = 'manager'")
mine=$(sql "SELECT id FROM tokens WHERE name = 'me'")
AUTH=$manager
post /v1/tokens '{"name": "more", "scopes": ["verify", "detail", "delete"]}'
problem "more than his own" 403 insufficient_scope 'delete,detail'
is "what it takes" "$(field WWW-Authenticate)" 'Bearer realm="surfaced", error="insufficient_scope", scope="delete detail"'
post "/v1/tokens/$mine/rotate" '{}'
problem "nor another's secret" 403 insufficient_scope
gives "403 insufficient_scope" "nor the end of one that may do more" req DELETE "/v1/tokens/$mine"
post /v1/tokens '{"name": "same", "scopes": ["verify", "tokens"]}'
is "as much as his own" "$STATUS" 201
other=$(get .id)
post "/v1/tokens/$other/rotate" '{"grace_s": 60}'
is "and its secret" "$STATUS $(get '.old_secret_until != null')" '200 true'
gives "409 own_token" "not himself" req DELETE "/v1/tokens/$managing"
gives 204 "another" req DELETE "/v1/tokens/$other"
gives 204 "again" req DELETE "/v1/tokens/$other"
post "/v1/tokens/$other/rotate" '{}'
problem "no secret for one that was revoked" 409 token_revoked
AUTH=$me
post "/v1/tokens/$id/rotate" '{}'
is "rotated" "$STATUS $(get '[.id, .old_secret_until] | tojson')" "200 [\"$id\",null]"
new=$(get .secret)
AUTH=$secret
gives "401 unauthorized" "the old secret" req GET /v1/token
AUTH=$new
req GET /v1/token
is "the new one" "$STATUS $(get .id)" "200 $id"
AUTH=$me
gives 204 "revoked" req DELETE "/v1/tokens/$id"
AUTH=$new
gives "401 unauthorized" "at once" req GET /v1/token
AUTH=$me
req GET /v1/tokens
is "it says when" "$(get ".tokens[] | select(.id == \"$id\") | [.state, (.revoked_at | length)] | tojson")" '["revoked",24]'
req GET "/v1/audit?actor=$managing&kind=create_token,rotate_token,revoke_token"
is "each change by whom" "$(kinds)" 'revoke_token rotate_token create_token'
ok "no secret is in the log" sh -c "! grep -Eq '$secret|$new|$manager' '$LOG'"

# ---- stats
req GET /v1/stats
cp "$T/body" "$T/stats"
is "counts" "$(get '.counts | [.subjects, .templates, .tokens, .devices] | tojson')" "$(sql "SELECT json_array(
    (SELECT count(*) FROM subjects), (SELECT count(*) FROM templates), (SELECT count(*) FROM tokens), 0)")"
is "calibration" "$(get '.calibration | [.source, .fmr, .made_at, .low, .high, .subjects, .non_mated, .mated, .threshold,
    (.knots | length > 3)] | tojson')" '["shipped",null,null,null,null,null,null,null,8,true]'
is "what was decided" "$(get '.rates | [.verifications, .decisions.no_match, .enrollments, .refusals.unauthorized] | tojson')" '[3,3,1,2]'
ok "times" jq_true '.latency_ms | .p50 > 0 and .p50 <= .p95 and .p95 <= .p99' "$T/stats"
is "of no finding nothing is to be done" "$(get '[.findings[] | select(.severity == "ok") | .do] | unique | tojson')" '[null]'
ctl stats
is "the command says the same" "$(said '[.counts, .engine, .calibration, .findings, .days, .scans] | tojson')" \
    "$(get '[.counts, .engine, .calibration, .findings, .days, .scans] | tojson')"
ctl doctor
is "and so does doctor" "$(said '[.findings[] | select(.about | IN("templates", "tokens", "token", "attempts", "calibration"))] | tojson')" \
    "$(get '.findings | tojson')"
# the scores of a day: a match, a mirror image's or a replayed scan none, each in its bin
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/a2.ply"
score=$(get .score)
gives "422 replayed" "no new scan" send POST /v1/subjects/Alice@home/verify "$PLY" "$T/a.ply"
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/b.ply"
low=$(get .score)
"$BUILD/surfacectl" --db "$DB" verify Alice@home "$T/a2.ply" >"$T/out"
req GET /v1/stats
is "of today" "$(get '[.days[] | .decision + " " + (.bins | add | tostring)] | join(" ")') $(get '[.days[].day] | unique | join(" ")')" "match 2 no_match 4 $day"
bin() { awk "BEGIN { b = int(($1 + 40) / 2); print ($1 < -40 ? 0 : (b > 63 ? 63 : b)) }"; }
is "both matches in their bin" "$(get ".days[0].bins[$(bin "$score")]")" 2
ok "the other's too" test "$(get ".days[1].bins[$(bin "$low")]")" -ge 1
is "a small row each" "$(sql 'SELECT count(*), max(length(bins)) FROM days')" '2|256'
"$BUILD/surfacectl" --db "$DB" stats >"$T/out"
contains "as text" "$T/out" "^$day *no_match *4, half of them with a score of -?[0-9]+ or more"
# what the file says that is no row of ours misleads nobody's verification
sqlite3 "$DB" "PRAGMA ignore_check_constraints = 1; UPDATE days SET bins = x'00'; INSERT INTO days VALUES ('<b>', 'match', zeroblob(256), 0)"
req GET /v1/stats
is "damaged" "$STATUS $(get '[.days[] | select(.day < "3") | .bins | add] | tojson')" '200 [0,0]'
req DELETE /v1/subjects/Alice@home/attempts
gives 200 "and a verification goes on" send POST /v1/subjects/Alice@home/verify "$PLY" "$T/a2.ply"
sql "DELETE FROM days WHERE day = '<b>'"

# the scans of a token: those that were compared, and those that were refused
scans() { get "[.scans[] | select(.token == \"$1\")][0] | $2"; }
req GET /v1/stats
is "as many as were decided, the command's among them" "$(get '[.scans[].weeks[].n] | add')" 7
is "by token" "$(scans me '[.token_id == null, .change, .weeks[0].unusable] | tojson') $(get '[.scans[].token_id | length] | unique | tojson')" \
    '[false,null,0] [0,32]'
ok "noise and quality" jq_true '.scans[].weeks[-1] | .noise_mm > 0 and .noise_mm < 1 and .quality > 0.5 and .quality <= 1' "$T/body"
printf '%s' '{"points": [[0,0,0],[1,0,0],[0,1,0]]}' >"$T/few.json"
n=$(scans me '.weeks[-1].n')
send POST /v1/subjects/Alice@home/verify "$JSON" "$T/few.json"
is "no face" "$STATUS" 422
send POST /v1/subjects/new/templates "$JSON" "$T/few.json"
is "not to enroll" "$STATUS" 422
req GET /v1/stats
is "it counts as unusable" "$(scans me '.weeks[-1] | [.n, .unusable] | tojson')" "[$n,1]"
# a day of noise is no change, two are
days_of() { # days_of NOISE_MM FROM UNTIL: forty scans a day, from so many days ago on
    sql "WITH RECURSIVE d(i) AS (SELECT $3 UNION ALL SELECT i + 1 FROM d WHERE i < $2)
        INSERT OR REPLACE INTO scans SELECT date('now', '-' || i || ' days'), token, 0, 40, 1, 40000 * $1, 36000
        FROM d, (SELECT id AS token FROM tokens WHERE name = 'me')"
}
days_of 0.3 30 1
days_of 0.6 0 0
req GET /v1/stats
is "no change" "$(scans me .change)" null
days_of 0.6 1 0
req GET /v1/stats
since=$(LC_ALL=C date -u -d '-1 day' '+%A, %F')
is "a change" "$(scans me .change)" "noise doubled since $since: 0.60 mm, before 0.30 mm"
is "a finding" "$(get '.findings[] | select(.about == "scans") | .severity + " " + .what')" "warning me: $(scans me .change)"
is "weeks" "$(scans me '[.weeks[] | .from] | tojson')" "$(sql "SELECT json_group_array(d) FROM (SELECT DISTINCT date(day, 'weekday 0', '-6 days') AS d FROM scans ORDER BY 1)")"
"$BUILD/surfacectl" --db "$DB" stats >"$T/out"
contains "as text" "$T/out" "^me .* scans in 12 weeks, .* mm, quality 0\.[0-9]*; noise doubled since $since"
"$BUILD/surfacectl" --db "$DB" doctor >"$T/out"
contains "doctor has it" "$T/out" "^warning *scans *me: noise doubled"
# the daemon deletes the days that are shown no more
kept=$(sql 'SELECT count(*) FROM scans')
days_of 0.3 400 390
sql "INSERT INTO days SELECT date('now', '-200 days'), decision, zeroblob(256), daemon FROM days"
old_days() { sql "SELECT count(*) FROM days WHERE day < date('now', '-190 days')"; }
is "old scores" "$(old_days)" 2
stop_daemon
start_daemon --attempts 2 --attempt-wait 50
ok "old days go" soon sh -c "test \$(sqlite3 '$DB' 'SELECT count(*) FROM scans') = $kept"
is "of scores too" "$(old_days)" 0

# ---- verified, and as files
req POST /v1/audit/verify
is "verified" "$STATUS $(get '[.ok, .changes, .accesses, .findings, .head.seq] | tojson')" \
    "200 $(sql "SELECT json_array(json('true'), (SELECT count(*) FROM change_log), (SELECT count(*) FROM access_log), json('[]'), (SELECT max(seq) FROM change_log))")"
is "each row" "$(get .rows)" "$(sql 'SELECT (SELECT count(*) FROM subjects) + (SELECT count(*) FROM templates) + (SELECT count(*) FROM tokens)')"
req GET /v1/audit/export
is "a file" "$STATUS $(field Content-Type) $(field Content-Disposition)" '200 application/jsonl attachment; filename="audit.jsonl"'
cp "$T/body" "$T/export.jsonl"
"$BUILD/surfacectl" --json audit verify "$T/export.jsonl" --public-key "$(head -n 1 "$T/body" | jq -r .public_key)" >"$T/ctl"
is "which the command verifies" "$(said '[.ok, .entries] | tojson')" "[true,$(sql "SELECT count(*) FROM $ENTRIES")]"
ok "without ids" sh -c "! grep -q Alice '$T/export.jsonl'"
is "recorded" "$(sql "SELECT kind, actor = '$mine' FROM change_log ORDER BY seq DESC LIMIT 1")" 'export_audit|1'
req GET '/v1/audit/export?format=csv'
is "a table" "$STATUS $(field Content-Type) $(field Content-Disposition)" '200 text/csv; charset=utf-8 attachment; filename="audit.csv"'
is "a row an entry" "$(python3 -c 'import csv,sys; r=list(csv.DictReader(open(sys.argv[1], newline=""))); print(len(r), r[0]["kind"], r[-1]["kind"])' "$T/body")" \
    "$(sql "SELECT count(*) FROM $ENTRIES") create_database export_audit"
contains "with names" "$T/body" '"verify","[0-9a-f]{32}","door","Alice@home"'
req GET '/v1/audit/export?format=csv&kind=create_token,add_subject'
contains "no formula" "$T/body" "\"'--\"|\"'=cmd"
ok "nor in any field" sh -c "! grep -Eq '(^|,)\"[=+@-]' '$T/body'"
is "of those kinds" "$(tail -n +2 "$T/body" | cut -d, -f4 | sort -u | paste -sd ' ')" '"add_subject" "create_token"'
# one at a time: a logs' worth of rows keeps one busy meanwhile
sql "INSERT INTO access_log SELECT daemon, seq + value, at, 'filler', actor, uid, object, outcome, hash, mac, NULL
    FROM generate_series(1, 1000000), (SELECT * FROM access_log ORDER BY seq DESC LIMIT 1)"
beside one POST /v1/audit/verify
beside two POST /v1/audit/verify
ok "one of them is refused" soon grep -lqx 503 "$T/s.one" "$T/s.two"
gives "503 overloaded" "nor an export beside the other" req GET /v1/audit/export
again "when again" 5
gives 200 "others go on" req GET /v1/subjects
all_sent
is "the other found it" "$TALLY $(jq -cs 'map(if .code then .code else [.ok, (.findings | length)] end) | sort' "$T/o.one" "$T/o.two")" \
    '200x1 503x1 ["overloaded",[false,1]]'
sql "DELETE FROM access_log WHERE kind = 'filler'"
req POST /v1/audit/verify
is "and then another" "$STATUS $(get .ok)" '200 true'
beside gone GET /v1/audit/export -m 0.01
all_sent
ok "who goes leaves the place" soon sh -c "test \"\$(curl -sS -o /dev/null -w '%{http_code}' -X POST -H 'Authorization: Bearer $AUTH' '$URL/v1/audit/verify')\" = 200"
# rows that are not the last change's: it says so once, and the daemon stops
sql "UPDATE subjects SET hold = 1 - hold WHERE subject_key = 1"
req POST /v1/audit/verify
is "a changed row" "$STATUS $(get '[.ok, .problems] | tojson')" '200 [false,2]'
gives "503 database_refused" "nothing more" req GET /v1/audit
finish
