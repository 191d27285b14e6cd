#!/bin/sh
# Goal: beside attackers who send much, slowly, or nothing, who do not read, or who go, ordinary
# verifications are all answered and right.  How long they take, scripts/attack measures.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

command -v python3 >/dev/null 2>&1 || {
    echo "SKIP $0: python3 is not installed"
    exit 0
}
ok "the files" python3 tests/box/attack.py prepare "$BUILD" "$DB" "$T"
start_daemon --workers 2 --timeout 5 --max-connections 300 --attempts 0
python3 tests/box/attack.py "${URL#http://}" "$T" "${ATTACK_COUNT:-8}" >"$T/rows" 2>"$T/err"
is "the client ran ($(tail -n 1 "$T/err"))" $? 0
# shellcheck disable=SC2016 # the variable is jq's
jq -r '[.attack, .lost, (.refused | tojson), (.attacker // {} | tojson)] | @tsv' "$T/rows" >"$T/list"
while IFS="$(printf '\t')" read -r name lost refused told; do
    is "$name: lost and refused beside it (the attacker: $told)" "$lost $refused" '0 {}'
done <"$T/list"
ok "all attacks ran" test "$(wc -l <"$T/list")" -ge 20
req GET /metrics
for reason in client_gone crowded_out; do
    ok "the metrics count $reason" \
        grep -Eq "^surfaced_connections_closed_total\\{reason=\"$reason\"\\} [1-9]" "$T/body"
done
is "what the daemon could not do for want of something" "$(grep -Ec 'status=500' "$LOG")" 0
alive "all of it"
finish
