#!/bin/sh
# Goal: the audit log says who did what; a change of any row of it is found, with its
# place; an export can be verified without the database; an erasure leaves a receipt.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# ---- a log of everything, by the daemon and by the command
ME=surfacectl:$(id -un)
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
is "signed" "$CODE $(said '[.chain, .checkpoint] | @csv')" '0 "changes",7'
# As they are in the file: the subject's wrapped key, and some of the encrypted model.
encrypted=$(sqlite3 "$DB" "SELECT hex(s.key), hex(substr(t.model, 2000, 40)) FROM templates t
    JOIN subjects s USING (subject_key) WHERE t.id = '$id'" | tr '|' ' ')
for one in $encrypted; do
    ok "what is looked for is found" holds "$one" "$DB" "$DB-wal"
done
req DELETE /v1/subjects/alice
cp "$T/body" "$T/receipt"
ctl backup "$T/backup"
is "a backup afterwards" $CODE 0
for one in $encrypted; do
    if holds "$one" "$DB" "$DB-wal" "$T/backup"; then found=yes; else found=no; fi
    is "the key and the model are nowhere any more" "$found" no
done
ctl template delete "$(sqlite3 "$DB" 'SELECT id FROM templates')" --yes
ctl token revoke "$DOOR"
ctl audit show
is "who did what" "$(said '.entries[] | [.kind, .actor, .outcome] | join(" ")')" "\
create_key  file
create_token $ME $DOOR
add_subject $DOOR created
enroll $DOOR created
verify $DOOR match
verify $DOOR no_match
add_subject $DOOR created
enroll $DOOR created
verify $ME match
checkpoint $ME 
delete_template $DOOR deleted
delete_subject $DOOR deleted
delete_template $ME deleted
count_templates $ME 0
revoke_token $ME $DOOR"
is "with which template" "$(said '.entries[3].template_id')" "$id"
is "in which chain" "$(said '[.entries[] | "\(.chain[:1])\(.seq)"] | join(" ")')" \
    "c1 c2 c3 c4 u1 u2 c5 c6 u3 c7 c8 c9 c10 c11 c12"
is "who is here is named" "$(said '.entries[7].subject')" bob
is "who was erased is not" "$(said '.entries[3] | [.subject, (.subject_ref | length)] | @csv')" ',32'
ctl audit show --subject alice
is "but found by the id" "$(said '[.entries[].seq] | @csv')" 3,4,1,2,8,9
ctl audit show --kind verify --limit 2
is "of a kind, the newest" "$(said '[.entries[].seq] | @csv')" 2,3
ctl audit show --since 2999
is "since then" "$CODE $(said '.entries | length')" "0 0"
ctl audit show --since soon
is "no such time" $CODE 65
"$BUILD/surfacectl" --db "$DB" audit show >"$T/text"
ok "as text" grep -q "^changes        9  20.*delete_subject .*#[0-9a-f]\{12\} .*$DOOR\$" "$T/text"
ctl audit verify
is "all as it was written" "$CODE $(said '[.ok, .entries, .checkpoints] | @csv')" "0 true,15,1"
key=$(said .public_key)

# ---- the receipt
receipt() {
    jq -r "$1" "$T/receipt"
}
is "of whom, what" "$(receipt '[.subject, .template_ids[]] | @csv')" "\"alice\",\"$id\""
is "where in the log" "$(receipt .audit.seq)" 9
is "by which key" "$(receipt .public_key)" "$key"
if command -v openssl >/dev/null && command -v xxd >/dev/null; then
    receipt '"surface receipt 1", .digest, .audit.seq, .audit.hash' >"$T/signed"
    receipt .signature | xxd -r -p >"$T/signature"
    # An Ed25519 key as X.509 has it: RFC 8410.
    printf '302a300506032b6570032100%s' "$key" | xxd -r -p >"$T/key.der"
    ok "the signature holds" openssl pkeyutl -verify -rawin -pubin -keyform DER \
        -inkey "$T/key.der" -in "$T/signed" -sigfile "$T/signature" -out "$T/out"
fi
ctl audit erased
is "it is remembered" "$CODE $(said '.erased[].erased_at')" "0 $(receipt .erased_at)"
ctl audit erased alice
is "by the id" $CODE 0
ctl audit erased bob
is "bob was not" "$CODE $(said '.erased | length')" "1 0"
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
    is "changed: $change" "$CODE $(said '.problems[0]')" '1 what it says is not what was signed'
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
sqlite3 "$T/copy.db" "UPDATE events SET at = '2026-01-01T00:00:00.000Z' WHERE chain = 0 AND seq = 9"
"$BUILD/surfacectl" --db "$T/copy.db" --key "$DB.key" --anchor none --json audit receipt "$T/receipt" >"$T/ctl"
is "what the database does not know of it" "$? $(said '.problems | length')" '1 1'
ctl subject erase bob --yes
cp "$T/ctl" "$T/receipt"
is "the command gives one too" "$CODE $(receipt '[.subject, .templates_removed, .audit.seq] | @csv')" \
    '0 "bob",0,13'
is "with its digest" "$(receipt .digest)" \
    "$(receipt '"surface erasure 1", .subject, .erased_at, .template_ids[]' | sha256sum | cut -c 1-64)"

# ---- exported
ctl audit export --out "$T/log" --force
is "exported" "$CODE $(said '[.changes, .public_key] | @csv')" "0 14,\"$key\""
is "its owner's" "$(stat -c %a "$T/log")" 600
is "what an entry is not about is null" \
    "$(jq -c 'select(.kind == "create_token") | [.subject_ref, .template_id]' "$T/log" | sort -u)" '[null,null]'
file() {
    "$BUILD/surfacectl" --json audit verify "$1" --public-key "${2:-$key}" >"$T/ctl" 2>"$T/ctl.err"
    CODE=$?
}
file "$T/log"
is "sound" "$CODE $(said '[.entries, .checkpoints] | @csv')" "0 17,2"
"$BUILD/surfacectl" --db "$DB" audit export >"$T/log2" 2>"$T/err"
is "to standard output" "$?" 0
file "$T/log2"
is "sound too" "$CODE $(said .entries)" "0 18"
ok "nobody is named" sh -c "! grep -q 'alice\|bob' '$T/log2'"
ctl audit export
is "not as another JSON" $CODE 64
file "$T/log" "$(echo "$key" | tr 0-9a-f 1-9a-f0)"
is "another key" "$CODE $(said .first_entry)" "1 1"
file "$T/log" abc
is "no key at all" $CODE 65
file "$T/none"
is "no file" $CODE 66
file "$T/a.ply"
is "no log" $CODE 65
"$BUILD/surfacectl" audit verify "$T/log" >"$T/out" 2>&1
is "no key given" $? 64

# wrong FIRST SED: the exported log, changed, is found to be wrong from there on.
wrong() {
    sed "$2" "$T/log" >"$T/changed"
    file "$T/changed"
    is "file: $2" "$CODE $(said .first_entry)" "1 $1"
}
C='"chain":"changes"' U='"chain":"uses"'
wrong 3 "/$C,\"seq\":3,/d"
wrong 4 "/$C,\"seq\":4,/s/created/deleted/"
wrong 4 "/$C,\"seq\":4,/s/\"row\":\"./\"row\":\"x/"
wrong 4 "/$C,\"seq\":4,/s/\"object\":\"../\"object\":\"00/"
wrong 4 "/$C,\"seq\":4,/s/\"uses\":0/\"uses\":1/"
wrong 5 "/$C,\"seq\":5,/s/\"actor\":\"./\"actor\":\"x/"
wrong 5 "/$C,\"seq\":5,/{h;d};/$C,\"seq\":6,/G"
wrong 9 "/$C,\"seq\":9,/s/.*/{}/"
wrong 7 "/\"checkpoint\":7,/s/\"signature\":\"..../\"signature\":\"0000/"
wrong 8 '/"checkpoint":14,/d'
wrong 8 "/$C,\"seq\":14,/d"
wrong 2 '3s/.*/garbage/'
wrong 15 "/\"checkpoint\":14,/s/.*/&\n{$C,\"seq\":15}/"
wrong 1 "/$U,\"seq\":1,/d"
wrong 2 "/$U,\"seq\":2,/s/no_match/match/"
wrong 2 "/$U,\"seq\":2,/{h;d};/$U,\"seq\":3,/G"
wrong 3 "/$U,\"seq\":3,/d"
wrong 1 "/$U/d"

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
    is "$3" "$CODE $(said '[.first_chain, .first_entry] | join(" ")')" "1 $1 $2"
}
for chain in 0 1; do
    last=$(sqlite3 "$DB" "SELECT max(seq) FROM events WHERE chain = $chain")
    word=$([ $chain = 0 ] && echo changes || echo uses)
    for seq in $(seq "$last"); do
        of="chain = $chain AND seq"
        tampered "$word" "$seq" "DELETE FROM events WHERE $of = $seq"
        tampered "$word" "$seq" "UPDATE events SET outcome = outcome || '.' WHERE $of = $seq"
        tampered "$word" "$seq" "UPDATE events SET at = '2026-01-01T00:00:00.000Z' WHERE $of = $seq"
        tampered "$word" "$seq" "UPDATE events SET hash = randomblob(32) WHERE $of = $seq"
        [ "$seq" = "$last" ] ||
            tampered "$word" "$seq" "UPDATE events SET seq = 99 WHERE $of = $seq;
                UPDATE events SET seq = $seq WHERE $of = $seq + 1;
                UPDATE events SET seq = $seq + 1 WHERE $of = 99"
    done
done
tampered changes 5 "DELETE FROM events WHERE chain = 0 AND seq >= 5"
tampered changes 7 "DELETE FROM checkpoints WHERE seq = 7"
ctl backup "$T/backup2"
is "nor is it taken for a backup" "$CODE $(ls "$T/backup2" 2>/dev/null)" "65 "
ctl check
is "check finds it as well" "$CODE $(said '.problems | length')" "1 1"
cp "$T/whole" "$DB"
ctl check
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
    is "they would be" "$CODE $(said '[.cut, .dry_run] | @csv')" "0 3,true"
    later audit trim --keep 399
    is "they are" "$CODE $(said .cut)" "0 3"
    is "no use is left" "$(sqlite3 "$DB" "SELECT count(*) FROM events WHERE chain = 1")" 0
    ctl audit show --kind trim_uses
    is "a change says so" "$(said '.entries[] | [.actor, .outcome] | @csv')" "\"$ME\",\"3\""
    ctl verify carol "$T/b.ply" # nobody: refused, and no use of it
    ctl template export "$(sqlite3 "$DB" 'SELECT id FROM templates LIMIT 1')" --out "$T/t.ply"
    ctl audit verify
    is "all as it was written" "$CODE $(said .ok)" "0 true"
    ctl audit export --out "$T/log3"
    file "$T/log3"
    is "so is the export" "$CODE $(said .ok)" "0 true"
    sed '/"kind":"trim_uses"/s/"outcome":"3"/"outcome":"2"/' "$T/log3" >"$T/changed"
    file "$T/changed"
    is "which must say where" "$CODE" 1
fi

# ---- an id that was changed: what is told of the subject under its former ids is shown
# too, and nothing of others who had them
DB=$T/renamed.db
ctl init
ctl subject set ann --consent A
ctl subject erase ann --yes
ctl subject set ann --consent B
ctl subject rename ann bea
ctl subject set ann --consent C
ctl subject rename bea cleo
ctl subject rename cleo bea
ctl subject rename bea dora
ctl audit show --subject dora
is "under every id it had" "$(said '[.entries[].seq] | @csv')" 4,5,6,8,9,10,11,12,13
ctl audit show --subject dora --limit 2
is "the newest" "$(said '[.entries[].seq] | @csv')" 12,13
ctl audit show --subject ann
is "an id alone" "$(said '[.entries[].seq] | @csv')" 2,3,4,5,7

# ---- who ran surfacectl: the login's name, or its number where it has none
ctl subject set dora --consent C-1
ctl audit show --subject dora
is "by whom" "$(said '.entries[-1].actor')" "$ME"
if [ "$(id -u)" -eq 0 ] && command -v setpriv >/dev/null; then
    mkdir "$T/theirs"
    for file in '' .key .key.anchor; do
        cp "$DB$file" "$T/theirs/faces.db$file"
    done
    chown -R 54321 "$T/theirs"
    chmod 711 "$T"
    they() { # as a user without a name
        setpriv --reuid 54321 --clear-groups "$(realpath "$BUILD")/surfacectl" --json \
            --db "$T/theirs/faces.db" "$@"
    }
    they subject set emil --consent C-2 >"$T/text" 2>&1
    is "by a number ($(cat "$T/text"))" "$(they audit show --subject emil |
        jq -r '.entries[-1].actor')" surfacectl:54321
fi
finish
