#!/bin/sh
# Goal: a backup that is made while the daemon enrolls is complete and verified, or does
# not exist; restoring it brings the database back, but no subject that was erased since,
# and no token that was revoked since.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# people: the subjects in the database.
people() {
    "$BUILD/surfacectl" --db "$DB" --json subject list | jq -r '[.subjects[].subject] | join(" ")'
}

for s in 1 2 3 4; do
    scan "$s" 0 "$T/s$s.ply" --points 1000
    scan "$s" 1 "$T/p$s.ply" --points 1000
done
ctl init
ctl enroll alice "$T/s1.ply"
ctl enroll bob "$T/s2.ply"
ctl enroll carol "$T/s3.ply"
token=$("$BUILD/surfacectl" --db "$DB" --json token create front --scope "$ALL")
AUTH=$(printf '%s' "$token" | jq -r .token)
id=$(printf '%s' "$token" | jq -r '.id // .token_id')

# ---- beside a daemon that enrolls meanwhile
start_daemon
(
    i=0
    while [ ! -e "$T/enough" ] && [ "$i" -lt 500 ]; do
        i=$((i + 1))
        curl -sS -m 60 -o /dev/null -H "$PLY" -H "Authorization: Bearer $AUTH" \
            --data-binary "@$T/s4.ply" "$URL/v1/subjects/more$i/templates"
        echo "$i" >"$T/enrolled"
    done
) &
loop=$!
tries=0
until [ -s "$T/enrolled" ] || [ "$tries" -ge 300 ]; do
    tries=$((tries + 1))
    sleep 0.1
done
for i in 1 2 3; do
    ctl backup "$T/b$i"
    is "backup $i" "$CODE" 0
    is "its file is its owner's" "$(stat -c %a "$T/b$i")" 600
done
n=$(said .subjects)
touch "$T/enough"
wait "$loop"
ok "it has who was there ($n)" test "$n" -ge 4
ok "one file" test ! -e "$T/b3-wal" -a ! -e "$T/b3-shm" -a ! -e "$T/b3.part"
is "it can be opened" "$("$BUILD/surfacectl" --db "$T/b3" --key "$DB.key" --json check-database |
    jq -r .ok)" true
is "and its counts are those told" "$("$BUILD/surfacectl" --db "$T/b3" --key "$DB.key" \
    --json stats | jq -r .subjects)" "$n"
ok "it holds no plaintext" sh -c "! grep -aq 'alice\|more1' '$T/b3'"

# ---- not while another process has it open
ctl restore "$T/b3"
is "not while the daemon runs" "$CODE" 75
ok "and it is said what to do" grep -q 'stop surfaced first' "$T/ctl.err"
ctl restore "$T/b3" --dry-run
is "what it would do can be asked" "$CODE $(said .restored)" "0 false"
alive "a refused restore"
req GET /v1/subjects/alice
is "it serves as before" "$STATUS" 200
stop_daemon

# ---- what is overwritten, and what is not
ctl backup "$T/b3"
is "an older backup is not replaced unasked" "$CODE" 65
ctl backup "$T/b3" --force
is "an older backup is replaced" "$CODE" 0
echo mine >"$T/notes"
ctl backup "$T/notes" --force
is "another file is not" "$CODE" 65
is "it is as it was" "$(cat "$T/notes")" mine
ctl backup "$DB" --force
is "nor the database" "$CODE" 65
ctl backup "$T/nowhere/b"
is "nor is it in a folder that is not there" "$CODE" 74
ctl check-database
is "the database is well" "$CODE" 0

# ---- back to what was
ctl backup "$T/back"
before=$(people)
cp "$DB.key" "$T/key"
ctl subject erase --yes bob
ctl enroll dave "$T/s4.ply"
ctl subject erase --yes carol
ctl enroll carol "$T/s4.ply" # erased, and there again with another face
ctl token revoke "$id"
ctl restore "$T/back" --dry-run
is "what would change" "$CODE $(said '.subjects_lost, .subjects_erased, .tokens_revoked' |
    tr '\n' ' ')" "0 2 2 1 "
is "nothing did" "$(people | grep -c dave)" 1
ok "nothing is left of trying" test ! -e "$DB.part" -a ! -e "$DB.before-restore"
ctl restore "$T/back"
is "restored" "$CODE $(said '.restored')" "0 true"
is "who was there is, but for the erased" "$(people)" \
    "$(printf '%s' "$before" | sed 's/ bob//; s/ carol//')"
ctl check-database
is "all is well" "$CODE" 0
ctl verify alice "$T/p1.ply"
is "alice is alice" "$CODE" 0
is "the events say so" "$(sqlite3 "$DB" "SELECT group_concat(kind || ':' || outcome, ' ')
    FROM (SELECT * FROM change_log ORDER BY seq DESC LIMIT 3)")" \
    "restore:restored revoke_token:front delete_subject:erased again"
is "a revoked token stays so" \
    "$("$BUILD/surfacectl" --db "$DB" --json token list | jq -r '.tokens[0].revoked')" true
is "what was there is kept" "$("$BUILD/surfacectl" --db "$DB.before-restore" \
    --key "$DB.key" --json subject list | jq -r '[.subjects[].subject] | map(select(. == "dave"))[]')" dave
is "for its owner alone" "$(stat -c %a "$DB.before-restore")" 600
ctl restore "$T/back"
is "it is not overwritten by another restore" "$CODE" 65
ok "it is said what to do" grep -q 'before-restore.*move it away first' "$T/ctl.err"
rm "$DB.before-restore"
ctl restore "$T/back"
is "a second time" "$CODE $(said .subjects_erased)" "0 2"
start_daemon --no-auth
send POST /v1/subjects/alice/verify "$PLY" "$T/p1.ply"
is "the daemon serves it" "$STATUS $(get .decision)" "200 match"
stop_daemon
rm "$DB.before-restore"

# ---- a subject that was renamed and then erased
ctl backup "$T/old-ids"
ctl subject rename alice ann
ctl enroll dan "$T/s4.ply" --force
ctl subject rename dan alice # another subject
ctl subject erase ann --yes
is "erased under the new id" "$CODE" 0
ctl restore "$T/old-ids"
is "the old id comes back with nobody" "$CODE $(said .subjects_erased)" "0 1"
is "neither id" "$(people | tr ' ' '\n' | grep -c -e '^alice$' -e '^ann$')" 0
ctl check-database
is "all is well" "$CODE" 0
ctl backup "$T/gone-on"
cp "$DB.before-restore" "$T/left"
rm "$DB.before-restore"
ctl restore "$T/left"
is "what the restore has left goes on beside it" "$CODE" 65
ok "it is said" grep -q 'both have gone on since' "$T/ctl.err"
ctl restore "$T/back"
is "an older one still" "$CODE $(people | grep -c 'alice\|bob\|carol')" "0 0"
rm "$DB.before-restore"

# ---- a backup from before a rekey: it takes its own key, and the result has the present one
ctl backup "$T/old-key"
ctl rekey --keep-old
rm "$DB.before-rekey"
ctl restore "$T/old-key"
is "its key is needed" "$CODE" 77
ok "it is said" grep -q -e '--backup-key FILE' "$T/ctl.err"
ctl restore "$T/old-key" --backup-key "$DB.key.old"
is "restored" "$CODE" 0
rm "$DB.before-restore" "$DB.key.old"
ctl check-database
is "under the present key" "$CODE" 0
ctl backup --force "$T/back"
before=$(people)

# ---- a restore that was killed when it had put the database aside, and nothing else: the
# next one knows that, also after the database went on, and needs no help.
ln "$DB" "$DB.before-restore"
ctl restore "$T/back"
is "put aside alone" "$CODE" 0
ctl restore "$T/back"
is "what one that was not killed put aside stays" "$CODE" 65
rm "$DB.before-restore"
ln "$DB" "$DB.before-restore"
ctl enroll eve "$T/s4.ply" --force
ctl restore "$T/back"
is "and gone on" "$CODE" 0
is "what is aside now is the newer one" "$("$BUILD/surfacectl" --db "$DB.before-restore" \
    --key "$DB.key" --json subject list | jq -r '.subjects[].subject' | grep -c eve)" 1
rm "$DB.before-restore"
end() { sqlite3 "$DB" 'SELECT hex(hash) FROM change_log ORDER BY seq DESC LIMIT 1'; }
for _ in 1 2 3 4 5 6; do # killed there indeed, or a little later
    was=$(end)
    "$BUILD/surfacectl" --db "$DB" restore "$T/back" >"$T/text" 2>&1 &
    pid=$!
    while [ ! -e "$DB.before-restore" ] && kill -0 "$pid" 2>/dev/null; do :; done
    kill -9 "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
    after=$(end)
    ctl restore "$T/back"
    if [ "$after" = "$was" ]; then
        is "killed before it replaced anything" "$CODE" 0
    else
        is "killed after" "$CODE" 65
    fi
    rm "$DB.before-restore"
done
ctl check-database
is "all is well after that" "$CODE" 0

# ---- where there is nothing
mv "$DB" "$T/away"
rm -f "$DB"-*
ctl restore "$T/back"
is "without a database" "$CODE" 0
is "all are back" "$(people)" "$before"
ok "nothing is aside" test ! -e "$DB.before-restore"
ctl check-database
is "well" "$CODE" 0

# ---- a backup that is no good
size=$(stat -c %s "$T/back")
sum=$(sha256sum <"$DB")
for cut in 0 1 100 4096 $((size / 2)) $((size - 4096)) $((size - 1)); do
    head -c "$cut" "$T/back" >"$T/cut"
    ctl restore "$T/cut"
    ok "cut to $cut bytes: exit $CODE" test "$CODE" -ge 65
done
# Its last byte, a zero, is missing: SQLite would put it back.
cp "$T/back" "$T/zero"
printf '\000' | dd of="$T/zero" bs=1 seek=$((size - 1)) conv=notrunc 2>/dev/null
head -c $((size - 1)) "$T/zero" >"$T/cut"
ctl restore "$T/cut"
is "a zero cut off" "$CODE" 65
ok "it is said" grep -q "cut short" "$T/ctl.err"
# A byte in the middle of every page: some are free, so it may be as good as before.
at=2000 bad=0 wrong=
while [ "$at" -lt "$size" ]; do
    cp "$T/back" "$T/flipped"
    byte=$(od -An -tu1 -j "$at" -N 1 "$T/flipped" | tr -d ' ')
    # shellcheck disable=SC2059 # an octal number
    printf "\\$(printf %o $((byte ^ 255)))" |
        dd of="$T/flipped" bs=1 seek="$at" conv=notrunc 2>/dev/null
    ctl restore "$T/flipped"
    if [ "$CODE" = 0 ]; then
        ctl check-database
        [ "$CODE" = 0 ] || wrong="$wrong $at"
        rm -f "$DB.before-restore"
        cp "$T/back" "$T/whole"
        ctl restore "$T/whole"
        rm -f "$DB.before-restore"
        sum=$(sha256sum <"$DB")
    else
        bad=$((bad + 1))
    fi
    at=$((at + 8192))
done
ok "flipped bytes were found ($bad)" test "$bad" -gt 5
is "the others made no difference" "$wrong" ""
is "the database is what it was" "$(sha256sum <"$DB")" "$sum"
ok "nothing is left" test ! -e "$DB.part" -a ! -e "$DB.before-restore"

# ---- a backup of another database
"$BUILD/surfacectl" --db "$T/other" init >/dev/null
"$BUILD/surfacectl" --db "$T/other" enroll eve "$T/s1.ply" >/dev/null
"$BUILD/surfacectl" --db "$T/other" backup "$T/other.bak" >/dev/null
ctl restore "$T/other.bak"
is "another key" "$CODE" 77
ctl restore "$T/other.bak" --backup-key "$T/other.key"
is "another database" "$CODE" 65
ok "it is said" grep -q 'not of the same database' "$T/ctl.err"
is "nothing changed" "$(sha256sum <"$DB")" "$sum"

# ---- a WAL that was left: no other file may get the name that it belongs to, and the
# next daemon empties it
start_daemon --no-auth
send POST /v1/subjects/frank/templates "$PLY" "$T/s3.ply"
is "a subject is enrolled" "$STATUS" 201
kill -9 "$PID"
wait "$PID" 2>/dev/null
PID=
cp "$DB" "$T/dead"
cp "$DB-wal" "$T/dead-wal"
ok "the killed daemon has left a WAL" test -s "$T/dead-wal"
ctl backup "$T/dead"
is "no backup over a database with a WAL" "$CODE" 65
rm "$T/dead"
"$BUILD/surfacectl" --db "$T/dead" --key "$DB.key" restore "$T/back" >/dev/null 2>"$T/ctl.err"
is "nor a restore beside one" $? 65
ok "it is said" grep -q 'dead-wal without its database' "$T/ctl.err"
ok "nothing was made" test ! -e "$T/dead" -a ! -e "$T/dead.part"
start_daemon --no-auth
ok "the next daemon empties it" sh -c "! cmp -s -n 32 '$DB-wal' '$T/dead-wal'"
stop_daemon

# ---- a backup that is killed
for wait in 0.002 0.005 0.01 0.02 0.04; do
    rm -f "$T/k"
    "$BUILD/surfacectl" --db "$DB" backup "$T/k" >/dev/null 2>&1 &
    pid=$!
    sleep "$wait"
    kill -9 "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
    whole=true # or not there
    [ ! -e "$T/k" ] || whole=$("$BUILD/surfacectl" --db "$T/k" --key "$DB.key" --json check-database |
        jq -r .ok)
    is "killed after $wait s" "$whole" true
done
ctl backup "$T/k" --force
is "what it left does not matter" "$CODE" 0
ok "nor is it left" test ! -e "$T/k.part"
finish
