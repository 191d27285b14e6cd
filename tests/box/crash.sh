#!/bin/sh
# Goal: commands that change a database lose power at one of their changes to its folder, and the
# daemon does or is killed there, many times: afterwards `check-database` finds nothing, an acknowledged
# change is there, no other is half done, erased bytes are gone, and the command, run again,
# completes.  Commands are killed in faults.sh.
# CRASH_TRIALS: of each command (6); SEED: of the first; CRASH_ONLY: a command's name.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
command -v python3 >/dev/null || {
    echo "SKIP $0: python3 is not installed"
    exit 0
}
export PYTHONDONTWRITEBYTECODE=1
trials=${CRASH_TRIALS:-6} seed=${SEED:-$(date +%s)}
admin() {
    "$BUILD/surfacectl" --db "$@" >"$T/ctl" 2>&1 || {
        echo "surfacectl --db $*: $(cat "$T/ctl")"
        exit 1
    }
}

T=$(cd "$T" && pwd -P) # as the programs name it
mkdir "$T/empty" "$T/work"
for n in 1 2 3 4; do
    scan "$n" 0 "$T/s$n.ply" --points 1000
done
scan 4 1 "$T/p4.ply" --points 1000
# A model of another mean face: its templates are of another engine.
awk '/^change/ { on = 0 } on { for (i = 1; i <= NF; i++) if ($i != ".") $i = $i + 1500 } /^mean/ { on = 1 } { print }' \
    core/face/default.model >"$T/raised.model"

# ---- what there is before
mkdir "$T/full" "$T/lost" "$T/old"
db=$T/full/db
admin "$db" --anchor "$T/full/anchor" init
admin "$db" --anchor "$T/full/anchor" enroll alice "$T/s1.ply"
admin "$db" --anchor "$T/full/anchor" enroll bob "$T/s2.ply"
admin "$db" --anchor "$T/full/anchor" token create gate --scope verify
admin "$db" --anchor "$T/full/anchor" backup "$T/full/copy"
cp "$T/full/copy" "$T/backup"
cp "$db.key" "$T/lost/"
admin "$db" --anchor "$T/full/anchor" subject erase --yes bob
admin "$db" --anchor "$T/full/anchor" enroll carol "$T/s3.ply"
admin "$db" --anchor "$T/full/anchor" enroll bob "$T/s2.ply"
cp "$T/full/anchor" "$T/lost/"
admin "$T/old/db" --anchor "$T/old/anchor" init
admin "$T/old/db" --anchor "$T/old/anchor" enroll alice "$T/s1.ply" --model "$T/raised.model"
admin "$T/other" init
admin "$T/other" enroll dave "$T/s4.ply"
admin "$T/other" enroll erin "$T/s1.ply"
od -An -tx1 -N 32 /dev/urandom | tr -d ' \n' >"$T/akey"
chmod 600 "$T/akey"
admin "$T/other" export --all -o "$T/archive" --archive-key "$T/akey"

# crash NAME BASE ARGUMENT...: trials of a command.
crash() {
    name=$1 base=$T/$2
    shift 2
    [ -z "${CRASH_ONLY:-}" ] || [ "$CRASH_ONLY" = "$name" ] || return 0
    env -u LD_PRELOAD python3 tests/box/crash.py "$BUILD" "$base" "$T/work" power "$seed" "$trials" \
        "$BUILD/surfacectl" --db @db --anchor @anchor "$@" >"$T/said" 2>&1
    code=$?
    echo "$name: $(cat "$T/said")"
    is "$name, from seed $seed" "$code" 0
    [ "$code" = 0 ] || cp -r "$T/work" "${CRASH_KEEP:-$T}/$name"
}

echo "seed $seed"
crash init empty init
crash enroll full enroll dave "$T/s4.ply"
crash erase full subject erase --yes alice
crash rename full subject rename bob rob
crash rekey full rekey --yes
crash accept full accept-state --yes
crash rekey-keep full rekey --keep-old
crash rekey-plain full rekey --plaintext --yes
crash import full import "$T/archive" --archive-key "$T/akey"
crash restore full restore "$T/backup"
crash restore-lost lost restore "$T/backup"
crash backup full backup --force @copy
crash vacuum full vacuum
crash reencode old template reencode

# ---- the daemon
if [ "${CRASH_ONLY:-daemon}" = daemon ]; then
    for kind in kill power; do
        env -u LD_PRELOAD python3 tests/box/crash.py "$BUILD" "$T/full" "$T/work" "$kind" "$seed" \
            "$trials" --clients "$T/s4.ply" "$T/p4.ply" "$BUILD/surfaced" --db @db --anchor @anchor --listen "unix:$T/work/socket" \
            --no-auth --workers 2 >"$T/said" 2>&1
        code=$?
        echo "daemon, $kind: $(cat "$T/said")"
        is "daemon, $kind, from seed $seed" "$code" 0
    done
fi

# ---- what a file system without renameat2(RENAME_NOREPLACE) may leave: two names of one
# file
if [ -z "${CRASH_ONLY:-}" ]; then
    ln "$db" "$T/second.part"
    sum=$(sha256sum <"$db")
    "$BUILD/surfacectl" --db "$db" backup "$T/second" >"$T/ctl" 2>&1
    is "it is not written to" $? 65
    is "a part that is the database itself is not overwritten" "$(sha256sum <"$db")" "$sum"
fi
finish
