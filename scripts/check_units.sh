#!/bin/sh
# check_units.sh: systemd accepts the units without a warning, and `systemd-analyze security`
# rates the services' exposure at most 2.0; faces and keys stay out of swap and core files.
set -eu
cd "$(dirname "$0")/.."
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
program=$(realpath "${BUILD:-build}/surfaced")
sed "s|=/usr/sbin/surfaced|=$program|" packaging/surfaced.service >"$place/surfaced.service"
sed "s|/usr/bin/surfacectl|${program%ed}ectl|" packaging/surfaced-backup.service \
    >"$place/surfaced-backup.service"
cp packaging/surfaced.socket packaging/surfaced-backup.timer "$place/"
if systemd-analyze verify --man=no "$place"/surfaced* 2>&1 | grep .; then
    exit 1 # any output is a warning
fi
for limit in MemoryMax= MemorySwapMax=0 TasksMax= LimitCORE=0; do
    grep -q "^$limit" packaging/surfaced.service || {
        echo "surfaced.service has no $limit" >&2
        exit 1
    }
done
for unit in surfaced surfaced-backup; do
    systemd-analyze security --offline=true --no-pager --threshold=20 \
        "packaging/$unit.service"
done
