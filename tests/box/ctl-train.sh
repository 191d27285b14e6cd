#!/bin/sh
# Goal: surfacectl train learns a model that the other commands and the daemon load, the same
# file on any number of threads; what it cannot learn from, it refuses or lists; a damaged
# model is refused by file and line everywhere.
set -u
# shellcheck source=tests/box/lib.sh
. tests/box/lib.sh
case $BUILD in /*) ;; *) BUILD=$PWD/$BUILD ;; esac
ctl=$BUILD/surfacectl
unset SURFACED_DB SURFACED_MODEL

# expect CODE TITLE COMMAND...: its output in $T/out and $T/err
expect() {
    want=$1 what=$2
    shift 2
    "$@" >"$T/out" 2>"$T/err" </dev/null
    got=$?
    ok "$what: exit $got, wanted $want: $(head -c 300 "$T/err")" [ "$got" -eq "$want" ]
}

says() { ok "$2: '$3' in $(head -c 300 "$1")" grep -qe "$3" "$1"; }

mkdir "$T/scans"
for s in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21; do
    for k in 0 1 2 3 4 5 6 7 8 9 10 11 12; do
        kind=p$k
        [ "$k" -ne 0 ] || kind=enroll
        "$BUILD/facegen" --subject $s --scan $k --pose 6 --shift 4 --points 1000 \
            --smile "0.$((k * 7 % 10))" --warp "0.$((2 + k % 4))" \
            -o "$T/scans/s${s}_$kind.ply" || exit 1
    done
done
head -c 200 "$T/scans/s3_p5.ply" >"$T/cut"
cp "$T/cut" "$T/scans/s3_p5.ply"

# ---- the model

expect 0 "train" "$ctl" train "$T/scans" --label 'made up' --threads 2 --out "$T/two.model" --json
says "$T/err" "a bad scan is told of" 'not used: .*s3_p5.ply'
is "listed too" "$(jq -r '.refused[].file' "$T/out")" s3_p5.ply
is "name" "$(jq -r .name "$T/out")" "made up"
is "mated" "$(jq .mated "$T/out")" 251
is "non-mated" "$(jq .non_mated "$T/out")" 3012
ok "figures" jq_true '(.before, .after) | .eer >= 0 and .eer <= 1' "$T/out"
engine=$(jq -r .engine "$T/out")
threshold=$(jq .threshold_mm "$T/out")
says "$T/two.model" "its name" '^name made up$'
ok "nothing beside it" [ ! -e "$T/two.model.part" ]
expect 0 "once more" "$ctl" train "$T/scans" --label 'made up' --threads 1 --out "$T/one.model"
ok "the same on one thread" cmp "$T/one.model" "$T/two.model"
says "$T/out" "text" '^after .*EER'

# ---- used

a=$T/scans/s1_enroll.ply b=$T/scans/s1_p1.ply m=$T/two.model
mkdir "$T/few"
cp "$T"/scans/s[1-4]_enroll.ply "$T"/scans/s[1-4]_p1.ply "$T/few"
expect 0 "evaluate" "$ctl" evaluate "$T/few" --model "$m" --out "$T/report" --json
is "evaluate: engine" "$(jq -r .engine "$T/out")" "$engine"
is "evaluate: threshold" "$(jq .threshold_mm "$T/out")" "$threshold"
"$ctl" compare "$a" "$b" --model "$m" --json >"$T/out"
is "compare: engine" "$(jq -r .engine "$T/out")" "$engine"
# shellcheck disable=SC2016 # jq's $t
ok "compare: its threshold, or more for noise" jq_true --argjson t "$threshold" \
    '.threshold_mm >= $t and .threshold_mm < 1.2 * $t' "$T/out"
SURFACED_MODEL=$m "$ctl" compare "$a" "$b" --json >"$T/env"
is "by SURFACED_MODEL" "$(jq .disparity_mm "$T/env")" "$(jq .disparity_mm "$T/out")"
"$ctl" compare "$a" "$b" --json >"$T/own"
shipped=$(jq -r .engine "$T/own")
ok "another engine" [ "$shipped" != "$engine" ]
is "regions" "$(jq -c '.regions | keys' "$T/own")" \
    '["cheeks","chin","eyes","forehead","mouth","nose"]'
ok "certainty, share, change" jq_true '.alignment.turn_deg != null and .weight_overlap > 0.3 and
    .change_mm > 0 and (.quality.reasons | type) == "array"' "$T/own"

# ---- in a database and the daemon: enrolled by the shipped model, compared by the new one

expect 0 "init" "$ctl" --db "$DB" init
expect 0 "enroll" "$ctl" --db "$DB" enroll anna "$a"
"$ctl" --db "$DB" verify anna "$b" --model "$m" --json >"$T/ctl" 2>"$T/err"
is "verify: engine" "$(jq -r .engine "$T/ctl")" "$engine"
is "the same as compare" "$(jq .disparity_mm "$T/ctl")" "$(jq .disparity_mm "$T/env")"
start_daemon --no-auth --model "$m"
says "$LOG" "the daemon says which model" "engine=\"$engine\""
curl -s -H "$PLY" --data-binary "@$b" "$URL/v1/subjects/anna/verify" >"$T/body"
is "the daemon: engine" "$(jq -r .engine "$T/body")" "$engine"
is "the daemon: disparity" "$(jq .disparity_mm "$T/body")" "$(jq .disparity_mm "$T/ctl")"
is "the daemon: reasons" "$(jq -c .quality.reasons "$T/body")" "$(jq -c .quality.reasons "$T/ctl")"
curl -s -H "$PLY" --data-binary "@$b" "$URL/v1/subjects/bea/templates" >"$T/body"
is "enrolled by it" "$(jq -r .engine "$T/body")" "$engine"
stop_daemon

# a calibration holds for the model that it was made with, and who ignores it says so
expect 0 "a calibration" "$ctl" --db "$DB" calibrate --reset
"$BUILD/forge" "$DB" "UPDATE calibrations SET shipped = 0"
"$ctl" --db "$DB" verify anna "$b" >"$T/out" 2>"$T/err"
is "holds: silence" "$(cat "$T/err")" ""
"$ctl" --db "$DB" verify anna "$b" --model "$m" --json >"$T/ctl" 2>"$T/err"
says "$T/err" "does not hold" "calibration 1 is not used: it was made by $shipped"
# shellcheck disable=SC2016 # jq's $t
ok "the model's own decides" jq_true --argjson t "$threshold" \
    '.threshold_mm >= $t and .threshold_mm < 1.2 * $t' "$T/ctl"
start_daemon --no-auth --model "$m"
says "$LOG" "the log" 'level=warn msg="calibration is not used.* version=1'
stop_daemon

# ---- refused

for c in "compare $a $b" "evaluate $T/few --out $T/r" "explain $a $b --out $T/e" \
    "train $T/scans" "--db $DB verify anna $b" "--db $DB enroll carl $b" \
    "--db $DB calibrate"; do
    sed '30s/[0-9]/x/' "$m" >"$T/bad.model"
    # shellcheck disable=SC2086 # words
    expect 65 "damaged: $c" "$ctl" $c --model "$T/bad.model"
    says "$T/err" "where: $c" 'bad.model, line 30'
done
head -c 5000 "$m" >"$T/bad.model"
expect 65 "cut off" "$ctl" compare "$a" "$b" --model "$T/bad.model"
sed '1s/[0-9]*$/9/' "$m" >"$T/bad.model"
expect 65 "another version" "$ctl" compare "$a" "$b" --model "$T/bad.model"
says "$T/err" "another version" 'another version'
expect 65 "a folder" "$ctl" compare "$a" "$b" --model "$T"
says "$T/err" "a folder" 'not a regular file'
mkfifo "$T/pipe"
expect 65 "a pipe" "$ctl" compare "$a" "$b" --model "$T/pipe"
expect 66 "missing" "$ctl" compare "$a" "$b" --model "$T/none"
expect 64 "where there is no model to use" "$ctl" --db "$DB" subject list --model "$m"
expect 1 "the daemon" "$BUILD/surfaced" --db "$DB" --listen 127.0.0.1:0 --model "$T/bad.model"
says "$T/err" "the daemon says why" 'bad.model'
expect 65 "too few" "$ctl" train "$T/few" --out "$T/few.model"
says "$T/err" "what is needed" '4 subjects and 4 .*20 and 250'
ok "no model then" [ ! -e "$T/few.model" ]
expect 64 "a name with a line's end" "$ctl" train "$T/few" --label 'a
b' --out "$T/few.model"
expect 66 "no folder" "$ctl" train "$T/nowhere"

finish
