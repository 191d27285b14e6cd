#!/bin/sh
# Goal: a database of an older version is upgraded as a whole or not at all, what was open in
# it is sealed afterwards, and everybody in it is still known.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

"$BUILD/facegen" --subject 1 --points 600 -o "$T/alice.ply"
"$BUILD/facegen" --subject 2 --points 600 -o "$T/bob.ply"
rm -f "$DB" "$DB.key"
sqlite3 "$DB" <tests/golden/database_v3.sql
secret=$(sed -n '3s/-- //p' tests/golden/database_v3.sql)
model=$(sqlite3 "$DB" 'SELECT hex(substr(model, 300, 40)) FROM templates LIMIT 1')

ok "what it says stands open" holds "$model" "$DB" "$DB-wal"
ctl subject list
is "an older version is not read as it is" $CODE 65
ok "nor is it changed" test ! -e "$DB.key"

# ---- a table in the way: nothing is half-done
cp "$DB" "$T/before"
sqlite3 "$DB" 'CREATE TABLE subjects_3 (nonsense TEXT)'
ctl migrate
is "it cannot be upgraded" $CODE 70
is "and stays what it was" "$(sqlite3 "$DB" 'PRAGMA user_version; SELECT id FROM subjects')" \
    "$(printf '3\nalice\nbob')"
ok "without a key" test ! -e "$DB.key"
cp "$T/before" "$DB"

# ---- a damaged row ends it too
sqlite3 "$DB" "PRAGMA ignore_check_constraints = ON; UPDATE templates SET digest = 'zz'
    WHERE template_key = 2"
ctl migrate
is "a damaged row is not sealed" $CODE 65
is "and the version stays" "$(sqlite3 "$DB" 'PRAGMA user_version')" 3
ok "no copy is left of it" test ! -e "$DB.v3.bak" -a ! -e "$DB.v3.bak.part"
cp "$T/before" "$DB"

# ---- what would be done
ctl migrate --dry-run
is "it can be asked" "$CODE $(said '.would_upgrade, .schema, .subjects' | tr '\n' ' ')" \
    "0 true 3 2 "
is "and nothing is" "$(sqlite3 "$DB" 'PRAGMA user_version')" 3
ok "nor made" test ! -e "$DB.key" -a ! -e "$DB.v3.bak"

# ---- upgraded
ctl migrate
is "upgraded" "$CODE $(said .upgraded)" "0 true"
is "the old one is kept" "$(said .backup)" "$DB.v3.bak"
is "for its owner alone" "$(stat -c %a "$DB.v3.bak")" 600
is "as it was" "$(sqlite3 "$DB.v3.bak" 'PRAGMA integrity_check; PRAGMA user_version;
    SELECT id FROM subjects')" "$(printf 'ok\n3\nalice\nbob')"
is "its key is its owner's" "$(stat -c %a "$DB.key")" 600
ok "nothing stands open any more" sh -c "! grep -aq 'left camera\|alice' '$DB'"
if holds "$model" "$DB" "$DB-wal"; then found=yes; else found=no; fi
is "nor does the model" "$found" no
ctl check
is "all is well" "$CODE $(said .templates)" "0 2"
ctl subject list
is "both are there" "$(said '[.subjects[].subject] | @csv')" '"alice","bob"'
ctl subject show alice
is "with all that was known" "$(said '.templates[0].label, .templates[0].points')" \
    "$(printf 'left camera\n600')"
ctl verify alice "$T/alice.ply"
is "alice is alice" "$CODE" 0
ctl verify alice "$T/bob.ply"
is "bob is not" "$CODE" 1
ctl attempts list
is "attempts are kept" "$(said '.attempts[] | select(.subject == "bob").failures')" 2
is "events are kept" "$(sqlite3 "$DB" "SELECT group_concat(kind, ' ') FROM events WHERE seq <= 5")" \
    "enroll enroll verify verify create_token"
ctl migrate
is "once is enough" "$CODE $(said .upgraded)" "0 false"
start_daemon
AUTH=$secret
send POST /v1/subjects/alice/verify "$PLY" "$T/alice.ply"
is "the token still opens" "$STATUS $(get .decision)" "200 match"
stop_daemon

# ---- with a key that is there already, and with none
cp "$T/before" "$DB"
ctl migrate
is "by the key that is there" "$CODE" 0
ctl verify bob "$T/bob.ply"
is "bob is bob" "$CODE" 0
cp "$T/before" "$DB"
rm -f "$DB.key"
ctl migrate --plaintext
is "without a key" "$CODE" 0
ok "none is made" test ! -e "$DB.key"
ctl verify bob "$T/bob.ply"
is "bob is bob here too" "$CODE" 0
finish
