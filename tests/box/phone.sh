#!/bin/sh
# Goal: a newcomer enrolls and verifies with a GLB file from a phone, in metres and with the
# shoulders, by the two curl lines of the README and without an option.
# shellcheck disable=SC2034,SC2317 # the variables and the function of the README's lines
. tests/box/lib.sh

command -v python3 >/dev/null 2>&1 || {
    echo "SKIP $0: python3 is not installed"
    exit 0
}

# phone NAME HEAD SEED [MM]: NAME.glb, a scan of the made-up head HEAD
phone() {
    "$BUILD/headscan" --kind bust --seed "$3" --unit "${4:-1000}" --agreed "made-up:$2" \
        -o "$T/$1.ply" || exit 1
    python3 - "$T/$1.ply" "$T/$1.glb" <<'EOF'
import json, struct, sys
data = open(sys.argv[1], "rb").read()
head, data = data.split(b"end_header\n", 1)
n = int(head.split(b"element vertex ")[1].split()[0])
size = len(data) // n
points = b"".join(data[i * size:i * size + 12] for i in range(n))
doc = {"asset": {"version": "2.0", "generator": "a phone"}, "scene": 0, "scenes": [{"nodes": [0]}],
       "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}],
       "buffers": [{"byteLength": len(points)}], "bufferViews": [{"buffer": 0, "byteLength": len(points)}],
       "accessors": [{"bufferView": 0, "componentType": 5126, "count": n, "type": "VEC3"}]}
text = json.dumps(doc).encode()
text += b" " * (-len(text) % 4)
open(sys.argv[2], "wb").write(
    struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(points))
    + struct.pack("<I4s", len(text), b"JSON") + text
    + struct.pack("<I4s", len(points), b"BIN\0") + points)
EOF
}

phone me 1 1
phone me-now 1 2
phone other 2 3
phone mm 1 4 1
ctl_exits 0 init
TOKEN=$(new_token me)
start_daemon
v1=$URL/v1
# As in the README.
c() { curl -sS -H "Authorization: Bearer $TOKEN" "$@"; echo; }
grep '^c .*[.]glb ' README.md >"$T/lines"
is "two lines" "$(wc -l <"$T/lines")" 2
here=$PWD
cd "$T" || exit 1
# shellcheck disable=SC1091 # made above
. ./lines >answers
cd "$here" || exit 1
sed -n 1p "$T/answers" >"$T/body"
is "enrolled" "$(get .subject)" me
is "the unit was found" "$(get .scan.units)" m
ok "so were the face, and what is not of it" jq_true \
    '.scan.points_used > 2000 and .scan.points_used <= 10000 and .scan.points_read > 20000' "$T/body"
sed -n 2p "$T/answers" >"$T/body"
is "verified" "$(get .decision)" match
AUTH=$TOKEN
send POST /v1/subjects/me/verify 'Content-Type: model/gltf-binary' "$T/other.glb"
is "somebody else" "$STATUS $(get .decision)" "200 no_match"

# ---- the command
"$BUILD/surfacectl" scan --json "$T/me.glb" >"$T/ctl"
is "what is found" "$(said '.scans[0] | [.usable, .enrollable, .scan.units] | join(" ")')" \
    "true true m"
ctl_exits 0 verify me "$T/me-now.glb"
ctl_exits 1 verify me "$T/other.glb"
ctl_exits 0 verify me "$T/mm.glb"
is "a program that does not keep to the format's unit" "$(said .scan.units)" mm
finish
