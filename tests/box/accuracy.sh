#!/bin/sh
# Goal: recognition over HTTP: among ten subjects each probe's mated template ranks first and
# matches, both at least nine times of ten; on generated faces, and on the scans of
# ../shared/faces (or $FACES) if they are there.
cd "$(dirname "$0")/../.." || exit 1
. tests/box/lib.sh

FACES=${FACES:-../shared/faces}
subjects="0 1 2 3 4 5 6 7 8 9"

# rank WHAT ENROLL PROBE [relatives]: ENROLL and PROBE are file names with % for the subject's
# number; relatives: 8 and 9 are, and count as neither.
rank() {
    first=0 mated=0 false=0
    for s in $subjects; do
        file=$(printf '%s\n' "$2" | sed "s/%/$s/")
        gives 201 "$1: enrolling $s" send POST "/v1/subjects/$1-$s/templates" "$PLY" "$file"
    done
    for p in $subjects; do
        file=$(printf '%s\n' "$3" | sed "s/%/$p/")
        : >"$T/ranks"
        for s in $subjects; do
            send POST "/v1/subjects/$1-$s/verify" "$PLY" "$file"
            [ "$STATUS" = 200 ] || is "$1: verifying $p against $s" "$STATUS" 200
            printf '%s %s\n' "$(get .score)" "$s" >>"$T/ranks"
            case $(get .decision),$s in
            "match,$p") mated=$((mated + 1)) ;;
            match,[89]) [ "${4:-} $p" = "relatives $((17 - s))" ] || false=$((false + 1)) ;;
            match,*) false=$((false + 1)) ;;
            esac
        done
        [ "$(sort -gr "$T/ranks" | head -1 | cut -d' ' -f2)" != "$p" ] || first=$((first + 1))
    done
    echo "$1: mated template first $first of 10; matches: $mated of 10 mated, $false of 90 non-mated"
    ok "$1: mated template first, $first of 10" test "$first" -ge 9
    ok "$1: mated matches, $mated of 10" test "$mated" -ge 9
    ok "$1: non-mated matches, $false of 90" test "$false" -le 1
}

start_daemon --no-auth --attempts 0
for s in $subjects; do
    scan "$s" 0 "$T/e$s.ply"
    scan "$s" 1 "$T/p$s.ply" --pose 10 --shift 20 --noise 0.25
done
rank generated "$T/e%.ply" "$T/p%.ply"
if [ -r "$FACES/id000_enroll.ply" ]; then
    rank scanned "$FACES/id00%_enroll.ply" "$FACES/id00%_p1.ply" relatives # 8 and 9 are
else
    echo "SKIP the scans: no $FACES/id000_enroll.ply"
fi
finish
