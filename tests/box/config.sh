#!/bin/sh
# Goal: a file, the environment and flags give the same settings to the daemon and to surfacectl, each
# overriding the one before; problems are reported with their source, and --check-config writes
# nothing.  The message for each wrong line is in tests/base/test_settings.c.
. tests/box/lib.sh
unset SURFACED_DB SURFACED_KEY SURFACED_MODEL CREDENTIALS_DIRECTORY

# surfaced OPTION...: its output is in $T/out, its messages are in $T/err.
surfaced() {
    timeout 20 "$BUILD/surfaced" "$@" >"$T/out" 2>"$T/err"
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
