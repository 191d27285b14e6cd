#!/bin/sh
# Goal: two daemons share one PostgreSQL: what one has done, a calibration too, is in force at the other
# with the next request, limits are those of one daemon, a nonce is good once, and when one is killed the
# other goes on; what both have written verifies.
if ! ldd "${BUILD:-build}/surfaced" | grep -q libpq; then
    echo "SKIP $0: built without PostgreSQL"
    exit
fi
[ -n "${PGHOST:-}" ] || exec scripts/with_postgres sh "$0"
. tests/box/lib.sh
needs openssl
ROUNDS=50
! sanitized || ROUNDS=12

limits='--attempts 3 --attempt-wait 3600 --attempt-subjects 1000'

# Each has its own anchor and its own log.
# shellcheck disable=SC2086 # options
start_two() {
    LOG=$T/log1
    start_daemon --anchor "$T/anchor1" $limits
    ONE=$PID URL1=$URL
    LOG=$T/log2
    start_daemon --anchor "$T/anchor2" $limits
    TWO=$PID URL2=$URL
    trap 'kill -9 $ONE $TWO 2>/dev/null; cleanup' EXIT
}

# to N METHOD PATH [CURL-OPTION...]: req to the daemon N.
to() {
    if [ "$1" = 1 ]; then URL=$URL1; else URL=$URL2; fi
    shift
    req "$@"
}

verify() {
    to "$1" POST "/v1/subjects/$2/verify" -H "$PLY" --data-binary "@$T/$3.ply"
}

for i in 0 1 2 3; do scan 1 $i "$T/a$i.ply"; done
for i in 1 2 3 4; do scan 2 $i "$T/b$i.ply"; done
scan 2 0 "$T/b.ply"
ctl_exits 0 init --anchor "$T/anchor1"
ctl_exits 0 join --anchor "$T/anchor2"
AUTH=$(new_token all --anchor "$T/anchor1")
start_two

# ---- what one has done is in force at the other
gives 201 "enrolled by one" to 1 POST /v1/subjects/alice/templates -H "$PLY" --data-binary "@$T/a0.ply"
verify 2 alice a1
is "verified by the other" "$STATUS $(get .decision)" "200 match"
verify 1 alice a1
is "and by the first" "$STATUS $(get .decision)" "200 match"
to 2 PATCH /v1/subjects/alice -H 'Content-Type: application/merge-patch+json' -d '{"disabled": true}'
is "disabled by the other" "$STATUS" 200
verify 1 alice a1
is "is no more verified" "$STATUS" 403
to 1 PATCH /v1/subjects/alice -H 'Content-Type: application/merge-patch+json' -d '{"disabled": false}'
verify 2 alice a2
is "enabled again" "$STATUS $(get .decision)" "200 match"
gives 200 "erased by the other" to 2 DELETE /v1/subjects/alice
verify 1 alice a1
is "who is erased is gone, also from memory" "$STATUS" 404
to 1 POST /v1/subjects/alice/templates -H "$PLY" --data-binary "@$T/a0.ply"
verify 2 alice a3
is "enrolled anew" "$STATUS $(get .decision)" "200 match"
ALL_TOKEN=$AUTH
AUTH=$(new_token door --scope verify)
for i in 1 2; do
    verify $i alice a1
    is "a new token" "$STATUS" 200
done
ctl_exits 0 token revoke "$(sql "SELECT id FROM tokens WHERE name = 'door'")"
for i in 1 2; do
    verify $i alice a1
    is "which is revoked" "$STATUS" 401
done
AUTH=$ALL_TOKEN

# ---- limits: 12 at once, at both, are as many as at one
for n in $(seq $ROUNDS); do
    scan $((n + 100)) 0 "$T/s.ply"
    to 1 POST "/v1/subjects/s$n/templates" -H "$PLY" --data-binary "@$T/s.ply"
    rm -f "$T"/[soh].*
    for k in $(seq 12); do
        if [ $((k % 2)) -eq 0 ]; then URL=$URL1; else URL=$URL2; fi
        beside "$k" POST "/v1/subjects/s$n/verify" -H "$PLY" --data-binary "@$T/b.ply"
    done
    all_sent
    is "round $n: exactly the limit" "$TALLY" "200x3 429x9"
done
is "and so it is written" "$(sql 'SELECT min(failures), max(failures), count(*) FROM attempts')" "3|3|$ROUNDS"

# ---- a nonce is good once, wherever
openssl genpkey -algorithm ed25519 -out "$T/door.key" 2>"$T/out"
openssl pkey -in "$T/door.key" -pubout -out "$T/door.pem"
ctl_exits 0 device add door "$T/door.pem"
for n in 1 2 3 4 5 6; do
    to $((n % 2 + 1)) POST /v1/challenge
    nonce=$(get .nonce)
    printf 'surfaced capture 2\nPOST %s\n%s\n%s\n%s\n%s\n%s\n\n' /v1/subjects/alice/verify door "$nonce" pass \
        "$(sha256sum "$T/a1.ply" | cut -d ' ' -f 1)" "${PLY#*: }" >"$T/text"
    openssl pkeyutl -sign -rawin -inkey "$T/door.key" -in "$T/text" -out "$T/sig"
    capture="Capture-Signature: device=door; nonce=$nonce; liveness=pass; sig=$(openssl base64 -A -in "$T/sig")"
    rm -f "$T"/[soh].*
    for k in 1 2; do
        if [ $k = 1 ]; then URL=$URL1; else URL=$URL2; fi
        beside $k POST /v1/subjects/alice/verify -H "$PLY" -H "$capture" --data-binary "@$T/a1.ply"
    done
    all_sent
    is "nonce $n, at both at once" "$TALLY" "200x1 403x1"
done

# ---- a calibration is in force at both at once; templates are re-encoded beside both
ctl_exits 0 calibrate --fmr 0.05 --yes
new=$(said '.threshold * 10 | round')
for i in 1 2; do
    verify $i alice a1
    is "the new threshold, at the daemon $i" "$(get ".threshold * 10 - $new | fabs < 1")" true # it is rounded
done
ok "which is another" test "$new" -ne 80
ctl_exits 0 calibrate --reset --yes
for i in 1 2; do
    verify $i alice a$((i + 1))
    is "the shipped one again, at the daemon $i" "$(get .decision) $(get .threshold)" "match 8"
done
awk '/^change/ { on = 0 } on { for (i = 1; i <= NF; i++) if ($i != ".") $i += 1500 } /^mean/ { on = 1 }
    { print }' core/face/default.model >"$T/raised.model"
ctl_exits 0 enroll bob "$T/b.ply" --model "$T/raised.model"
for i in 1 2; do
    verify $i bob "b$i"
    is "a template of another engine, at the daemon $i" "$STATUS $(get .decision)" "200 match"
done
ctl_exits 0 template reencode
is "one was re-encoded" "$(said '[.templates, .current, .failed] | tojson')" '[1,0,0]'
for i in 1 2; do
    verify $i bob "b$((i + 2))"
    is "which both use" "$STATUS $(get .decision)" "200 match"
done

# ---- work at both, while one is killed
# worker N: enrolls, verifies and erases subjects of its own at either daemon; a line for each that
# was not as it should be, where its daemon was not killed.
worker() {
    w=$1
    for j in $(seq 12); do
        for step in enroll verify erase; do
            d=$(((w + j) % 2 + 1))
            if [ $d = 1 ]; then base=$URL1; else base=$URL2; fi
            case $step in
            enroll) set -- 201 -X POST "$base/v1/subjects/w$w-$j/templates" --data-binary "@$T/a0.ply" ;;
            verify) set -- 200 -X POST "$base/v1/subjects/w$w-$j/verify" --data-binary "@$T/a1.ply" ;;
            erase) set -- 200 -X DELETE "$base/v1/subjects/w$w-$j" ;;
            esac
            wanted=$1
            shift
            got=$(curl -sS -m 60 -o /dev/null -w '%{http_code}' -H "Authorization: Bearer $AUTH" -H "$PLY" "$@" 2>/dev/null)
            [ "$got" = "$wanted" ] || [ "$d" = 2 ] || echo "w$w-$j $step: $got"
        done
    done
}
: >"$T/wrong"
workers=''
for w in 1 2 3 4 5 6; do
    worker $w >>"$T/wrong" &
    workers="$workers $!"
done
sleep 0.7
kill -9 "$TWO"
# shellcheck disable=SC2086 # a list
wait $workers
is "all that the first daemon was asked for was done" "$(cat "$T/wrong")" ''
LOG=$T/log1
verify 1 alice a2
is "it goes on" "$STATUS $(get .decision)" "200 match"
LOG=$T/log2
# shellcheck disable=SC2086 # options
start_daemon --anchor "$T/anchor2" $limits
URL2=$URL TWO=$PID
verify 2 alice a1
is "the other is there again" "$STATUS $(get .decision)" "200 match"
ctl_exits 0 audit verify
ctl_exits 0 check-database
ctl_exits 0 audit verify --anchor "$T/anchor1"
ok "each has an access log of its own" test "$(sql 'SELECT count(DISTINCT daemon) FROM access_log')" -eq 2
ctl_exits 0 audit compare "$T/anchor1" "$T/anchor2"

# ---- the server is put back to an older state
gives 201 "enrolled before the backup" to 1 POST /v1/subjects/carol/templates -H "$PLY" --data-binary "@$T/b.ply"
stop_daemon
PID=$ONE LOG=$T/log1
stop_daemon
OLD=$DB-old
psql -X -q -d postgres -c "CREATE DATABASE \"${OLD##*/}\" TEMPLATE \"${DB##*/}\""
start_two
gives 200 "erased after it" to 2 DELETE /v1/subjects/carol
verify 1 alice a3
is "and a verification, which the log has" "$STATUS" 200
ctl_exits 0 token revoke "$(sql "SELECT id FROM tokens WHERE name = 'all'")"
ctl_exits 0 audit export -o "$T/log.jsonl"
public=$(head -n 1 "$T/log.jsonl" | gojq -r .public_key)
stop_daemon
PID=$ONE LOG=$T/log1
stop_daemon
"$BUILD/surfacectl" audit verify "$T/log.jsonl" --public-key "$public" >"$T/out" 2>&1
is "the export of both daemons verifies" $? 0
DB=$OLD
start_fails "the older state is refused" 1 'older than its anchor' --db "$DB" --key "$KEY" --anchor "$T/anchor1" \
    --listen 127.0.0.1:0
ctl_exits 1 audit compare "$T/anchor1" "$T/anchor2"
is "both daemons have seen a later one" "$(said '[.anchors[].in_log] | tojson')" '[false,false]'
sed 's/"outcome":"deleted"/"outcome":"dElEted"/' "$T/log.jsonl" >"$T/forged.jsonl"
ctl reapply-erasures "$T/forged.jsonl" --anchor "$T/anchor2"
ctl_failed "an export that was changed" 77 'not authentic'
ctl_exits 0 reapply-erasures "$T/log.jsonl" --anchor "$T/anchor2" --dry-run
is "who would be erased" "$(said '[.subjects_erased, .tokens_revoked] | tojson')" '[1,1]'
ctl_exits 0 reapply-erasures "$T/log.jsonl" --anchor "$T/anchor2"
is "who is erased again" "$(said '[.subjects_erased, .tokens_revoked] | tojson')" '[1,1]'
ctl_exits 0 reapply-erasures "$T/log.jsonl" --anchor "$T/anchor2" # as one that was interrupted at its end
is "a second time there is nothing left to do" "$(said .already)" true
ctl_exits 0 accept-state --yes --anchor "$T/anchor1"
ctl_exits 0 audit compare "$T/anchor1" "$T/anchor2"
start_two
verify 1 alice a1
is "the token is revoked again" "$STATUS" 401
AUTH=$(new_token again --anchor "$T/anchor1")
gives 404 "who was erased is gone" to 2 GET /v1/subjects/carol
verify 2 alice a1
is "the others are there" "$STATUS $(get .decision)" "200 match"
ctl_exits 0 audit verify
was=$(said .entries)
ctl_exits 0 copy "$T/file.db"
DB=$T/file.db ctl_exits 0 audit verify
is "a file has the accesses of both too" "$(said .entries)" "$was"
DB=$T/file.db ctl_exits 0 check-database

# ---- a new key for all, by way of the file
stop_daemon
PID=$ONE LOG=$T/log1
stop_daemon
DB=$T/file.db
ctl_exits 0 rekey --yes
DB=$OLD ctl subject list
ctl_failed "the new key does not open the former database" 77 key
createdb "${OLD##*/}-new"
ctl_exits 0 copy "$OLD-new"
DB=$OLD-new
rm "$T/anchor1" "$T/anchor2"
for i in 1 2; do ctl_exits 0 join --anchor "$T/anchor$i"; done
start_two
for i in 1 2; do
    verify $i alice "a$((i + 1))"
    is "under the new key, at the daemon $i" "$STATUS $(get .decision)" "200 match"
done
ctl_exits 0 audit verify --anchor "$T/anchor1"
finish
