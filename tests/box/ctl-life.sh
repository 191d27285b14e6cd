#!/bin/sh
# Goal: the life of a database by surfacectl alone: init, enroll, verify, compare, stats,
# check, token, and the subjects and templates; as text and as JSON, with the exit codes of its help.
. tests/box/lib.sh
in_folder

scan 1 0 a0.ply --pose 0 --shift 0
scan 1 1 a1.ply --pose 5 --shift 5
scan 5 0 b0.ply --pose 0 --shift 0
scan 5 1 b1.xyz --pose 5 --shift 5

export SURFACED_DB="$T/faces.db"
expect 0 init "$ctl" init
has out initialised
ok "the database's mode is 600" [ "$(stat -c %a faces.db)" = 600 ]
expect 0 "init again" "$ctl" init
has out already
expect 0 "empty list" "$ctl" subject list
has out 'no subjects'
expect 0 enroll "$ctl" enroll alice a0.ply --label 'first day'
id=$(cut -d' ' -f1 out)
expect 0 "enroll again" "$ctl" enroll alice a0.ply
has out "$id.*already"
expect 0 "enroll json" "$ctl" --json enroll bob b0.ply
has out '"new":.*true'
expect 0 verify "$ctl" verify alice a1.ply
has out '^decision *match'
expect 1 "verify another person" "$ctl" verify alice b0.ply
has out '^decision *no_match'
expect 0 "verify json" "$ctl" verify bob b1.xyz --json
has out '"decision":.*"match"'
has out '"templates_compared":.*1'
awk '{ print -$1, $2, $3 }' b1.xyz >swapped.xyz
expect 65 "left and right swapped" "$ctl" verify bob swapped.xyz
has err 'mirror image'
expect 1 "another person's" "$ctl" verify alice swapped.xyz
expect 65 "enroll it" "$ctl" enroll bob swapped.xyz
has err 'mirror image'
expect 64 "verify by a threshold of one's own" "$ctl" verify --threshold -1000 alice b0.ply
expect 64 "compare by one" "$ctl" compare --threshold -1000 a0.ply b0.ply
expect 0 compare "$ctl" compare a0.ply a1.ply
expect 1 "compare two people" "$ctl" compare a0.ply b0.ply
expect 65 "a sample that does not fit" "$ctl" enroll alice b0.ply
has err 'does not fit'
awk '$2 < -10' b1.xyz >part.xyz
expect 65 "a part is no enrolment" "$ctl" enroll bob part.xyz
has err 'does not have the shape of a face (evidence [0-9.]*, at least 1[24].[0-9]* wanted)'
scan 1 1 c1.xyz --pose 0 --shift 0
awk '$2 < -14' c1.xyz >part.xyz
expect 2 "a part, too little to compare" "$ctl" verify bob part.xyz
has out '^decision *inconclusive'
expect 0 "enrolled all the same" "$ctl" enroll --force alice b1.xyz
expect 0 "in centimetres" sh -c "awk -v OFMT=%.12g '{ print \$1 / 10, \$2 / 10, \$3 / 10 }' b1.xyz |
    '$ctl' --units cm verify bob -"
has out '^decision *match'
expect 0 "a pipe" sh -c "'$ctl' verify alice - <a1.ply"
expect 0 list "$ctl" subject list
has out '^alice *2 '
expect 0 "show a subject" "$ctl" subject show alice
has out 'first day'
expect 0 "show a template" "$ctl" --json template show "$id"
has out "\"template_id\":.*\"$id\""
has out '"points":.*29[0-9][0-9]'
expect 0 stats "$ctl" stats
has out '^templates *3'
expect 0 check "$ctl" check-database
has out '^ok: 3 templates'
expect 64 "delete unasked" "$ctl" template delete "$id"
has err -- --yes
expect 0 "delete a template" "$ctl" template delete "$id" --yes
expect 66 "it is gone" "$ctl" template show "$id"
expect 0 "delete a subject" "$ctl" --yes --json subject erase alice
has out '"templates_removed":.*1'
expect 66 "no such subject" "$ctl" verify alice a1.ply
has err 'no subject alice'

expect 0 "make a token without a name" "$ctl" token create --scope verify
ok "it has 64 characters too" [ "$(wc -c <out)" -eq 65 ]
expect 0 "make a token" "$ctl" token create 'front door' --scope read
secret=$(cat out)
ok "the token has 64 characters" [ ${#secret} -eq 64 ]
ok "the token itself is not in the database" [ -z "$(grep -l "$secret" faces.db*)" ]
expect 0 "list tokens" "$ctl" token list
has out '^front door  *valid .* read$'
expect 0 "another of that name" "$ctl" token create 'front door' --scope read
expect 65 "which of them" "$ctl" token revoke 'front door'
has err '2 tokens have this name.*: [0-9a-f]\{32\} [0-9a-f]\{32\}$'
token=$(awk '{ print $NF }' err)
expect 0 "by its id" "$ctl" token revoke "$token"
has out "^revoked front door ($token)\$"
expect 0 "by its name" "$ctl" --json token rotate 'front door'
ok "it is the other" [ -z "$(grep "$token" out)" ]
expect 0 "in words" "$ctl" token rotate 'front door'
has err '^token front door ([0-9a-f]\{32\}) for read, valid until'
expect 0 "revoke it" "$ctl" token revoke 'front door'
expect 66 "none is left" "$ctl" token revoke 'front door'
expect 0 "list revoked" "$ctl" token list --json
has out '"state":.*"revoked"'
expect 66 "revoke another" "$ctl" token revoke 00000000000000000000000000000000

expect 0 help "$ctl" --help
expect 0 version "$ctl" --version
has out '^surfacectl [0-9]'

finish
