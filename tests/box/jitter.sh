#!/bin/sh
# Goal: a scan of any kind matches changed copies of itself: points dropped, turned, cropped, thinned,
# noisy, moved, in another unit, its picture turned, anyhow.  A copy that does not match is a fault of
# the frame, the crop or the cover.
# JITTER_COPIES: copies of each scan (10), JITTER_PEOPLE: of each kind (3), JITTER_SEED: of all that is drawn (0).
. tests/box/lib.sh
in_folder
copies=${JITTER_COPIES:-10} people=${JITTER_PEOPLE:-3} seed=${JITTER_SEED:-0}
jitter=$BUILD/jitter

# face NAME OPTION...: of each person a frontal scan.
face() {
    name=$1
    shift
    for s in $(seq 1 "$people"); do
        "$BUILD/facegen" --subject $((s + 10)) --scan $((seed + s)) "$@" -o "scans/p${s}_$name.ply"
    done
}

# sized NAME FACTOR: of each person a frontal scan of a head of another size.
sized() {
    for s in $(seq 1 "$people"); do
        "$BUILD/facegen" --subject $((s + 10)) --scan $((seed + s)) --pose 5 --format xyz |
            awk -v by="$2" '{ print $1 * by, $2 * by, $3 * by }' >"scans/p${s}_$1.xyz"
    done
}

# stepped NAME MM: of each person a scan whose depths are steps of so many mm.
stepped() {
    for s in $(seq 1 "$people"); do
        "$BUILD/facegen" --subject $((s + 10)) --scan $((seed + s)) --pose 5 --format xyz |
            awk -v step="$2" '{ print $1, $2, step * sprintf("%.0f", $3 / step) }' >"scans/p${s}_$1.xyz"
    done
}

# cover KIND: of each person a frontal scan, covered by it.
cover() {
    for s in $(seq 1 "$people"); do
        "$BUILD/headscan" --kind "$1" --seed $((seed + s)) "scans/p${s}_plain.ply" -o "scans/p${s}_$1.ply"
    done
}

# head_of KIND [OPTION]...: of each person a scan of the whole head.
head_of() {
    kind=$1
    shift
    for s in $(seq 1 "$people"); do
        "$BUILD/headscan" --kind "$kind" --seed $((seed + s)) "$@" "made-up:$((s + 10))" -o "scans/p${s}_$kind.pcd"
    done
}

mkdir scans
face plain
face turned --pose 12 --shift 20 --noise 0.4 --warp 0.3
face smile --smile 1 --pose 5 --shift 5
face holes --holes 0.35 --spikes 0.012 --noise 0.35 --pose 6
face noisy --noise 1 --pose 5
face coarse --points 900 --pose 5
face dense --points 40000 --pose 5
face side --yaw 22 --pitch 8
sized child 0.78
sized young 0.88
sized large 1.12
stepped steps 1
for kind in glasses mask scarf hand fringe beard cap; do
    cover $kind
done
for kind in head bust half depth grid behind; do
    head_of $kind
done
expect 0 "copies of $(files scans | wc -w) scans" "$jitter" "$copies" "$seed" scans/*
grep '^FAIL' out
is "each scan is one of a face" "$(grep -c '^REFUSED' out)" 0
is "each copy was compared" "$(awk '$1 == "all" { print $2 }' out)" $((copies * $(files scans | wc -w)))
tail -n 12 out

# ---- what the program itself does
expect 2 "no scans" "$jitter" 1 0
expect 2 "a file that is not there" "$jitter" 1 0 none.ply
printf '0 0 0\n1 0 0\n0 1 0\n' >few.xyz
expect 0 "too few points" "$jitter" 1 0 few.xyz
has out '^REFUSED few.xyz: '
finish
