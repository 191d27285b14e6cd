#!/bin/sh
# Goal: subjects move to another database with all that is stored of them, in an archive: a
# database file under a key of its own.  Any change of it is refused or changes nothing; an import is
# one transaction, and a second one adds nothing; neither needs more memory for more subjects.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

TO=$T/to.db
# on_exits STATUS DATABASE ARGUMENT...: the exit status must be STATUS.
on_exits() {
    x_wanted=$1
    shift
    on "$@"
    is "on $*" "$CODE" "$x_wanted"
}
# on DATABASE ARGUMENT...: run ctl on that database.
on() {
    o_db=$DB DB=$1
    shift
    ctl "$@"
    DB=$o_db
    return $CODE
}

# everything DATABASE: all that it has of subjects and templates.
everything() {
    for who in $("$BUILD/surfacectl" --db "$1" --json subject list | jq -r '.subjects[].subject'); do
        "$BUILD/surfacectl" --db "$1" --json subject show "$who"
    done
}

for s in 1 2 3; do
    scan "$s" 0 "$T/s$s.ply" --points 1000
    scan "$s" 1 "$T/p$s.ply" --points 1000
done
on "$DB" init
on "$DB" enroll alice "$T/s1.ply" --label 'left camera'
on "$DB" enroll bob "$T/s2.ply" --group staff,door-3
on "$DB" enroll carol "$T/s3.ply"
on "$DB" subject set carol --identify no
on "$TO" init
echo 'correct horse battery staple' >"$T/phrase"
od -An -tx1 -N 32 /dev/urandom | tr -d ' \n' >"$T/akey"
chmod 600 "$T/phrase" "$T/akey"
export SURFACED_KEY=

# ---- export
on_exits 64 "$DB" export alice bob # where to is asked
on_exits 64 "$DB" export -o "$T/a" # whom is asked
on_exits 64 "$DB" export alice --all -o "$T/a" # some or all
on_exits 66 "$DB" export alice nobody -o "$T/a" --archive-key "$T/akey" # nobody of that name
ok "then there is no archive" test ! -e "$T/a" -a ! -e "$T/a.part"
on "$DB" export alice bob alice -o "$T/a" --archive-key "$T/akey"
is "two are out" "$CODE $(said '.subjects, .templates' | tr '\n' ' ')" "0 2 2 "
is "for the owner alone" "$(stat -c %a "$T/a")" 600
ok "it holds no plaintext" sh -c "! grep -aq 'alice\|left camera\|SURF\|surfacectl' '$T/a'"
on_exits 65 "$DB" export alice -o "$T/a" --archive-key "$T/akey" # an archive is not overwritten
on "$DB" export --all -o "$T/all" --archive-key "$T/phrase"
is "all, by a passphrase" "$CODE $(said .subjects)" "0 3"
is "who was exported is in the events" "$(sql "SELECT count(*) FROM access_log
    WHERE kind = 'export'" | tr -d '\n')" 5

# ---- import
on_exits 77 "$TO" import "$T/a" --archive-key "$T/phrase" # not by a passphrase
contains "it is said" "$T/ctl.err" 'not encrypted with this key'
on_exits 77 "$TO" import "$T/all" --archive-key "$T/akey" # nor by another
"$BUILD/surfacectl" --db "$T/plaintext" --plaintext-database init >"$T/out"
on_exits 77 "$TO" import "$T/plaintext" --archive-key "$T/akey" # which anyone can make
on "$TO" import "$T/a" --archive-key "$T/akey" --dry-run
is "what would come" "$CODE $(said '.subjects_new, .templates_new, .imported' |
    tr '\n' ' ')" "0 2 2 false "
on "$TO" stats
is "nobody did" "$(said .counts.subjects)" 0
on "$TO" import "$T/a" --archive-key "$T/akey"
is "two are in" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 2 2 "
on "$TO" import "$T/all" --archive-key "$T/phrase"
is "one more" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 1 1 "
is "as they were" "$(everything "$TO" | sha256sum)" "$(everything "$DB" | sha256sum)"
events=$(sqlite3 "$TO" "SELECT count(*) FROM $ENTRIES")
on "$TO" import "$T/all" --archive-key "$T/phrase"
is "twice is once" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 0 0 "
is "without an event" "$(sqlite3 "$TO" "SELECT count(*) FROM $ENTRIES")" "$events"
on "$TO" check-database
is "all is well" "$CODE $(said .templates)" "0 3"
on_exits 0 "$TO" verify alice "$T/p1.ply" # alice is alice
on_exits 1 "$TO" verify bob "$T/p1.ply" # and not bob

# ---- a subject that was erased there does not come back; a running daemon sees the
# others
on "$TO" subject erase --yes bob
DB=$TO
start_daemon --no-auth
on "$TO" import "$T/all" --archive-key "$T/phrase"
is "bob is left out" "$CODE $(said '.subjects_new, .subjects_erased' | tr '\n' ' ')" "0 0 1 "
gives 404 "he is not there" req GET /v1/subjects/bob
template=$("$BUILD/surfacectl" --db "$TO" --json subject show alice | jq -r '.templates[0].template_id')
on "$TO" template delete --yes "$template"
on_exits 65 "$TO" import "$T/all" --archive-key "$T/phrase" # of somebody who is enrolled
contains "it says what to do" "$T/ctl.err" 'subject alice is enrolled here.*--force'
on "$TO" import "$T/all" --archive-key "$T/phrase" --force
is "a deleted template does" "$CODE $(said .templates_new)" "0 1"
send POST /v1/subjects/alice/verify "$PLY" "$T/p1.ply"
is "the daemon sees it" "$STATUS $(get .decision)" "200 match"
stop_daemon
# The entry that says so is of somebody else: then nothing here says who was erased.
sqlite3 "$TO" "VACUUM INTO '$T/forged.db'"
cp "$TO.key" "$T/forged.db.key"
sqlite3 "$T/forged.db" "UPDATE change_log SET uid = zeroblob(16) WHERE kind = 'delete_subject'"
on_exits 77 "$T/forged.db" import "$T/all" --archive-key "$T/phrase"

# ---- another id here, then erased: the archive has the old one
on "$TO" subject rename alice ann
on "$TO" import "$T/all" --archive-key "$T/phrase"
is "she is there already" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 0 0 "
on "$TO" subject erase --yes ann
on "$TO" import "$T/all" --archive-key "$T/phrase"
is "she does not come back" "$CODE $(said '.subjects_new, .subjects_erased' | tr '\n' ' ')" "0 0 2 "
on "$TO" subject set alice --consent new
on "$TO" import "$T/all" --archive-key "$T/phrase"
is "nor by somebody of that id" "$CODE $(said '.templates_new, .subjects_erased' |
    tr '\n' ' ')" "0 0 2 "
on "$TO" subject list
is "who is there" "$(said '[.subjects[].subject] | join(" ")')" 'carol alice'
# Whom an id means is this database's to say.
rm -f "$T/third"*
on "$T/third" init
on "$T/third" enroll carol "$T/s1.ply"
on_exits 65 "$T/third" import "$T/all" --archive-key "$T/phrase" # another carol
on "$T/third" subject list
is "then nobody comes" "$(said '[.subjects[].subject] | join(" ")')" carol
on "$T/third" subject erase --yes carol
on "$T/third" import "$T/all" --archive-key "$T/phrase"
is "the id is free again" "$CODE $(said '.subjects_new, .subjects_erased' | tr '\n' ' ')" "0 3 0 "

# ---- all or nothing: the second of two subjects cannot be imported
DB=$T/faces.db
rm -f "$TO"*
on "$TO" init
# The same id under another subject: what an import must not mix up.
on "$DB" export bob -o "$T/bob" --archive-key "$T/akey"
on "$TO" import "$T/bob" --archive-key "$T/akey"
"$BUILD/forge" "$TO" "$TO.key" "UPDATE templates SET id = '$template'"
on_exits 65 "$TO" import "$T/a" --archive-key "$T/akey" # an id that is another's
on "$TO" subject list
is "nobody came" "$(said '[.subjects[].subject] | join(" ")')" bob

# ---- a damaged archive
# nobody TITLE: the database is as it was made.
nobody() {
    on "$TO" stats
    is "nobody came of $1" "$(said '.counts | .subjects, .templates' | tr '\n' ' ')" "0 0 "
}
rm -f "$TO"*
on "$TO" init
size=$(stat -c %s "$T/a")
for cut in 0 8 60 4096 $((size / 2)) $((size - 1)); do
    head -c "$cut" "$T/a" >"$T/bad"
    on "$TO" import "$T/bad" --archive-key "$T/akey"
    ok "cut to $cut bytes: exit $CODE" test "$CODE" = 65 -o "$CODE" = 77
done
cat "$T/a" "$T/a" >"$T/bad"
on_exits 65 "$TO" import "$T/bad" --archive-key "$T/akey" # something after its end
on_exits 65 "$TO" import "$T/s1.ply" --archive-key "$T/akey" # no archive at all
on_exits 66 "$TO" import "$T/nowhere" --archive-key "$T/akey" # no file
for change in 'UPDATE subjects SET hold = 1' 'UPDATE templates SET engine = 1' \
    'DELETE FROM templates WHERE template_key = 1' 'DELETE FROM subjects WHERE subject_key = 1' \
    'UPDATE faces SET face = (SELECT face FROM faces ORDER BY 1 LIMIT 1)' \
    'DELETE FROM change_log' 'UPDATE root SET secrets = zeroblob(136)' 'PRAGMA user_version = 9'; do
    cp "$T/a" "$T/bad"
    sqlite3 "$T/bad" "$change"
    on "$TO" import "$T/bad" --archive-key "$T/akey"
    ok "$change: exit $CODE" test "$CODE" = 65 -o "$CODE" = 77
done
nobody "all that"
# Bytes that SQLite does not use say nothing: then all of it comes, as it was.
cp "$TO" "$T/empty"
everything "$DB" | jq -c 'select(.subject != "carol")' >"$T/wanted"
refused=0 whole=0
for at in $(python3 -c "import random; random.seed(1)
print(18, *random.sample(range(100, $size), 40))"); do # 18: as if it had a WAL
    cp "$T/a" "$T/bad"
    python3 - "$T/bad" "$at" <<'END'
import sys
with open(sys.argv[1], 'r+b') as f:
    f.seek(int(sys.argv[2]))
    b = f.read(1)[0]
    f.seek(-1, 1)
    f.write(bytes([b ^ 3]))
END
    cp "$T/empty" "$TO"
    on "$TO" import "$T/bad" --archive-key "$T/akey"
    case $CODE in
    0)
        whole=$((whole + 1))
        everything "$TO" | jq -c . >"$T/came"
        ok "byte $at: as it was" cmp "$T/wanted" "$T/came"
        ;;
    65 | 77)
        refused=$((refused + 1))
        nobody "byte $at"
        ;;
    *) ok "byte $at: exit $CODE" false ;;
    esac
done
ok "refused: $refused, the same: $whole" test "$refused" -ge 4
is "no other file is left" "$(files "$T" | tr ' ' '\n' | grep -E '^(a|all|bad)([-.]|$)' | paste -sd ' ')" "a all bad"

# ---- as much memory for 100 subjects as for 10
# peak ARGUMENT...: KB that surfacectl needs at most.
peak() {
    python3 -c 'import resource, subprocess, sys
code = subprocess.call(sys.argv[1:], stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss if code == 0 else "failed")' \
        "$BUILD/surfacectl" --archive-key "$T/akey" --db "$@"
}
mkdir "$T/scans"
for s in $(seq 100); do
    scan "$s" 0 "$T/scans/m${s}_1.ply"
done
on_exits 0 "$T/many" init
on_exits 0 "$T/many" enroll "$T/scans"
# shellcheck disable=SC2046 # ids
few="$(peak "$T/many" export $(seq -f 'm%g' 10) -o "$T/few.archive")"
many=$(peak "$T/many" export --all -o "$T/many.archive")
# A sanitizer keeps what is freed.
sanitized || ok "exported: $few KB, $many KB" test "$many" -lt $((few + 3000))
on_exits 0 "$T/here" init
few=$(peak "$T/here" import "$T/few.archive")
many=$(peak "$T/here" import "$T/many.archive")
sanitized || ok "of $(($(stat -c %s "$T/many.archive") / 1024)) KB, imported: $few KB, $many KB" \
    test "$many" -lt $((few + 3000))
on "$T/here" stats
is "all are in" "$(said .counts.subjects)" 100
finish
