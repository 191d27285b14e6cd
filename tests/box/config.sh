#!/bin/sh
# Goal: a file, the environment and flags give the same settings to the daemon and to surfacectl, each
# overriding the one before; problems are reported with their source, and --check-config writes
# nothing.  The daemon does not listen if an option is wrong, or if it cannot open the database or bind the
# address.  The message for each wrong value is in tests/base/test_settings.c and test_options.c.
. tests/box/lib.sh
unset SURFACED_DB SURFACED_KEY SURFACED_MODEL CREDENTIALS_DIRECTORY

# surfaced OPTION...: its output is in $T/out, its messages are in $T/err.
surfaced() {
    timeout 60 "$BUILD/surfaced" "$@" >"$T/out" 2>"$T/err"
}

# wrong TITLE PATTERN [OPTION...]: the file is rejected with a message that matches PATTERN.
wrong() {
    w_title=$1 w_pattern=$2
    shift 2
    surfaced --config "$T/conf" --check-config "$@"
    is "$w_title: exit status" $? 64
    contains "$w_title" "$T/err" "$w_pattern"
}

# setting NAME: its value by the last --print-config, and where that is from.
setting() {
    echo "$(sed -n "s/^$1 = //p" "$T/out")" "$(grep -E -B 1 "^#?$1 =" "$T/out" | sed -n '1s/^# //p')"
}

# try CODE ARGUMENT...: like ctl_exits, but without --db.
try() {
    c_code=$1
    shift
    "$BUILD/surfacectl" --json "$@" >"$T/ctl" 2>"$T/ctl.err" </dev/null
    is "surfacectl $*" $? "$c_code"
}
says() { contains "$1" "$T/ctl.err" "$2"; }

# ---- precedence
conf '# a comment' '; another' "db = $DB" '' '[surfaced]' 'queue = 9' '  workers=3  ' 'max-body: 1M'
surfaced --config "$T/conf" --print-config
is "--print-config" $? 0
is "a value of the file" "$(setting db)" "$DB $T/conf:3"
is "an indented line" "$(setting workers)" "3 $T/conf:7"
is "a colon, a unit" "$(setting max-body)" "1M $T/conf:8"
is "a default" "$(setting listen)" '127.0.0.1:8787 default'
is "not set" "$(setting model)" ' not set'
SURFACED_QUEUE=8 SURFACED_WORKERS='' surfaced --config "$T/conf" --print-config
is "the environment overrides the file" "$(setting queue)" '8 SURFACED_QUEUE'
is "an empty variable is ignored" "$(setting workers)" "3 $T/conf:7"
SURFACED_QUEUE=8 surfaced --config "$T/conf" --queue 7 --no-auth --print-config
is "a flag overrides both" "$(setting queue) $(setting no-auth)" '7 --queue 1 --no-auth'
cp "$T/out" "$T/printed"
surfaced --config "$T/printed" --print-config
is "the printed settings are a valid file" "$(grep -v '^#' "$T/out")" "$(grep -v '^#' "$T/printed")"
SURFACED_CONFIG=$T/conf surfaced --print-config
is "SURFACED_CONFIG" "$(setting queue)" "9 $T/conf:6"
SURFACED_CONFIG=/nowhere surfaced --config "$T/conf" --print-config
is "--config overrides it" "$(setting queue)" "9 $T/conf:6"

# ---- problems and their sources
conf 'queue = x' 'workers = x' 'nothing = x'
wrong "all problems: the first" "^surfaced: $T/conf:1: queue = x: not a number from 1 to 65536"
contains "all problems: the last" "$T/err" 'conf:3: no such setting: nothing'
conf "db = $DB" 'queue = 5 ; five'
wrong "a comment after a value" 'conf:2: queue = 5 ; five: not a number'
wrong "a wrong value that is overridden" 'conf:2: queue = 5 ; five' --queue 5
conf "db = $DB" '[surfaced' 'queue = 5'
wrong "a malformed section" 'conf:2: neither NAME = VALUE'
conf 'queue = 5'
wrong "no database" 'no database'
printf 'db = x\nqueue = 5\0\n' >"$T/conf"
wrong "a zero byte" 'conf:2: a zero byte'
printf 'db = x\nqueue = 5\033[2J\n' >"$T/conf"
wrong "a control character" 'conf:2: queue = 5\?\[2J: '
surfaced --config "$T/nowhere" --check-config
is "no such file" "$? $(cat "$T/err")" "64 surfaced: $T/nowhere: No such file or directory"
surfaced --config "$T" --check-config
is "a folder" $? 64
surfaced --config "$T/conf" --config "$T/conf"
contains "--config twice" "$T/err" '--config is given twice'
surfaced --config "$T/conf" --check-config --print-config
contains "both" "$T/err" 'either --check-config or'

# ---- files and credentials
conf "db = $T/nowhere/faces.db"
wrong "a missing folder" 'conf:1: db = .*/nowhere/faces.db: No such file'
mkdir "$T/credentials"
ln -s "$PWD/core/face/default.model" "$T/credentials/model"
conf "db = $DB" "model = credential:model"
wrong "no folder of credentials" 'credential:model: No such file'
export CREDENTIALS_DIRECTORY="$T/credentials"
surfaced --config "$T/conf" --check-config
is "a credential" $? 0
conf "db = $DB" "model = credential:other"
wrong "no such credential" 'credential:other: No such file'
unset CREDENTIALS_DIRECTORY

# ---- options
start_fails "no database" 64 '--db'
start_fails "an unknown option" 64 '--unknown' --db "$DB" --unknown
start_fails "a word" 64 'word' --db "$DB" word
start_fails "a missing value" 64 'missing' --db
start_fails "an option twice" 64 '--db is given twice' --db "$DB" --db "$DB"
start_fails "a flag twice" 64 'twice' --db "$DB" --no-auth --no-auth
start_fails "a wrong number" 64 '--workers .*from 1 to' --db "$DB" --workers 257
start_fails "no room in the queue" 64 '--queue' --db "$DB" --queue 0
start_fails "a body of more than 1 GiB" 64 '--max-body' --db "$DB" --max-body 1073741825
start_fails "no address" 64 'not an address' --db "$DB" --listen 8787
start_fails "no loopback address" 64 'loopback' --db "$DB" --listen 0.0.0.0:0
start_fails "proxies" 64 'proxy-protocol' --create --db "$DB" --proxy-protocol localhost
SURFACED_NO_AUTH=yes start_fails "a flag of the environment" 64 'SURFACED_NO_AUTH' --db "$DB"
SURFACED_WORKERS=x start_fails "a number of the environment" 64 'SURFACED_WORKERS=x: not a number' --db "$DB"
ok "no database was made" test ! -e "$DB"
surfaced --help
is "--help" $? 0
contains "--help names the options" "$T/out" --max-body
start_fails "an unwritable place" 1 '/proc/' --db /proc/surfaced.db --listen 127.0.0.1:0
SURFACED_NO_AUTH=1 SURFACED_WORKERS=3 SURFACED_QUEUE=9 start_daemon --queue 7
ok "the environment sets options, and an option overrides it" grep -q 'workers=3 queue=7 .*auth=none' "$LOG"
is "only its owner can read the database" "$(stat -c %a "$DB")" 600
start_fails "a busy port" 1 'cannot listen.*in use' --create --db "$T/busy.db" --listen "127.0.0.1:${URL##*:}"
stop_daemon
rm "$DB"*
# Not every machine has IPv6.
if [ -e /proc/net/if_inet6 ] && grep -q '^0*1 ' /proc/net/if_inet6; then
    LISTEN='[::1]:0' start_daemon --no-auth
    gives 200 "IPv6 ($URL)" req GET /healthz -g
    stop_daemon
    rm "$DB"*
else
    echo "SKIP: no IPv6 on the loopback interface"
fi

# ---- the file alone starts the daemon
conf "db = $DB" 'queue = 9' 'workers = 3'
surfaced --config "$T/conf" --check-config
is "a good file" "$? $(grep -c good "$T/out")" '0 1'
ok "nothing was written" test ! -e "$DB"
start_daemon --config "$T/conf"
ok "the file sets options" grep -q 'workers=3 queue=9 ' "$LOG"
stop_daemon
rm "$DB"*

# ---- the example and the manuals have every setting
surfaced --config packaging/surfaced.conf --print-config
is "the example is valid" $? 0
surfaced --db "$DB" --print-config
names=$(sed -n 's/^#\{0,1\}\([a-z-]*\) =.*/\1/p' "$T/out")
ok "settings were printed" test -n "$names"
for name in $names; do
    ok "the example has $name" grep -q "^#\{0,1\}$name = " packaging/surfaced.conf
    ok "surfaced.conf(5) has $name" grep -q "^\.It Ic $name " man/surfaced.conf.5
    ok "surfaced(8) has $name" grep -Fq ".It Fl -$name" man/surfaced.8
done

# ---- surfacectl: which database
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
export SURFACED_DB="$T/other.db"
try 0 subject list
is "so does the environment" "$(said '.subjects | length')" 0
unset SURFACED_DB
try 0 doctor
conf "db = $DB" 'key = credential:the.key' 'tls-key = credential:tls.key' 'tls-cert = credential:tls.crt'
try 66 subject list
says "a credential of the service" '/run/credentials/surfaced.service/the.key'
export CREDENTIALS_DIRECTORY="$T"
try 0 subject list
unset CREDENTIALS_DIRECTORY

# ---- a wrong configuration
conf "db = $DB" 'queue = many' 'colour = red'
try 64 subject list
says "the first problem" "conf:2: queue = many: not a number"

# ---- without a daemon
mkdir "$T/bin"
cp "$BUILD/surfacectl" "$T/bin"
conf "db = $DB" "key = $T/the.key"
"$T/bin/surfacectl" --json subject show alice >"$T/ctl" 2>"$T/ctl.err"
is "the daemon's program is not needed" "$? $(said .subject)" '0 alice'
finish
