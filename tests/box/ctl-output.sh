#!/bin/sh
# Goal: no command of surfacectl writes over a file that is there, unless with --force, and none over
# a file that it reads, by whatever name it has; "-" is standard output or refused.
. tests/box/lib.sh
in_folder

scan 1 0 a.ply --points 1000
scan 1 1 a1.ply --points 1000
"$ctl" --db f.db init >out && "$ctl" --db f.db enroll alice a.ply --json >out || exit 1
id=$(jq -r '.templates[0].template_id' out)
echo 'a passphrase of an archive' >phrase
chmod 600 phrase
mkdir scans
for s in 1 2 3; do
    for k in 0 1; do
        scan $s $k "scans/p${s}_$k.ply" --points 1000
    done
done
printf 'file,subject\np1_0.ply,1\np1_1.ply,1\np2_0.ply,2\np2_1.ply,2\n' >scans/index.csv
printf 'id,population\n1,x\n2,x\n' >scans/subjects.csv

awk 'BEGIN { print "comparison,score"
    for (i = 0; i < 4000; i++) print "non-mated," (i * 7919 % 4000) / 100 - 30 }' >scores.csv

# kept TITLE COMMAND...: it exits with 65, names the file and the option or the reason, and no file
# has changed.
kept() {
    k_title=$1 k_text=$2 k_before=$(sums)
    shift 2
    expect 65 "$k_title" "$@"
    has err "$k_text"
    is "$k_title: nothing changed" "$(sums)" "$k_before"
}

# Of every file but this script's own and the database, in which an export is recorded.
sums() {
    find . -type f ! -name out ! -name err ! -name 'f.db*' -exec sha256sum {} + | sort | sha256sum
}

# ---- a file that is there
mkdir explanation report
for f in o.ply explanation/explain.json report/report.json; do
    echo mine >$f
done
while read -r name line; do
    case $name in
    explain) file=explanation/explain.json ;;
    evaluate) file=report/report.json ;;
    *) file=o.ply ;;
    esac
    case $name in
    simplify | fill | train | explain | evaluate) program=$lab ;;
    *) program=$ctl ;;
    esac
    # shellcheck disable=SC2086 # words
    kept "$name" "$file: the file exists: use --force" "$program" $line
    # shellcheck disable=SC2086
    case $name in
    backup) # of another program: never
        expect 65 "$name --force" "$program" $line --force
        is "$name: not a backup" "$(cat $file)" mine
        ;;
    *)
        "$program" $line --force >out 2>err
        ok "$name --force ($(cat err))" test $? -lt 3
        ok "$name: replaced" test "$(head -c 5 $file)" != mine
        ;;
    esac
    echo mine >$file
done <<END
face scan a.ply --face o.ply
simplify simplify a.ply --tolerance 1 -o o.ply
fill fill a.ply -o o.ply
template --db f.db template export $id -o o.ply
audit --db f.db audit export -o o.ply
export --db f.db export alice -o o.ply --archive-key phrase
train train --calibrate scores.csv -o o.ply
explain explain a.ply a1.ply
evaluate evaluate scans -o report
backup --db f.db backup o.ply
END

# ---- a file that is read: never, by whatever name
ln -s a.ply link.ply
ln a.ply hard.ply
mkdir sub
ln -sf ../a.ply explanation/points.csv
cp a.ply p.ply.part
read='is a file that this command reads'
for name in a.ply ./a.ply sub/../a.ply "$PWD/a.ply" link.ply hard.ply; do
    kept "scan over $name" "$read" "$ctl" scan a.ply --face "$name" --force
    kept "simplify over $name" "$read" "$lab" simplify a.ply --tolerance 1 -o "$name" --force
done
kept "a scan of the name that the new file has at first" "$read" \
    "$lab" simplify p.ply.part --tolerance 1 -o p.ply --force
kept "fill" "$read" "$lab" fill link.ply -o a.ply --force
kept "explain" "$read" "$lab" explain a1.ply a.ply --force
kept "a scan of a collection" "$read" "$lab" train scans -o scans/p1_0.ply --force
kept "the list of a collection" "$read" "$lab" train scans -o scans/index.csv --force
kept "the subjects of a collection" "$read" "$lab" train scans/index.csv -o scans/subjects.csv --force
kept "scores" "$read" "$lab" train --calibrate scores.csv -o scores.csv --force
cp "$PWD/scans/p1_0.ply" report/p1_0.ply
ln -f report/p1_0.ply report/scores.csv
printf 'file,subject\nreport/p1_0.ply,1\nscans/p2_0.ply,2\nscans/p2_1.ply,2\n' >list.csv
kept "a scan of a list" "$read" "$lab" evaluate list.csv -o report --force
for name in f.db f.db.key phrase; do
    kept "export over $name" "$read" "$ctl" --db f.db export alice -o "$name" --archive-key phrase --force
done
kept "the log over the database" "$read" "$ctl" --db f.db audit export -o f.db --force
kept "a backup over the database" "$read" "$ctl" --db f.db backup ./sub/../f.db --force
kept "a template over the key" "$read" "$ctl" --db f.db template export "$id" -o f.db.key --force
expect 0 "the database is whole" "$ctl" --db f.db check-database

# ---- what is no file
mkfifo pipe
kept "a pipe" 'pipe: not a regular file' "$lab" simplify a.ply --tolerance 1 -o pipe --force
expect 65 "a device" "$lab" simplify a.ply --tolerance 1 -o /dev/null --force
has err '/dev/null: not a regular file'
ok "it is a device still" test -c /dev/null
kept "a folder" 'sub: a folder' "$lab" fill a.ply -o sub --force
ln -s nowhere dangling
kept "a link to nowhere" 'dangling: the file exists' "$lab" simplify a.ply --tolerance 1 -o dangling
ok "it made nothing" test ! -e nowhere

# ---- standard output
expect 0 "simplify" "$lab" simplify a.ply --tolerance 1 -o -
cp out piped.ply
has err '^kept '
expect 0 "the same as a file" "$lab" simplify a.ply --tolerance 1 -o named.ply
ok "to the byte" cmp -s piped.ply named.ply
expect 0 "fill" sh -c "'$lab' fill a.ply -o - | '$ctl' scan -"
expect 0 "template export" "$ctl" --db f.db template export "$id" -o -
is "a mesh" "$(head -n 1 out)" ply
has err 'points, '
expect 0 "audit export" "$ctl" --db f.db audit export -o -
ok "JSON lines alone" jq -e . out >/dev/null
expect 64 "and --json" "$lab" simplify --json a.ply --tolerance 1 -o -
for line in 'scan a.ply --face -' '--db f.db backup -' \
    '--db f.db export alice --archive-key phrase -o -'; do
    # shellcheck disable=SC2086 # words
    expect 64 "$line" "$ctl" $line
    has err '(./- is one)'
done
for line in 'train --calibrate scores.csv -o -' 'explain a.ply a1.ply -o -' 'evaluate scans -o -'; do
    # shellcheck disable=SC2086 # words
    expect 64 "$line" "$lab" $line
    has err '(./- is one)'
done
expect 74 "a full disk" sh -c "'$lab' simplify a.ply --tolerance 1 -o - >/dev/full"
ok "no file of that name" test ! -e - -a ! -d -

# ---- the tools: what they write is the same every time, but their input is no output
expect 0 "facegen" "$BUILD/facegen" --points 1000 -o -
ok "a scan" grep -aq '^ply' out
ok "and no file" test ! -e -
for name in a.ply link.ply hard.ply; do
    expect 1 "headscan over $name" "$BUILD/headscan" --kind glasses a.ply -o "$name"
done
expect 0 "the scan is as it was" "$ctl" scan a.ply
finish
