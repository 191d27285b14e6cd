#!/bin/sh
# Goal: a scanner signs what it captures, for what, and its liveness check's result: nothing of
# that can be exchanged, no signed request can be sent again, and where signed captures are
# required nothing else is enrolled, verified or compared.  By the example of a client in
# packaging/examples; the test vector is in docs/operation.md.
. tests/box/lib.sh
needs openssl

for i in 0 1 2; do scan 1 "$i" "$T/a$i.ply"; done
scan 2 0 "$T/b.ply"
jq -n --rawfile f /dev/null '{a: {points: [[1, 2, 3]]}, b: {points: [[1, 2, 3]]}}' >"$T/few.json"
for name in door-1 door-2; do
    openssl genpkey -algorithm ed25519 -out "$T/$name.key" 2>"$T/out"
    openssl pkey -in "$T/$name.key" -pubout -out "$T/$name.pem"
done

# key_bits NAME: the 32 bytes of the public key.
key_bits() {
    openssl pkey -in "$T/$1.key" -pubout -outform DER | tail -c 32
}

# client DEVICE KEY TARGET FILE [VARIABLE=VALUE...]: the example; sets STATUS and $T/body.
client() {
    c_device=$1 c_key=$2 c_target=$3 c_file=$4
    shift 4
    env URL="$URL" TOKEN="$AUTH" "$@" packaging/examples/signed-capture \
        "$c_device" "$T/$c_key.key" "$c_target" "$c_file" >"$T/body" 2>"$T/out"
    STATUS=$(get '.status // 200')
}

# refused TITLE CODE [DETAIL-PATTERN]: what client got is a 403.
refused() {
    is "$1" "$STATUS $(get .code)" "403 $2"
    [ -z "${3:-}" ] || ok "$1: detail '$(get .detail)' like '$3'" matches "$(get .detail)" "$3"
}

# sign DEVICE KEY TARGET FILE NONCE LIVENESS [CODING [TYPE]]: the header's value, without the example.
sign() {
    printf 'surfaced capture 2\nPOST %s\n%s\n%s\n%s\n%s\n%s\n%s\n' "$3" "$1" "$5" "$6" \
        "$(sha256sum "$4" | cut -d ' ' -f 1)" "${8-${PLY#*: }}" "${7-}" >"$T/text"
    openssl pkeyutl -sign -rawin -inkey "$T/$2.key" -in "$T/text" -out "$T/sig"
    printf 'device=%s; nonce=%s; liveness=%s; sig=%s' "$1" "$5" "$6" \
        "$(openssl base64 -A -in "$T/sig")"
}

challenge() {
    req POST /v1/challenge
    NONCE=$(get .nonce)
}

# outcome KIND: of the newest entry of the audit log.
outcome() {
    ctl audit show --kind "$1" --limit 1
    said '.entries[0].outcome'
}

VERIFY=/v1/subjects/alice/verify ENROLL=/v1/subjects/alice/templates

# ---- devices
ctl_exits 0 init
ctl_exits 0 device add door-1 "$T/door-1.pem"
ctl_exits 0 device add door-2 "$(key_bits door-2 | od -An -v -tx1 | tr -d ' \n')"
is "a key in hexadecimal" "$(said .public_key)" "$(key_bits door-2 | od -An -v -tx1 | tr -d ' \n')"
ctl_exits 0 device add door-3 "$(key_bits door-2 | openssl base64 -A)"
ctl_exits 65 device add door-1 "$T/door-2.pem"
ctl_exits 65 device add door-4 "$T/a0.ply"
ctl_exits 65 device add 'door 4' "$T/door-1.pem"
ctl_exits 65 device add door-4 "$(printf '0%.0s' $(seq 64))"
ctl_exits 66 device remove door-9
ctl device list
is "the devices" "$(said '[.devices[].name] | join(" ")')" "door-1 door-2 door-3"
ctl_exits 0 device remove door-3
WATCHER=$(new_token watcher --scope audit)
AUTH=$(new_token scanner --scope enroll,verify)

# ---- required
start_daemon --require-signed-captures
send POST "$ENROLL" "$PLY" "$T/a0.ply"
problem "enrolled unsigned" 403 capture_required Capture-Signature
for path in "$VERIFY" /v1/templates/00000000000000000000000000000000/verify; do
    gives "403 capture_required" "$path unsigned" send POST "$path" "$PLY" "$T/a0.ply"
done
gives "403 capture_required" "compared unsigned" send POST /v1/compare "$JSON" "$T/few.json"
gives 200 "a check needs none" send POST /v1/check "$PLY" "$T/a0.ply"
client door-1 door-1 "$ENROLL" "$T/a0.ply" LIVENESS=pass
is "enrolled" "$(get .subject)" alice
is "in the audit log" "$(outcome enroll)" "created capture=pass:door-1"
client door-1 door-1 "$VERIFY" "$T/a1.ply"
is "verified" "$(get .decision)" match
is "in the audit log" "$(outcome verify)" "match capture=none:door-1"
client door-2 door-2 "$VERIFY?units=mm&detail=x" "$T/b.ply"
is "other mistakes are told first" "$(get .code)" invalid_parameter
client door-2 door-2 /v1/compare "$T/few.json" TYPE=application/json
is "a signed comparison is read" "$(get .code)" too_few_points
gzip -k "$T/a1.ply"
challenge
send POST "$VERIFY" "$PLY" "$T/a1.ply.gz" -H 'Content-Encoding: gzip' -H 'Transfer-Encoding: chunked' \
    -H "Capture-Signature: $(sign door-1 door-1 "$VERIFY" "$T/a1.ply.gz" "$NONCE" pass gzip)"
is "the digest is of the compressed body, without its chunks" "$(get .decision)" match

scan 1 2 "$T/large.ply" --points 12000
client door-1 door-1 "$VERIFY" "$T/large.ply"
is "a body for another worker than the first uses its nonce once" "$(get .decision)" match

# ---- what may not be exchanged
client door-1 door-1 "$VERIFY" "$T/a1.ply" NONCE="$NONCE"
refused "the nonce again" capture_replayed
is "in the audit log" "$(outcome capture)" "capture_replayed capture=none:door-1"
client door-1 door-2 "$VERIFY" "$T/a1.ply"
refused "the key of another device" capture_invalid 'has not signed'
client door-9 door-1 "$VERIFY" "$T/a1.ply"
refused "an unknown device" capture_invalid 'no such device'
client door-3 door-2 "$VERIFY" "$T/a1.ply"
refused "one that was removed" capture_invalid 'no such device'
challenge
signed=$(sign door-1 door-1 "$VERIFY" "$T/a1.ply" "$NONCE" fail)
# forged TITLE TARGET FILE HEADER
forged() {
    send POST "$2" "$PLY" "$3" -H "Capture-Signature: $4"
    problem "$1" 403 capture_invalid 'has not signed'
}
forged "another body" "$VERIFY" "$T/a2.ply" "$signed"
forged "another subject" /v1/subjects/bob/verify "$T/a1.ply" "$signed"
forged "another purpose" "$ENROLL" "$T/a1.ply" "$signed"
forged "other parameters" "$VERIFY?units=mm" "$T/a1.ply" "$signed"
send POST "$VERIFY" 'Content-Type: text/plain' "$T/a1.ply" -H "Capture-Signature: $signed"
problem "another type" 403 capture_invalid 'has not signed'
send POST "$VERIFY" 'Content-Type:' "$T/a1.ply" -H "Capture-Signature: $signed"
problem "no type" 403 capture_invalid 'has not signed'
send POST "$VERIFY" "$PLY" "$T/a1.ply" -H 'Content-Encoding: identity' -H "Capture-Signature: $signed"
problem "another coding" 403 capture_invalid 'has not signed'
forged "another liveness" "$VERIFY" "$T/a1.ply" "$(echo "$signed" | sed 's/=fail/=pass/')"
forged "another nonce" "$VERIFY" "$T/a1.ply" "$(echo "$signed" | sed 's/nonce=[^;]*/nonce=A/')"
forged "another device" "$VERIFY" "$T/a1.ply" "$(echo "$signed" | sed 's/door-1/door-2/')"
send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $signed"
problem "a failed liveness check" 403 liveness_failed
is "in the audit log" "$(outcome capture)" "liveness_failed capture=fail:door-1"
send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $signed"
problem "and its nonce is used" 403 capture_replayed
for header in 'device=door-1' "$signed; $signed" "$signed; more=1" "$(echo "$signed" | sed 's/fail/maybe/')" \
    "$(printf 'x%.0s' $(seq 400))" "$(echo "$signed" | sed 's/; sig=.*/; sig=AAAA/')"; do
    send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $header"
    problem "malformed: $(echo "$header" | cut -c 1-60)" 403 capture_invalid 'is not once device='
done
challenge
once=$(sign door-1 door-1 "$VERIFY" "$T/a1.ply" "$NONCE" pass)
send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $once" -H "Capture-Signature: $once"
problem "two of them" 403 capture_invalid
# The text that the test vector in the manual is of is the one that the daemon verifies: only the nonce
# is not the database's.
printf '{"points": [[-41.2, 10.5, 612.1]]}' >"$T/vector"
vector=$(sed -n 's/^Capture-Signature: //p' docs/operation.md)
send POST "$VERIFY?units=mm" "$JSON" "$T/vector" -H "Capture-Signature: $vector"
problem "the test vector, of another device" 403 capture_invalid 'has not signed'
ctl_exits 0 device remove door-1
client door-1 door-1 "$VERIFY" "$T/a1.ply"
refused "removed while the daemon runs" capture_invalid 'no such device'
ctl_exits 0 device add door-1 d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a
send POST "$VERIFY?units=mm" "$JSON" "$T/vector" -H "Capture-Signature: $vector"
problem "the test vector" 403 capture_invalid 'the nonce is not from POST /v1/challenge'
client door-1 door-1 "$VERIFY" "$T/a1.ply"
refused "the old key under a name that is another's now" capture_invalid 'has not signed'

# ---- a client that has lost the response needs another capture
challenge
header="Capture-Signature: $(sign door-2 door-2 /v1/subjects/carol/templates "$T/b.ply" "$NONCE" pass)"
gives "403 capture_required" "unsigned" send POST /v1/subjects/carol/templates "$PLY" "$T/b.ply"
gives 201 "signed" send POST /v1/subjects/carol/templates "$PLY" "$T/b.ply" -H "$header"
gives "403 capture_replayed" "once more" send POST /v1/subjects/carol/templates "$PLY" "$T/b.ply" -H "$header"

# ---- counted
is "taken" "$(metric 'surfaced_captures_total{outcome="taken"}')" 6
is "none" "$(metric 'surfaced_captures_total{outcome="capture_required"}')" 5
is "failed liveness" "$(metric 'surfaced_captures_total{outcome="liveness_failed"}')" 1
is "replayed" "$(metric 'surfaced_captures_total{outcome="capture_replayed"}')" 3

# ---- the database is written by an attacker: another key for the device
sql "UPDATE devices SET public = x'$(key_bits door-1 | od -An -v -tx1 | tr -d ' \n')'
    WHERE name = 'door-2'"
client door-2 door-1 "$VERIFY" "$T/a1.ply"
is "a key that was put there" "$STATUS $(get .code)" "500 internal"
stop_daemon
ctl_exits 1 audit verify
ok "is found" jq_true '[.problems[] | tostring] | any(contains("devices"))' "$T/ctl"
sql "UPDATE devices SET public = x'$(key_bits door-2 | od -An -v -tx1 | tr -d ' \n')'
    WHERE name = 'door-2'"
ctl_exits 0 audit verify

# ---- a device that was removed since the backup is not brought back by it
ctl_exits 0 device add lost "$T/door-1.pem"
ctl_exits 0 backup "$T/backup"
ctl_exits 0 device remove lost
ctl_exits 0 restore "$T/backup"
ctl device list
is "the devices" "$(said '[.devices[].name] | join(" ")')" "door-2 door-1"
ctl_exits 0 audit verify

# ---- new secrets of the database: the devices are the same
ctl_exits 0 rekey --yes
ctl_exits 0 audit verify
ctl device list
is "the devices" "$(said '[.devices[].name] | join(" ")')" "door-2 door-1"

# ---- not required: what is there must be right all the same
start_daemon
send POST "$VERIFY" "$PLY" "$T/a1.ply"
is "unsigned" "$(get .decision)" match
is "in the audit log" "$(outcome verify)" match
client door-2 door-1 "$VERIFY" "$T/a1.ply"
refused "wrongly signed" capture_invalid
client door-2 door-2 "$VERIFY" "$T/a1.ply" LIVENESS=fail
refused "a failed liveness check" liveness_failed
client door-2 door-2 "$ENROLL" "$T/b.ply"
is "a sample of another person" "$STATUS $(get .code)" "409 sample_mismatch"
is "in the audit log" "$(outcome enroll_mismatch)" "no_match capture=none:door-2"
client door-2 door-2 "$VERIFY" "$T/a1.ply" LIVENESS=pass
is "signed" "$(get .decision)" match
challenge
once=$(sign door-2 door-2 "$VERIFY" "$T/a1.ply" "$NONCE" pass)
stop_daemon
start_daemon
for wanted in 200 403; do
    send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $once"
    is "of a nonce from before a restart" "$STATUS" "$wanted"
    stop_daemon
    start_daemon
done
AUTH=$(new_token reader --scope read)
gives "403 insufficient_scope" "a nonce takes a scope" req POST /v1/challenge
stop_daemon

# ---- time
if ! command -v faketime >/dev/null 2>&1 || sanitized; then
    echo "no faketime: whether nonces expire is not tested"
    finish
fi
start_clocked --no-auth
AUTH=
for step in +100s +130s -10s; do
    clock +0
    challenge
    once=$(sign door-2 door-2 "$VERIFY" "$T/a1.ply" "$NONCE" pass)
    clock "$step"
    send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $once"
    case $step in
    +100s) is "after $step" "$(get .decision)" match ;;
    *) problem "after $step" 403 capture_stale ;;
    esac
done
clock +0 # and three hours ahead for a while, as after a start by a wrong time zone
challenge
once=$(sign door-2 door-2 "$VERIFY" "$T/a1.ply" "$NONCE" pass)
send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $once"
is "before the clock is wrong" "$(get .decision)" match
clock +3h
client door-2 door-2 "$VERIFY" "$T/a1.ply"
is "while it is wrong" "$(get .decision)" match
clock +0
send POST "$VERIFY" "$PLY" "$T/a1.ply" -H "Capture-Signature: $once"
problem "when it is right again" 403 capture_replayed
clock +28h
client door-2 door-2 "$VERIFY" "$T/a1.ply"
is "a day later" "$(get .decision)" match
is "nonces that expired a day ago are not kept" "$(sql 'SELECT count(*) FROM nonces')" 1
finish
