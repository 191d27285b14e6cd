#!/bin/sh
# Goal: a file, the environment and flags give the same settings, each overriding the one before;
# problems are reported with their source, and --check-config writes nothing.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

# surfaced OPTION...: its output is in $T/out, its messages are in $T/err.
surfaced() {
    timeout 20 "$BUILD/surfaced" "$@" >"$T/out" 2>"$T/err"
}

# says TITLE PATTERN: one of the last run's messages matches PATTERN.
says() {
    contains "$1" "$T/err" "$2"
}

# wrong TITLE PATTERN: the file is rejected with a message that matches PATTERN.
wrong() {
    surfaced --config "$T/conf" --check-config
    is "$1: exit status" $? 64
    says "$1" "$2"
}

# setting NAME: its value by the last --print-config.
setting() {
    sed -n "s/^$1 = //p" "$T/out"
}

# from NAME: the source of that value.
from() {
    grep -E -B 1 "^#?$1 =" "$T/out" | sed -n '1s/^# //p'
}

# ---- precedence
conf '# a comment' '; another' "db = $DB" '' '[surfaced]' 'queue = 9' '  workers=3  ' 'max-body: 1M'
surfaced --config "$T/conf" --print-config
is "--print-config" $? 0
is "a value of the file" "$(setting db)" "$DB"
is "its source" "$(from db)" "$T/conf:3"
is "an indented line" "$(setting workers)" 3
is "a colon, a unit" "$(setting max-body)" 1M
is "a default" "$(setting listen) $(from listen)" '127.0.0.1:8787 default'
is "not set" "$(from model)" 'not set'
SURFACED_QUEUE=8 SURFACED_WORKERS='' surfaced --config "$T/conf" --print-config
is "the environment overrides the file" "$(setting queue) $(from queue)" '8 SURFACED_QUEUE'
is "an empty variable is ignored" "$(setting workers) $(from workers)" "3 $T/conf:7"
SURFACED_QUEUE=8 surfaced --config "$T/conf" --queue 7 --no-auth --print-config
is "a flag overrides both" "$(setting queue) $(from queue)" '7 --queue'
is "a flag without value" "$(setting no-auth) $(from no-auth)" '1 --no-auth'
cp "$T/out" "$T/printed"
surfaced --config "$T/printed" --print-config
is "the printed settings are a valid file" "$(grep -v '^#' "$T/out")" "$(grep -v '^#' "$T/printed")"
SURFACED_CONFIG=$T/conf surfaced --print-config
is "SURFACED_CONFIG" "$(setting queue)" 9
SURFACED_CONFIG=/nowhere surfaced --config "$T/conf" --print-config
is "--config overrides it" "$(setting queue)" 9

# ---- problems and their sources
conf "db = $DB" 'quueue = 5'
wrong "an unknown name" "^surfaced: $T/conf:2: no such setting: quueue"
conf "db = $DB" 'queue = 5' '# x' 'queue = 6'
wrong "a setting twice" "conf:4: queue is given twice, first on line 2"
conf "db = $DB" '' 'queue = 5 ; five'
wrong "a comment after a value" "conf:3: queue = 5 ; five: not a number from 1 to 65536"
for v in '' x 0 -1 65537 0x10 99999999999999999999999; do
    conf "db = $DB" "queue = $v"
    wrong "queue = $v" "conf:2: queue = $v: not a number"
done
for v in 1k 2G 1025M 64MB 99999999999G 0; do
    conf "db = $DB" "max-body = $v"
    wrong "max-body = $v" "conf:2: max-body = $v: not a number of bytes"
done
conf "db = $DB" 'no-auth = yes'
wrong "neither 0 nor 1" 'conf:2: no-auth = yes: neither 0 nor 1'
conf "db = $DB" 'listen = here'
wrong "not an address" 'conf:2: listen = here: not an address'
conf 'db ='
wrong "an empty path" 'conf:1: db = : an empty value'
conf 'queue = 5'
wrong "no database" 'no database'
conf "db = $DB" queue
wrong "no value" 'conf:2: neither NAME = VALUE'
conf "db = $DB" '[surfaced' 'queue = 5'
wrong "a malformed section" 'conf:2: neither NAME = VALUE'
conf "db = $DB" '[other]' 'queue = 5'
wrong "another section" 'conf:3: .*section'
printf 'db = x\nqueue = 5\0\n' >"$T/conf"
wrong "a zero byte" 'conf:2: a zero byte'
printf 'db = x\nqueue = 5\033[2J\n' >"$T/conf"
wrong "a control character" 'conf:2: queue = 5\?\[2J: '
{ printf 'db = x\nmodel = '; head -c 5000 /dev/zero | tr '\0' x; } >"$T/conf"
wrong "a long line" 'conf:2: a line of more than 4000 bytes'
conf 'queue = x' 'workers = x' 'nothing = x'
wrong "all problems: the first" 'conf:1: queue'
says "all problems: the last" 'conf:3: no such'
conf "db = $DB" 'queue = x'
surfaced --config "$T/conf" --queue 5
is "a wrong value that is overridden: exit status" $? 64
says "a wrong value that is overridden" 'conf:2: queue = x'
surfaced --config "$T/nowhere" --check-config
is "no such file: exit status" $? 64
says "no such file" "$T/nowhere: No such file"
surfaced --config "$T" --check-config
is "a folder: exit status" $? 64
says "a folder" 'directory'
surfaced --config "$T/conf" --config "$T/conf"
says "--config twice" '--config is given twice'
surfaced --config "$T/conf" --check-config --print-config
says "both" 'one at a time'

# ---- files and credentials
conf "db = $T/nowhere/faces.db"
wrong "a missing folder" 'conf:1: db = .*/nowhere/faces.db: No such file'
conf "db = $DB" "model = $T/no.model"
wrong "a missing model" 'conf:2: model = .*no.model: No such file'
echo junk >"$T/no.model"
wrong "not a model" 'conf:2: model = .*no.model: '
mkdir "$T/credentials"
ln -s "$PWD/core/face/default.model" "$T/credentials/model"
conf "db = $DB" "model = credential:model"
wrong "no folder of credentials" 'CREDENTIALS_DIRECTORY is not set'
export CREDENTIALS_DIRECTORY="$T/credentials"
surfaced --config "$T/conf" --check-config
is "a credential" $? 0
conf "db = $DB" "model = credential:other"
wrong "no such credential" 'credential:other: No such file'
conf "db = $DB" "model = credential:../conf"
wrong "a path as a credential" 'not the name of a credential'
unset CREDENTIALS_DIRECTORY

# ---- the file alone starts the daemon
conf "db = $DB" 'queue = 9' 'workers = 3'
surfaced --config "$T/conf" --check-config
is "a good file" $? 0
ok "--check-config reports it" grep -q good "$T/out"
ok "nothing was written" test ! -e "$DB"
start_daemon --config "$T/conf"
ok "the file sets options" grep -q 'workers=3 queue=9 ' "$LOG"
stop_daemon

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
finish
