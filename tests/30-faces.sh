#!/bin/sh
# Goal: realistic scans (../shared/faces, where they are) end to end over HTTP: of the first
# 10 subjects the p1 probe's own template ranks first at least 9 times, and genuine probes
# score clearly below impostors.
cd "$(dirname "$0")/.." || exit 1
. tests/lib.sh

faces=../shared/faces
[ -f "$faces/id009_p1.ply" ] || {
    echo "SKIP $0: $faces is not there"
    exit 0
}
subjects='id000 id001 id002 id003 id004 id005 id006 id007 id008 id009'
start_daemon --no-auth
for s in $subjects; do
    send POST "/v1/subjects/$s/templates" "$PLY" "$faces/${s}_enroll.ply"
    is "enroll $s" "$STATUS" 201
done

first=0
: >"$T/genuine"
: >"$T/impostor"
for p in $subjects; do
    : >"$T/ranking"
    for s in $subjects; do
        send POST "/v1/subjects/$s/verify" "$PLY" "$faces/${p}_p1.ply"
        is "verify ${p}_p1 as $s" "$STATUS" 200
        kind=impostor
        [ "$p" != "$s" ] || kind=genuine
        get .disparity_mm >>"$T/$kind"
        echo "$(get .disparity_mm) $s" >>"$T/ranking"
    done
    [ "$(sort -g "$T/ranking" | sed -n '1s/.* //p')" != "$p" ] || first=$((first + 1))
done
ok "own template first for $first of 10, wanted 9" test "$first" -ge 9

# The worst genuine probe but one scores below 19 of 20 impostors.
worst=$(sort -g "$T/genuine" | tail -n 2 | head -n 1)
near=$(sort -g "$T/impostor" | sed -n 5p)
ok "genuine $worst mm below impostors' $near mm" \
    awk "BEGIN { exit !($worst < $near) }"
finish
