#!/bin/sh
# Goal: where another process has locked the database, or it cannot be written, the daemon
# says so at once or after a bounded wait, and reading goes on.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

for s in 1 2 3 4 5 6; do
    scan "$s" 0 "$T/s$s.ply" --points 1500
    scan "$s" 1 "$T/p$s.ply" --points 1500
done

# ---- locked by another process
start_daemon --no-auth --workers 6
send POST /v1/subjects/s1/templates "$PLY" "$T/s1.ply"
is "enrolled before" "$STATUS" 201
hold_db 'BEGIN IMMEDIATE'
clients=
for s in 2 3 4 5 6; do # each waits as long as one: not for the others' waiting
    curl -sS -m 60 -o /dev/null -w '%{http_code} %{time_total}\n' -H "$PLY" \
        --data-binary "@$T/s$s.ply" "$URL/v1/subjects/s$s/templates" >"$T/b.$s" &
    clients="$clients $!"
done
req GET /v1/subjects/s1
is "reading goes on" "$STATUS" 200
req GET /healthz
is "so does /healthz" "$STATUS" 200
req GET /readyz
is "so does /readyz" "$STATUS" 200
# shellcheck disable=SC2086 # a list
wait $clients
is "enrolling does not" "$(cut -d ' ' -f 1 "$T"/b.* | tr '\n' ' ')" "503 503 503 503 503 "
# 5 s by the daemon's clock; the rest is for a machine that is busy.
ok "after a wait that is bounded ($(cut -d ' ' -f 2 "$T"/b.* | tr '\n' ' '))" \
    test "$(cut -d ' ' -f 2 "$T"/b.* | awk '$1 > 15' | wc -l)" -eq 0
send POST /v1/subjects/s2/templates "$PLY" "$T/s2.ply"
problem "one more" 503 busy
is "Retry-After" "$(field Retry-After)" 1
req DELETE /v1/subjects/s1
problem "nor does deleting" 503 busy
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
problem "a verification that cannot be recorded is not told" 503 busy
release_db
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
is "and is after it" "$STATUS $(get .decision)" "200 match"
ctl audit show
is "one event, of the one that was told" \
    "$(said '[.entries[] | select(.kind == "verify") | .outcome] | join(" ")')" match
send POST /v1/subjects/s2/templates "$PLY" "$T/s2.ply"
is "enrolled after it" "$STATUS" 201
req GET '/v1/subjects?limit=100'
is "nothing of the refused is there" "$(get '[.subjects[].subject] | join(" ")')" "s1 s2"

# ---- an audit log that is damaged: nothing can be appended, until somebody looks into it
last="seq = (SELECT max(seq) FROM access_log)"
mac=$(sqlite3 "$DB" "SELECT hex(mac) FROM access_log WHERE $last")
sqlite3 "$DB" "UPDATE access_log SET mac = zeroblob(32) WHERE $last"
send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
problem "a verification that cannot be recorded is not answered" 500 internal
send POST /v1/subjects/s3/templates "$PLY" "$T/s3.ply"
problem "nor does anything change" 500 internal
contains "the log says why" "$LOG" 'last entry of the access log is not authenticated'
stop_daemon
sqlite3 "$DB" "UPDATE access_log SET mac = x'$mac' WHERE $last"

# ---- read-only: as a user whom the file's mode binds, unlike root
as=
if [ "$(id -u)" = 0 ]; then
    as="setpriv --reuid 65534 --regid 65534 --clear-groups"
    chmod 711 "$T"
fi
# shellcheck disable=SC2086 # a command and its options
if $as "$BUILD/surfaced" --version >/dev/null 2>&1 && $as test -x "$T"; then
    mkdir "$T/ro"
    cp "$DB" "$T/ro/faces.db"
    cp "$DB.key" "$T/ro/faces.db.key"

    # refused TITLE PATTERN: the daemon does not start, and says so.
    refused() {
        # shellcheck disable=SC2086 # a command and its options
        timeout 60 $as "$BUILD/surfaced" --db "$T/ro/faces.db" --listen 127.0.0.1:0 2>"$T/err"
        is "$1: exit status" $? 1
        ok "$1: '$(cat "$T/err")' like '$2'" grep -Eq "$2" "$T/err"
        is "$1: the file is as it was" "$(cksum <"$T/ro/faces.db")" "$(cksum <"$DB")"
    }
    [ -z "$as" ] || chown -R 65534:65534 "$T/ro"
    chmod 444 "$T/ro/faces.db"
    refused "a read-only file" '^surfaced: cannot write .*/ro/faces.db: Permission denied'
    chmod 644 "$T/ro/faces.db"
    chmod 555 "$T/ro"
    refused "a read-only folder" '^surfaced: .*/ro/faces.db: '
    # shellcheck disable=SC2086 # a command and its options
    $as "$BUILD/surfaced" --config /dev/null --db "$T/ro/faces.db" --check-config 2>"$T/err"
    is "--check-config on it" $? 64
    chmod 755 "$T/ro"
    DB=$T/ro/faces.db UNDER=$as start_daemon --no-auth
    # Open connections stay; new ones cannot create their files any more.
    chmod 555 "$T/ro"
    send POST /v1/subjects/s1/verify "$PLY" "$T/p1.ply"
    is "read-only while it runs: verify" "$STATUS" 200
    send POST /v1/subjects/s3/templates "$PLY" "$T/s3.ply"
    is "read-only while it runs: enroll" "$STATUS" 201
    stop_daemon
    chmod 755 "$T/ro"
    is "what was enrolled is there" "$(sqlite3 "$T/ro/faces.db" 'SELECT count(*) FROM templates')" 3
else
    echo "SKIP read-only: no user here whom a file's mode binds can run the program"
fi
finish
