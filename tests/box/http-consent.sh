#!/bin/sh
# Goal: a subject's consent, purpose, expiry, hold and disabled are shown and changed over HTTP
# as by surfacectl (what is refused: http-bad-input.sh).  A change needs the scope manage, is in
# force at once, and is in the audit log with its token.  The scope delete cannot end a hold.
. tests/box/lib.sh

MERGE='Content-Type: application/merge-patch+json'

# change SUBJECT JSON [CURL-OPTION...]
change() {
    c_subject=$1 c_body=$2
    shift 2
    req PATCH "/v1/subjects/$c_subject" -H "$MERGE" --data-binary "$c_body" "$@"
}

# shows WANTED: the daemon shows these members of alice.
shows() {
    req GET /v1/subjects/alice
    is "alice" "$(get '[.consent, .purpose, .expires_at, .hold, .disabled] | tojson')" "$1"
}

# events KIND: their number in the audit log, and the last one's actor and subject.
events() {
    ctl audit show --kind "$1"
    said '[.entries[]] | "\(length) \(last.actor) \(last.subject)"'
}

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 5
start_daemon
AUTH=$(new_token all)
enroll=$(new_token enroll --scope enroll)
delete=$(new_token delete --scope delete)
read=$(new_token read --scope read)
ctl token create manage --scope manage,verify,read
id=$(said .id)
manage=$(said .secret)
gives 201 "enrolled" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
template=$(get .template_id)
shows '[null,null,null,false,false]'
ok "last seen at the enrolment" matches "$(get .last_seen)" '^20[0-9-]*T[0-9:.]*Z$'

# ---- changed
AUTH=$manage
change alice '{"consent": "C-17 \u00e4", "purpose": "front door", "expires_at": "2031-01-31T12:00:00+01:00"}'
is "changed" "$STATUS $(get .subject)" '200 alice'
is "the response is the subject" "$(get '.consent + " " + (.templates | length | tostring)')" 'C-17 ä 1'
shows '["C-17 ä","front door","2031-01-31T11:00:00.000Z",false,false]'
ctl subject show alice
is "as surfacectl shows it" "$(said '[.consent, .purpose, .expires_at] | join("|")')" \
    'C-17 ä|front door|2031-01-31T11:00:00.000Z'
is "its audit event" "$(events set_subject)" "1 $id alice"
change alice '{"purpose": null, "hold": false}'
shows '["C-17 ä",null,"2031-01-31T11:00:00.000Z",false,false]'
change alice '{"consent": "", "expires_at": null}' -H 'Prefer: return=minimal'
is "no body if it is not wanted" "$STATUS $(field Preference-Applied)" '204 return=minimal'
shows '[null,null,null,false,false]'
before=$(sql "SELECT count(*) FROM $ENTRIES")
gives 200 "nothing to change" change alice '{}'
is "no audit event" "$(sql "SELECT count(*) FROM $ENTRIES")" "$before"
req PATCH /v1/subjects/alice -H "$JSON" -d '{"expires_at": "2031-01-31"}'
is "plain JSON, a date" "$STATUS $(get .expires_at)" '200 2031-01-31T23:59:59.999Z'
ctl subject set alice --expires never --consent C-1
shows '["C-1",null,null,false,false]'

# ---- before the first scan
AUTH=$enroll
req POST /v1/subjects -H "$JSON" -d '{"subject": "d@ora:1", "consent": "C-2", "expires_at": "2031-01-31"}'
is "created" "$STATUS $(field Location) $(get '[.consent, .purpose, .expires_at] | tojson')" \
    '201 /v1/subjects/d@ora:1 ["C-2",null,"2031-01-31T23:59:59.999Z"]'
is "its audit event" "$(events add_subject | cut -d ' ' -f 1,3)" '2 d@ora:1'
gives 201 "enrolled then" send POST /v1/subjects/d@ora:1/templates "$PLY" "$T/a.ply"
AUTH=$read
req GET /v1/subjects/d@ora:1
is "with its consent" "$(get .consent)" C-2
AUTH=$manage

# ---- on hold
change alice '{"hold": true}'
is "on hold" "$STATUS $(get .hold)" '200 true'
is "its audit event" "$(events hold_subject)" "1 $id alice"
AUTH=$delete
for one in subjects/alice "templates/$template"; do
    gives "409 on_hold" "DELETE $one" req DELETE "/v1/$one"
done
gives "403 insufficient_scope" "the scope delete cannot end the hold" change alice '{"hold": false}'
AUTH=$manage
change alice '{"hold": false}'
is "its audit event" "$(events release_subject)" "2 $id alice"

# ---- disabled, expired
change alice '{"disabled": true}'
gives "403 subject_disabled" "disabled" send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
change alice '{"disabled": false}'
change alice "$(ending)"
sleep 1.1
gives "403 subject_expired" "expired" send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
gives "403 subject_expired" "by its template too" send POST "/v1/templates/$template/verify" "$PLY" "$T/a2.ply"
ctl purge --dry-run
is "it is due for erasure" "$(said '.due[]')" alice
change alice '{"expires_at": "2031-01-01"}'
is "a day ends at its end" "$(get .expires_at)" 2031-01-01T23:59:59.999Z
send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
is "verified again" "$STATUS $(get .decision)" '200 match'
is "the audit events" "$(events disable_subject) $(events enable_subject)" "1 $id alice 1 $id alice"
AUTH=$delete
gives 200 "erased" req DELETE /v1/subjects/alice
ctl_exits 0 audit verify
finish
