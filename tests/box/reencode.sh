#!/bin/sh
# Goal: templates of another engine are never compared as if they were this one's: daemon
# and command respond as if the scans were enrolled now, say that there are such
# templates, and `template reencode` re-encodes them for good while the daemon serves:
# only the model changes, and a template that cannot be re-encoded stays and is reported.
# That nothing drifts is in test_reencode.c; what a kill leaves in crash.sh.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh
unset SURFACED_DB SURFACED_MODEL

counts() { said '[.templates, .reencoded, .current, .failed, .undone] | join(" ")'; }
# models: one with another mean face; and one that only hollow faces resemble.
mean() { awk -v how="$1" '/^change/ { on = 0 } on { for (i = 1; i <= NF; i++) if ($i != ".")
    $i = how == "hollow" ? -$i : $i + 1500 } /^mean/ { on = 1 } { print }' core/face/default.model; }
mean raised >"$T/raised.model"
mean hollow >"$T/hollow.model"

# verdicts: of the daemon, for alice and bob, without times; compared by the digits
verdicts() {
    for who in alice bob; do
        send POST "/v1/subjects/$who/verify" "$PLY" "$T/$who-later.ply"
        without_times "$T/body"
    done
}

for n in 1 2; do
    who=$([ $n = 1 ] && echo alice || echo bob)
    scan $n 0 "$T/$who.ply" --points 900
    scan $n 1 "$T/$who-later.ply" --points 900 --pose 8 --shift 10
done
# A hollow face, as only another model would take it, where it lies: none is searched for.
scan 3 0 "$T/dan.xyz"
awk '{ print $1, $2, -$3 }' "$T/dan.xyz" >"$T/hollow.xyz"

# ---- the reference: enrolled by this engine
ctl_exits 0 init
for who in alice bob; do ctl_exits 0 enroll $who "$T/$who.ply" --axes scanner; done
engine=$("$BUILD/surfacectl" --db "$DB" --json template list | jq -r '.templates[0].engine')
start_daemon --no-auth
verdicts >"$T/wanted"
is "two verdicts" "$(jq -r .decision "$T/wanted" | tr '\n' ' ')" 'match match '
ok "nothing is said" test "$(grep -c 'another engine' "$LOG")" -eq 0
stop_daemon
ctl_exits 0 template reencode
is "nothing to do" "$(counts)" '0 0 0 0 0'

# ---- the same enrolled by another engine
DB=$T/other.db
ctl_exits 0 init
for who in alice bob; do ctl_exits 0 enroll $who "$T/$who.ply" --axes scanner --model "$T/raised.model"; done
ctl_exits 0 enroll dan "$T/hollow.xyz" --axes scanner --model "$T/hollow.model"
ctl_exits 0 template list
is "all are of another engine" "$(said '[.templates[].to_reencode] | join(" ")')" 'true true true'
dan=$(said '.templates[2].template_id')
jq -c '[.templates[] | del(.engine, .to_reencode, .triangles)]' "$T/ctl" >"$T/kept"
ctl_exits 0 template list --model "$T/raised.model"
is "but by their own model" "$(said '[.templates[].to_reencode] | join(" ")')" 'false false true'
ctl_exits 0 stats
is "stats" "$(said '.counts.templates, .to_reencode' | tr '\n' ' ')" '3 3 '
ctl_exits 1 doctor
ok "doctor" grep -q 'template reencode' "$T/ctl"
ctl_exits 0 verify alice "$T/alice-later.ply"
is "the command: as enrolled now" "$(said .score)" \
    "$(jq .score "$T/wanted" | head -1)"

start_daemon --no-auth
ok "the daemon says so" grep -q 'level=warn msg="templates were made by another engine.* templates=3' "$LOG"
verdicts >"$T/before"
ok "as if enrolled now, to the last digit" cmp "$T/wanted" "$T/before"
gives 500 "never compared where that cannot be" send POST /v1/subjects/dan/verify "$PLY" "$T/alice-later.ply"
ok "and the log says why" grep -q 'template skipped.*cannot re-encode it' "$LOG"

# ---- for good, beside the daemon
ctl_exits 65 template reencode --threads 2
is "those that can be" "$(counts)" '3 2 0 1 0'
is "what failed" "$(said '.failures[].template_id')" "$dan"
ok "and why" grep -q "$dan was made by .*: not a face" "$T/ctl.err"
ctl_exits 65 template reencode
is "again" "$(counts)" '1 0 0 1 0'
verdicts >"$T/after"
ok "the daemon goes on with the same digits" cmp "$T/wanted" "$T/after"
is "an event each" "$(sql "SELECT count(*) FROM $ENTRIES
    WHERE kind = 'reencode' AND outcome = 'reencoded' AND actor LIKE 'surfacectl%'")" 2
ctl_exits 0 template list
is "by this engine" "$(said .templates[0].engine)" "$engine"
is "nothing else has changed" "$(jq -c '[.templates[] | del(.engine, .to_reencode, .triangles)]' "$T/ctl")" \
    "$(cat "$T/kept")"
ctl_exits 0 check-database
stop_daemon
start_daemon --no-auth
verdicts >"$T/after"
ok "as stored, too" cmp "$T/wanted" "$T/after"
stop_daemon

# ---- an archive of another engine
head -c 32 /dev/zero | tr '\0' a >"$T/akey"
chmod 600 "$T/akey"
ctl_exits 65 template reencode --model "$T/raised.model"
ctl_exits 0 export alice -o "$T/a" --archive-key "$T/akey"
from=$DB DB=$T/third.db
ctl_exits 0 init
ctl_exits 0 import "$T/a" --archive-key "$T/akey"
is "is taken, to be re-encoded" "$(said '.templates_new, .templates_to_reencode' | tr '\n' ' ')" '1 1 '
ctl_exits 0 verify alice "$T/alice-later.ply"
is "and judged by this one" "$(said .score)" "$(jq .score "$T/wanted" | head -1)"

# ---- as text
DB=$from
ctl_exits 0 stats
"$BUILD/surfacectl" --db "$DB" template reencode >"$T/text" 2>/dev/null
is "as text" "$(head -1 "$T/text")" "3 templates: 2 re-encoded by $engine, 0 current, 1 failed"
finish
