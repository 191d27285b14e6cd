#!/bin/sh
# Goal: an id that begins with a hyphen is an id to every command, behind --, and without that it
# is never taken for one: the command says so and changes nothing.
. tests/box/lib.sh

scan 1 0 "$T/a.ply" --points 1000
scan 1 1 "$T/a2.ply" --points 1000
echo 'a passphrase of an archive' >"$T/phrase"
chmod 600 "$T/phrase"
ctl_exits 0 init
for id in -x --json --yes -o; do
    while read -r wanted command; do
        # shellcheck disable=SC2086 # words
        set -- $command
        before=$(sql 'SELECT max(seq) FROM change_log')
        ctl "$@" "$id" "$T/a2.ply"
        is "$id is no id of $command: exit" "$CODE" 64
        case $command in # that have more arguments behind it
        enroll) set -- "$@" -- "$id" "$T/a.ply" ;;
        verify | explain) set -- "$@" -- "$id" "$T/a2.ply" ;;
        rename) set -- subject rename -- "$id" "to$id" ;;
        back) set -- subject rename -- "to$id" "$id" ;;
        *) set -- "$@" -- "$id" ;;
        esac
        is "$id: nothing has changed" "$(sql 'SELECT max(seq) FROM change_log')" "$before"
        ctl_exits "$wanted" "$@"
    done <<END
0 enroll
0 verify
0 explain
0 subject show
0 subject set --consent C-1
0 subject hold
0 subject release
0 subject disable
0 subject enable
0 rename
0 back
0 template list
0 attempts reset
0 export --archive-key $T/phrase --out $T/archive$id
0 subject erase --yes
0 token create --scope read
0 token rotate
0 token revoke
END
done
for id in . ..; do
    ctl_exits 65 enroll "$id" "$T/a.ply"
    ctl_exits 65 subject set "$id" --consent C-1
done
ctl subject show -x
ok "it is said what to do" grep -q 'there is no option -x .* put -- before' "$T/ctl.err"
"$BUILD/surfacectl" scan -units mm "$T/a.ply" >"$T/text"
is "one hyphen does" $? 0
ctl scan -xyz "$T/a.ply"
ok "letters that are no options" grep -q 'there is no option -xyz' "$T/ctl.err"
ctl_exits 0 enroll -- - "$T/a.ply"
ctl_exits 0 verify - "$T/a2.ply"
is "a hyphen alone is an id" "$(said .subject)" -
finish
