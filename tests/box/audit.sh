#!/bin/sh
# Goal: the audit log says who did what; an export can be verified without the database, and a
# change of any of its members is found, with its place; an erasure leaves a receipt.  What is
# found of changed rows is in tests/log and test_audit.c.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# ---- a log of everything, by the daemon and by the command
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a1.ply"
scan 2 0 "$T/b.ply"
scan 2 1 "$T/b1.ply"
start_daemon
ctl token create door --scope "$ALL"
AUTH=$(said .secret) DOOR=$(said .id)
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
id=$(get .template_id)
send POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
send POST /v1/subjects/alice/verify "$PLY" "$T/b.ply"
send POST /v1/subjects/bob/templates "$PLY" "$T/b.ply"
ctl verify bob "$T/b1.ply"
ctl audit checkpoint
is "signed" "$CODE $(said .checkpoint)" "0 7"
# As they are in the file: the subject's wrapped key, and some of the encrypted face.
encrypted=$(sql "SELECT hex(s.key), hex(substr(f.face, 3000, 40)) FROM templates t
    JOIN subjects s USING (uid) JOIN faces f USING (template_key) WHERE t.id = '$id'" | tr '|' ' ')
for one in $encrypted; do
    ok "what is looked for is found" holds "$one" "$DB" "$DB-wal"
done
req DELETE /v1/subjects/alice
cp "$T/body" "$T/receipt"
ctl_exits 0 backup "$T/backup" # a backup afterwards
for one in $encrypted; do
    if holds "$one" "$DB" "$DB-wal" "$T/backup"; then found=yes; else found=no; fi
    is "the key and the face are nowhere any more" "$found" no
done
ctl template delete "$(sql 'SELECT id FROM templates')" --yes
ctl token revoke "$DOOR"
ctl audit show
is "who did what" "$(said '.entries[] | [.kind, (.actor | sub(":.*"; "")), .outcome] | join(" ")')" "\
create_database  file
create_token surfacectl door
add_subject $DOOR created
enroll $DOOR created
verify $DOOR match
verify $DOOR no_match
add_subject $DOOR created
enroll $DOOR created
verify surfacectl match
checkpoint surfacectl 
delete_template $DOOR deleted
delete_subject $DOOR erased
delete_template surfacectl deleted
revoke_token surfacectl door"
is "with which template" "$(said '.entries[3].object')" "$id"
is "in which log" "$(said '[.entries[] | "\(.log[:1])\(.seq)"] | join(" ")')" \
    "c1 c2 c3 c4 a1 a2 c5 c6 a3 c7 c8 c9 c10 c11"
is "who is here is named" "$(said '.entries[7].subject')" bob
is "who was erased is not" "$(said '.entries[3] | [.subject, (.subject_uid | length)] | @csv')" ',32'
ctl_exits 66 audit show --subject alice # nor found by the id
ctl audit show --uid "$(jq -r .subject_uid "$T/receipt")"
is "but by the uid, which the receipt has" "$(said '[.entries[].seq] | @csv')" 3,4,1,2,8,9
ctl audit show --kind verify --limit 2
is "of a kind, the newest" "$(said '[.entries[].seq] | @csv')" 2,3
ctl audit show --since 2999
is "since then" "$CODE $(said '.entries | length')" "0 0"
ctl_exits 65 audit show --since soon # no such time
"$BUILD/surfacectl" --db "$DB" audit show >"$T/text"
ok "as text, with the token's name" grep -Eq "^changes *9  20.*delete_subject .* door \($(echo "$DOOR" | cut -c-8)\)$" "$T/text"
for by in door "$DOOR"; do
    ctl audit show --actor "$by" --kind delete_subject
    is "what $by did" "$CODE $(said '[.entries[].seq] | @csv')" '0 9'
done
ctl audit verify
is "all as it was written" "$CODE $(said '[.ok, .entries, .checkpoints] | @csv')" "0 true,14,1"
key=$(said .public_key)

# ---- the receipt
receipt() {
    jq -r "$1" "$T/receipt"
}
is "of whom, what" "$(receipt '[.subject, .template_ids[]] | @csv')" "\"alice\",\"$id\""
is "where in the log" "$(receipt .audit.seq)" 9
is "by which key" "$(receipt .public_key)" "$key"
if command -v openssl >/dev/null && command -v xxd >/dev/null; then
    receipt '"surface signed 3", .audit.seq, .erased_at, .audit.hash, .digest' >"$T/signed"
    receipt .signature | xxd -r -p >"$T/signature"
    # An Ed25519 key as X.509 has it: RFC 8410.
    printf '302a300506032b6570032100%s' "$key" | xxd -r -p >"$T/key.der"
    ok "the signature holds" openssl pkeyutl -verify -rawin -pubin -keyform DER \
        -inkey "$T/key.der" -in "$T/signed" -sigfile "$T/signature" -out "$T/out"
fi
ctl audit show --kind delete_subject
is "it is remembered" "$CODE $(said '.entries[].at')" "0 $(receipt .erased_at)"
# proves WANTED FILE [OPTION...]: exit code and problems of verifying a receipt
proves() {
    p_wanted=$1
    shift
    ctl audit verify "$@"
    is "receipt $*" "$CODE $(said '[.ok, (.problems | length)] | @csv')" "$p_wanted"
}
proves '0 true,0' "$T/receipt"
is "what it is of" "$(said '[.subject, .templates_removed, .audit.seq] | @csv')" '"alice",1,9'
offline() { "$BUILD/surfacectl" --json audit verify "$@" >"$T/ctl" 2>"$T/ctl.err"; }
offline "$T/receipt" --public-key "$key"
is "with the public key alone" "$? $(said .ok)" '0 true'
offline "$T/receipt" --public-key "$(printf '%064d' 0)"
is "with another" "$? $(said '.problems | length')" '1 1'
offline "$T/receipt"
is "by nothing" $? 64
"$BUILD/surfacectl" --db "$DB" audit verify - <"$T/receipt" >"$T/text"
is "from a pipe, as text" "$? $(cut -c 1-29 "$T/text")" '0 ok: alice with 1 template, at'
# digest_of FILE: of a receipt, made by hand.
digest_of() {
    jq -r '"surface erasure 2", .subject, .subject_uid, .erased_at, .template_ids[]' "$1" | sha256sum | cut -c 1-64
}
jq '.subject = "bob"' "$T/receipt" >"$T/other"
jq --arg d "$(digest_of "$T/other")" '.digest = $d' "$T/other" >"$T/forged"
ctl audit verify "$T/forged"
is "another subject, with its digest" "$CODE $(said '.problems | length')" '1 1'
for change in '.subject = "bob"' '.erased_at = "2026-01-01T00:00:00.000Z"' '.template_ids = []' \
    '.template_ids += ["x"]' '.audit.seq = 8' '.subject_uid |= sub("^...."; "0000")' \
    '.signature |= sub("^...."; "0000")'; do
    jq "$change" "$T/receipt" >"$T/forged"
    ctl audit verify "$T/forged"
    is "changed: $change" "$CODE $(said '.problems[0].problem')" '1 the contents of the receipt differ from what was signed'
done
for change in 'del(.audit)' '.audit.seq = 0' '.template_ids = "x"' '.template_ids = [1]' \
    'del(.signature)' '.subject = "a b"' '[.]'; do
    jq "$change" "$T/receipt" >"$T/forged"
    ctl_exits 65 audit verify "$T/forged" # no receipt: $change
done
ctl_exits 66 audit verify "$T/none" # no file
"$BUILD/surfacectl" --db "$T/third.db" init >"$T/text"
"$BUILD/surfacectl" --db "$T/third.db" --json audit verify "$T/receipt" >"$T/ctl"
is "another database's" "$? $(said '.problems | length')" '1 1'
cp "$DB" "$T/copy.db"
sqlite3 "$T/copy.db" "UPDATE change_log SET hash = zeroblob(32) WHERE seq = 9"
"$BUILD/surfacectl" --db "$T/copy.db" --key "$DB.key" --json audit verify "$T/receipt" >"$T/ctl"
is "what the database does not know of it" $? 65
ctl subject erase bob --yes
cp "$T/ctl" "$T/receipt"
is "the command gives one too" "$CODE $(receipt '[.subject, .templates_removed, .audit.seq] | @csv')" \
    '0 "bob",0,12'
is "with its digest" "$(receipt .digest)" "$(digest_of "$T/receipt")"

# ---- exported
ctl audit export --out "$T/exported"
is "exported" "$CODE $(said '[.changes, .public_key] | @csv')" "0 13,\"$key\""
is "its owner's" "$(stat -c %a "$T/exported")" 600
is "what an entry is not about is null" \
    "$(jq -c 'select(.kind == "create_token") | .subject_uid' "$T/exported" | sort -u)" null
file() {
    "$BUILD/surfacectl" --json audit verify "$1" --public-key "${2:-$key}" >"$T/ctl" 2>"$T/ctl.err"
    CODE=$?
}
file "$T/exported"
is "sound" "$CODE $(said '[.entries, .checkpoints] | @csv')" "0 16,2"
"$BUILD/surfacectl" --db "$DB" audit export >"$T/log2" 2>"$T/err"
is "to standard output" "$?" 0
file "$T/log2"
is "sound too" "$CODE $(said .entries)" "0 17"
ok "nobody is named" sh -c "! grep -q 'alice\|bob' '$T/log2'"
ctl_exits 64 audit export # not as another JSON
file "$T/exported" "$(echo "$key" | tr 0-9a-f 1-9a-f0)"
is "another key" "$CODE $(said .first_entry)" "1 1"
file "$T/exported" abc
is "no key at all" $CODE 65
file "$T/none"
is "no file" $CODE 66
file "$T/a.ply"
is "no log" $CODE 65
"$BUILD/surfacectl" audit verify "$T/exported" >"$T/out" 2>&1
is "no key given" $? 64

# wrong FIRST SED: the exported log, changed, is found to be wrong from there on.
wrong() {
    sed "$2" "$T/exported" >"$T/changed"
    file "$T/changed"
    is "file: $2" "$CODE $(said .first_entry)" "1 $1"
}
C='"log":"changes"' A='"log":"accesses"'
wrong 3 "/$C,\"seq\":3,/d"
for change in 's/created/deleted/' 's/"object":"../"object":"00/' 's/"at":"2026/"at":"2025/' \
    's/"subject_uid":"..../"subject_uid":"0000/' 's/"digest":"..../"digest":"0000/' \
    's/"access_seq":0/"access_seq":1/' 's/"actor":"./"actor":"x/' 's/"kind":"./"kind":"x/'; do
    wrong 4 "/$C,\"seq\":4,/$change"
done
wrong 8 "/$C,\"seq\":13,/s/\"signature\":\"..../\"signature\":\"0000/"
wrong 8 "/$C,\"seq\":13,/d"
wrong 13 "/$C,\"seq\":13,/s/.*/&\n&/"
wrong 2 "/$A,\"seq\":2,/s/no_match/match/"
wrong 2 "/$A,\"seq\":2,/{h;d};/$A,\"seq\":3,/G"
wrong 1 "/$A/d"
wrong 1 "2,\$d"
wrong 4 "/$C,\"seq\":13,/h;\$G"
for line in nonsense '{}' '{"log":"changes"}'; do
    wrong 4 "\$s/\$/\n$line/"
    is "it is malformed" "$(said '.problems[0].problem')" 'line 18 of the file is malformed'
done

# ---- a changed row: `audit verify` says where, and nobody takes it for a backup
stop_daemon
cp "$DB" "$T/whole"
sql "UPDATE access_log SET outcome = 'x' WHERE seq = 2"
ctl audit verify
is "found" "$CODE $(said '[.first_log, .first_entry] | join(" ")')" "1 accesses 2"
ctl backup "$T/backup2"
ok "no backup" [ "$CODE" != 0 -a ! -e "$T/backup2" ]
ctl check-database
ok "check finds it as well" [ "$CODE" != 0 ]
cp "$T/whole" "$DB"
ctl_exits 0 check-database

# ---- the oldest uses cut off: test_audit.c
ctl_exits 64 audit trim # for how long?
ctl audit trim --keep 30
is "none is as old" "$CODE $(said .cut)" "0 0"
finish
