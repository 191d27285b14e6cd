#!/bin/sh
# Goal: the cloud of a template is refused as a probe of its subject, whatever the order and number
# of its points, the format and the unit, over HTTP and by surfacectl; any other scan is taken, as
# often as it comes.
. tests/box/lib.sh

XYZ='Content-Type: text/plain'

# verify SUBJECT TYPE FILE [CURL-OPTION...]
verify() {
    v_subject=$1
    shift
    send POST "/v1/subjects/$v_subject/verify" "$@"
}

decides() {
    is "$1" "$STATUS $(get .decision)" "200 $2"
}

scan 1 0 "$T/a.ply"
scan 1 0 "$T/a.xyz"
scan 1 1 "$T/a1.ply"
scan 1 1 "$T/a1.xyz"
shuf --random-source=/dev/zero "$T/a.xyz" >"$T/shuffled.xyz"
cat "$T/a.xyz" "$T/shuffled.xyz" >"$T/twice.xyz"
awk '{ printf "%s[%s,%s,%s]", NR == 1 ? "{\"points\":[" : ",", $1, $2, $3 } END { print "]}" }' \
    "$T/shuffled.xyz" >"$T/a.json"
awk '{ print $1 / 1000, $2 / 1000, $3 / 1000 }' CONVFMT=%.9g OFMT=%.9g "$T/a.xyz" >"$T/metres.xyz"
gzip -c "$T/a.ply" >"$T/a.ply.gz"
# Each coordinate is moved by 0.2 mm at most.
awk 'BEGIN { srand(1) } function moved(v) { return v + 0.4 * (rand() - 0.5) }
    { printf "%.6f %.6f %.6f\n", moved($1), moved($2), moved($3) }' "$T/a.xyz" >"$T/moved.xyz"
# On its side, so that the face has to be found.
awk '{ print -$2, $1, $3 }' "$T/a1.xyz" >"$T/turned.xyz"
tac "$T/turned.xyz" >"$T/turned-tac.xyz"

# ---- the cloud of a template
start_daemon --no-auth --attempts 0
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
id=$(get .template_id)
gives 201 "a scan on its side is enrolled" send POST /v1/subjects/bob/templates "$XYZ" "$T/turned.xyz"
for i in a.ply shuffled.xyz twice.xyz a.json metres.xyz a.ply.gz; do
    verify alice "$BYTES" "$T/$i"
    problem "$i" 422 replayed 'scan again'
    ok "$i: no disparity" sh -c "! grep -q disparity '$T/body'"
done
verify alice "$XYZ" "$T/turned-tac.xyz"
decides "the scan of another subject's template" match
gives "422 replayed" "one that is turned, in another order" verify bob "$XYZ" "$T/turned-tac.xyz"
gives "422 replayed" "by template" send POST "/v1/templates/$id/verify" "$JSON" "$T/a.json"
# Enrolled again it is the template that is there, also where not all of its points are used.
send POST /v1/subjects/alice/templates "$BYTES" "$T/metres.xyz"
is "enrolled again: the same template" "$STATUS $(get .template_id)" "200 $id"
scan 1 5 "$T/dense.xyz" --points 12000
shuf --random-source=/dev/zero "$T/dense.xyz" >"$T/dense-shuffled.xyz"
send POST /v1/subjects/dan/templates "$BYTES" "$T/dense.xyz"
dense=$(get .template_id)
is "a dense scan is enrolled, thinned" "$STATUS $(get '.scan.warnings | tojson')" '201 ["thinned"]'
send POST /v1/subjects/dan/templates "$BYTES" "$T/dense-shuffled.xyz"
is "in another order: the same template" "$STATUS $(get .template_id)" "200 $dense"
req DELETE /v1/subjects/dan
verify alice "$XYZ" "$T/moved.xyz" # what is not found, as docs/threat-model.md says
decides "other points" match
is "they are events" "$(sql "SELECT count(*) FROM $ENTRIES WHERE kind = 'verify' AND outcome = 'replayed'")" 8
is "and counted" "$(metric surfaced_replayed_total)" 8
is "but no decisions" "$(metric 'surfaced_decisions_total{decision="match"}')" 2
ctl verify alice "$T/shuffled.xyz"
is "surfacectl verify" "$CODE $(grep -c 'the scan was used before' "$T/ctl.err")" "65 1"
ctl verify alice "$T/a1.ply"
is "and another scan" "$CODE" 0
verify alice "$PLY" "$T/a1.ply"
decides "which is taken over HTTP too" match
verify alice "$PLY" "$T/a1.ply"
decides "and once more" match
req DELETE /v1/subjects/alice
gives 201 "erased and enrolled again" send POST /v1/subjects/alice/templates "$PLY" "$T/a1.ply"
verify alice "$PLY" "$T/a.ply"
decides "what the template was made of that is gone" match
gives "422 replayed" "the new one's" verify alice "$PLY" "$T/a1.ply"
req DELETE /v1/subjects/alice
req DELETE /v1/subjects/bob
is "nothing is left" "$(sql "SELECT count(*) FROM faces")" 0
stop_daemon

# ---- it counts as a failure
start_daemon --no-auth
send POST /v1/subjects/alice/templates "$PLY" "$T/a.ply"
for i in 1 2 3; do
    gives "422 replayed" "replay $i" verify alice "$PLY" "$T/a.ply"
done
gives "429 too_many_attempts" "then" verify alice "$PLY" "$T/a1.ply"
finish
