#!/bin/sh
# Goal: whatever is wrong, surfacectl says what and where, exits with the code of its help,
# and changes nothing.
. tests/box/lib.sh
in_folder

# refuse CODE TEXT COMMAND...: it exits with CODE and its message has TEXT
refuse() {
    want=$1 text=$2
    shift 2
    "$@" >out 2>err </dev/null
    got=$?
    if [ "$got" -eq "$want" ] && grep -q -e "$text" err; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL exit $got, not $want, or no '$text': $*"
        cat out err
    fi
}

"$BUILD/facegen" -o good.ply || exit 1
"$ctl" --db f.db init >/dev/null || exit 1
"$ctl" --db f.db enroll alice good.ply >/dev/null || exit 1
before=$(sha256sum <f.db)

# the command line
refuse 64 'a command is missing' "$ctl"
refuse 64 'no command' "$ctl" frobnicate
refuse 64 'no option --frob' "$ctl" --frob subject list
refuse 64 'no database: give --db PATH' "$ctl" subject list
refuse 64 'value missing: --db' "$ctl" subject list --db
refuse 64 'given twice' "$ctl" --db f.db --db f.db subject list
refuse 64 'usage: surfacectl enroll' "$ctl" --db f.db enroll alice
refuse 64 'good.ply is one scan, and its subject is missing; usage: surfacectl enroll SUBJECT FILE' \
    "$ctl" --db f.db enroll good.ply
refuse 65 'no passphrase: .*name a file that contains it with --archive-key' "$ctl" --db f.db import good.ply
refuse 64 'usage: surfacectl subject list' "$ctl" --db f.db subject list alice
refuse 64 'does not take' "$ctl" --db f.db subject list --yes
refuse 64 'units takes auto, mm, cm, m, in or um' "$ctl" --db f.db --units inch enroll alice good.ply
refuse 64 'axes takes auto or scanner' "$ctl" --db f.db --axes camera enroll alice good.ply
refuse 64 'threshold' "$ctl" --db f.db dedup --threshold nan
refuse 64 'token COMMAND, which is one of create, ' "$ctl" --db f.db token destroy all
refuse 64 'token create \[NAME' "$ctl" --db f.db token create a b
refuse 64 'scope takes a list' "$ctl" --db f.db token create --scope 'enroll verify' a
refuse 64 "needs --scope: one or more of $ALL" "$ctl" --db f.db token create a
for time in 0d 90 1w -1d 1.5h 99999999d 99999999999999999999d d '' '90 d'; do
    refuse 64 '--expires takes' "$ctl" --db f.db token create --scope read --expires "$time" a
done
refuse 64 '--grace takes' "$ctl" --db f.db token rotate 00000000000000000000000000000000 --grace never
refuse 64 'token create does not take --grace' "$ctl" --db f.db token create --grace 1h a
refuse 64 'attempts COMMAND, which is one of list, reset' "$ctl" --db f.db attempts
refuse 64 'no option --json=1' "$ctl" --db f.db subject list --json=1

# ids
refuse 65 'a subject id is 1 to 128 characters' "$ctl" --db f.db enroll 'al ice' good.ply
refuse 66 'no subject nobody' "$ctl" --db f.db subject erase nobody --yes
refuse 66 'no subject nobody' "$ctl" --db f.db verify nobody good.ply
refuse 66 'no token nonsense' "$ctl" --db f.db token revoke nonsense
refuse 66 'no token' "$ctl" --db f.db token rotate 00000000000000000000000000000000
refuse 66 'no subject nobody' "$ctl" --db f.db attempts reset nobody

# scans (what a scan is refused for: http-examples.sh)
: >empty
printf '0 0 0\n1 0 0\n0 1 0\n' >three.xyz
head -c 4000 good.ply >cut.ply
head -c 3000 /dev/zero >zeros
refuse 66 'missing.ply: No such file' "$ctl" --db f.db verify alice missing.ply
refuse 65 'empty' "$ctl" --db f.db verify alice empty
refuse 65 'three.xyz: 3 points' "$ctl" --db f.db verify alice three.xyz
refuse 65 'good.ply: the extent' "$ctl" --db f.db --units cm verify alice good.ply
refuse 65 'cut.ply' "$ctl" --db f.db verify alice cut.ply
refuse 65 'zeros' "$ctl" --db f.db verify alice zeros
refuse 65 '1 of 1 scans' "$ctl" --db f.db enroll alice cut.ply
ok "nothing was changed" [ "$before" = "$(sha256sum <f.db)" ]

# databases
refuse 66 'no database none.db' "$ctl" --db none.db subject list
ok "none was made" [ ! -e none.db ]
refuse 65 'is not a file' "$ctl" --db "$T" init
refuse 74 'cannot create no/such/dir/f.db: No such file' "$ctl" --db no/such/dir/f.db init
refuse 65 'good.ply is not a database' "$ctl" --db good.ply subject list
refuse 65 'good.ply is not a database' "$ctl" --db good.ply init
refuse 66 'no database empty' "$ctl" --db empty subject list
for line in "$ctl --db f.db subject list" "$ctl --help" "$ctl --version" "$lab --help" \
    "$BUILD/surfaced --help" "$BUILD/surfaced --version" "$BUILD/surfaced --print-config --db f.db" \
    "$BUILD/surfaced --check-config --db f.db"; do
    # shellcheck disable=SC2086 # words
    $line >/dev/full 2>err
    is "a full output is reported: $line" $? 74
    contains "$line" err 'the output cannot be written'
done

# bytes changed in the middle of the face: reported by check-database and by verify, as text and JSON
cp f.db damaged.db
cp f.db.key damaged.db.key
sqlite3 damaged.db "UPDATE faces SET face =
    CAST(substr(face, 1, 5000) || x'78787878' || substr(face, 5005) AS BLOB)"
"$ctl" --db damaged.db check-database >out 2>err
ok "check finds it" [ $? -eq 1 ]
ok "check counts it" grep -q 'NOT ok: 1 template, 1 bad' out
ok "check says what" grep -q 'its face is not authentic' out
"$ctl" --db damaged.db check-database --json >out 2>err
ok "check --json finds it" [ $? -eq 1 ]
ok "check --json says so" grep -q '"ok":.*false' out
refuse 65 'not authentic' "$ctl" --db damaged.db verify alice good.ply
"$ctl" --db damaged.db verify alice good.ply --json >out 2>err
ok "verify --json refuses" [ $? -eq 65 ]
ok "verify --json says so" grep -q '"exit":.*65' out

# ---- --json: a word for programs
code() { # WORD COMMAND...
    want=$1
    shift
    "$ctl" --json "$@" >out 2>err </dev/null
    is "code of $*" "$(jq -r .error.code out)" "$want"
}
code usage frobnicate
code usage --db f.db enroll alice
code not_found --db f.db subject show nobody
code not_found scan none.ply
code exists scan good.ply --face f.db.key
printf '0 0 0\n1 1 1\n' >few.xyz
code too_few_points --db f.db verify alice few.xyz
echo nonsense >nonsense
code malformed --db f.db enroll bob nonsense

# ---- a file that is too large is not read first
truncate -s 3T large.ply
refuse 65 'large.ply: 3298534.9 MB or more; the limit is 268.4 MB' timeout 60 "$ctl" compare good.ply large.ply

# ---- one of something, and no minus zero
"$ctl" --db f.db check-database >out
ok "one template" grep -q ' 1 template, ' out
"$ctl" scan good.ply >out
ok "no -0: $(grep ^view out)" sh -c "! grep -q -e ' -0' out"
finish
