#!/bin/sh
# check_deb.sh: test the Debian packages in $BUILD/deb on a bare Debian 12: install, start by
# systemd, use, upgrade, remove, install again, purge.  mmdebstrap makes the system in a
# temporary folder, from Debian's mirror, and its own systemd is booted there.  Needs root and
# some minutes; the last line is "N passed, N failed".  The bare system is kept in $BUILD as a
# tar file for the next run.
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build}
deb=$(ls "$BUILD"/deb/surfaced_*.deb) || exit 1
dev=$(ls "$BUILD"/deb/libsurface-dev_*.deb) || exit 1
lib=$(ls "$BUILD"/deb/libsurface0_*.deb) || exit 1
bare=$BUILD/bookworm.tar
db=/var/lib/surfaced/surfaced.db
passed=0 failed=0 boot='' system=''
if [ "$(id -u)" -ne 0 ] || ! command -v mmdebstrap >/dev/null; then
    echo "check_deb: needs root and mmdebstrap (scripts/setup check-deb)" >&2
    exit 1
fi
place=$(mktemp -d)
root=$place/root
log=$place/log

clean_up() {
    if [ -n "$boot" ]; then
        kill -KILL "$boot" # unshare --kill-child then kills the systemd too
        wait "$boot"
    fi 2>/dev/null
    rm -rf --one-file-system "$place"
}
trap clean_up EXIT
trap 'exit 1' INT TERM

# ok TITLE COMMAND...: a test; it passes if the command exits 0.
ok() {
    title=$1
    shift
    if "$@" >"$log" 2>&1; then
        echo "  ok    $title"
        passed=$((passed + 1))
    else
        echo "  FAIL  $title"
        tail -n 20 "$log" | sed 's/^/        | /'
        failed=$((failed + 1))
    fi
}
no() { ! "$@"; }
is() { [ "$1" = "$2" ]; }

# run COMMAND...: in the booted system, or before the boot in a chroot.
run() {
    if [ -n "$system" ]; then
        nsenter -t "$system" -m -p -u -i -n -C env -i LC_ALL=C \
            DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"
    else
        chroot "$root" env -i LC_ALL=C DEBIAN_FRONTEND=noninteractive \
            PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"
    fi
}
install_deb() { run apt-get -q -y --no-install-recommends install "$@"; }
surfacectl() { run runuser -u surfaced -- surfacectl --db $db "$@"; }
http() { nsenter -t "$system" -n curl -sS -f -m 20 -H "Authorization: Bearer $token" "$@"; }
pid() { run systemctl show -P MainPID surfaced.service; }

# in_time COMMAND...: repeat the command for a minute, until it succeeds.
in_time() {
    for _ in $(seq 300); do
        "$@" && return
        sleep 0.2
    done
    return 1
}
another_pid() { [ "$(pid)" != "$1" ] && [ "$(pid)" != 0 ]; }

# An earlier version to upgrade from: the same package with a lower version number.
earlier() {
    dpkg-deb -R "$deb" "$place/earlier" &&
        sed -i 's/^Version: .*/Version: 0.0.1/' "$place/earlier/DEBIAN/control" &&
        dpkg-deb --root-owner-group -b "$place/earlier" "$root/surfaced_0.0.1.deb"
}

boot() {
    setsid scripts/boot_root.sh "$root" >"$place/boot.log" 2>&1 </dev/null &
    boot=$!
    in_time pgrep -P "$boot" || return 1
    system=$(pgrep -P "$boot")
    in_time run test -S /run/systemd/private
}

echo "== the packages"
if command -v lintian >/dev/null; then
    ok "lintian" lintian --fail-on error,warning "$deb" "$lib" "$dev"
else
    echo "  SKIP  lintian: it is not installed"
fi
if [ ! -s "$bare" ]; then
    mmdebstrap --variant=minbase --skip=cleanup/apt bookworm "$place/bare.tar" &&
        mv "$place/bare.tar" "$bare" || exit 1
fi
mkdir -p "$root"
tar -x --exclude './dev/*' -f "$bare" -C "$root" || exit 1
cp /etc/resolv.conf "$root/etc/"
for device in null random urandom; do cp -a "/dev/$device" "$root/dev/"; done
cp "$deb" "$root/surfaced.deb"
cp "$lib" "$root/surface0.deb"
cp "$dev" "$root/surface.deb"
for scan in 0 1; do
    "$BUILD/facegen" --subject 1 --scan $scan -o "$root/alice-$scan.ply" || exit 1
done

echo "== installed on a bare Debian 12"
earlier >"$log" || exit 1
ok "installs with the dependencies that apt finds" install_deb /surfaced_0.0.1.deb
ok "the library installs beside it" install_deb /surface0.deb /surface.deb
ok "there is a system user" run getent passwd surfaced
ok "it cannot log in" is "$(run getent passwd surfaced | cut -d : -f 7)" /usr/sbin/nologin
ok "it owns the state folder" is "$(run stat -c '%U %a' /var/lib/surfaced)" "surfaced 700"
for file in surfaced.db surfaced.db.key; do
    ok "it made $file" is "$(run stat -c '%U %a' /var/lib/surfaced/$file)" "surfaced 600"
done
ok "the unit does not say --create" no run grep -rq '^ExecStart.*create' /lib/systemd/system/surfaced.service
ok "surfacectl runs" run surfacectl --version
for file in doc/surfaced/examples/grafana-dashboard.json doc/surfaced/examples/signed-capture \
    bash-completion/completions/surfacectl; do
    ok "it has $file" run test -s /usr/share/$file
done
ok "the settings are valid" run runuser -u surfaced -- surfaced --check-config
ok "the service is enabled" run systemctl is-enabled surfaced.service
ok "the socket is not enabled" no run systemctl is-enabled surfaced.socket

echo "== running"
ok "systemd boots" boot
ok "the service is active" in_time run systemctl -q is-active surfaced.service
first=$(pid)
ok "not root, no capabilities, filtered system calls" run sh -c "
    set -e
    grep -q '^Uid:	[1-9]' /proc/$first/status
    grep -q '^CapBnd:	0*\$' /proc/$first/status
    grep -q '^NoNewPrivs:	1' /proc/$first/status
    grep -q '^Seccomp:	2' /proc/$first/status"
token=$(surfacectl token create check --scope enroll,verify,read 2>/dev/null)
ok "surfacectl enrolls beside the daemon" run sh -c \
    "cat /alice-0.ply | runuser -u surfaced -- surfacectl --db $db enroll alice -"
probe() {
    http -H 'Content-Type: model/x-ply' --data-binary "@$root/alice-1.ply" \
        http://127.0.0.1:8787/v1/subjects/alice/verify | grep '"decision": *"match"'
}
ok "the daemon verifies" probe
ok "reload" run systemctl reload surfaced.service
ok "verifies after a reload" probe
ok "it is the same process" is "$(pid)" "$first"

echo "== hung and crashed"
run mkdir -p /run/systemd/system/surfaced.service.d
run sh -c 'printf "[Service]\nWatchdogSec=2\n" >/run/systemd/system/surfaced.service.d/w.conf'
run systemctl daemon-reload
run systemctl restart surfaced.service
before=$(pid)
run sh -c "kill -STOP $before"
ok "the watchdog restarts a daemon that hangs" in_time another_pid "$before"
run rm -r /run/systemd/system/surfaced.service.d
run systemctl daemon-reload
run systemctl restart surfaced.service
before=$(pid)
run sh -c "kill -KILL $before"
ok "systemd restarts it after a crash" in_time another_pid "$before"
ok "the daemon verifies again" in_time probe

echo "== lost, and put back"
run systemctl stop surfaced.service
ok "the database is good after a crash and a stop" surfacectl check-database
anchor=/var/lib/surfaced/anchor # on a disk of its own, were this no test
run sh -c "echo 'anchor = $anchor' >>/etc/surfaced.conf"
ok "an anchor is made" surfacectl --anchor $anchor accept-state --yes
run mv $db /var/lib/surfaced/away
ok "the service does not start without its database" no run systemctl start surfaced.service
ok "and makes none" no run test -e $db
run sh -c "cp /var/lib/surfaced/away $db; chown surfaced: $db; chmod 600 $db"
surfacectl --anchor $anchor token create later --scope verify >"$log" 2>&1
run mv /var/lib/surfaced/away $db
ok "nor with an older one" no run systemctl start surfaced.service
ok "unless it is accepted" surfacectl --anchor $anchor accept-state --yes
run systemctl reset-failed surfaced.service
ok "then it starts" run systemctl start surfaced.service
ok "the daemon verifies once more" in_time probe
run sed -i '/^anchor/d' /etc/surfaced.conf

echo "== upgraded"
run sh -c 'echo "queue = 77" >>/etc/surfaced.conf'
before=$(pid)
ok "upgrades" install_deb /surfaced.deb
ok "the new daemon runs" in_time another_pid "$before"
ok "the database is kept" probe
ok "the settings are kept" run grep 'queue = 77' /etc/surfaced.conf

echo "== activated by the socket"
run systemctl stop surfaced.service
ok "the service stops cleanly" is "$(run systemctl show -P Result surfaced.service)" success
ok "the socket is enabled" run systemctl -q enable --now surfaced.socket
ok "the service is not running" is "$(pid)" 0
ok "the first request starts it" probe
ok "the daemon accepts connections itself" is "$(run systemctl show -P NAccepted surfaced.socket)" 0

echo "== removed"
ok "removes" run apt-get -q -y remove surfaced
ok "the daemon is stopped" no run pgrep -x surfaced
ok "the programs are removed" no run test -e /usr/sbin/surfaced -o -e /usr/bin/surfacectl
ok "the database is kept" run test -s $db
ok "the settings are kept" run test -s /etc/surfaced.conf
ok "installs again" install_deb /surfaced.deb
ok "the database is used again" in_time probe

echo "== purged"
ok "purges" run apt-get -q -y purge surfaced libsurface-dev libsurface0
left=$(run find / -xdev -name '*surface[d.]*' -not -path '/proc/*' -not -path '/sys/*' \
    -not -name '*.deb' -not -path '/var/log/*' -not -path '/tmp/*')
ok "no file is left: $(echo "$left" | tr '\n' ' ')" is "$left" ""
ok "the system user stays" run getent passwd surfaced

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
