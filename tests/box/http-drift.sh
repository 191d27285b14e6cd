#!/bin/sh
# Goal: a row of samples, each like the one before, does not lead from a subject to another person.
# Whoever has a token with enroll alone and a scan of the victim enrolls blends of it and of a scan
# of their own, nearer to themselves each time: one file a request, or several in a form.
. tests/box/lib.sh
needs python3

XYZ='Content-Type: text/plain'
STEPS='0.14 0.28 0.42 0.56 0.7 0.85 1'

for person in 1 2; do
    for scan in 0 1; do
        scan "$person" "$scan" "$T/$person$scan.xyz"
    done
done
for share in $STEPS; do
    python3 tests/box/blend.py "$T/10.xyz" "$T/20.xyz" "$share" "$T/$share.xyz"
done

# enroll SUBJECT SHARE: adds the status code to CODES.
enroll() {
    send POST "/v1/subjects/$1/templates?axes=scanner" "$XYZ" "$T/$2.xyz"
    CODES="$CODES $STATUS"
    ok "$1, a share of $2: $STATUS" matches "$STATUS" '^(201|409)$'
    [ "$STATUS" = 201 ] || is "why not" "$(get .code)" sample_mismatch
    ok "no score is told" jq_true '(has("score") or has("first_score")) | not' "$T/body"
}

# verified SUBJECT DECISION: of the attacker, by another scan and by the enrolled one, moved.
verified() {
    send POST "/v1/subjects/$1/verify" "$XYZ" "$T/21.xyz"
    is "$1: the attacker" "$STATUS $(get .decision)" "200 $2"
}

start_daemon --attempts 0
NARROW=$(new_token scanner --scope enroll)
CHECKS=$(new_token door --scope verify)
MANAGER=$(new_token manager --scope enroll,manage,read)

# ---- one at a time, the victim's own scan first
AUTH=$NARROW CODES=''
gives 201 "the victim" send POST /v1/subjects/alice/templates "$XYZ" "$T/10.xyz"
AUTH=$CHECKS
verified alice no_match
AUTH=$NARROW
for share in $STEPS; do
    enroll alice "$share"
done
ok "the nearest blends are taken:$CODES" matches "$CODES" '^ 201'
ok "the attacker's own face is not:$CODES" matches "$CODES" '409$'
AUTH=$CHECKS
verified alice no_match

# ---- several in a form: each is held against the victim's, not against the one before
AUTH=$NARROW
send POST /v1/subjects/bob/templates "$XYZ" "$T/10.xyz"
last=0.14
for share in $STEPS; do
    req POST '/v1/subjects/bob/templates?fuse=false&axes=scanner' -F "file=@$T/$last.xyz" -F "file=@$T/$share.xyz"
    ok "a form, a share of $share: $STATUS" matches "$STATUS" '^20[01]$'
    [ "$(get '.templates[1].template_id')" = null ] || last=$share
done
ok "the last one taken is not the attacker's: $last" test "$last" != 1
AUTH=$CHECKS
verified bob no_match

# ---- how far from the first each was is recorded, for those who may know scores
AUTH=$MANAGER
req GET /v1/subjects/alice
ok "far less than the first" jq_true '.templates | (first.first_score == 0) and (map(.manager) | any | not)
    and (.[1:] | length > 0 and all(.first_score >= 8))' "$T/body"
AUTH=$(new_token reads --scope read)
req GET /v1/subjects/alice
ok "not for others" jq_true '.templates | map(has("first_score") or has("manager")) | any | not' "$T/body"

# ---- who manages may bring another face, and others may then follow it
AUTH=$NARROW
send POST /v1/subjects/carol/templates "$XYZ" "$T/10.xyz"
send POST '/v1/subjects/carol/templates?force=true' "$XYZ" "$T/20.xyz"
problem "force without manage" 403 insufficient_scope
AUTH=$MANAGER
send POST '/v1/subjects/carol/templates?force=true' "$XYZ" "$T/20.xyz"
is "with manage" "$STATUS $(get '.manager, .first_score < 0' | tr '\n' ' ')" '201 true true '
AUTH=$NARROW
gives 201 "a sample that fits it" send POST /v1/subjects/carol/templates "$XYZ" "$T/21.xyz"
ctl_exits 0 enroll dave "$T/10.xyz" --axes scanner
ctl_exits 0 template list dave
is "surfacectl counts as manage" "$(said '.templates[0] | "\(.manager) \(.first_score)"')" 'true 0'
finish
