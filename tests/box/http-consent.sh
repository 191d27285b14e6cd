#!/bin/sh
# Goal: what is noted of a subject is shown and changed over HTTP as by surfacectl: consent,
# purpose, expiry, hold, disabled.  All of a change or nothing of it, by who may alone, in
# force at once, and in the audit log with the token.  Who can only delete ends no hold.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

MERGE='Content-Type: application/merge-patch+json'

# admin ARGUMENT...: surfacectl, whose JSON is printed.
admin() { "$BUILD/surfacectl" --db "$DB" --json "$@" 2>"$T/err" </dev/null; }
token() { admin token create "$1" --scope "$1" | jq -r .token; }

# change SUBJECT JSON [CURL-OPTION...]
change() {
    c_subject=$1 c_body=$2
    shift 2
    req PATCH "/v1/subjects/$c_subject" -H "$MERGE" --data-binary "$c_body" "$@"
}

# noted WANTED: what the daemon shows of alice
noted() {
    req GET /v1/subjects/alice
    is "alice" "$(get '[.consent, .purpose, .expires_at, .hold, .disabled] | tojson')" "$1"
}

# events KIND: how many, and by whom the last
events() {
    admin audit show --kind "$1" | jq -r '[.entries[]] | "\(length) \(last.actor) \(last.subject)"'
}

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 5
AUTH=
start_daemon
AUTH=$(admin token create all | jq -r .token)
enroll=$(token enroll) delete=$(token delete) read=$(token read)
id=$(admin token create manage --scope manage,verify,read | tee "$T/manage" | jq -r .id)
manage=$(jq -r .token "$T/manage")
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
is "enrolled" "$STATUS" 201
template=$(get .template_id)
noted '[null,null,null,false,false]'
ok "seen when enrolled" matches "$(get .last_seen)" '^20[0-9-]*T[0-9:.]*Z$'

# ---- changed
AUTH=$manage
change alice '{"consent": "C-17 \u00e4", "purpose": "front door", "expires_at": "2031-01-31T12:00:00+01:00"}'
is "changed" "$STATUS $(get .subject)" '200 alice'
is "the answer is the subject" "$(get '.consent + " " + (.templates | length | tostring)')" 'C-17 ä 1'
noted '["C-17 ä","front door","2031-01-31T11:00:00.000Z",false,false]'
is "as surfacectl has it" "$(admin subject show alice | jq -r '[.consent, .purpose, .expires_at] | join("|")')" \
    'C-17 ä|front door|2031-01-31T11:00:00.000Z'
is "an event of it" "$(events set_subject)" "1 $id alice"
change alice '{"purpose": null, "hold": false}'
noted '["C-17 ä",null,"2031-01-31T11:00:00.000Z",false,false]'
change alice '{"consent": "", "expires_at": null}' -H 'Prefer: return=minimal'
is "no body where none is preferred" "$STATUS $(field Preference-Applied)" '204 return=minimal'
noted '[null,null,null,false,false]'
before=$(sqlite3 "$DB" 'SELECT count(*) FROM events')
change alice '{}'
is "nothing to change" "$STATUS" 200
is "and no event" "$(sqlite3 "$DB" 'SELECT count(*) FROM events')" "$before"
req PATCH /v1/subjects/alice -H "$JSON" -d '{"expires_at": "2031-01-31"}'
is "plain JSON, a day" "$STATUS $(get .expires_at)" '200 2031-01-31T00:00:00.000Z'
admin subject set alice --expires never --consent C-1 >/dev/null
noted '["C-1",null,null,false,false]'

# ---- refused, and nothing changed
long=$(printf '%0129d' 1)
for body in '' '[]' 'null' '{' '{"hold": 1}' '{"disabled": null}' '{"consent": 17}' \
    '{"hold": true, "on_hold": true}' '{"hold": true, "subject": "bob"}' \
    '{"hold": true, "hold": false}' '{"hold": true, "expires_at": "tomorrow"}' \
    '{"hold": true, "expires_at": "2031-02-29"}' "{\"hold\": true, \"consent\": \"$long\"}" \
    '{"hold": true, "purpose": "a\nb"}' '{"hold": true, "purpose": "a\u0000b"}' \
    "{\"hold\": true, \"purpose\": \"$long$long$long\"}"; do
    change alice "$body"
    problem "refused: $body" 400 malformed
done
change alice '{"on_hold": true}'
ok "it says what can be changed" matches "$(get .detail)" 'not on_hold$'
change nobody '{"hold": true}'
problem "nobody" 404 not_found
change a%20b '{"hold": true}'
problem "not an id" 400 invalid_parameter
req PATCH /v1/subjects/alice -H "$PLY" --data-binary "@$T/a.ply"
problem "a scan" 415 unsupported_media_type
send POST /v1/subjects/alice/verify "$MERGE" "$T/a.ply"
problem "a patch is no scan" 415 unsupported_media_type
noted '["C-1",null,null,false,false]'

# ---- who may
for AUTH in $enroll $delete $read; do
    change alice '{"hold": true}'
    problem "not for this" 403 insufficient_scope
done
AUTH=$manage
req DELETE /v1/subjects/alice
problem "who changes cannot erase" 403 insufficient_scope

# ---- before the first scan
AUTH=$enroll
req POST /v1/subjects -H "$JSON" -d '{"subject": "d@ora:1", "consent": "C-2", "expires_at": "2031-01-31"}'
is "made" "$STATUS $(field Location) $(get '[.consent, .purpose, .expires_at] | tojson')" \
    '201 /v1/subjects/d@ora:1 ["C-2",null,"2031-01-31T00:00:00.000Z"]'
is "an event of it" "$(events add_subject | cut -d ' ' -f 1,3)" '1 d@ora:1'
req POST /v1/subjects -H "$JSON" -d '{"subject": "alice"}'
problem "there already" 409 exists
for body in '{}' '{"subject": null}' '{"subject": "a b"}' '{"subject": "x", "hold": true}' \
    "{\"subject\": \"x\", \"consent\": \"$long\"}" '{"subject": "x", "expires_at": "soon"}' \
    "{\"subject\": \"x$long\"}" '{"subject": "x", "purpose": "a\nb"}'; do
    req POST /v1/subjects -H "$JSON" -d "$body"
    problem "refused: $body" 400 malformed
done
send POST /v1/subjects/d@ora:1/templates "$PLY" "$T/a.ply"
is "enrolled then" "$STATUS" 201
AUTH=$read
req GET /v1/subjects/d@ora:1
is "with its consent" "$(get .consent)" C-2
AUTH=$manage

# ---- on hold
change alice '{"hold": true}'
is "on hold" "$STATUS $(get .hold)" '200 true'
is "an event of it" "$(events hold_subject)" "1 $id alice"
AUTH=$delete
for one in subjects/alice "templates/$template"; do
    req DELETE "/v1/$one"
    problem "DELETE $one" 409 on_hold
done
change alice '{"hold": false}'
problem "not by who deletes" 403 insufficient_scope
AUTH=$manage
change alice '{"hold": false}'
is "an event of it" "$(events release_subject)" "2 $id alice"

# ---- disabled, expired
change alice '{"disabled": true}'
send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
problem "disabled" 403 subject_disabled
change alice '{"disabled": false, "expires_at": "2020-01-01"}'
send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
problem "expired" 403 subject_expired
send POST "/v1/templates/$template/verify" "$PLY" "$T/a2.ply"
problem "by its template too" 403 subject_expired
is "it is due" "$(admin purge --due --dry-run | jq -r '.due[]')" alice
change alice '{"expires_at": "2031-01-01"}'
send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
is "verified again" "$STATUS $(get .decision)" '200 match'
is "events of it" "$(events disable_subject) $(events enable_subject)" "1 $id alice 1 $id alice"
AUTH=$delete
req DELETE /v1/subjects/alice
is "erased" "$STATUS" 200
ok "the log is whole" admin audit verify
finish
