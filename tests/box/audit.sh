#!/bin/sh
# Goal: the audit log says who did what; a change of any row of it is found, with its
# place; an export can be verified without the database; an erasure leaves a receipt.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# ---- a log of everything, by the daemon and by the command
scan 1 0 "$T/a.ply"
scan 1 1 "$T/a1.ply"
scan 2 0 "$T/b.ply"
scan 2 1 "$T/b1.ply"
AUTH=
start_daemon
ctl token create door --scope "$ALL"
AUTH=$(said .token) DOOR=$(said .id)
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
id=$(get .template_id)
send POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
send POST /v1/subjects/alice/verify "$PLY" "$T/b.ply"
send POST /v1/subjects/bob/templates "$PLY" "$T/b.ply"
ctl verify bob "$T/b1.ply"
ctl audit checkpoint
is "signed" "$CODE $(said .checkpoint)" "0 7"
# As they are in the file: the subject's wrapped key, and some of the encrypted face.
encrypted=$(sqlite3 "$DB" "SELECT hex(s.key), hex(substr(f.face, 3000, 40)) FROM templates t
    JOIN subjects s USING (uid) JOIN faces f USING (template_key) WHERE t.id = '$id'" | tr '|' ' ')
for one in $encrypted; do
    ok "what is looked for is found" holds "$one" "$DB" "$DB-wal"
done
req DELETE /v1/subjects/alice
cp "$T/body" "$T/receipt"
ctl backup "$T/backup"
is "a backup afterwards" $CODE 0
for one in $encrypted; do
    if holds "$one" "$DB" "$DB-wal" "$T/backup"; then found=yes; else found=no; fi
    is "the key and the face are nowhere any more" "$found" no
done
ctl template delete "$(sqlite3 "$DB" 'SELECT id FROM templates')" --yes
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
delete_subject $DOOR deleted
delete_template surfacectl deleted
revoke_token surfacectl door"
is "with which template" "$(said '.entries[3].object')" "$id"
is "in which log" "$(said '[.entries[] | "\(.log[:1])\(.seq)"] | join(" ")')" \
    "c1 c2 c3 c4 a1 a2 c5 c6 a3 c7 c8 c9 c10 c11"
is "who is here is named" "$(said '.entries[7].subject')" bob
is "who was erased is not" "$(said '.entries[3] | [.subject, (.subject_uid | length)] | @csv')" ',32'
ctl audit show --subject alice
is "nor found by the id" "$CODE" 66
ctl audit show --uid "$(jq -r .subject_uid "$T/receipt")"
is "but by the uid, which the receipt has" "$(said '[.entries[].seq] | @csv')" 3,4,1,2,8,9
ctl audit show --kind verify --limit 2
is "of a kind, the newest" "$(said '[.entries[].seq] | @csv')" 2,3
ctl audit show --since 2999
is "since then" "$CODE $(said '.entries | length')" "0 0"
ctl audit show --since soon
is "no such time" $CODE 65
"$BUILD/surfacectl" --db "$DB" audit show >"$T/text"
ok "as text" grep -q "^changes *9  20.*delete_subject .*$DOOR" "$T/text"
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
    receipt '"surface receipt 2", .digest, .audit.seq, .audit.hash' >"$T/signed"
    receipt .signature | xxd -r -p >"$T/signature"
    # An Ed25519 key as X.509 has it: RFC 8410.
    printf '302a300506032b6570032100%s' "$key" | xxd -r -p >"$T/key.der"
    ok "the signature holds" openssl pkeyutl -verify -rawin -pubin -keyform DER \
        -inkey "$T/key.der" -in "$T/signed" -sigfile "$T/signature" -out "$T/out"
fi
ctl audit erased
is "it is remembered" "$CODE $(said '.erased[].erased_at')" "0 $(receipt .erased_at)"
# proves WANTED FILE [OPTION...]: exit code and problems of verifying a receipt
proves() {
    p_wanted=$1
    shift
    ctl audit receipt "$@"
    is "receipt $*" "$CODE $(said '[.ok, (.problems | length)] | @csv')" "$p_wanted"
}
proves '0 true,0' "$T/receipt"
is "what it is of" "$(said '[.subject, .templates_removed, .audit.seq] | @csv')" '"alice",1,9'
offline() { "$BUILD/surfacectl" --json audit receipt "$@" >"$T/ctl" 2>"$T/ctl.err"; }
offline "$T/receipt" --public-key "$key"
is "with the public key alone" "$? $(said .ok)" '0 true'
offline "$T/receipt" --public-key "$(printf '%064d' 0)"
is "with another" "$? $(said '.problems | length')" '1 1'
offline "$T/receipt"
is "by nothing" $? 64
"$BUILD/surfacectl" --db "$DB" audit receipt - <"$T/receipt" >"$T/text"
is "from a pipe, as text" "$? $(cut -c 1-29 "$T/text")" '0 ok: alice with 1 template, at'
for change in '.subject = "bob"' '.erased_at = "2026-01-01T00:00:00.000Z"' '.template_ids = []' \
    '.template_ids += ["x"]' '.audit.seq = 8'; do
    jq "$change" "$T/receipt" >"$T/forged"
    ctl audit receipt "$T/forged"
    is "changed: $change" "$CODE $(said '.problems[0]')" '1 its contents are not what was signed'
done
for change in 'del(.audit)' '.audit.seq = 0' '.template_ids = "x"' '.template_ids = [1]' \
    'del(.signature)' '.subject = "a b"' '[.]'; do
    jq "$change" "$T/receipt" >"$T/forged"
    ctl audit receipt "$T/forged"
    is "no receipt: $change" "$CODE" 65
done
ctl audit receipt "$T/none"
is "no file" "$CODE" 66
"$BUILD/surfacectl" --db "$T/third.db" init >"$T/text"
"$BUILD/surfacectl" --db "$T/third.db" --json audit receipt "$T/receipt" >"$T/ctl"
is "another database's" "$? $(said '.problems | length')" '1 1'
cp "$DB" "$T/copy.db"
sqlite3 "$T/copy.db" "UPDATE change_log SET hash = zeroblob(32) WHERE seq = 9"
"$BUILD/surfacectl" --db "$T/copy.db" --key "$DB.key" --json audit receipt "$T/receipt" >"$T/ctl"
is "what the database does not know of it" $? 65
ctl subject erase bob --yes
cp "$T/ctl" "$T/receipt"
is "the command gives one too" "$CODE $(receipt '[.subject, .templates_removed, .audit.seq] | @csv')" \
    '0 "bob",0,12'
is "with its digest" "$(receipt .digest)" \
    "$(receipt '"surface erasure 2", .subject, .subject_uid, .erased_at, .template_ids[]' | sha256sum | cut -c 1-64)"

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
ctl audit export
is "not as another JSON" $CODE 64
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
wrong 4 "/$C,\"seq\":4,/s/created/deleted/"
wrong 4 "/$C,\"seq\":4,/s/\"object\":\"../\"object\":\"00/"
wrong 4 "/$C,\"seq\":4,/s/\"subject_uid\":\"..../\"subject_uid\":\"0000/"
wrong 4 "/$C,\"seq\":4,/s/\"digest\":\"..../\"digest\":\"0000/"
wrong 4 "/$C,\"seq\":4,/s/\"access_seq\":0/\"access_seq\":1/"
wrong 5 "/$C,\"seq\":5,/s/\"actor\":\"./\"actor\":\"x/"
wrong 5 "/$C,\"seq\":5,/{h;d};/$C,\"seq\":6,/G"
wrong 8 "/$C,\"seq\":13,/s/\"signature\":\"..../\"signature\":\"0000/"
wrong 8 "/$C,\"seq\":13,/d"
wrong 13 "/$C,\"seq\":13,/s/.*/&\n&/"
wrong 1 "/$A,\"seq\":1,/d"
wrong 2 "/$A,\"seq\":2,/s/no_match/match/"
wrong 2 "/$A,\"seq\":2,/{h;d};/$A,\"seq\":3,/G"
wrong 3 "/$A,\"seq\":3,/d"
wrong 1 "/$A/d"

# ---- every row of the table, one after the other, in every way
cp "$DB" "$T/whole"
stop_daemon
sqlite3 "$DB" 'PRAGMA wal_checkpoint(TRUNCATE)' >/dev/null
cp "$DB" "$T/whole"
# tampered CHAIN FIRST SQL
tampered() {
    cp "$T/whole" "$DB"
    sqlite3 "$DB" "$3"
    ctl audit verify
    if [ "$1" = changes ] && [ "$2" -ge $((last - 2)) ]; then # nothing is opened that has no good end
        is "$3" "$([ "$CODE" = 0 ] || echo found)" found
    else
        is "$3" "$CODE $(said '[.first_log, .first_entry] | join(" ")')" "1 $1 $2"
    fi
}
for log in change access; do
    last=$(sqlite3 "$DB" "SELECT max(seq) FROM ${log}_log")
    word=$([ $log = change ] && echo changes || echo accesses)
    for seq in $(seq "$last"); do
        of="${log}_log WHERE seq = $seq"
        # The last change is the export: without it the database is one from before, as a whole.
        [ "$log $seq" = "change $last" ] || tampered "$word" "$seq" "DELETE FROM $of"
        for column in "outcome = outcome || '.'" "at = '2026-01-01T00:00:00.000Z'" 'hash = randomblob(32)' \
            'uid = randomblob(16)' 'mac = randomblob(32)'; do
            tampered "$word" "$seq" "UPDATE ${log}_log SET $column WHERE seq = $seq"
        done
        [ "$seq" -ge $((last - 1)) ] || tampered "$word" "$seq" "UPDATE ${log}_log SET seq = 99 WHERE seq = $seq;
            UPDATE ${log}_log SET seq = $seq WHERE seq = $seq + 1;
            UPDATE ${log}_log SET seq = $seq + 1 WHERE seq = 99"
    done
done
ctl backup "$T/backup2"
is "nor is it taken for a backup" "$(ls "$T/backup2" 2>/dev/null)" ""
ctl check-database
ok "check finds it as well" [ "$CODE" != 0 ]
cp "$T/whole" "$DB"
ctl check-database
is "restored" "$CODE $(said .problems)" "0 []"

# ---- the oldest uses cut off: the chain and exports go on from there
ctl audit trim
is "for how long?" "$CODE" 64
ctl audit trim --keep 30
is "none is as old" "$CODE $(said .cut)" "0 0"
if command -v faketime >/dev/null && ! grep -q __asan_init "$BUILD/surfacectl"; then
    later() {
        faketime -f +400d "$BUILD/surfacectl" --db "$DB" --json "$@" >"$T/ctl" 2>"$T/ctl.err"
        CODE=$?
    }
    later audit trim --keep 399 --dry-run
    is "they would be" "$CODE $(said '[.cut, .dry_run] | @csv')" "0 2,true"
    later audit trim --keep 399
    is "they are, but the last" "$CODE $(said .cut) $(sqlite3 "$DB" "SELECT count(*) FROM access_log")" "0 2 1"
    ctl audit show --kind trim_accesses
    is "a change says so" "$(said '.entries[] | .outcome')" 2
    ctl verify carol "$T/b.ply" # nobody: refused, and no use of it
    ctl template export "$(sqlite3 "$DB" 'SELECT id FROM templates LIMIT 1')" --out "$T/t.ply"
    ctl audit verify
    is "all as it was written" "$CODE $(said .ok)" "0 true"
    ctl audit export --out "$T/log3"
    file "$T/log3"
    is "so is the export" "$CODE $(said .ok)" "0 true"
    sed '/"kind":"trim_accesses"/s/"outcome":"2"/"outcome":"1"/' "$T/log3" >"$T/changed"
    file "$T/changed"
    is "which must say where" "$CODE" 1
fi

# ---- an id that was changed: what is told of the subject under its former ids is shown too, and
# nothing of others who had them
DB=$T/renamed.db
ctl init
ctl subject set ann --consent A
ctl subject erase ann --yes
ctl subject set ann --consent B
ctl subject rename ann bea
ctl subject set ann --consent C
ctl subject rename bea dora
ctl audit show --subject dora
is "under every id it had" "$(said '[.entries[].kind] | join(" ")')" \
    "add_subject rename_subject rename_subject"
ctl audit show --subject dora --limit 2
is "the newest" "$(said '[.entries[].kind] | join(" ")')" "rename_subject rename_subject"
ctl audit show --subject ann
is "of who has it now" "$(said '[.entries[].kind] | join(" ")')" add_subject
finish
