#!/bin/sh
# Goal: the files of a form are the frames of one capture session: fused into one template or one
# probe, one attempt; what is left out is told, and another person's frame refuses the form.
# shellcheck disable=SC2016 # the variables are jq's
. tests/box/lib.sh

for k in 0 1 2 3 4 5 6; do
    scan 1 $k "$T/a$k.ply" --pose 5 --shift 5 --noise 0.8
    scan 2 $k "$T/b$k.ply" --pose 5 --shift 5 --noise 0.8
done
scan 1 8 "$T/noisy.ply" --noise 6
for k in 0 1; do # without one side each: side0 has the person's left, which is the picture's right
    scan 3 $k "$T/whole.xyz" --noise 0.5
    awk -v by=$((1 - 2 * k)) '$1 * by > -22' "$T/whole.xyz" >"$T/side$k.xyz"
done
cp "$T/side0.xyz" "$T/copy.xyz"
echo 'no scan' >"$T/none.ply"
awk 'BEGIN { for (i = 0; i < 2000; i++) print i % 50 * 3, int(i / 50) * 4, 0 }' >"$T/plane.xyz"

# form PATH FILE...: of each file what became of it in $LIST
form() {
    f_path=$1
    shift
    for f_file; do
        set -- "$@" -F "file=@$T/$f_file"
        shift
    done
    req POST "/v1/$f_path" "$@"
    LIST=$(get '[.frames[]? | if .used then "used" else .reason.code end] | join(" ")')
}
stored() { sql "SELECT count(*) FROM $1"; }
events() { sql "SELECT count(*) FROM $ENTRIES WHERE kind = '$1'"; }

start_daemon --attempts 4 --max-body 2000000 --workers 2
AUTH=$(new_token one)

# ---- enrolment
form subjects/alice/templates a0.ply a1.ply none.ply a2.ply plane.xyz
is "three frames" "$STATUS $LIST" '201 used used malformed used not_a_face'
fits "a template" Template
is "one template" "$(stored templates)" 1
is "its location" "$(field Location)" "/v1/templates/$(get .template_id)"
is "with their names" "$(get '[.frames[].file] | join(" ")')" 'a0.ply a1.ply none.ply a2.ply plane.xyz'
fused=$(get .quality.noise_mm)
id=$(get .template_id)
gives 201 "one frame is enrolled" send POST /v1/subjects/single/templates "$PLY" "$T/a0.ply"
ok "it has more noise" jq_true "$fused < 0.8 * .quality.noise_mm" "$T/body"
form subjects/alice/templates a0.ply a1.ply none.ply a2.ply plane.xyz
is "again: the same template" "$STATUS $(get .template_id)" "200 $id"
form subjects/carol/templates a0.ply
is "a form with one file" "$STATUS $LIST" '201 used'
is "is the scan itself" "$(get .digest)" "$(req GET /v1/subjects/single && get '.templates[0].digest')"
form 'subjects/dave/templates?fuse=false' a0.ply a1.ply
is "without fusing" "$STATUS $(get '.templates | length') $(get '.frames')" '201 2 null'
form 'subjects/dave/templates?fuse=maybe' a0.ply a1.ply
problem "a wrong parameter" 400 invalid_parameter '^fuse'
before=$(stored templates)
form subjects/erin/templates a0.ply b1.ply a2.ply
problem "two people" 422 several_people '^b1.ply shows another person than a[02].ply'
is "each is listed" "$LIST" 'used several_people used'
is "and what nothing was made of adds nothing" "$(get '[.frames[].adds] | tojson')" '[null,null,null]'
form subjects/erin/templates none.ply plane.xyz
problem "no frame has a face" 422 not_a_face 'none of the 2 frames shows a face; plane.xyz: the surface'
is "each is listed" "$LIST" 'malformed not_a_face'
is "nothing was stored" "$(stored templates)" "$before"
gives "409 sample_mismatch" "another person's session" form subjects/alice/templates b0.ply b1.ply b2.ply
is "is one attempt" "$(events enroll_mismatch)" 1
form subjects/alice/templates a3.ply a4.ply
is "a further one" "$STATUS $LIST" '201 used used'

# ---- what each adds
# adds FILE...: enrolls them, and sets $ADDS: name, place and parts of each, in the order of fusing
adds() {
    form "subjects/new$(stored subjects)/templates" "$@"
    ADDS=$(get '[.frames | sort_by(.adds.place // 99)[] | .file + (.adds | if . == null then " -" else
        " \(.place) \([.parts[] | select(.region == "cheeks" and .share > 0.5) | .side // "both"] | join(","))" end)] | join("; ")')
}
adds side0.xyz plane.xyz side1.xyz
case $ADDS in
side0*) wanted='side0.xyz 1 left; side1.xyz 2 right; plane.xyz -' ;;
*) wanted='side1.xyz 1 right; side0.xyz 2 left; plane.xyz -' ;;
esac
is "a side each" "$STATUS $ADDS" "201 $wanted"
is "the face is what they have together" "$(get '[.frames[] | .adds.share // 0] | [(add * 100 | round), .[1]] | tojson')" '[100,0]'
adds side0.xyz copy.xyz
ok "a copy adds nothing" jq_true '.frames | map(.adds) | sort_by(.place) |
    (.[0].share > 0.998) and (.[1].share < 0.002) and .[1].parts == [] and (.[1].noise_mm / .[0].noise_mm - 1 | fabs) < 0.02' "$T/body"
adds a0.ply a1.ply a2.ply a3.ply
ok "each lowers the noise" jq_true '[.frames | sort_by(.adds.place)[].adds.noise_mm] | . == (sort | reverse) and .[3] < 0.7 * .[0]' "$T/body"
ok "to the face's own" jq_true '(.frames | map(.adds) | max_by(.place).noise_mm) / .quality.noise_mm - 1 | fabs < 0.15' "$T/body"
same=$(get '[.frames[].adds] | tojson')
for k in 0 1 2 3; do cp "$T/a$k.ply" "$T/z$((9 - k)).ply"; done
form "subjects/renamed/templates" z9.ply z8.ply z7.ply z6.ply
is "whatever their names" "$(get '[.frames[].adds] | tojson')" "$same"

# ---- verification
form subjects/alice/verify a5.ply none.ply a6.ply
is "verified" "$STATUS $(get .decision) $LIST" '200 match used malformed used'
fits "a comparison" Verdict
form "templates/$id/verify" a5.ply a6.ply
is "against one template" "$STATUS $(get .decision) $LIST" '200 match used used'
square='[.heatmap[] | select(. != null) | . * .] | add / length'
form 'subjects/alice/verify?detail=heatmap' a5.ply
one=$(get "$square")
form 'subjects/alice/verify?detail=heatmap' a5.ply a6.ply
is "its heat map is of the points of the base" "$STATUS $(get '.heatmap | length')" "200 $(get .scan.points_read)"
ok "of the fused surface" jq_true "($square) < 0.9 * $one" "$T/body"
before=$(events verify)
form subjects/alice/verify b3.ply b4.ply b5.ply b6.ply
is "another person" "$STATUS $(get .decision) $LIST" '200 no_match used used used used'
is "one event" "$(events verify)" $((before + 1))
req GET /v1/subjects/alice
is "one failed attempt" "$(get .attempts.failures)" 1
before=$(events verify)
form subjects/alice/verify a5.ply b4.ply a6.ply
problem "two people" 422 several_people '^b4.ply shows another person'
is "each is listed" "$LIST" 'used several_people used'
is "which is compared with nobody" "$(events verify)" "$before"
form subjects/alice/verify plane.xyz none.ply
problem "no face" 422 not_a_face 'none of the 2 frames shows a face; plane.xyz: '
gives "422 replayed" "a frame of a template" form subjects/alice/verify a5.ply a1.ply
gives "422 replayed" "by itself" form subjects/alice/verify a2.ply
form subjects/alice/verify b3.ply b4.ply
gives "429 too_many_attempts" "locked out" form subjects/alice/verify a5.ply a6.ply
set --
for _ in $(seq 11); do set -- "$@" a0.ply; done
form subjects/single/verify "$@"
problem "11 files" 400 malformed 'send 1 to 10 files, each with a file name'
finish
