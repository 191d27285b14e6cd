#!/bin/sh
# Goal: somebody who can write the database's file and has older copies of it, but no key, gets
# nothing that lasts: what attack_store.py does at rest or beside a daemon is found by the next
# verification of the rows, and stays found whatever is written honestly after it; nothing that
# is written hangs a command.  Then attacks that go on while the store works.  More of them: tests/rows,
# test_restore.c, replaced.sh, archive.sh, audit.sh.
# ATTACK: some of them alone, by their names.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
command -v python3 >/dev/null || {
    echo "SKIP $0: python3 is not installed"
    exit 0
}

# ctl as in lib.sh, but no command may hang.
ctl() {
    timeout 60 "$BUILD/surfacectl" --db "$DB" --json "$@" >"$T/ctl" 2>"$T/ctl.err" </dev/null
    CODE=$?
    return $CODE
}

# fresh: the database is what it was.
fresh() {
    rm -f "$DB"* # also the key of a rekey
    cp "$T/now.db" "$DB"
    cp "$T/key" "$DB.key"
}

# attack NAME [OLDER]: on the database as it is.
attack() {
    env -u LD_PRELOAD python3 tests/box/attack_store.py "$1" "$DB" "${2:-$T/old.db}" >"$T/out" 2>&1 ||
        ok "$1: it can be done: $(tail -n 1 "$T/out")" false
}

# refuses TITLE ARGUMENT...: the command fails, in time.
refuses() {
    r_title=$1
    shift
    ctl "$@"
    ok "$r_title: surfacectl $1: exit $CODE" [ "$CODE" -ge 64 ] && ok "$r_title: in time" [ "$CODE" != 124 ]
}

# checked TITLE WANTED: `check` says that all is well (0) or not (1).
checked() {
    ctl check-database
    [ "$CODE" = 0 ] && c_got=0 || c_got=1
    is "$1: check" "$c_got" "$2"
    ok "$1: check in time" [ "$CODE" != 124 ]
}

# wanted NAME: is this attack to be made?
wanted() { case " ${ATTACK:-$1} " in *" $1 "*) ;; *) return 1 ;; esac; }

key_of() { # NAME: a device's public key
    openssl genpkey -algorithm ed25519 -out "$T/$1.private" 2>"$T/out"
    openssl pkey -in "$T/$1.private" -pubout -out "$T/$1.pem"
}

for n in 1 2 3 4 5; do
    scan "$n" 0 "$T/s$n.ply" --points 1000
    scan "$n" 1 "$T/p$n.ply" --points 1000
done
scan 1 2 "$T/s1b.ply" --points 1000
key_of front
key_of gone
ctl_exits 0 init
cp "$DB.key" "$T/key"
DOOR=$(new_token door)
for name in lost stolen x; do new_token $name >"$T/out"; done
ctl_exits 0 device add front "$T/front.pem"
ctl_exits 0 device add gone "$T/gone.pem"
for who in alice:1 bob:2 carol:3 dave:4; do
    ctl_exits 0 enroll "${who%:*}" "$T/s${who#*:}.ply"
done
ctl_exits 0 enroll alice "$T/s1b.ply"
second=$(said '.templates[0].template_id')
ctl_exits 0 verify alice "$T/p1.ply"
ctl_exits 0 subject set dave --expires 2099-01-01T00:00:00Z
ctl_exits 0 calibrate --reset --yes
sqlite3 "$DB" "VACUUM INTO '$T/old.db'"
id_of() { ctl token list && said ".tokens[] | select(.name == \"$1\") | .id"; }
ctl_exits 0 token revoke "$(id_of lost)"
ctl token rotate "$(id_of stolen)"
ctl_exits 0 subject disable bob
ctl_exits 0 subject erase carol --yes
ctl_exits 0 subject hold dave
ctl_exits 0 template delete "$second" --yes
ctl_exits 0 device remove gone
ctl_exits 0 calibrate --reset --yes
sql "INSERT INTO attempts SELECT subject_key, '', 2, 1, 6 FROM subjects"
sqlite3 "$DB" "VACUUM INTO '$T/now.db'"
checked "as it was written" 0

# ---- at rest, and beside a daemon
list() { python3 tests/box/attack_store.py --list "$@"; }
for name in $(list rows found) $(list pages found); do
    wanted "$name" || continue
    fresh
    attack "$name"
    checked "$name" 1
    refuses "$name" enroll erin "$T/s5.ply"
    refuses "$name" rekey --yes
    refuses "$name" backup "$T/b"
    refuses "$name" vacuum
    refuses "$name" purge --yes
    timeout 60 "$BUILD/surfaced" --db "$DB" --listen 127.0.0.1:0 >"$T/out" 2>&1
    r=$?
    ok "$name: the daemon does not start: $r" [ $r != 0 -a $r != 124 ]
    checked "$name: after all that" 1
    ok "$name: nothing is left of the rekey" test ! -e "$DB.key.new" -a ! -e "$DB.before-rekey" -a ! -e "$DB.part"
    # the daemon is at work, and goes on writing what it is asked to
    case $name in hot_journal | wal_left) continue ;; esac # for who opens it first
    fresh
    AUTH=$DOOR start_daemon
    AUTH=$DOOR send POST /v1/subjects/alice/verify "$PLY" "$T/p1.ply"
    attack "$name"
    AUTH=$DOOR send POST /v1/subjects/erin/templates "$PLY" "$T/s5.ply"
    ok "$name: an enrolment is answered: $STATUS" [ "$STATUS" != 000 ]
    kill_daemon
    checked "$name: after an honest enrolment" 1
    refuses "$name: after it" rekey --yes
    checked "$name: and after that" 1
done

# ---- in the logs and the faces: by who reads them
for name in $(list rows walk) $(list pages walk); do
    wanted "$name" || continue
    fresh
    attack "$name"
    checked "$name" 1
    ctl enroll erin "$T/s5.ply"
    checked "$name: after an honest enrolment" 1
    refuses "$name" rekey --yes
    refuses "$name" backup "$T/b"
    checked "$name: after all that" 1
done

# ---- what does no harm
for name in $(list rows harmless) $(list pages harmless); do
    wanted "$name" || continue
    fresh
    attack "$name"
    for at in rest work; do
        [ $at = rest ] || start_daemon
        ctl_exits 0 enroll erin "$T/s5.ply"
        ctl_exits 0 token create new --scope verify
        is "$name, at $at: a token as it was meant" \
            "$(sql "SELECT scopes, old_hash IS NULL FROM tokens WHERE name = 'new' LIMIT 1")" 'verify|1'
        ctl device list
        ctl device remove "$(said '.devices[0].name')"
        ctl_exits 0 device add front "$T/front.pem"
        ctl verify bob "$T/p2.ply"
        ok "$name, at $at: bob is disabled" [ "$CODE" != 0 ]
    done
    stop_daemon
    checked "$name" 0
done
for name in $(list pages outright); do
    wanted "$name" || continue
    fresh
    attack "$name"
    refuses "$name" subject list
    refuses "$name" rekey --yes
    start_fails "$name" 1 'surfaced: ' --db "$DB" --listen 127.0.0.1:0
done

# swap SQL...: statements on the database, by somebody without a key; old and now are attached.
swap() {
    sqlite3 "$DB" "PRAGMA foreign_keys = OFF; ATTACH '$T/old.db' AS old; ATTACH '$T/now.db' AS now; BEGIN; $*; COMMIT" ||
        ok "the attacker can write" false
}
# ---- an older row is in the place of a newer one while it is changed honestly, which is put back
if wanted older; then
    for what in "token rotate $(id_of lost)" 'subject set bob --consent C' "enroll bob $T/p2.ply"; do
        fresh
        start_daemon
        AUTH=$DOOR
        case $what in
        token*) swap "DELETE FROM main.tokens WHERE name = 'lost';
            INSERT INTO main.tokens SELECT * FROM old.tokens WHERE name = 'lost'" ;;
        *) swap "DELETE FROM main.subjects WHERE subject_key = 2;
            INSERT INTO main.subjects SELECT * FROM old.subjects WHERE subject_key = 2" ;;
        esac
        case $what in
        subject*)
            printf '{"consent": "C"}' >"$T/patch"
            send PATCH /v1/subjects/bob 'Content-Type: application/merge-patch+json' "$T/patch"
            ;;
        enroll*) send POST /v1/subjects/bob/templates "$PLY" "$T/p2.ply" ;;
        *) STATUS=200 ;;
        esac
        ok "$what: the daemon cannot know yet: $STATUS" [ "$STATUS" = 200 -o "$STATUS" = 201 ]
        # shellcheck disable=SC2086 # a command and its arguments
        refuses "$what" $what
        kill_daemon
        checked "$what" 1
    done
    AUTH=''
fi

# ---- a subject is hidden while another is enrolled under her id, and put back: no row is missing
for name in $(list pages second); do
    wanted "$name" || continue
    fresh
    AUTH=$DOOR start_daemon
    swap "DELETE FROM main.faces WHERE template_key = 1; DELETE FROM main.templates WHERE template_key = 1;
        DELETE FROM main.subjects WHERE subject_key = 1"
    AUTH=$DOOR send POST /v1/subjects/alice/templates "$PLY" "$T/s5.ply"
    is "$name: the daemon cannot know yet" "$STATUS" 201
    attack "$name" "$T/now.db"
    refuses "$name" enroll erin "$T/s5.ply"
    kill_daemon
    is "$name: two of them" "$(sqlite3 "$DB" "SELECT count(*) FROM subjects NOT INDEXED WHERE lookup =
        (SELECT lookup FROM subjects NOT INDEXED WHERE subject_key = 1)")" 2
    for command in 'rekey --yes' "backup $T/b" 'subject erase alice --yes'; do
        # shellcheck disable=SC2086 # a command and its arguments
        refuses "$name" $command
    done
    start_fails "$name" 1 'surfaced: the database is not as it was written' --db "$DB" --listen 127.0.0.1:0
    checked "$name: after all that" 1
done

# ---- the digest of another history: of the one that a restore gave up
if wanted history; then
    fresh
    ctl_exits 0 token create rogue --scope verify
    sqlite3 "$DB" "VACUUM INTO '$T/rogue.db'"
    fresh
    ctl_exits 0 subject set alice --consent C # the entry of the same number
    sqlite3 "$DB" "ATTACH '$T/rogue.db' AS rogue; BEGIN; DELETE FROM main.tokens; DELETE FROM main.subjects;
        INSERT INTO main.tokens SELECT * FROM rogue.tokens; INSERT INTO main.subjects SELECT * FROM rogue.subjects;
        UPDATE main.change_log SET digest = (SELECT r.digest FROM rogue.change_log r WHERE r.seq = main.change_log.seq)
            WHERE seq = (SELECT max(seq) FROM main.change_log); COMMIT"
    refuses "another history's digest" enroll erin "$T/s5.ply"
    start_fails "another history's digest" 1 'surfaced: ' --db "$DB" --listen 127.0.0.1:0
fi

finish
