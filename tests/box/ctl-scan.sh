#!/bin/sh
# Goal: surfacectl scan says of any file what is found in it and what would be done, and what to
# do better; nothing is stored; it says what the daemon says.
. tests/box/lib.sh
in_folder

# one FILTER: of the first scan of the last expect's JSON
one() { jq -r ".scans[0] | $1" out; }

scan 2 0 a.ply --pose 4 --shift 5
scan 2 0 a.xyz --pose 4 --shift 5
awk 'BEGIN { for (x = -80; x <= 80; x += 3) for (y = -80; y <= 80; y += 3)
    print x, y, 60 - sqrt(x * x + y * y) }' >cone.xyz
awk 'BEGIN { for (x = -74; x <= 74; x += 2) for (y = -99; y <= 99; y += 2) if ((x / 75) ^ 2 + (y / 100) ^ 2 <= 1)
    print x, y, 19 * exp(-((x / 9) ^ 2 + (y / 27) ^ 2) / 2) - 50 * ((x / 72) ^ 2 + (y / 92) ^ 2) }' >egg.xyz
head -n 60 a.xyz >few.xyz
printf 'OFF\n3 1 0\n' >a.off
printf 'v 1 2 x\n' >bad.obj
: >empty.ply

# ---- a frontal scan in mm
expect 0 "a good scan" "$ctl" scan a.ply
has out '^scan  *a.ply$'
has out '^format  *PLY, 3000 points, 0 without a value, 29[0-9]* used$'
has out '^unit  *mm'
has out '^quality  *0\.9'
has out '^enrolment  *usable$'
has out '^verification  *usable$'
expect 0 "as JSON" "$ctl" scan --json a.ply
ok "its members" jq_true '.scans | length == 1 and (.[0] |
    .file == "a.ply" and .usable and .enrollable and .code == null and .detail == null and
    .advice == [] and .scan.format == "ply" and .scan.points_read == 3000 and
    .scan.points_used > 2800 and .scan.points_used <= 3000 and .scan.units == "mm" and (.scan.view | length) == 16 and
    .scan.occluded == 0 and .scan.warnings == [] and .quality.score > 0.9)' out

# ---- what cannot be used, and why
expect 1 "a cone" "$ctl" scan --json cone.xyz
is "it is refused" "$(one '[.enrollable, .code] | join(" ")')" 'false not_a_face'
ok "and why" [ "$(one '.detail | length')" -gt 20 ]
ok "and what to do" [ "$(one '.advice | length')" -gt 0 ]
expect 1 "an egg with a ridge like a nose" "$ctl" scan egg.xyz
has out '^verification  *accepted, but hardly a face$'
expect 1 "the same as JSON" "$ctl" scan --json egg.xyz
is "nothing is said of its chin" "$(one '.advice | join("; ")')" 'send one face seen from the front, with forehead, nose and chin'
expect 1 "few points" "$ctl" scan few.xyz
has out '^enrolment  *refused: few.xyz: 60 points, fewer than 100'
has out 'move nearer to the scanner, or let'
expect 1 "unreadable" "$ctl" scan a.off
has out '^enrolment  *refused: a.off: an OFF file'
expect 1 "as JSON" "$ctl" scan --json few.xyz
is "the detail names the file, and is no sentence in a sentence" "$(one '.detail | test("^few.xyz: 60 points")')" true
expect 1 "a format that is not read" "$ctl" scan --json a.off
is "it is told" "$(one .code)" malformed
ok "by its name" jq_true '.scans[0].detail | test("an OFF file, which is not read: send PLY")' out

# ---- several, one after the other
expect 1 "several" "$ctl" scan a.ply cone.xyz a.off bad.obj empty.ply a.xyz --json
is "each of them" "$(jq -r '[.scans[] | .enrollable] | join(" ")' out)" \
    'true false false false false true'
expect 66 "one that is not there" "$ctl" scan a.ply none.ply a.xyz
has err 'none.ply: No such file'
is "the others were looked at" "$(grep -c '^verification  *usable' out)" 2
expect 0 "from a pipe" sh -c "'$ctl' scan - <a.ply"

# ---- units, axes, and how a depth image is read are options here as well
awk '{ print $1 / 25.4, -$2 / 25.4, -$3 / 25.4 }' a.xyz >camera.xyz
expect 1 "inches taken for mm" "$ctl" scan --units mm camera.xyz --json
is "the extent tells" "$(one .code)" units_suspicious
awk '{ print $1 * 1000, $2 * 1000, $3 * 1000 }' a.xyz >micro.xyz
expect 0 "micrometres" "$ctl" scan --units um micro.xyz --json
is "the unit taken" "$(one .scan.units)" um
expect 1 "axes of a camera" "$ctl" scan --units in --axes scanner camera.xyz
expect 64 "an option it does not take" "$ctl" scan a.ply --label x

# ---- the face as a file
awk '{ print $1 / 1000, $3 / 1000, -$2 / 1000 }
    END { for (i = 0; i < 6400; i++) print i % 80 / 100 - 0.4, -0.4, int(i / 80) / 100 - 0.4 }' \
    a.xyz >wall.xyz # lying on its back before a wall, in metres
expect 0 "the face as a file" "$ctl" scan wall.xyz --face found.ply
expect 74 "in no folder" "$ctl" scan wall.xyz --face found.ply/x.ply
ok "which is said, with its name" grep -q 'cannot open the folder of found.ply/x.ply: Not a directory' "$T/err"
is "its owner's alone" "$(stat -c %a found.ply)" 600
expect 0 "what is in it" "$ctl" scan --json found.ply
ok "a frontal face in mm, and nothing else" jq_true '.scans[0] | .scan | .format == "ply" and
    .units == "mm" and .warnings == [] and (.yaw_deg | fabs) < 1 and .points_read < 3100' out
"$ctl" compare a.ply wall.xyz --json >whole.json
expect 0 "compared" "$ctl" compare a.ply found.ply --json
# shellcheck disable=SC2016 # the variable is jq's
ok "as the scan itself" jq_true --slurpfile w whole.json '.decision == $w[0].decision' out
cp wall.xyz kept.xyz
ln wall.xyz same.xyz
for force in '' --force; do
    for out in wall.xyz same.xyz ./wall.xyz; do
        # shellcheck disable=SC2086 # an option or none
        expect 65 "over the scan: $out $force" "$ctl" scan wall.xyz --face $out $force
        has err 'reads: it is never replaced'
    done
done
ok "it was not" cmp kept.xyz wall.xyz
expect 65 "over another file" "$ctl" scan wall.xyz --face found.ply
has err 'found.ply: the file exists: use --force'
expect 0 "with --force" "$ctl" scan wall.xyz --face found.ply --force
expect 1 "of what is no face" "$ctl" scan few.xyz --face few.ply
ok "there is none" [ ! -e few.ply ]
expect 64 "one face of several" "$ctl" scan a.ply a.xyz --face b.ply

# ---- as the daemon says
cd "$OLDPWD" || exit 1
start_daemon --no-auth
for name in a.ply cone.xyz few.xyz camera.xyz; do
    send POST /v1/check "$BYTES" "$T/$name"
    "$ctl" scan --json "$T/$name" >"$T/ctl" 2>"$T/ctl.err"
    is "$name: as POST /v1/check" \
        "$(jq -c '.scans[0] | del(.file, .detail, .timing_ms)' "$T/ctl")" \
        "$(jq -c 'del(.detail, .timing_ms)' "$T/body")"
done
finish
