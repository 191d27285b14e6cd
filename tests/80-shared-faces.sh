#!/bin/sh
# Goal: on the development scans beside the checkout, where they are, each of the first ten
# subjects' next neutral scan is nearest to its own enrolment, over HTTP.
cd "$(dirname "$0")/.." || exit 1
FACES=../shared/faces
if [ ! -r "$FACES/id009_p1.ply" ]; then
    echo "SKIP $0: there is no $FACES"
    exit 0
fi
. tests/lib.sh

start_daemon --no-auth
subjects="id000 id001 id002 id003 id004 id005 id006 id007 id008 id009"
for s in $subjects; do
    send POST "/v1/subjects/$s/templates" "$PLY" "$FACES/${s}_enroll.ply"
    is "$s enrolled" "$STATUS" 201
done
first=0
for probe in $subjects; do
    for s in $subjects; do
        send POST "/v1/subjects/$s/verify" "$PLY" "$FACES/${probe}_p1.ply"
        echo "$(get .disparity_mm) $s $probe $STATUS"
    done | sort -g >"$T/ranks"
    is "$probe: all compared" "$(grep -c ' 200$' "$T/ranks")" 10
    nearest=$(head -n 1 "$T/ranks" | cut -d ' ' -f 2)
    [ "$nearest" != "$probe" ] || first=$((first + 1))
    echo "$probe: $(head -n 1 "$T/ranks" | cut -d ' ' -f 1,2), then $(sed -n 2p "$T/ranks")"
done
ok "own template first for $first of 10, at least 9" test "$first" -ge 9
finish
