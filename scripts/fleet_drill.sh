# shellcheck shell=sh
# fleet_drill.sh -- load, drill and faults of scripts/fleet, which sources it.
# shellcheck disable=SC2154 # daemons, servers, front, url: of the fleet

# ---- load

# under_load COMMAND...: runs it while $CLIENTS (4) clients work (scripts/fleet_client); then each subject
# must be as the last response to its client said.
under_load() {
    rm -rf "$dir/load"
    mkdir "$dir/load"
    : >"$dir/load/go"
    trap 'rm -f "$dir/load/go"' EXIT
    scripts/fleet_client "$dir" "$front" "${CLIENTS:-4}" &
    clients=$!
    sleep 2
    "$@"
    sleep 2
    rm "$dir/load/go"
    wait $clients
}

# unlike BUT: prints the number of responses that were neither as wanted nor one of these.
unlike() {
    awk -v but="^($1)$" '$5 != $6 && $5 !~ but' "$dir/load/all" | wc -l
}

load() {
    under_load sleep "${1:-60}"
    [ "$(unlike none)" -eq 0 ] || die "$(unlike none) requests failed: $dir/load/all"
    audit
}

audit() {
    "$BUILD/surfacectl" --db "$url" --key "$dir/d1/key" --anchor "$dir/d1/anchor" audit verify
}

# ---- drill

fail_over() {
    kill_primary
    sleep 1
    rejoin
}

# all_write: each daemon makes a change.
all_write() {
    for n in $daemons; do
        write "http://127.0.0.1:$(cat "$dir/d$n/port")" || return 1
    done
}

sees() {
    [ "$(request "http://127.0.0.1:$(cat "$dir/d$1/port")/v1/subjects/$2")" = "$3" ]
}

waiting="FROM pg_stat_activity WHERE wait_event = 'SyncRep'"

waits() {
    [ "$(sql "$1" "SELECT count(*) $waiting")" -gt 0 ]
}

# lose_commit FUNCTION: a commit that waits for a standby is ended by this function of the server.  It is
# visible then, so that both daemons see it, but on no standby, and is lost with the primary.
lose_commit() {
    was=$(primary)
    ghost=ghost$(ms)
    for n in 1 2 3; do
        [ $n = "$was" ] || kill_server $n
    done
    request --data-binary "@$dir/alice0.ply" "http://127.0.0.1:$front/v1/subjects/$ghost/templates" >"$dir/ghost" &
    client=$!
    soon 60 waits "$was" || die "the commit does not wait: $(cat "$dir/ghost")"
    sql "$was" "SELECT $1(pid) $waiting" >/dev/null
    for n in $daemons; do
        soon 60 sees "$n" "$ghost" 200 || die "the daemon $n does not see it"
    done
    kill_server "$was"
    for n in 1 2 3; do
        [ $n = "$was" ] || {
            soon 60 ended $n || die "db$n does not end"
            start_server $n
        }
    done
    promote_other "$was"
    began=$(ms)
    soon 30 all_write || die "a daemon does not write within 30 s: $(tail -n 1 "$dir"/d*/log)"
    echo "all daemons write again $(seconds $(($(ms) - began))) after the promotion"
    wait $client || :
    code=$(cat "$dir/ghost")
    is=$(request "http://127.0.0.1:$front/v1/subjects/$ghost")
    echo "the enrolment: $code; afterwards: $is"
    case $code$is in
    503404 | 201200) ;;
    *) die "the response is not true" ;;
    esac
    rejoin
}

# strike K: the K-th fault.
strike() {
    now=$(primary) || die "no server takes writes"
    away=$((now % 3 + 1)) d=$(($1 % $(echo "$daemons" | wc -w) + 1))
    case $(($1 % 20)) in
    0) fail_over ;;
    10) # one of two standbys: no commit waits
        kill_server $away
        soon 60 ended $away || die "db$away does not end"
        sleep 1
        start_server $away
        soon 60 standbys "$now" 2 || die "db$away does not follow"
        ;;
    [13579] | 1[13579]) sql "$now" "SELECT pg_terminate_backend(pid) FROM pg_stat_activity
        WHERE usename = 'surfaced' ORDER BY random() LIMIT 2" >/dev/null ;;
    *)
        kill -9 "$(cat "$dir/d$d/pid")"
        soon 60 ready "$d" || die "the daemon $d does not start"
        ;;
    esac
    sleep 0.2
}

strikes() {
    for k in $(seq "$1"); do
        strike "$k"
    done
}

faults() {
    under_load strikes "${1:-40}"
    soon 30 all_write || die "a daemon does not write"
    audit
}

# capture NONCE URL: of alice, signed by a scanner; prints the body of the response.
capture() {
    URL=$2 TOKEN=$(cat "$dir/token") NONCE=$1 packaging/examples/signed-capture door "$dir/door.key" \
        /v1/subjects/alice/verify "$dir/alice1.ply"
}

# A failed attempt and a used nonce are on a standby before their response: after a failover the token is
# still locked out, and no capture is accepted twice.
lock_out() {
    [ -e "$dir/door.key" ] || {
        openssl genpkey -algorithm ed25519 -out "$dir/door.key" 2>/dev/null
        openssl pkey -in "$dir/door.key" -pubout -out "$dir/door.pem"
        "$BUILD/surfacectl" --db "$url" --key "$dir/d1/key" --anchor "$dir/d1/anchor" device add door "$dir/door.pem" >/dev/null
    }
    nonce=$(curl -sS -H "@$dir/auth" -X POST "http://127.0.0.1:$front/v1/challenge" | sed 's/.*"nonce":"\([^"]*\)".*/\1/')
    capture "$nonce" "http://127.0.0.1:$front" >"$dir/capture"
    grep -q '"decision":"match"' "$dir/capture" || die "the signed capture: $(cat "$dir/capture")"
    k=0
    while [ "$(request --data-binary "@$dir/other.ply" "http://127.0.0.1:$front/v1/subjects/alice/verify")" = 200 ]; do
        k=$((k + 1))
        [ $k -lt 30 ] || die "nobody is locked out"
    done
    was=$(primary)
    kill_server "$was"
    promote_other "$was"
    soon 60 write "http://127.0.0.1:$front" || die "no write within 60 s"
    for n in $daemons; do
        at=http://127.0.0.1:$(cat "$dir/d$n/port")
        is=$(request --data-binary "@$dir/alice1.ply" "$at/v1/subjects/alice/verify")
        [ "$is" = 429 ] || die "alice is not locked out any more at the daemon $n: $is"
        capture "$nonce" "$at" >"$dir/capture"
        grep -q capture_replayed "$dir/capture" || die "the capture is good twice, at the daemon $n: $(cat "$dir/capture")"
    done
    echo "after $k failures and the failover alice is locked out at each daemon, and the used nonce is"
    request -X DELETE "http://127.0.0.1:$front/v1/subjects/alice/attempts" >/dev/null
    rejoin
}

drill() {
    echo "== the daemons are restarted under load: no request may fail"
    under_load restart
    [ "$(unlike none)" -eq 0 ] || die "$(unlike none) requests failed: $dir/load/all"
    echo "== the primary is killed under load: only 503, for 10 s at most"
    under_load fail_over
    [ "$(unlike 503)" -eq 0 ] || die "$(unlike 503) other failures: $dir/load/all"
    late=$(awk -v p="$(cat "$dir/promoted")" '$5 == 503 && $2 - p > late { late = $2 - p }
        END { print late + 0 }' "$dir/load/all")
    echo "the last 503 came $(seconds "$late") after the promotion"
    [ "$late" -le 10000 ] || die "that is too late"
    all_write || die "not every daemon writes"
    echo "== the primary is killed right after a lock-out"
    lock_out
    for how in pg_cancel_backend pg_terminate_backend; do
        echo "== a commit that waits for a standby is ended by $how, and the primary is lost"
        lose_commit $how
    done
    echo "== a base backup is restored"
    restore
    echo "== the database of the fleet"
    audit
}

