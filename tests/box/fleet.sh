#!/bin/sh
# Goal: scripts/fleet does what it says: the daemons are restarted under load without a failed request,
# the primary is killed under load and nothing that was acknowledged is lost, a commit that was seen and
# is lost stops no daemon for long, a base backup restores, and nothing is left afterwards; 64 clients
# get no wrong response in a minute, and 2 no untrue one while 200 times something is killed.  Its own
# checks are in `drill`, `load` and `faults`; these look at it from outside.
. tests/box/lib.sh
PATH=$PATH:/usr/sbin
if ! ldd "$BUILD/surfaced" | grep -q libpq; then
    echo "SKIP $0: built without PostgreSQL"
    exit
fi
needs_section test haproxy nc /usr/lib/postgresql/15/bin/postgres
export FLEET="$T/fleet"
chmod 711 "$T" # root's servers run as nobody
trap 'scripts/fleet down >/dev/null 2>&1; cleanup' EXIT

# fleet WANTED COMMAND...: its exit status; its output is in $T/out.
fleet() {
    f_wanted=$1
    shift
    scripts/fleet "$@" >"$T/out" 2>&1 </dev/null
    is "fleet $* ($(tail -n 3 "$T/out"))" $? "$f_wanted"
}

# left: processes that name the folder; grep itself does not.
left() {
    # shellcheck disable=SC2062 # the names of files
    echo "$FLEET/" | grep -laF --file=- /proc/[0-9]*/cmdline 2>/dev/null | wc -l
}

fleet 1 status
fleet 0 up
URL=$(sed -n 's/.* HAProxy at \(http[^;]*\);.*/\1/p' "$T/out")
AUTH=$(sed -n 's/^Its token: //p' "$T/out")
fleet 1 up
send POST /v1/subjects/alice/verify "$PLY" "$FLEET/alice1.ply"
is "alice, through HAProxy" "$STATUS $(get .decision)" '200 match'
fleet 0 status
is "one primary, two standbys, two daemons" "$(grep -c 'primary  has' "$T/out") $(
    grep -c 'standby  has .*, connected' "$T/out") $(grep -c ', ready; in HAProxy: UP' "$T/out")" '1 2 2'
fleet 0 drill
cat "$T/out"
fleet 0 status
is "the same afterwards" "$(grep -c 'primary  has' "$T/out") $(
    grep -c 'standby  has .*, connected' "$T/out") $(grep -c ', ready; in HAProxy: UP' "$T/out")" '1 2 2'
for n in 1 2; do
    ok "the anchor of the daemon $n agreed each time" sh -c "! grep -q 'older than its anchor' '$FLEET/d$n/log'"
    is "it was started again after each lost commit" "$(grep -c 'server went back' "$FLEET/d$n/log")" 2
done
export CLIENTS=64
fleet 0 load 60
cat "$T/out"
export CLIENTS=2
fleet 0 faults 200
cat "$T/out"
fleet 0 kill-primary
fleet 1 kill-primary
ok "a standby is missing" grep -q rejoin "$T/out"
fleet 0 down
is "no process is left" "$(left)" 0
ok "nor the folder" test ! -e "$FLEET"
finish
