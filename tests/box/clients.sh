#!/bin/sh
# Goal: the clients of docs/clients.md, each in its language, do what the document says: they enroll
# and verify, and each error is told to the one who can do something about it.
. tests/box/lib.sh
needs_section clients go node /usr/bin/python3

ctl init
token=$(new_token clients --scope enroll,verify)
scan 1 0 "$T/a.ply"
scan 1 1 "$T/again.ply" --pose 8 --shift 10
scan 2 0 "$T/other.ply"
head -c 2000 "$T/a.ply" >"$T/short.ply"
scan 1 0 "$T/all.xyz"
head -n 60 "$T/all.xyz" >"$T/few.xyz"
mkdir "$T/py"
cp -R clients/python/surfaced "$T/py"
scripts/example.sh sh docs/clients.md >"$T/client.sh"
scripts/example.sh python docs/clients.md >"$T/client.py"
scripts/example.sh js docs/clients.md >"$T/client.mjs"
scripts/example.sh go docs/clients.md >"$T/client.go"
chmod +x "$T/client.sh"
ok "the program in Go compiles" env GOCACHE="$T/go" GOFLAGS=-mod=mod GO111MODULE=off HOME="$T" \
    go build -o "$T/client" "$T/client.go"
ok "and is laid out as gofmt has it" test -z "$(gofmt -l "$T/client.go")"

# client LANGUAGE ARGUMENT...: $CODE, and its output in $T/out.
client() {
    case $1 in
    curl) command="sh $T/client.sh" ;;
    python) command="env PYTHONPATH=$T/py /usr/bin/python3 $T/client.py" ;;
    node) command="node $T/client.mjs" ;;
    go) command=$T/client ;;
    esac
    shift
    # shellcheck disable=SC2086 # a program and its arguments
    env SURFACED_URL="$URL" SURFACED_TOKEN="${TOKEN:-$token}" no_proxy='*' $command "$@" >"$T/out" 2>&1
    CODE=$?
}

# tells TITLE STATUS PATTERN...: of the last client.
tells() {
    is "$1, $language" "$CODE" "$2"
    title=$1
    shift 2
    for pattern in "$@"; do
        contains "$title, $language" "$T/out" "$pattern"
    done
}

start_daemon
for language in curl python node go; do
    client "$language" "$language" "$T/a.ply" "$T/again.ply"
    tells "one person" 0 '^enrolled [0-9a-f]{32}$' '^match$'
    client "$language" "$language" "$T/a.ply" "$T/other.ply"
    tells "another" 1 '^no_match$'
    client "$language" "$language" "$T/few.xyz" "$T/other.ply"
    tells "a scan that cannot be enrolled" 2 "^move nearer to the scanner"
    client "$language" "$language" "$T/a.ply" "$T/short.ply"
    tells "a file that is cut off" 2 '^400 malformed: .*promises 3000 points'
    client "$language" "$language" "$T/other.ply" "$T/other.ply"
    tells "another person's scan" 2 '^409 sample_mismatch: '
    client "$language" "$language" "$T/none.ply" "$T/other.ply"
    is "a file that is not there, $language" "$CODE" 2
    TOKEN=sfd_wrong client "$language" "$language" "$T/a.ply" "$T/again.ply"
    tells "a wrong token" 2 '^401 unauthorized: '
    client "$language" "$language" "$T/a.ply" "$T/other.ply"
    client "$language" "$language" "$T/a.ply" "$T/again.ply"
    tells "a lock-out" 2 '^429 too_many_attempts: '
    [ "$language" = curl ] || contains "when it ends, $language" "$T/out" '^try again in [0-9]+ s$'
    client "$language" "../$language" "$T/a.ply" "$T/again.ply"
    is "an id that is none, $language" "$CODE" 2
done

# ---- a depth camera: several frames are one attempt
scripts/example.sh bash docs/clients.md >"$T/camera.sh"
for k in 0 1 2 3 4 5 6 7; do # four of one person, and four of another
    scan $((1 + k / 4)) $k "$T/frame.ply"
    "$BUILD/surfacelab" simplify "$T/frame.ply" --tolerance 0.0005 --force -o "$T/mesh.ply" >"$T/out"
    mkdir "$T/depth"
    /usr/bin/python3 tests/box/formats.py "$T/mesh.ply" "$T/depth"
    mv "$T/depth/depth.png" "$T/$k.png"
    rm -r "$T/depth"
done
# camera PATTERN ARGUMENT...: the script's output has it.
camera() {
    pattern=$1
    shift
    (cd "$T" && env SURFACED_URL="$URL" SURFACED_TOKEN="$token" no_proxy='*' sh camera.sh "$@" >out 2>&1)
    contains "camera $*" "$T/out" "$pattern"
}
camera '^[0-9a-f]{32}$' enroll cam 0.png 1.png
camera '^match$' verify cam 2.png 3.png
camera '^left out: short.ply: ' verify cam 2.png short.ply
camera '^no_match$' verify cam 4.png 5.png 6.png
ctl attempts list
is "three frames are one attempt" "$(said '.attempts[] | select(.subject == "cam") | .failures')" 1
camera '^no_match$' verify cam 4.png
sed -i 's/=600/=550/g' "$T/camera.sh"
camera '^no_match$' verify cam 3.png
ok "550 for 600 is not seen" sh -c "! grep -q focal_length '$T/out'"
camera '^too_many_attempts: ' verify cam 3.png
sed -i 's/=550/=500/g' "$T/camera.sh"
camera '^warning: focal_length$' enroll wrong 3.png
ok "Python, in one line" env SURFACED_URL="$URL" SURFACED_TOKEN="$token" PYTHONPATH="$T/py" no_proxy='*' \
    /usr/bin/python3 -c "
from surfaced import Client
camera = {'fx': 600, 'fy': 600, 'cx': 119.5, 'cy': 159.5, 'depth_scale': 0.0001}
with Client() as client:
    client.enroll('line', '$T/4.png', '$T/5.png', **camera)
    assert client.verify('line', '$T/6.png', '$T/7.png', **camera)['decision'] == 'match'"

# ---- who is it?
scripts/example.sh shell docs/clients.md >"$T/who.sh"
# who WANTED TOKEN SCAN...: what the script prints.
who() {
    wanted=$1 with=$2
    shift 2
    (cd "$T" && env SURFACED_URL="$URL" SURFACED_TOKEN="$with" no_proxy='*' sh who.sh "$@" >out 2>&1)
    contains "who $*" "$T/out" "$wanted"
}
hall=$(new_token hall --scope identify)
scan 8 0 "$T/ida.ply"
scan 8 1 "$T/ida2.ply" --pose 8 --shift 10
scan 8 2 "$T/ida3.ply" --pose 8 --shift 10
scan 9 0 "$T/stranger.ply"
ctl enroll ida "$T/ida.ply"
who '^ida$' "$hall" ida2.ply
who '^ida$' "$hall" ida2.ply ida3.ply
who '^nobody of the [0-9]+ who were searched$' "$hall" stranger.ply
who '^malformed: ' "$hall" short.ply
who '^insufficient_scope: ' "$token" ida2.ply
ok "Python, in one line" env SURFACED_URL="$URL" SURFACED_TOKEN="$hall" PYTHONPATH="$T/py" no_proxy='*' \
    /usr/bin/python3 -c "
from surfaced import Client
with Client() as client:
    assert client.identify('$T/ida3.ply')['subject'] == 'ida'
    assert client.identify('$T/stranger.ply')['subject'] is None"

# ---- what happens: a door, a monitoring system, a personnel system
scripts/example.sh py docs/clients.md >"$T/door.py"
scripts/example.sh python3 docs/clients.md >"$T/collector.py"
scripts/example.sh shell-script docs/clients.md >"$T/staff.sh"
ok "the shell script is good" shellcheck "$T/staff.sh"
id_of() {
    sql "SELECT id FROM tokens WHERE name = '$1'"
}
front=$(new_token front --scope verify --group staff)
for name in door siem; do new_token $name --scope events --group staff >"$T/$name.token"; done
staff_token=$(new_token staff --scope manage,delete --group staff)
echo "a secret of both" >"$T/secret"
ctl_exits 0 subject set ida --group staff
ctl_exits 0 enroll guest "$T/other.ply"
env SURFACED_URL="$URL" SURFACED_TOKEN="$(cat "$T/door.token")" PYTHONPATH="$T/py" no_proxy='*' \
    /usr/bin/python3 "$T/door.py" "$(id_of front)" >"$T/door" 2>&1 &
door=$!
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
/usr/bin/python3 "$T/collector.py" "$port" "$T/secret" >"$T/collected" 2>&1 &
collector=$!
forward() {
    env SURFACED_URL="$URL" PYTHONPATH="$T/py" no_proxy='*' /usr/bin/python3 -m surfaced.forward --to "http://127.0.0.1:$port/" \
        --cursor "$T/cursor" --secret-file "$T/secret" --token-file "$T/siem.token" >"$T/forwarded" 2>&1 &
    forwarder=$!
}
forward
trap 'kill -9 $door $collector $forwarder 2>/dev/null; cleanup' EXIT
# shellcheck disable=SC2034 # for metric
WATCHER=$(new_token watcher --scope audit)
# shellcheck disable=SC2317 # called by soon
two_listen() { [ "$(metric surfaced_event_streams)" = 2 ]; }
ok "the door and the forwarder listen" soon two_listen
# at FRONT SCAN...: a verification of ida at the door
at_front() {
    AUTH=$front send POST /v1/subjects/ida/verify "$PLY" "$T/$1.ply"
    AUTH=
}
staff() {
    env SURFACED_URL="$URL" SURFACED_TOKEN="$staff_token" no_proxy='*' sh "$T/staff.sh" "$@" >"$T/out" 2>&1
    CODE=$?
}
at_front ida2
ok "the door opens" soon grep -qx 'open for ida' "$T/door"
staff suspend ida
is "suspended" "$CODE" 0
at_front ida2
ok "not for whoever is suspended" soon grep -qx 'scan again: subject_disabled' "$T/door"
is "it has opened once" "$(grep -c open "$T/door")" 1
staff resume ida
is "resumed" "$CODE" 0
kill -9 $forwarder # what happens meanwhile is not lost
for _ in 1 2 3; do at_front stranger; done
ok "a lock-out, with its end" soon grep -q '^ida is locked out until 20' "$T/door"
forward
# shellcheck disable=SC2317 # called by soon
all_collected() { [ "$(wc -l <"$T/collected")" -ge 8 ]; }
ok "all is collected" soon all_collected
is "each once, in order" "$(cut -d ' ' -f 2,3 "$T/collected" | paste -sd ,)" "verify match,subject_disabled disabled,\
refused subject_disabled,subject_enabled enabled,verify no_match,verify no_match,verify no_match,locked_out locked_out"
is "none but of ida" "$(cut -d ' ' -f 4 "$T/collected" | sort -u | paste -sd ' ')" ida
staff erase ida "$T/receipt.json"
is "erased" "$CODE" 0
ok "with a receipt" jq_true '.signature and .subject == "ida"' "$T/receipt.json"
staff suspend guest
is "of other groups there is nobody" "$CODE" 2
contains "which is said" "$T/out" '^404 not_found: '
curl -sS -o "$T/out" -w '%{http_code}' -d '{"cursor": "1-1"}' -H "Surfaced-Signature: t=$(date +%s),v1=00" "http://127.0.0.1:$port/" >"$T/s"
is "a forged event is refused" "$(cat "$T/s") $(grep -c '1-1' "$T/collected")" "401 0"
kill $door $collector $forwarder
wait $door $collector $forwarder 2>/dev/null

stop_daemon
for language in curl python node go; do
    client "$language" "$language" "$T/a.ply" "$T/again.ply"
    is "no daemon, $language" "$CODE" 2
    ok "which is said, $language" test -s "$T/out"
done
start_daemon --disk-reserve 1000000G
for language in curl python node go; do
    client "$language" new "$T/a.ply" "$T/again.ply"
    tells "no room" 2 '^503 storage_full: '
done
finish
