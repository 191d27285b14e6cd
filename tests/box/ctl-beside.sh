#!/bin/sh
# Goal: surfacectl and a running daemon share a database: each sees at once what the other
# did, a template that was deleted beside the daemon never matches again, and the daemon killed
# in the middle loses nothing that it answered.
. tests/box/lib.sh

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a1.ply" --pose 5 --shift 5
scan 2 0 "$T/b.ply"
scan 2 1 "$T/b1.ply"
start_daemon --no-auth

gives 201 "enrolled over HTTP" send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
alice=$(get .template_id)
ctl subject show alice
is "seen by surfacectl" "$(jq -r '.templates[0].template_id' "$T/ctl")" "$alice"
ctl verify alice "$T/a1.ply"
is "it verifies" $? 0
send POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
is "the daemon verifies too" "$(get .decision)" match
is "to the same digits" "$(get .score)" "$(jq -r .score "$T/ctl")"

ctl enroll bob "$T/b.ply"
is "enrolled by surfacectl" $? 0
send POST /v1/subjects/bob/verify "$PLY" "$T/b1.ply"
is "seen by the daemon" "$(get .decision)" match

ctl --yes template delete "$alice"
is "deleted by surfacectl" $? 0
gives 404 "a deleted template never matches" send POST "/v1/templates/$alice/verify" "$PLY" "$T/a1.ply"
gives 404 "nor does its subject" send POST /v1/subjects/alice/verify "$PLY" "$T/a1.ply"
ctl check-database
is "check beside the daemon" "$?/$(jq -r .ok "$T/ctl")" 0/true

# Erased by surfacectl while another reads, so that it cannot cut the log: the daemon does, at
# its next changes after the reader.
ctl enroll erased "$T/a.ply"
key=$(sql 'SELECT hex(key) FROM subjects ORDER BY subject_key DESC LIMIT 1')
hold_db BEGIN
ctl --yes subject erase erased
is "erased beside a reader" $? 0
ok "its key is in the log" holds "$key" "$DB" "$DB-wal"
release_db
for _ in 1 2; do
    gives 200 "verified" send POST /v1/subjects/bob/verify "$PLY" "$T/b1.ply"
done
is "its key is gone" "$(holds "$key" "$DB" "$DB-wal" && echo there)" ""

# Many at once from both sides.
i=0
while [ $i -lt 8 ]; do
    scan $((100 + i)) 0 "$T/c$i.ply" --points 1000
    (ctl enroll "c$i" "$T/c$i.ply" || touch "$T/lost") &
    gives 201 "enrolled while surfacectl enrolls" send POST "/v1/subjects/h$i/templates" "$PLY" "$T/c$i.ply"
    wait $!
    i=$((i + 1))
done
ok "surfacectl enrolled all" test ! -e "$T/lost"

# Two people at once as the first sample of a subject, one from each side: never both.
i=0
while [ $i -lt 8 ]; do
    (ctl enroll "both$i" "$T/a.ply") &
    send POST "/v1/subjects/both$i/templates" "$PLY" "$T/b.ply"
    wait $!
    req GET "/v1/subjects/both$i"
    is "one of two people is in" "$(get '.templates | length')" 1
    req DELETE "/v1/subjects/both$i"
    i=$((i + 1))
done

# Killed: what was answered is there.
kill -9 "$PID"
wait "$PID" 2>/dev/null
PID=
ctl subject list
is "nothing is lost" "$(jq '.subjects | length' "$T/ctl")" 18
ctl check-database
is "nothing is damaged" "$?/$(jq -r .templates "$T/ctl")" 0/17

# A newer version's database.
sqlite3 "$DB" 'PRAGMA user_version = 99'
"$BUILD/surfaced" --db "$DB" --listen 127.0.0.1:0 --no-auth >"$T/out" 2>&1
ok "the daemon refuses a newer database" test $? -ne 0
ok "and says so: $(tail -1 "$T/out")" grep -q 'version 99' "$T/out"
ctl subject list
is "surfacectl too" $? 65
finish
