#!/bin/sh
# Goal: with fuse=false several files of a form are enrolled together: each that matches the first accepted sample
# becomes a template, the response lists them all, and a request takes full effect or none.
# shellcheck disable=SC2016 # the variables are jq's
. tests/box/lib.sh

for k in 0 1 2 3; do
    scan 1 $k "$T/a$k.ply" --pose $((2 * k))
done
scan 2 0 "$T/b.ply"
scan 2 1 "$T/c.ply"
scan 1 4 "$T/a4.xyz"
gzip -k "$T/a3.ply" "$T/a4.xyz"
echo 'no scan' >"$T/none.ply"
awk 'BEGIN { for (i = 0; i < 2000; i++) print i % 50 * 3, int(i / 50) * 4, 0 }' >"$T/plane.xyz"
head -c 1500 "$T/a1.ply" >"$T/cut.ply"

# burst SUBJECT[?QUERY] FILE...: enrolls them; the template ids or refusals are in $LIST.
burst() {
    b_subject=${1%%\?*} b_query='?fuse=false'
    [ "$1" = "$b_subject" ] || b_query="$b_query&${1#*\?}"
    shift
    for b_file; do
        set -- "$@" -F "file=@$T/$b_file"
        shift
    done
    req POST "/v1/subjects/$b_subject/templates$b_query" "$@"
    LIST=$(get '[.templates[] | if .refusal then .refusal.code elif .new then "new" else "same" end]
        | join(" ")')
}
stored() { sql "SELECT count(*) FROM $1"; }
# mismatches [OUTCOME]: files that did not match the templates, or those with this outcome.
mismatches() {
    sql "SELECT count(*) FROM $ENTRIES WHERE kind = 'enroll_mismatch' AND outcome LIKE '${1-no_match}'"
}

start_daemon --attempts 4 --max-body 2000000 --workers 2
AUTH=$(new_token one)

# ---- a new subject: the first is taken, a stranger and what is no face are not
burst alice a0.ply b.ply none.ply a1.ply a0.ply plane.xyz a2.ply cut.ply
is "a burst" "$STATUS $LIST" '201 new sample_mismatch malformed new same not_a_face new malformed'
is "its names" "$(get '.subject + " " + ([.templates[].file] | join(" "))')" \
    'alice a0.ply b.ply none.ply a1.ply a0.ply plane.xyz a2.ply cut.ply'
is "its location is the first" "$(field Location)" "/v1/templates/$(get '.templates[0].template_id')"
is "the same cloud, the same template" "$(get '.templates[4].template_id')" \
    "$(get '.templates[0].template_id')"
ok "a stranger, told apart" jq_true '.templates[1] | .template_id == null and .quality == null and
    .scan.points_read == 3000 and
    (.refusal.detail | test("does not match the first accepted sample"))' "$T/body"
ok "no scan" jq_true '.templates[2] | .scan == null and .quality == null and .new == false' "$T/body"
ok "no face: the advice" jq_true '.templates[5].refusal.detail | test("^plane.xyz: the surface does not have")' \
    "$T/body"
ok "a template" jq_true '.templates[3] | .refusal == null and .quality.score > 0.5' "$T/body"
is "between the samples no attempt is counted" "$(mismatches) $(stored attempts)" '0 0'
ids=$(get '[.templates[].template_id | values] | unique | join(" ")')
req GET /v1/subjects/alice
is "they are there" "$(get '[.templates[].template_id] | sort | join(" ")')" "$ids"
is "an event each" "$(sql "SELECT count(*) FROM $ENTRIES WHERE kind = 'enroll'")" 3
send POST /v1/subjects/alice/verify "$PLY" "$T/a3.ply"
is "verified by them" "$STATUS $(get '[.decision, .templates_compared] | @csv')" '200 "match",3'
burst alice a0.ply b.ply none.ply a1.ply
is "again" "$STATUS $LIST $(stored templates)" '200 same sample_mismatch malformed same 3'
is "now it is recorded, and not counted" "$(mismatches) $(mismatches '%first sample') $(stored attempts)" '0 1 0'
is "metrics" "$(metric 'surfaced_enrollments_total{outcome="created"}') $(
    metric 'surfaced_enrollments_total{outcome="known"}') $(
    metric 'surfaced_enrollments_total{outcome="mismatch"}') $(
    metric 'surfaced_scans_refused_total{code="not_a_face"}')" '3 3 2 1'

# ---- the first is refused: the next that can be enrolled stands for the others
burst bob?label=door none.ply plane.xyz a0.ply b.ply a4.xyz.gz
is "the first is refused" "$STATUS $LIST" '201 malformed not_a_face new sample_mismatch new'
req GET /v1/subjects/bob
is "the label is for all" "$(get '[.templates[].label] | join(" ")')" 'door door'

# ---- a subject's templates: those before the first that fits are failed attempts
is "none so far" "$(mismatches)" 0
burst alice b.ply a3.ply c.ply
is "a stranger first" "$STATUS $LIST $(mismatches)" '201 sample_mismatch new sample_mismatch 1'
ok "it matches no template" jq_true '.templates[0].refusal.detail | test("neither the subject")' "$T/body"
burst alice c.ply none.ply
problem "strangers alone" 409 sample_mismatch '^none of the 2 files was enrolled; c.ply: the sample does not fit'
is "each is listed" "$LIST $(get '[.templates[].file] | join(" ")')" \
    'sample_mismatch malformed c.ply none.ply'
burst alice none.ply c.ply
problem "no scan first" 400 malformed '^none of the 2 files was enrolled; none.ply: '
burst alice plane.xyz none.ply
problem "no face at all" 422 not_a_face '^none of the 2 files was enrolled; plane.xyz: the surface'
is "with the same text" "$(get '.templates[0].refusal.detail as $d | .detail | endswith($d)')" true
is "nothing was stored" "$(stored templates)" 6
gives "429 too_many_attempts" "locked out on the way" burst alice c.ply b.ply a0.ply
is "nothing was stored" "$(stored templates) $(mismatches)" '6 4'
burst carol a0.ply a1.ply
is "others are not" "$STATUS $LIST" '201 new new'
"$BUILD/surfacectl" --db "$DB" subject disable carol >"$T/text"
built() { metric 'surfaced_stage_duration_seconds_count{stage="prepare"}'; }
before=$(built)
gives "403 subject_disabled" "disabled" burst carol b.ply a2.ply
gives "403 subject_disabled" "disabled, one file" send POST /v1/subjects/carol/templates "$PLY" "$T/a2.ply"
is "no face was made for that" "$(built)" "$before"

# ---- with force
burst dave?force=true a0.ply b.ply none.ply a0.ply
is "with force" "$STATUS $LIST" '201 new new malformed same'
AUTH=$(new_token enrolls --scope enroll)
gives "403 insufficient_scope" "without manage" burst dave?force=true c.ply a1.ply
req POST /v1/subjects/erin/templates?fuse=false -F "file=@$T/a0.ply" -F "file=@$T/a1.ply" -H 'Prefer: return=minimal'
is "what was refused is told whatever is preferred" "$STATUS $(get '.templates | length') $(field Preference-Applied)" '201 2 '
gives 200 "sent again" req POST /v1/subjects/erin/templates?fuse=false -F "file=@$T/a0.ply" -F "file=@$T/a1.ply"

# ---- the form
set --
for _ in $(seq 21); do set -- "$@" a0.ply; done
burst frank "$@"
problem "21 files" 400 malformed 'send 1 to 20 files, each with a file name, with all else in the query'
shift
burst frank "$@"
is "20 files" "$STATUS $LIST" "201 new$(printf ' same%.0s' $(seq 19))"
AUTH=$(new_token two)
burst 'gina?units=parsec' a0.ply a1.ply
problem "a wrong parameter" 400 invalid_parameter '^units'
req POST /v1/subjects/gina/templates?fuse=false -F "file=@$T/a0.ply;headers=Content-Encoding: br" \
    -F 'file=@/dev/null;filename=empty.ply' -F "file=@$T/a3.ply.gz;headers=Content-Encoding: gzip"
is "codings and an empty one" "$STATUS $(get '[.templates[].refusal.detail] | tojson')" \
    '201 ["a0.ply: Content-Encoding may be gzip or zstd, one of them and once","empty.ply: the file is empty",null]'
name=$(printf 'a\033\377"b.ply')
req POST /v1/subjects/gina/templates?fuse=false -F "file=@$T/a0.ply;filename=$name" -F "file=@$T/none.ply;filename=$name"
is "an odd name is told, and harmless" "$STATUS $(get '.templates[1].file')" "201 $(printf 'a\033\357\277\275%%22b.ply')"

# ---- the limits are for all together
head -c 1100000 /dev/zero | tr '\0' '#' >"$T/long.xyz"
cat "$T/a4.xyz" >>"$T/long.xyz"
gzip "$T/long.xyz"
before=$(stored templates)
gives 201 "one is small enough" burst hank long.xyz.gz
burst ines long.xyz.gz long.xyz.gz
problem "two are not" 413 body_too_large 'the limit is 2000000 bytes of all files together when unpacked'
stop_daemon
start_daemon --no-auth --workers 1
AUTH=
awk 'BEGIN { for (i = 0; i < 500001; i++) print "1 2 3" }' | gzip >"$T/many.xyz.gz"
burst ines a0.ply many.xyz.gz many.xyz.gz
problem "too many points" 422 too_many_points 'the files together have more than 1000000 points'
is "nothing was stored" "$(stored templates)" $((before + 1))
burst ines a0.ply a1.ply a2.ply
is "one worker, without a token" "$STATUS $LIST" '201 new new new'

# ---- no room: none of them
prlimit --pid "$PID" --fsize=1000
gives "503 storage" "no room" burst jack a0.ply a1.ply a2.ply
gives "404 not_found" "nothing is stored" req GET /v1/subjects/jack
finish
