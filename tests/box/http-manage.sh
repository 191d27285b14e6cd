#!/bin/sh
# Goal: what the console's pages People, Audit and Health ask for: a search that decrypts is bounded,
# both logs come in one order, nobody gets a token that may do more than his own, and command and
# daemon say the same.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
AUTH=
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
for state in 'active Alice@home -- alice.2' 'disabled bob' 'hold alice.2' 'expired ..alice' 'ending alice.2'; do
    req GET "/v1/subjects?state=${state%% *}"
    is "${state%% *}" "${state%% *} $(ids)" "$state"
    ctl subject list --state "${state%% *}"
    is "the command says the same" "$(said '.subjects | tojson')" "$(get '.subjects | tojson')"
done
req GET '/v1/subjects?state=hold&q=ALI'
is "both" "$(ids)" alice.2
ctl subject list --match ALI --state hold
is "by the command" "$(said '[.subjects[].subject] | join(" ")')" alice.2
ctl_exits 64 subject list --state gone
for query in state=gone q= state= cursor=x cursor=99999999999999999999 limit=1001 "q=$(printf 'a%.0s' $(seq 129))"; do
    req GET "/v1/subjects?$query"
    problem "$query" 400 invalid_parameter
done
# a damaged template is one without a quality: the list still comes
sqlite3 "$DB" "CREATE TABLE saved AS SELECT mac FROM templates; UPDATE templates SET mac = zeroblob(32)"
req GET '/v1/subjects?limit=1'
is "a damaged template" "$STATUS $(get '.subjects[0].quality')" '200 null'
sqlite3 "$DB" "UPDATE templates SET mac = (SELECT mac FROM saved); DROP TABLE saved"

# ---- attempts
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/b.ply"
req GET /v1/subjects/Alice@home
is "one failure" "$(get '.attempts | tojson')" '{"failures":1,"locked_until":null}'
AUTH=$(new_token door --scope verify)
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/b.ply"
send POST /v1/subjects/Alice@home/verify "$PLY" "$T/b.ply"
AUTH=$me
req GET /v1/subjects/Alice@home
ok "a token that has not failed waits for others" jq_true '.attempts | .failures == 2
    and (.locked_until | sub("\\.[0-9]*"; "") | fromdate | . > now + 50 and . < now + 61)' "$T/body"
req DELETE /v1/subjects/Alice@home/attempts
req GET /v1/subjects/Alice@home
is "forgotten" "$(get '.attempts | tojson')" '{"failures":0,"locked_until":null}'
finish
