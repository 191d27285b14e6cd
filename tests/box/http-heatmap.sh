#!/bin/sh
# Goal: detail=heatmap gives the signed gap at each point of the request, in their order, null
# where the template has no surface, and what each cell of the face adds to the score; compare and
# verify give the same.
# shellcheck disable=SC2016 # the variables are jq's
. tests/box/lib.sh

# The template lacks one cheek of the probe.  With the scanner's axes, so that each point sent is one of
# the face.
scan 1 1 "$T/b.json" --pose 8 --shift 10
scan 1 1 "$T/b.xyz" --pose 8 --shift 10
jq -c '{axes: "scanner", points}' "$T/b.json" >"$T/frontal.json" && mv "$T/frontal.json" "$T/b.json"
jq -c '.points |= map(select(.[0] < 25))' "$T/b.json" >"$T/a.json"
jq -c -n --slurpfile a "$T/a.json" --slurpfile b "$T/b.json" '{a: $a[0], b: $b[0]}' >"$T/ab.json"
start_daemon --no-auth

# heatmap TITLE FILTER: jq's FILTER is true; in it $m is the response's heatmap, $p its [x, gap]s.
heatmap() {
    ok "$1" jq_true -n --slurpfile b "$T/b.json" --slurpfile m "$T/body" \
        '$m[0].heatmap as $m | $b[0].points as $b
         | ([range($b | length) | [$b[.][0], $m[.]]]) as $p | '"$2"
}

send POST /v1/compare "$JSON" "$T/ab.json"
is "compare" "$STATUS $(get '[has("heatmap", "cells")] | @csv')" "200 false,false"
send POST '/v1/compare?detail=heatmap' "$JSON" "$T/ab.json"
is "compare with a heatmap" "$STATUS $(get .decision)" "200 match"
heatmap "a gap for each point of b" '($m | length) == ($b | length)'
heatmap "null where a has no surface" \
    '$p | map(select(.[0] > 27)) | length > 100 and all(.[1] == null)'
heatmap "elsewhere a number near 0" '$p | map(select(.[0] < 15)) | length > 1000 and
    (map(select(.[1] != null and (.[1] | fabs) < 0.01)) | length) > 0.97 * length'
ok "the cells add up to the score, and to the regions" jq_true '.score as $s | .regions as $r | .cells
    | .part as $part | ($part | map(numbers) | add - $s | fabs < 0.02)
    and [.mm, .nx, .ny, .left, .bottom, ($part | length)] == [4, 32, 41, -64, -94, 1312]
    and ($part | map(numbers) | length > 400)
    and ([range(1312) | select(-94 + 4 * (. / 32 | floor) >= 46) | $part[.] | numbers] | add
        | . - $r.forehead | fabs < 0.02)' "$T/body"
ok "null at the corners, where no face is" jq_true '.cells.part | [.[0], .[31], .[1280], .[1311]]
    | all(. == null)' "$T/body"
cp "$T/body" "$T/first"
jq -c '.b.points |= reverse' "$T/ab.json" >"$T/ba.json"
send POST '/v1/compare?detail=heatmap' "$JSON" "$T/ba.json"
ok "b reversed: the heatmap is reversed" jq_true -n --slurpfile a "$T/first" --slurpfile b "$T/body" \
    '[$a[0].heatmap, ($b[0].heatmap | reverse)] | transpose
    | all(.[0] == .[1] or (.[0] != null and .[1] != null and (.[0] - .[1] | fabs) < 1e-4))'
i=$(jq '.points | map(.[0] > -10 and .[0] < 10 and .[1] > 30 and .[1] < 50) | index(true)' "$T/b.json")
jq -c --argjson i "$i" '.b.points[$i][2] += 2 | .b.points += [.b.points[11]]' "$T/ab.json" \
    >"$T/odd.json"
send POST '/v1/compare?detail=heatmap' "$JSON" "$T/odd.json"
ok "a point moved 2 mm to the scanner, another sent twice" jq_true --argjson i "$i" \
    --slurpfile a "$T/first" '.heatmap as $m | $a[0].heatmap as $n
    | ($m | length) == ($n | length) + 1 and $m[-1] == $m[11] and
      ($m[$i] - $n[$i] | . > 1.5 and . < 2.5)' "$T/body"

send POST /v1/subjects/a/templates "$JSON" "$T/a.json"
id=$(get .template_id)
for route in "subjects/a" "templates/$id"; do
    gives 200 "verify at $route" send POST "/v1/$route/verify?detail=heatmap" "$JSON" "$T/b.json"
    ok "the heatmap of compare" jq_true --slurpfile a "$T/first" \
        '.heatmap == $a[0].heatmap and .cells == $a[0].cells' "$T/body"
done
send POST '/v1/subjects/a/verify?axes=scanner&detail=heatmap' 'Content-Type: text/plain' "$T/b.xyz"
heatmap "a file: a gap for each of its points" '($m | length) == ($b | length)'

# The cells of surfacectl explain are those of the heatmap.
scan 2 0 "$T/c.xyz"
send POST '/v1/subjects/c/templates?axes=scanner' 'Content-Type: text/plain' "$T/c.xyz"
send POST '/v1/subjects/c/verify?axes=scanner&detail=heatmap' 'Content-Type: text/plain' "$T/b.xyz"
ctl_exits 1 explain c "$T/b.xyz" --axes scanner
ok "explain's cells" jq_true --slurpfile m "$T/body" '.cells == $m[0].cells' "$T/ctl"
finish
