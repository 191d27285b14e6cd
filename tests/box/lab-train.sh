#!/bin/sh
# Goal: surfacelab train adapts a model to scans and calibrates it by scores.  It writes the same
# file on any number of threads; the other commands and the daemon load this file.  The figures of
# the shipped model stand beside those of the new one.  Inputs that it cannot learn from are refused
# or listed; a damaged model is refused everywhere, with its file and line.
set -u
# shellcheck source=tests/box/lib.sh
. tests/box/lib.sh
case $BUILD in /*) ;; *) BUILD=$PWD/$BUILD ;; esac
ctl=$BUILD/surfacectl lab=$BUILD/surfacelab
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

# ---- from scans

mkdir "$T/scans"
for s in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21; do
    for k in 0 1 2; do
        "$BUILD/facegen" --subject $s --scan $k --pose 6 --shift 4 --points 1500 \
            --smile "0.$((k * 7 % 10))" -o "$T/scans/s${s}_p$k.ply" || exit 1
    done
done
head -c 200 "$T/scans/s3_p2.ply" >"$T/cut"
cp "$T/cut" "$T/scans/s3_p2.ply"
expect 0 "scans" "$lab" train "$T/scans" --threads 2 --out "$T/scans.model" --json
says "$T/err" "a bad scan is told of" 'not used: .*s3_p2.ply'
is "listed too" "$(jq -r '.refused[].file' "$T/out")" s3_p2.ply
is "subjects" "$(jq -c '[.subjects, .scans, .mated]' "$T/out")" '[21,62,41]'
ok "the weight" jq_true '(.weight - 21 / 221 | fabs) < 0.001' "$T/out"
ok "figures" jq_true '.base.eer >= 0 and .trained.eer >= 0 and .worse == false' "$T/out"
is "the base model's name" "$(jq -r .name "$T/out")" "$(sed -n 's/^name //p' core/face/default.model)"
engine=$(jq -r .engine "$T/out")
is "the model adapted, as on one thread" "$(sed -n '/^mean/,$p' "$T/scans.model" | sha256sum)" \
    "1c86d34980ce2b394aa6e1401ecc2b8c2a004ba7b5c640303ad95fc23018a175  -"

# Both models are compared on the same pairs: with no weight nothing changes but the rounding of
# what is cut down to modes again.
expect 0 "no weight" "$lab" train "$T/scans" --weight 0 --out "$T/none.model"
ok "the same figures" test "$(sed -n 's/^before *//p' "$T/out")" = "$(sed -n 's/^after *//p' "$T/out")"
says "$T/out" "the figures" '^after  *EER .* accepted .* at FMR 1 %'
says "$T/out" "which is in-sample" 'in-sample'
says "$T/out" "text" '^model  *.*none.model: measure'

# A model that has learned from a few noisy scans alone is worse than the shipped one, and that is
# said.
mkdir "$T/noisy"
for s in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21; do
    for k in 0 1; do
        "$BUILD/facegen" --subject $s --scan $k --pose 6 --shift 4 --points 1500 \
            --noise 1.5 --warp 1.5 -o "$T/noisy/s${s}_p$k.ply" || exit 1
    done
done
expect 1 "worse" "$lab" train "$T/noisy" --weight 1 --out "$T/worse.model"
says "$T/err" "worse" 'is worse than the base model.*not written without --force'
ok "it was not written" [ ! -e "$T/worse.model" ]
expect 0 "worse, forced" "$lab" train "$T/noisy" --weight 1 --out "$T/worse.model" --force --json
ok "it was written, and that is reported" jq_true '.worse' "$T/out"
ok "the file" [ -s "$T/worse.model" ]

# ---- used

a=$T/scans/s1_p0.ply b=$T/scans/s1_p1.ply m=$T/scans.model
mkdir "$T/few"
cp "$T"/scans/s[1-4]_p[01].ply "$T/few"
expect 0 "evaluate" "$lab" evaluate "$T/few" --model "$m" --out "$T/report" --json
is "evaluate: engine" "$(jq -r .engine "$T/out")" "$engine"
# (with the scanner's axes: which points are the face's depends on the model that finds it)
"$ctl" compare "$a" "$b" --axes scanner --model "$m" --json >"$T/out"
is "compare: engine" "$(jq -r .engine "$T/out")" "$engine"
SURFACED_MODEL=$m "$ctl" compare "$a" "$b" --axes scanner --json >"$T/env"
is "by SURFACED_MODEL" "$(jq .score "$T/env")" "$(jq .score "$T/out")"
"$ctl" compare "$a" "$b" --json >"$T/own"
shipped=$(jq -r .engine "$T/own")
ok "another engine" [ "$shipped" != "$engine" ]

# ---- in a database and the daemon: enrolled by the shipped model, compared by the new one

expect 0 "init" "$ctl" --db "$DB" init
expect 0 "enroll" "$ctl" --db "$DB" enroll anna "$a" --axes scanner
"$ctl" --db "$DB" verify anna "$b" --axes scanner --model "$m" --json >"$T/ctl" 2>"$T/err"
is "verify: engine" "$(jq -r .engine "$T/ctl")" "$engine"
is "the same as compare" "$(jq .score "$T/ctl")" "$(jq .score "$T/env")"
start_daemon --no-auth --model "$m"
says "$LOG" "the daemon says which model" "engine=\"$engine\""
curl -s -H "$PLY" --data-binary "@$b" "$URL/v1/subjects/anna/verify" >"$T/body"
is "the daemon: engine" "$(jq -r .engine "$T/body")" "$engine"
curl -s -H "$PLY" --data-binary "@$b" "$URL/v1/subjects/bea/templates" >"$T/body"
is "enrolled by it" "$(jq -r .engine "$T/body")" "$engine"
stop_daemon

# a calibration holds for the model that it was made with, and who ignores it says so
expect 0 "a calibration" "$ctl" --db "$DB" calibrate --reset
"$BUILD/forge" "$DB" "$KEY" "UPDATE calibrations SET shipped = 0"
"$ctl" --db "$DB" verify anna "$b" >"$T/out" 2>"$T/err"
is "holds: silence" "$(cat "$T/err")" ""
"$ctl" --db "$DB" verify anna "$b" --model "$m" --json >"$T/ctl" 2>"$T/err"
says "$T/err" "does not hold" "calibration 1 is not used: it was made by $shipped"
start_daemon --no-auth --model "$m"
says "$LOG" "the log" 'level=warn msg="calibration is not used.* version=1'
stop_daemon

# ---- calibrated by scores

awk 'BEGIN { print "comparison,score,decision"
    for (i = 0; i < 4000; i++) print "non-mated," (i * 7919 % 4000) / 100 - 30 ",no_match"
    print "mated,55,match\nnon-mated,,refused" }' >"$T/scores.csv"
expect 0 "calibrate" "$lab" train --model "$m" --calibrate "$T/scores.csv" --name 'made up' \
    --out "$T/c.model" --json
ok "0.1 % above it" jq_true '.threshold == 9.96' "$T/out"
is "name" "$(jq -r .name "$T/out")" "made up"
is "no scans" "$(jq .subjects "$T/out")" null
says "$T/c.model" "its name" '^name made up$'
ok "nothing beside it" [ ! -e "$T/c.model.part" ]
is "nothing else changes" "$(jq -r .engine "$T/out")" "$engine"
ok "the mean stays" [ "$(sed -n '/^mean/,$p' "$m" | cksum)" = \
    "$(sed -n '/^mean/,$p' "$T/c.model" | cksum)" ]
head -2000 "$T/scores.csv" >"$T/fewer.csv"
expect 65 "too few scores" "$lab" train --calibrate "$T/fewer.csv" --out "$T/x.model"
says "$T/err" "how many" '1999 non-mated scores are too few .*3000 are needed'
printf 'comparison,score\nnon-mated,x\n' >"$T/bad.csv"
expect 65 "not a number" "$lab" train --calibrate "$T/bad.csv" --out "$T/x.model"
says "$T/err" "where" 'bad.csv, line 2'
expect 65 "no scores" "$lab" train --calibrate "$m" --out "$T/x.model"

# ---- refused

for c in "$ctl compare $a $b" "$lab evaluate $T/few --out $T/r" "$lab explain $a $b --out $T/e" \
    "$lab train $T/scans --out $T/x.model" "$ctl --db $DB verify anna $b" \
    "$ctl --db $DB enroll carl $b" "$ctl --db $DB calibrate"; do
    sed '43s/[0-9]/x/' "$m" >"$T/bad.model"
    # shellcheck disable=SC2086 # words
    expect 65 "damaged: $c" $c --model "$T/bad.model"
    says "$T/err" "where: $c" 'bad.model, line 43'
done
head -c 5000 "$m" >"$T/bad.model"
expect 65 "cut off" "$ctl" compare "$a" "$b" --model "$T/bad.model"
sed '1s/[0-9]*$/9/' "$m" >"$T/bad.model"
expect 65 "another version" "$ctl" compare "$a" "$b" --model "$T/bad.model"
says "$T/err" "another version" 'a version that this program does not read'
expect 74 "a folder" "$ctl" compare "$a" "$b" --model "$T"
says "$T/err" "a folder" 'Is a directory'
expect 66 "missing" "$ctl" compare "$a" "$b" --model "$T/none"
expect 64 "where there is no model to use" "$ctl" --db "$DB" subject list --model "$m"
expect 1 "the daemon" "$BUILD/surfaced" --db "$DB" --listen 127.0.0.1:0 --model "$T/bad.model"
says "$T/err" "the daemon says why" 'bad.model'

expect 65 "too few" "$lab" train "$T/few" --out "$T/x.model"
says "$T/err" "what is needed" '4 subjects .* 20 are needed'
expect 66 "no folder" "$lab" train "$T/nowhere" --out "$T/x.model"
ok "no model then" [ ! -e "$T/x.model" ]
for c in "" "--out $T/x.model" "--out $T/x.model --weight 0.5 --calibrate $T/scores.csv" \
    "$T/scans --out $T/x.model --weight 2" "$T/scans --out $T/x.model --weight -0.1"; do
    # shellcheck disable=SC2086 # words
    expect 64 "usage: $c" "$lab" train $c
done
expect 64 "a name with a line's end" "$lab" train "$T/scans" --out "$T/x.model" --name 'a
b'
cksum "$m" >"$T/sum"
expect 65 "an existing file" "$lab" train "$T/scans" --out "$m"
says "$T/err" "force" 'the file exists: use --force'
expect 65 "its input" "$lab" train --calibrate "$T/scores.csv" --out "$T/scores.csv" --force
expect 65 "the base" "$lab" train --calibrate "$T/scores.csv" --model "$m" --out "$m" --force
is "untouched" "$(cksum "$m")" "$(cat "$T/sum")"
expect 0 "forced" "$lab" train --calibrate "$T/scores.csv" --out "$T/c.model" --force

finish
