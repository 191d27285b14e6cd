#!/bin/sh
# Goal: subjects move to another database with all that is known of them, in an archive that
# nobody can read or change; importing is all or nothing, and twice is once.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

TO=$T/to.db
# ctl DATABASE ARGUMENT...
ctl() {
    database=$1
    shift
    "$BUILD/surfacectl" --db "$database" --json "$@" >"$T/ctl" 2>"$T/ctl.err" </dev/null
    CODE=$?
}

said() {
    jq -r "$1" "$T/ctl"
}

# everything DATABASE: all that it says of people.
everything() {
    for who in $("$BUILD/surfacectl" --db "$1" --json list | jq -r '.subjects[].subject'); do
        "$BUILD/surfacectl" --db "$1" --json show "$who"
    done
}

for s in 1 2 3; do
    scan "$s" 0 "$T/s$s.ply" --points 600
done
ctl "$DB" init
ctl "$DB" enroll alice "$T/s1.ply" --label 'left camera'
ctl "$DB" enroll bob "$T/s2.ply"
ctl "$DB" enroll carol "$T/s3.ply"
ctl "$TO" init
echo 'correct horse battery staple' >"$T/phrase"
od -An -tx1 -N 32 /dev/urandom | tr -d ' \n' >"$T/akey"
chmod 600 "$T/phrase" "$T/akey"
export SURFACED_KEY=

# ---- out
ctl "$DB" export alice bob
is "where to is asked" "$CODE" 64
ctl "$DB" export -o "$T/a"
is "whom is asked" "$CODE" 64
ctl "$DB" export alice --all -o "$T/a"
is "some or all" "$CODE" 64
ctl "$DB" export alice nobody -o "$T/a" --archive-key "$T/akey"
is "nobody of that name" "$CODE" 66
ok "then there is no archive" test ! -e "$T/a" -a ! -e "$T/a.part"
ctl "$DB" export alice bob -o "$T/a" --archive-key "$T/akey"
is "two are out" "$CODE $(said '.subjects, .templates' | tr '\n' ' ')" "0 2 2 "
is "for the owner alone" "$(stat -c %a "$T/a")" 600
ok "nothing stands open" sh -c "! grep -aq 'alice\|left camera\|SURF[^A]' '$T/a'"
ctl "$DB" export alice -o "$T/a" --archive-key "$T/akey"
is "an archive is not overwritten" "$CODE" 65
ctl "$DB" export --all -o "$T/all" --archive-key "$T/phrase"
is "all, by a passphrase" "$CODE $(said .subjects)" "0 3"
is "who was exported is in the events" "$(sqlite3 "$DB" "SELECT count(*) FROM events
    WHERE kind = 'export'" | tr -d '\n')" 5

# ---- in
ctl "$TO" import "$T/a" --archive-key "$T/phrase"
is "not by a passphrase" "$CODE" 77
ctl "$TO" import "$T/all" --archive-key "$T/akey"
is "nor by another" "$CODE" 77
ctl "$TO" import "$T/a" --archive-key "$T/akey" --dry-run
is "what would come" "$CODE $(said '.subjects_new, .templates_new, .imported' |
    tr '\n' ' ')" "0 2 2 false "
ctl "$TO" stats
is "nobody did" "$(said .subjects)" 0
ctl "$TO" import "$T/a" --archive-key "$T/akey"
is "two are in" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 2 2 "
ctl "$TO" import "$T/all" --archive-key "$T/phrase"
is "one more" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 1 1 "
is "as they were" "$(everything "$TO" | sha256sum)" "$(everything "$DB" | sha256sum)"
events=$(sqlite3 "$TO" 'SELECT count(*) FROM events')
ctl "$TO" import "$T/all" --archive-key "$T/phrase"
is "twice is once" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 0 0 "
is "without an event" "$(sqlite3 "$TO" 'SELECT count(*) FROM events')" "$events"
ctl "$TO" check
is "all is well" "$CODE $(said .templates)" "0 3"
ctl "$TO" verify alice "$T/s1.ply"
is "alice is alice" "$CODE" 0
ctl "$TO" verify bob "$T/s1.ply"
is "and not bob" "$CODE" 1

# ---- who was erased there does not come back; a daemon that runs sees who does
ctl "$TO" delete --yes bob
DB=$TO
start_daemon --no-auth
ctl "$TO" import "$T/all" --archive-key "$T/phrase"
is "bob is left out" "$CODE $(said '.subjects_new, .subjects_erased' | tr '\n' ' ')" "0 0 1 "
req GET /v1/subjects/bob
is "he is not there" "$STATUS" 404
template=$("$BUILD/surfacectl" --db "$TO" --json show alice | jq -r '.templates[0].template_id')
ctl "$TO" delete --yes "$template"
ctl "$TO" import "$T/all" --archive-key "$T/phrase"
is "a deleted template does" "$CODE $(said .templates_new)" "0 1"
send POST /v1/subjects/alice/verify "$PLY" "$T/s1.ply"
is "the daemon sees it" "$STATUS $(get .decision)" "200 match"
stop_daemon

# ---- another id here, then erased: the archive has the old one
ctl "$TO" subject rename alice ann
ctl "$TO" import "$T/all" --archive-key "$T/phrase"
is "she is there already" "$CODE $(said '.subjects_new, .templates_new' | tr '\n' ' ')" "0 0 0 "
ctl "$TO" delete --yes ann
ctl "$TO" import "$T/all" --archive-key "$T/phrase"
is "she does not come back" "$CODE $(said '.subjects_new, .subjects_erased' | tr '\n' ' ')" "0 0 2 "
ctl "$TO" subject set alice --reference new
ctl "$TO" import "$T/all" --archive-key "$T/phrase"
is "nor by somebody of that id" "$CODE $(said '.templates_new, .subjects_erased' |
    tr '\n' ' ')" "0 0 2 "
ctl "$TO" list
is "who is there" "$(said '[.subjects[].subject] | join(" ")')" 'carol alice'
# By the id alone, where another database knew somebody else by it.
rm -f "$T/third"*
ctl "$T/third" init
ctl "$T/third" enroll carol "$T/s1.ply"
ctl "$T/third" delete --yes carol
ctl "$T/third" import "$T/all" --archive-key "$T/phrase"
is "an id that was erased" "$CODE $(said '.subjects_new, .subjects_erased' | tr '\n' ' ')" "0 2 1 "
ctl "$T/third" subject set carol --reference back
ctl "$T/third" import "$T/all" --archive-key "$T/phrase"
is "until it is there again" "$CODE $(said '.templates_new, .subjects_erased' | tr '\n' ' ')" "0 1 0 "

# ---- all or nothing: the second of two cannot be
DB=$T/faces.db
rm -f "$TO"*
ctl "$TO" init
# The same id under another subject: what an import must not mix up.
ctl "$TO" import "$T/a" --archive-key "$T/akey"
ctl "$TO" delete --yes alice
sqlite3 "$TO" "DELETE FROM erased; UPDATE templates SET id = '$template'"
ctl "$TO" import "$T/a" --archive-key "$T/akey"
is "an id that is another's" "$CODE" 65
ctl "$TO" list
is "nobody came" "$(said '[.subjects[].subject] | join(" ")')" bob

# ---- an archive that is no good
rm -f "$TO"*
ctl "$TO" init
size=$(stat -c %s "$T/a")
for cut in 0 7 8 59 60 61 64 100 300 $((size / 2)) $((size - 40)) $((size - 1)); do
    head -c "$cut" "$T/a" >"$T/bad"
    ctl "$TO" import "$T/bad" --archive-key "$T/akey"
    ok "cut to $cut bytes: exit $CODE" test "$CODE" = 65 -o "$CODE" = 77
done
cat "$T/a" "$T/a" >"$T/bad"
ctl "$TO" import "$T/bad" --archive-key "$T/akey"
is "something after its end" "$CODE" 65
at=0
while [ "$at" -lt "$size" ]; do
    cp "$T/a" "$T/bad"
    byte=$(od -An -tu1 -j "$at" -N 1 "$T/bad" | tr -d ' ')
    # shellcheck disable=SC2059 # an octal number
    printf "\\$(printf %o $((byte ^ 16)))" |
        dd of="$T/bad" bs=1 seek="$at" conv=notrunc 2>/dev/null
    ctl "$TO" import "$T/bad" --archive-key "$T/akey"
    [ "$CODE" = 65 ] || [ "$CODE" = 77 ] || is "flipped at $at" "$CODE" "65 or 77"
    if [ "$at" -lt 80 ]; then at=$((at + 3)); else at=$((at + size / 20)); fi
done
ctl "$TO" import "$T/s1.ply" --archive-key "$T/akey"
is "no archive at all" "$CODE" 65
ctl "$TO" import "$T/nowhere" --archive-key "$T/akey"
is "no file" "$CODE" 66
ctl "$TO" stats
is "nobody came of all that" "$(said '.subjects, .templates' | tr '\n' ' ')" "0 0 "
ctl "$TO" check
is "and all is well" "$CODE" 0
finish
