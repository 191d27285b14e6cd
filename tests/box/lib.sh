# lib.sh -- for the black-box scripts: surfaced on a free port with a database of its own in
# a temporary folder, requests by curl, and a count of what held.
# A script begins with `. tests/box/lib.sh`, from the top of the checkout, and ends with `finish`.
# shellcheck shell=sh disable=SC2034 # some variables are for the scripts alone

BUILD=${BUILD:-build}
T=$(mktemp -d "${TMPDIR:-/tmp}/surfaced-test.XXXXXX")
passed=0 failed=0
PID='' URL='' DB=$T/faces.db LOG=$T/log AUTH=''
PLY='Content-Type: model/x-ply' JSON='Content-Type: application/json'
BYTES='Content-Type: application/octet-stream'
# The machine's own configuration is none of the tests'.
export SURFACED_CONFIG=/dev/null

for tool in curl jq sqlite3; do
    command -v "$tool" >/dev/null 2>&1 || {
        echo "SKIP $0: $tool is not installed"
        exit 0
    }
done

# Beside a daemon, which may be writing just then.
sqlite3() {
    command sqlite3 -cmd '.timeout 10000' "$@"
}

cleanup() {
    [ -z "$PID" ] || kill -9 "$PID" 2>/dev/null
    rm -rf "$T"
}
trap cleanup EXIT
trap 'exit 1' INT TERM

# ok TITLE COMMAND...: the command must succeed.
ok() {
    title=$1
    shift
    if "$@"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL: $title"
        [ ! -f "$T/body" ] || head -c 400 "$T/body"
        echo
    fi
}

# is TITLE GOT WANTED
is() {
    ok "$1: got '$2', wanted '$3'" test "$2" = "$3"
}

# finish: stop the daemon, print the counts, and say by the exit status whether all held.
finish() {
    [ -z "$PID" ] || stop_daemon
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ]
    exit
}

# ctl OPTION...: surfacectl on $DB: its JSON is in $T/ctl, its complaints in $T/ctl.err; returns
# its exit status and sets CODE.
ctl() {
    "$BUILD/surfacectl" --db "$DB" --json "$@" >"$T/ctl" 2>"$T/ctl.err" </dev/null
    CODE=$?
    return $CODE
}

# ctl_exits STATUS OPTION...: the same, and the exit status must be this one.
ctl_exits() {
    c_wanted=$1
    shift
    ctl "$@"
    is "surfacectl $*" "$CODE" "$c_wanted"
}

# said FILTER: of the JSON of the last ctl.
said() {
    jq -r "$1" "$T/ctl"
}

# start_daemon OPTION...: sets PID and URL; fails when it does not say that it listens.
# $UNDER: a command that it is run by; $LISTEN: where, instead of on a free port.
start_daemon() {
    : >"$LOG"
    # shellcheck disable=SC2086 # a command and its options
    ${UNDER:-} "$BUILD/surfaced" --db "$DB" --listen "${LISTEN:-127.0.0.1:0}" "$@" 2>"$LOG" &
    PID=$!
    tries=0
    URL=
    while [ -z "$URL" ] && kill -0 "$PID" 2>/dev/null && [ "$tries" -lt 300 ]; do
        URL=$(sed -n 's/.*listening on \([^"]*\)".*/\1/p' "$LOG")
        tries=$((tries + 1))
        [ -n "$URL" ] || sleep 0.1
    done
    [ -n "$URL" ] || {
        echo "FAIL: the daemon does not listen:"
        cat "$LOG"
        failed=$((failed + 1))
        finish
    }
}

# stop_daemon: SIGTERM, and its exit status must be 0.
stop_daemon() {
    kill -TERM "$PID"
    wait "$PID"
    is "exit status after SIGTERM" $? 0
    PID=
    if grep -Eq 'Sanitizer|runtime error' "$LOG"; then
        cat "$LOG"
        ok "no sanitizer report" false
    fi
}

# req METHOD PATH [CURL-OPTION...]: sets STATUS; the answer is in $T/body and $T/head.
req() {
    method=$1 path=$2
    shift 2
    [ "$method" != HEAD ] || set -- --head "$@"
    STATUS=$(curl -sS -m 60 -X "$method" -o "$T/body" -D "$T/head" -w '%{http_code}' \
        ${AUTH:+-H "Authorization: Bearer $AUTH"} "$@" "$URL$path" 2>"$T/curl")
}

# send METHOD PATH TYPE FILE [CURL-OPTION...]: the same with a body.
send() {
    method=$1 path=$2 type=$3 file=$4
    shift 4
    req "$method" "$path" -H "$type" --data-binary "@$file" "$@"
}

# get .MEMBER: of the JSON answer.
get() {
    jq -r "$1" "$T/body" 2>/dev/null
}

# field NAME: a header of the answer.
field() {
    tr -d '\r' <"$T/head" | sed -n "s/^$1: //Ip"
}

# problem TITLE STATUS CODE [DETAIL-PATTERN]: the last answer is this problem document.
problem() {
    is "$1: status" "$STATUS" "$2"
    is "$1: Content-Type" "$(field Content-Type)" application/problem+json
    is "$1: code" "$(get .code)" "$3"
    is "$1: its status" "$(get .status)" "$2"
    is "$1: request_id" "$(get .request_id)" "$(field X-Request-Id)"
    [ -z "${4:-}" ] || ok "$1: detail '$(get .detail)' like '$4'" matches "$(get .detail)" "$4"
}

# fits TITLE SCHEMA: the last answer has every member that the API's description requires,
# and none that it does not know.
fits() {
    [ -f "$T/openapi" ] || curl -sS -o "$T/openapi" "$URL/openapi.json"
    # shellcheck disable=SC2016 # the variables are jq's
    ok "$1 fits the schema $2" jq -e -n --slurpfile d "$T/openapi" --slurpfile a "$T/body" \
        --arg s "$2" '$d[0].components.schemas[$s] as $s | ($a[0] | keys) as $k
        | ($s.required - $k == []) and ($k - ($s.properties | keys) == [])' >/dev/null
}

matches() {
    printf '%s\n' "$1" | grep -Eq -- "$2"
}

# alive: the daemon still answers.
alive() {
    req GET /healthz
    is "alive after $1" "$STATUS" 200
}

# scan SUBJECT SCAN FILE [FACEGEN-OPTION...]: a simulated scan; the same every time.
scan() {
    s_subject=$1 s_scan=$2 s_file=$3
    shift 3
    "$BUILD/facegen" --subject "$s_subject" --scan "$s_scan" -o "$s_file" "$@" || exit 1
}

# without_times FILE: a JSON answer without what may differ between runs.
without_times() {
    jq -cS 'walk(if type == "object" then del(.timing_ms, .template_id, .created, .request_id)
                 else . end)' "$1"
}

# soon COMMAND...: it succeeds within half a minute, tried again and again.
soon() {
    tries=0
    until "$@"; do
        tries=$((tries + 1))
        [ "$tries" -lt 300 ] || return 1
        sleep 0.1
    done
}

# holds HEX FILE...: these bytes are in one of the files, where they are there.
holds() {
    h_hex=$1
    shift
    cat "$@" 2>/dev/null | od -An -v -tx1 | tr -d ' \n' | grep -qi "$h_hex"
}

# hold_db BEGIN: another process has the database in a transaction, begun so and having read,
# until release_db.
hold_db() {
    mkfifo "$T/holder"
    sqlite3 "$DB" <"$T/holder" >"$T/held" 2>&1 &
    HOLDER=$!
    exec 7>"$T/holder"
    printf '%s;\nSELECT count(*) FROM root;\n' "$1" >&7
    soon grep -q . "$T/held"
    is "another process has the database" "$(cat "$T/held")" 1
}

release_db() {
    echo .quit >&7 # who was started meanwhile holds the pipe too: its end may come late
    exec 7>&-
    wait "$HOLDER"
    rm "$T/holder"
}
