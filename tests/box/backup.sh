#!/bin/sh
# Goal: a backup that is made while the daemon enrolls is complete and verified; `restore` brings it
# back, but no subject that was erased since, under whatever id, and no token that was revoked since.
# More of restore is in test_restore.c, and what a kill leaves in crash.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# people: the subjects in the database.
people() { ctl subject list && said '[.subjects[].subject] | join(" ")'; }
# of BACKUP ARGUMENT...: surfacectl on it.
of() {
    o_db=$1
    shift
    "$BUILD/surfacectl" --db "$o_db" --key "$DB.key" --json "$@" >"$T/ctl"
}

for s in 1 2 3 4; do scan "$s" 0 "$T/s$s.ply" --points 1000; done
scan 1 1 "$T/p1.ply" --points 1000
ctl_exits 0 init
ctl_exits 0 enroll alice "$T/s1.ply"
ctl_exits 0 enroll bob "$T/s2.ply"
ctl_exits 0 enroll carol "$T/s3.ply"
ctl_exits 0 token create front --scope "$ALL"
AUTH=$(said .secret) id=$(said .id)

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
soon test -s "$T/enrolled"
for i in 1 2 3; do ctl_exits 0 backup "$T/b$i"; done
n=$(said .subjects)
touch "$T/enough"
wait "$loop"
is "its file is its owner's" "$(stat -c %a "$T/b3")" 600
ok "it has who was there ($n)" test "$n" -ge 4
ok "one file" test ! -e "$T/b3-wal" -a ! -e "$T/b3-shm" -a ! -e "$T/b3.part"
of "$T/b3" check-database
is "it is well" "$(said .ok)" true
of "$T/b3" stats
is "and its counts are those told" "$(said .counts.subjects)" "$n"
ok "it holds no plaintext" sh -c "! grep -aq 'alice\|more1' '$T/b3'"

# ---- not while another process has it open
ctl_exits 75 restore "$T/b3"
contains "it is said what to do" "$T/ctl.err" 'stop surfaced first'
ctl_exits 0 restore "$T/b3" --dry-run
is "what it would do can be asked" "$(said .restored)" false
gives 200 "the daemon serves as before" req GET /v1/subjects/alice
stop_daemon

# ---- what is overwritten, and what is not
ctl_exits 65 backup "$T/b3"
ctl_exits 0 backup "$T/b3" --force
echo mine >"$T/notes"
ctl_exits 65 backup "$T/notes" --force
is "another file is as it was" "$(cat "$T/notes")" mine
ctl_exits 65 backup "$DB" --force
ctl_exits 74 backup "$T/nowhere/b"

# ---- back to what was
ctl_exits 0 backup "$T/back"
before=$(people)
ctl_exits 0 subject erase --yes bob
ctl_exits 0 enroll dave "$T/s4.ply" --force
ctl_exits 0 subject erase --yes carol
ctl_exits 0 enroll carol "$T/s3.ply" # erased, and there again
ctl_exits 0 token revoke "$id"
for dry in --dry-run ''; do
    # shellcheck disable=SC2086 # an option or none
    ctl_exits 0 restore "$T/back" $dry
    is "what changes ($dry)" "$(said '.subjects_lost, .subjects_erased, .tokens_revoked' | tr '\n' ' ')" "2 2 1 "
done
is "who was there is, but for the erased" "$(people)" \
    "$(printf '%s' "$before" | sed 's/ bob//; s/ carol//')"
ctl_exits 0 check-database
ctl_exits 0 verify alice "$T/p1.ply"
is "the events say so" "$(sql "SELECT group_concat(kind || ':' || outcome, ' ')
    FROM (SELECT * FROM change_log ORDER BY seq DESC LIMIT 3)")" \
    "restore:restored revoke_token:front delete_subject:erased again"
of "$DB.before-restore" subject list
is "what was there is kept" "$(said '.subjects[].subject' | grep -c '^dave$')" 1
is "for its owner alone" "$(stat -c %a "$DB.before-restore")" 600
cp "$DB.before-restore" "$T/was"
last=$(sql "SELECT max(seq) FROM change_log")
ctl_exits 0 restore "$T/back" # as one that was interrupted at its very end
is "nothing was left to do" "$(said .already) $(sql "SELECT max(seq) FROM change_log")" "true $last"
ctl_exits 0 token create since --scope verify
ctl_exits 65 restore "$T/back"
contains "it is not overwritten" "$T/ctl.err" 'before-restore.*move it away first'
ok "what was there is as it was" cmp -s "$DB.before-restore" "$T/was"
rm "$DB.before-restore"

# ---- a subject that was renamed and then erased
ctl_exits 0 backup "$T/old-ids"
ctl_exits 0 subject rename alice ann
ctl_exits 0 enroll dan "$T/s4.ply" --force
ctl_exits 0 subject rename dan alice # another subject
ctl_exits 0 subject erase ann --yes
ctl_exits 0 restore "$T/old-ids"
is "the old id comes back with nobody" "$(said .subjects_erased)" 1
is "neither id" "$(people | tr ' ' '\n' | grep -c -e '^alice$' -e '^ann$')" 0
rm "$DB.before-restore"

# ---- a backup from before a rekey: it takes its own key
ctl_exits 0 rekey --keep-old
ctl_exits 77 restore "$T/back"
contains "it is said" "$T/ctl.err" '--backup-key FILE'
ctl_exits 0 restore "$T/back" --backup-key "$DB.key.old"
rm "$DB.before-restore"
ctl_exits 0 check-database # under the present key

# ---- a backup that is cut short, its last byte, a zero, too: SQLite would put it back
ctl_exits 0 backup --force "$T/back"
size=$(stat -c %s "$T/back")
sum=$(sha256sum <"$DB")
printf '\000' | dd of="$T/back" bs=1 seek=$((size - 1)) conv=notrunc 2>/dev/null
for cut in 0 1 100 4096 $((size / 2)) $((size - 4096)) $((size - 1)); do
    head -c "$cut" "$T/back" >"$T/cut"
    ctl restore "$T/cut"
    ok "cut to $cut bytes: exit $CODE" test "$CODE" -ge 65
done
contains "it is said" "$T/ctl.err" 'cut short'
is "the database is what it was" "$(sha256sum <"$DB")" "$sum"
ok "nothing is left" test ! -e "$DB.part" -a ! -e "$DB.before-restore"

# ---- a WAL that was left: no other file may get the name that it belongs to, and the
# next daemon empties it
start_daemon --no-auth
gives 201 "a subject is enrolled" send POST /v1/subjects/frank/templates "$PLY" "$T/s3.ply"
kill_daemon
cp "$DB" "$T/dead"
cp "$DB-wal" "$T/dead-wal"
ok "the killed daemon has left a WAL" test -s "$T/dead-wal"
ctl_exits 65 backup "$T/dead"
rm "$T/dead"
"$BUILD/surfacectl" --db "$T/dead" --key "$DB.key" restore "$T/b3" >"$T/out" 2>"$T/ctl.err"
is "nor a restore beside one" $? 65
contains "it is said" "$T/ctl.err" 'dead-wal of another database of that name: move it away first'
ok "nothing was made" test ! -e "$T/dead" -a ! -e "$T/dead.part"
start_daemon --no-auth
ok "the next daemon empties it" sh -c "! cmp -s -n 32 '$DB-wal' '$T/dead-wal'"
finish
