#!/bin/sh
# Goal: surfacectl uses the database and key of the daemon's configuration unless others are
# given; config show prints the daemon's settings and the source of each, config check the
# problems in them.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
unset SURFACED_DB SURFACED_KEY SURFACED_MODEL CREDENTIALS_DIRECTORY

# try CODE ARGUMENT...: like ctl_exits, but without --db.
try() {
    c_code=$1
    shift
    "$BUILD/surfacectl" --json "$@" >"$T/ctl" 2>"$T/ctl.err" </dev/null
    is "surfacectl $*" $? "$c_code"
}
says() { contains "$1" "$T/ctl.err" "$2"; }

# ---- which database
try 64 subject list
says "no database is given" 'no database: give --db PATH'
conf "db = $DB" "key = $T/the.key" 'queue = 9'
try 0 --config "$T/conf" init
ok "the key is where the configuration says" test -s "$T/the.key" -a ! -e "$DB.key"
export SURFACED_CONFIG="$T/conf"
try 0 subject set alice --consent C-1
try 0 subject show alice
is "found by the configuration" "$(said .consent)" C-1
try 77 --key "$T/conf" subject list
try 0 --db "$T/other.db" init
ok "another database has its own key" test -s "$T/other.db.key"
try 0 --db "$T/other.db" subject list
is "an option overrides it" "$(said '.subjects | length')" 0
SURFACED_DB=$T/other.db
export SURFACED_DB
try 0 subject list
is "so does the environment" "$(said '.subjects | length')" 0
unset SURFACED_DB
try 0 doctor
conf "db = $DB" 'queue = many'
try 64 subject list
says "a wrong configuration" "conf:2: queue = many: not a number"
conf "db = $DB" 'key = credential:the.key' 'tls-key = credential:tls.key' 'tls-cert = credential:tls.crt'
try 66 subject list
says "a credential of the service" '/run/credentials/surfaced.service/the.key'
CREDENTIALS_DIRECTORY=$T
export CREDENTIALS_DIRECTORY
try 0 subject list
unset CREDENTIALS_DIRECTORY

# ---- show
conf "db = $DB" "key = $T/the.key" 'queue = 9'
SURFACED_WORKERS=3 "$BUILD/surfacectl" config show >"$T/text"
SURFACED_WORKERS=3 "$BUILD/surfaced" --print-config >"$T/daemon"
ok "the same as the daemon prints" cmp "$T/text" "$T/daemon"
SURFACED_WORKERS=3 try 0 config show
is "from the file" "$(said '.settings.queue | [.value, .from] | join(" ")')" "9 $T/conf:3"
is "from the environment" "$(said '.settings.workers | [.value, .from] | join(" ")')" '3 SURFACED_WORKERS'
is "by default" "$(said '.settings.listen | [.value, .from] | join(" ")')" '127.0.0.1:8787 default'
is "not set" "$(said '.settings | has("model")')" false
printf 'db = %s\n' "$T/x.db" >"$T/second"
try 0 config show --config "$T/second"
is "another file" "$(said .settings.db.value)" "$T/x.db"
try 65 config show --config "$T/none"
says "no such file" 'No such file'

# ---- check
try 0 config check
is "no problems" "$(said '[.ok, .problems] | tojson')" '[true,[]]'
conf "db = $DB" 'queue = many' 'colour = red'
try 1 config check
is "every problem" "$(said '[.ok, (.problems | length)] | tojson')" '[false,2]'
ok "with its place" matches "$(said '.problems[0]')" "^$T/conf:2: queue = many"
"$BUILD/surfacectl" config check >"$T/text"
is "as text" "$? $(grep -c conf: "$T/text")" '1 2'

conf "db = $DB" "model = $T/conf"
try 1 config check
ok "a file that is not a model" matches "$(said '.problems[0]')" "^$T/conf:2: model = .*line 1: not a model"

# ---- without a daemon
mkdir "$T/bin"
cp "$BUILD/surfacectl" "$T/bin"
conf "db = $DB" "key = $T/the.key"
"$T/bin/surfacectl" --json subject show alice >"$T/ctl" 2>"$T/ctl.err"
is "the daemon's program is not needed" "$? $(said .subject)" '0 alice'
finish
