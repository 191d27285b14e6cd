# lib.sh -- for the black-box scripts: starts surfaced on a free port with its own database in a
# temporary folder, sends requests with curl, and counts the checks that passed and failed.
# A script begins with `. tests/box/lib.sh`, from the top of the checkout, and ends with `finish`.
# shellcheck shell=sh disable=SC2034 # some variables are only used by the scripts

BUILD=${BUILD:-build}
T=$(mktemp -d "${TMPDIR:-/tmp}/surfaced-test.XXXXXX")
passed=0 failed=0
PID='' URL='' DB=$T/faces.db KEY=$T/faces.db.key LOG=$T/log AUTH=''
PLY='Content-Type: model/x-ply' JSON='Content-Type: application/json'
BYTES='Content-Type: application/octet-stream' CR=$(printf '\r')
# The tests must not read the machine's own configuration.
export SURFACED_CONFIG=/dev/null
# The entries of both logs, for SQL.
ENTRIES="(SELECT 0 AS log, seq, at, kind, actor, uid, object, outcome, hash FROM change_log
    UNION ALL SELECT 1, seq, at, kind, actor, uid, object, outcome, hash FROM access_log) AS entries"
# Every scope that a token may have.
ALL=verify,enroll,identify,read,delete,manage,tokens,audit,events,score,detail

# needs PROGRAM...: without them the script ends, with exit status 0.
needs() {
    for tool in "$@"; do
        command -v "$tool" >/dev/null 2>&1 || {
            echo "SKIP $0: $tool is not installed"
            exit 0
        }
    done
}
needs curl gojq jq sqlite3

# needs_section SECTION PROGRAM...: as needs; with CI=true that is a failure.  SECTION: of
# scripts/packages.txt.
needs_section() {
    section=$1
    shift
    [ "${CI:-}" = true ] || needs "$@"
    for tool in "$@"; do
        command -v "$tool" >/dev/null 2>&1 || {
            echo "FAIL: $tool is not installed: scripts/setup $section"
            echo "0 passed, 1 failed"
            exit 1
        }
    done
}

# sanitized: the daemon was built with a sanitizer.
sanitized() {
    nm "$BUILD/surfaced" 2>/dev/null | grep -Eq '__(asan|tsan|ubsan)_'
}

# Under scripts/with_postgres the database is one on that server.
if [ -n "${PGHOST:-}" ]; then
    DB=postgresql:///$(basename "$T")
    export SURFACED_KEY="$KEY"
    psql -X -q -d postgres -c "CREATE DATABASE \"$(basename "$T")\"" || exit 1
fi

# sql STATEMENTS: on $DB, as another program runs them; a row a line, columns with | between.
sql() {
    case $DB in
    postgresql:*) psql -X -q -A -t -v ON_ERROR_STOP=1 -d "$DB" -c "$1" ;;
    *) sqlite3 "$DB" "$1" ;;
    esac
}

# jq ARGUMENT...: by gojq, which starts in an eighth of jq's time; it sorts the members of objects.
jq() {
    gojq "$@"
}

# sqlite3 ARGUMENT...: waits while the daemon writes.
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

# contains TITLE FILE PATTERN: FILE has a line that matches PATTERN.
contains() {
    ok "$1: '$(head -c 400 "$2")' like '$3'" grep -Eq -- "$3" "$2"
}

# jq_true ARGUMENT...: the result of jq's filter is true.
jq_true() {
    jq -e "$@" >/dev/null
}

# finish: stops the daemon, prints the counts, and exits with 0 if no check failed, else 1.
finish() {
    [ -z "$PID" ] || stop_daemon
    echo "$passed passed, $failed failed"
    [ "$failed" -eq 0 ]
    exit
}

# ctl OPTION...: runs surfacectl on $DB; its JSON is in $T/ctl, its messages in $T/ctl.err.
# Returns its exit status and sets CODE.
ctl() {
    "$BUILD/surfacectl" --db "$DB" --json "$@" >"$T/ctl" 2>"$T/ctl.err" </dev/null
    CODE=$?
    return $CODE
}

# ctl_exits STATUS OPTION...: the same; the exit status must be STATUS.
ctl_exits() {
    c_wanted=$1
    shift
    ctl "$@"
    is "surfacectl $*" "$CODE" "$c_wanted"
}

# ctl_failed TITLE STATUS DETAIL-PATTERN: the last ctl failed so, with this detail of its error.
ctl_failed() {
    is "$1" "$CODE" "$2"
    ok "$1: '$(said .error.detail)' like '$3'" matches "$(said .error.detail)" "$3"
}

# said FILTER: applies jq's FILTER to the JSON of the last ctl.
said() {
    jq -r "$1" "$T/ctl"
}

# new_token NAME [OPTION...]: makes a token and prints its secret; with every scope, unless an
# option says otherwise.
new_token() {
    case " $* " in
    *' --scope '*) ;;
    *) set -- "$@" --scope "$ALL" ;;
    esac
    "$BUILD/surfacectl" --db "$DB" token create "$@" 2>/dev/null
}

# conf LINE...: writes the configuration file $T/conf.
conf() {
    printf '%s\n' "$@" >"$T/conf"
}

# start_fails TITLE STATUS PATTERN OPTION...: the daemon exits with STATUS, prints a line that
# matches PATTERN (it is in $T/out), and does not listen.
start_fails() {
    f_title=$1 f_status=$2 f_pattern=$3
    shift 3
    timeout 60 "$BUILD/surfaced" "$@" >"$T/out" 2>&1
    is "$f_title: exit status" $? "$f_status"
    contains "$f_title" "$T/out" "$f_pattern"
    ok "$f_title: does not listen" sh -c "! grep -q 'listening on' '$T/out'"
}

# in_folder: the rest of the script runs in $T, without a daemon; $ctl is surfacectl, $lab surfacelab.
in_folder() {
    BUILD=$(cd "$BUILD" && pwd)
    ctl=$BUILD/surfacectl lab=$BUILD/surfacelab
    cd "$T" || exit 1
    unset SURFACED_DB
}

# expect STATUS TITLE COMMAND...: run it; its output is in the files out and err.
expect() {
    e_wanted=$1 what=$2
    shift 2
    "$@" >out 2>err </dev/null
    e_got=$?
    is "$what: exit status ($(head -c 400 err))" "$e_got" "$e_wanted"
}

# has FILE TEXT: the output of the last expect has it.
has() {
    ok "$what: no '$2' in $1: $(head -n 20 "$1")" grep -q -e "$2" "$1"
}

# files FOLDER: the names in it.
files() {
    find "$1" -mindepth 1 -printf '%f\n' | LC_ALL=C sort | paste -sd ' '
}

# start_daemon OPTION...: starts the daemon and sets PID and URL; the script ends if the daemon
# does not listen.  $UNDER: a command to run it under; $LISTEN: its address, instead of a free
# port.
start_daemon() {
    : >"$LOG"
    # shellcheck disable=SC2086 # UNDER is a command and its options
    ${UNDER:-} "$BUILD/surfaced" --create --db "$DB" --listen "${LISTEN:-127.0.0.1:0}" "$@" 2>"$LOG" &
    PID=$!
    tries=0
    URL=
    while [ -z "$URL" ] && kill -0 "$PID" 2>/dev/null && [ "$tries" -lt 600 ]; do
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

# start_clocked OPTION...: start_daemon, its wall clock as clock says (of faketime); its monotonic one
# is the machine's.
start_clocked() {
    clock +0
    export FAKETIME_TIMESTAMP_FILE="$T/shift" FAKETIME_NO_CACHE=1 FAKETIME_DONT_FAKE_MONOTONIC=1
    UNDER="env LD_PRELOAD=$(faketime -f +0 printenv LD_PRELOAD)" start_daemon "$@"
}

# clock SHIFT: from now on, of such a daemon: +3d, say.
clock() {
    echo "$1" >"$T/shift.new"
    mv "$T/shift.new" "$T/shift"
}

# stop_daemon: sends SIGTERM; the daemon's exit status must be 0.
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

# kill_daemon: by SIGKILL.
kill_daemon() {
    kill -9 "$PID"
    wait "$PID" 2>/dev/null
    PID=''
}

# killed_after SECONDS ARGUMENT...: surfacectl on $DB, by SIGKILL if it still runs then.
killed_after() {
    k_wait=$1
    shift
    "$BUILD/surfacectl" --db "$DB" "$@" >/dev/null 2>&1 &
    k_pid=$!
    sleep "$k_wait"
    kill -9 "$k_pid" 2>/dev/null
    wait "$k_pid" 2>/dev/null
}

# req METHOD PATH [CURL-OPTION...]: sends a request and sets STATUS; the response is in $T/body
# and $T/head.
req() {
    method=$1 path=$2
    shift 2
    [ "$method" != HEAD ] || set -- --head "$@"
    STATUS=$(curl -sS -m 60 -X "$method" -o "$T/body" -D "$T/head" -w '%{http_code}' \
        ${AUTH:+-H "Authorization: Bearer $AUTH"} "$@" "$URL$path" 2>"$T/curl")
}

# beside NAME METHOD PATH [CURL-OPTION...]: sends a request without waiting for the response: its
# status will be in $T/s.NAME, its body and headers in $T/o.NAME and $T/h.NAME.
beside() {
    b_name=$1 b_method=$2 b_path=$3
    shift 3
    curl -sS -m 60 -X "$b_method" -o "$T/o.$b_name" -D "$T/h.$b_name" -w '%{http_code}\n' \
        ${AUTH:+-H "Authorization: Bearer $AUTH"} "$@" "$URL$b_path" >"$T/s.$b_name" 2>/dev/null &
    clients="${clients:-} $!"
}

# all_sent: waits for those; sets TALLY to how many had each status: "200x3 429x21".
all_sent() {
    # shellcheck disable=SC2086 # a list
    wait $clients
    clients=''
    TALLY=$(cat "$T"/s.* | sort | uniq -c | awk '{ print $2 "x" $1 }' | paste -sd ' ')
}

# at_once N METHOD PATH [CURL-OPTION...]: the same request N times at once.
at_once() {
    a_n=$1
    shift
    rm -f "$T"/[soh].*
    for a_i in $(seq "$a_n"); do
        beside "$a_i" "$@"
    done
    all_sent
}

# send METHOD PATH TYPE FILE [CURL-OPTION...]: req with FILE as the body.
send() {
    method=$1 path=$2 type=$3 file=$4
    shift 4
    req "$method" "$path" -H "$type" --data-binary "@$file" "$@"
}

# gives "STATUS[ CODE]" TITLE COMMAND...: the COMMAND, req or send, gets a response of this status, or this problem
# document.
gives() {
    g_wanted=$1 g_title=$2
    shift 2
    "$@"
    case $g_wanted in
    *' '*) problem "$g_title" "${g_wanted% *}" "${g_wanted#* }" ;;
    *) is "$g_title" "$STATUS" "$g_wanted" ;;
    esac
}

# get FILTER: applies jq's FILTER to the JSON body of the last response.
get() {
    jq -r "$1" "$T/body" 2>/dev/null
}

# npm_packages PACKAGE@VERSION...: installs them into $T.  Ends the test, and says so, without npm or a network.
npm_packages() {
    needs npm
    (cd "$T" && HOME=$T timeout 120 npm install --silent --no-audit --no-fund --ignore-scripts \
        --fetch-retries 1 "$@" >npm.log 2>&1) || {
        cat "$T/npm.log"
        echo "SKIP $0: npm cannot install $*: is there a network?"
        exit 0
    }
}

# browser_tests LEAST FILE ARGUMENT...: runs FILE, a test in a browser, and counts its checks, at least LEAST; its
# pictures are kept in $BUILD/console.
browser_tests() {
    least=$1
    shift
    mkdir -p "$T/home" "$BUILD/console"
    HOME=$T/home /usr/bin/python3 "$@" >"$T/checks" 2>"$T/err"
    cat "$T/err"
    grep -v '^ok ' "$T/checks"
    passed=$((passed + $(grep -c '^ok ' "$T/checks")))
    failed=$((failed + $(grep -c '^FAIL ' "$T/checks")))
    ok "the browser's tests ran" test "$passed" -gt "$least"
    cp "$T"/*.png "$BUILD/console"
}

# field NAME: prints the values of a header of the last response.  No other program, as one takes longer to
# start than the daemon to answer.
field() {
    while IFS= read -r v_line; do
        case $v_line in
        "$1: "*)
            v_line=${v_line#*: }
            printf '%s\n' "${v_line%"$CR"}"
            ;;
        esac
    done <"$T/head"
}

# ending: a change of a subject that expires a second later.
ending() {
    date -u -d '+1 second' +'{"expires_at": "%Y-%m-%dT%H:%M:%S.%3NZ"}'
}

# problem TITLE STATUS CODE [DETAIL-PATTERN]: the last response is this problem document.
problem() {
    { # of one jq, which takes longer to start than the daemon to answer
        IFS= read -r p_code
        IFS= read -r p_status
        IFS= read -r p_id
        IFS= read -r p_detail
    } <<END
$(get '.code, .status, .request_id, .detail')
END
    is "$1: status" "$STATUS" "$2"
    is "$1: Content-Type" "$(field Content-Type)" application/problem+json
    is "$1: code" "$p_code" "$3"
    is "$1: its status" "$p_status" "$2"
    is "$1: request_id" "$p_id" "$(field X-Request-Id)"
    [ -z "${4:-}" ] || ok "$1: detail '$p_detail' like '$4'" matches "$p_detail" "$4"
}

# again TITLE LEAST [MOST]: the last response says to try again in LEAST to MOST (LEAST) seconds, and an
# eighth and two more, so that not all come back together.
again() {
    again_s=$(field Retry-After)
    ok "$1: Retry-After $again_s, $2 to ${3:-$2}" test "${again_s:-0}" -ge "$2" -a \
        "${again_s:-0}" -le $((${3:-$2} * 9 / 8 + 2))
}

# fits TITLE SCHEMA: the last response has every member that SCHEMA of the API's description
# requires, and no other than those it describes.
fits() {
    [ -f "$T/openapi" ] || curl -sS -o "$T/openapi" "$URL/openapi.json"
    # shellcheck disable=SC2016 # the variables are jq's
    ok "$1 fits the schema $2" jq -e -n --slurpfile d "$T/openapi" --slurpfile a "$T/body" \
        --arg s "$2" '$d[0].components.schemas[$s] as $s | ($a[0] | keys) as $k
        | ($s.required - $k == []) and ($k - ($s.properties | keys) == [])' >/dev/null
}

# matches TEXT PATTERN: a line of TEXT matches PATTERN.
matches() {
    grep -Eq -- "$2" <<END
$1
END
}

# metric SERIES: its value in /metrics; nothing if there is no such series.  WATCHER: a token with
# audit, where $AUTH has not that scope.
metric() {
    m_auth=$AUTH AUTH=${WATCHER:-$AUTH}
    req GET /metrics
    AUTH=$m_auth
    awk -v name="$1" '$1 == name { print $2 }' "$T/body"
}

# serves: the daemon accepts a connection and serves a request.
serves() {
    req GET /healthz
    [ "$STATUS" = 200 ]
}

# hold N FORMAT [OPTION...]: opens N connections that send printf's FORMAT and stay open, from $FROM if that
# is set; what hold.py says of them is in $T/held.
hold() {
    h_n=$1
    # shellcheck disable=SC2059 # with \r\n in it
    printf "$2" >"$T/text"
    shift 2
    : >"$T/held"
    python3 tests/box/hold.py "${URL#http://}" "$h_n" ${FROM:+--from "$FROM"} "$@" <"$T/text" >"$T/held" 2>&1 &
    HOLD=$!
}

# held TITLE LINE: hold.py says LINE soon.
held() {
    ok "$1" soon grep -qx "$2" "$T/held"
}

# let_go: closes these connections.
let_go() {
    kill "$HOLD" 2>/dev/null
    wait "$HOLD" 2>/dev/null
}

# alive WHAT: the daemon still serves requests after WHAT.
alive() {
    req GET /healthz
    is "alive after $1" "$STATUS" 200
}

# scan SUBJECT SCAN FILE [FACEGEN-OPTION...]: writes a simulated scan; it is the same every time.
scan() {
    s_subject=$1 s_scan=$2 s_file=$3
    shift 3
    "$BUILD/facegen" --subject "$s_subject" --scan "$s_scan" -o "$s_file" "$@" || exit 1
}

# thirty_people: a new database of p1 to p30, each but the first with two templates.
thirty_people() {
    ctl init
    for i in $(seq 30); do
        scan "$i" 0 "$T/first.ply" --points 1500
        scan "$i" 1 "$T/second.ply" --points 1500 --pose 5
        ctl enroll "p$i" "$T/first.ply"
        [ "$i" = 1 ] || ctl enroll "p$i" "$T/second.ply" --force
    done
}

# without_times FILE: a JSON response without the members that differ between runs.
without_times() {
    jq -c 'walk(if type == "object" then del(.timing_ms, .template_id, .created, .request_id)
                 else . end)' "$1"
}

# soon COMMAND...: repeats the command until it succeeds; fails after 30 seconds.
soon() {
    tries=0
    until "$@"; do
        tries=$((tries + 1))
        [ "$tries" -lt 300 ] || return 1
        sleep 0.1
    done
}

# working N: N requests are with a worker or wait for one.
working() {
    soon sh -c "[ \"\$(curl -sS -H 'Authorization: Bearer ${WATCHER:-$AUTH}' '$URL/metrics' |
        awk '/^surfaced_(queue_depth|workers_busy) / { n += \$2 } END { print n }')\" -ge $1 ]"
}

# holds HEX FILE...: one of the files contains these bytes; missing files are ignored.
holds() {
    h_hex=$1
    shift
    cat "$@" 2>/dev/null | od -An -v -tx1 | tr -d ' \n' | grep -qi "$h_hex"
}

# hold_db BEGIN: another process starts a transaction by the statement BEGIN, reads, and keeps
# the transaction open until release_db.
hold_db() {
    mkfifo "$T/holder"
    sqlite3 "$DB" <"$T/holder" >"$T/held" 2>&1 &
    HOLDER=$!
    exec 7>"$T/holder"
    printf '%s;\nSELECT count(*) FROM root;\n' "$1" >&7
    soon grep -q . "$T/held"
    is "another process has an open transaction" "$(cat "$T/held")" 1
}

release_db() {
    echo .quit >&7 # not by end of file: processes started meanwhile have the pipe open too
    exec 7>&-
    wait "$HOLDER"
    rm "$T/holder"
}

# damage_faces WHERE: another byte than there was, in the middle of these templates' faces.
damage_faces() {
    sqlite3 "$DB" "UPDATE faces SET face = CAST(substr(face, 1, 5000)
        || CASE substr(face, 5001, 1) WHEN x'00' THEN x'01' ELSE x'00' END
        || substr(face, 5002) AS BLOB)
        WHERE template_key IN (SELECT template_key FROM templates WHERE $1)"
}
