#!/bin/sh
# Goal: what is known of a subject is noted, shown and changed by surfacectl, beside a running
# daemon that sees it at once: consent, expiry, hold, disabled, another id; purge erases who
# is due and nobody else; templates are listed and exported; the shell completes it all.
. tests/box/lib.sh

scan 1 0 "$T/a.ply"
scan 1 1 "$T/a2.ply" --pose 5
scan 2 0 "$T/b.ply"
start_daemon
ctl_exits 0 enroll alice "$T/a.ply" --label first
ctl_exits 0 enroll bob "$T/b.ply"
ctl_exits 0 token create test --scope "$ALL"
AUTH=$(said .secret)

# ---- the consent
ctl_exits 0 subject set alice --consent C-17 --purpose 'the front door' --expires 2031-02-28
is "it is noted" "$(said '[.consent, .purpose, .expires_at] | join("|")')" \
    'C-17|the front door|2031-02-28T23:59:59.999Z'
ctl_exits 0 subject set alice --purpose ''
ctl_exits 0 subject show alice
is "it is shown" "$(said '[.subject, .consent, .purpose, .expires_at, .hold, .templates[0].label]
    | map(tostring) | join("|")')" 'alice|C-17|null|2031-02-28T23:59:59.999Z|false|first'
ok "seen when it was enrolled" test "$(said .last_seen)" = "$(said .templates[0].created)"
ctl_exits 0 subject set carol --consent C-18 --expires never
ctl_exits 0 subject show carol
is "somebody without a scan" "$(said '[.consent, (.templates | length)] | join("|")')" 'C-18|0'
ctl_exits 64 subject set alice
ctl_exits 64 subject set alice --expires 2031-02-29
ctl_exits 65 subject set alice --consent "$(printf 'a\nb')"
ctl_exits 65 subject set 'a b' --consent x
"$BUILD/surfacectl" --db "$DB" subject list >"$T/text"
is "a list" "$(awk 'NR > 1 { print $1, $2 }' "$T/text" | tr '\n' ' ')" 'alice 1 bob 1 carol 0 '

# ---- groups, and opting out of searches
ctl_exits 0 subject set bob --group staff,door-3,staff --identify no
ctl_exits 0 subject show bob
is "groups and consent" "$(said '[(.groups | join(",")), .identify] | join("|")')" 'door-3,staff|false'
"$BUILD/surfacectl" --db "$DB" subject show bob >"$T/text"
is "as text" "$(sed -n '3,4p' "$T/text" | tr -s ' ' | tr '\n' ';')" \
    ' groups door-3,staff; opted out no search finds the subject;'
"$BUILD/surfacectl" --db "$DB" subject list --group staff >"$T/text"
is "in a list" "$(awk 'NR > 1 { print $1, $4, $5, $6 }' "$T/text")" 'bob opted out door-3,staff'
ctl_exits 0 subject list --group door-3
is "by group" "$(said '[.subjects[].subject] | join(" ")')" bob
ctl_exits 0 subject list --group door
is "none of this group" "$(said '.subjects | length')" 0
ctl_exits 64 subject list --group a,b
ctl_exits 64 subject set bob --identify maybe
ctl_exits 65 subject set bob --group Staff
ctl_exits 0 subject set bob --group '' --identify yes
is "neither" "$(said '[(.groups | join(",")), .identify] | join("|")')" '|true'
ctl_exits 0 subject set erin --group b,a --identify no
is "a subject that is new" "$(said '[(.groups | join(",")), .identify] | join("|")')" 'a,b|false'
ctl_exits 0 subject erase erin --yes
"$BUILD/surfacectl" --db "$DB" token create bound --scope read --group b,a >"$T/text" 2>"$T/ctl.err"
ok "the groups of a token are said" grep -q 'for read in the groups a,b, valid' "$T/ctl.err"
"$BUILD/surfacectl" --db "$DB" token list >"$T/text"
ok "and listed" grep -q '^bound  .* a,b  *read$' "$T/text"

# ---- disabled
send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
is "verified" "$STATUS $(get .decision)" '200 match'
id=$(get .template_id)
ctl_exits 0 subject disable alice
gives "403 subject_disabled" "disabled" send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
ctl_exits 77 verify alice "$T/a2.ply"
ok "surfacectl says why" grep -q 'alice is disabled' "$T/ctl.err"
ctl_exits 77 explain alice "$T/a2.ply"
ctl_exits 77 explain "$id" "$T/a2.ply"
ctl_exits 77 enroll alice "$T/a2.ply" --force
ok "surfacectl says why here too" grep -q 'alice is disabled' "$T/ctl.err"
is "they are no attempts" "$("$BUILD/surfacectl" --db "$DB" attempts list)" 'no failed verifications'
ctl_exits 0 subject enable alice
send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
is "enabled" "$STATUS $(get .decision)" '200 match'
ctl_exits 66 subject disable nobody

# ---- expired
ctl_exits 64 subject set alice --expires 2020-01-01
ctl_exits 0 subject set alice --expires 1s
sleep 1.1
ctl_exits 77 verify alice "$T/a2.ply"
ok "surfacectl says since when" grep -q 'alice expired at 20..-..-..T' "$T/ctl.err"
ctl_exits 0 subject set alice --expires 2031-01-01T12:00:00+01:00
is "a time" "$(said .expires_at)" 2031-01-01T11:00:00.000Z

# ---- seen
sql "UPDATE subjects SET seen = '2026-01-01T00:00:00.000Z'"
ctl_exits 0 verify alice "$T/a2.ply"
ctl_exits 0 subject show alice
ok "seen by surfacectl" test "$(said .last_seen)" != 2026-01-01T00:00:00.000Z
sql "UPDATE subjects SET seen = '2026-01-01T00:00:00.000Z'"
send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"
ctl_exits 0 subject show alice
ok "seen by the daemon" test "$(said .last_seen)" != 2026-01-01T00:00:00.000Z

# ---- on hold
ctl_exits 0 subject hold alice
gives "409 on_hold" "on hold" req DELETE /v1/subjects/alice
ctl_exits 77 subject erase alice --yes
ctl_exits 77 subject erase alice --dry-run
ctl_exits 77 template delete "$id" --dry-run
ctl_exits 77 template delete "$id" --yes
ctl_exits 0 subject release alice

# ---- another id
ctl_exits 0 subject rename alice ann
is "it has it" "$(said .subject)" ann
ctl_exits 65 subject rename ann bob
ctl_exits 66 subject rename alice dan
ctl_exits 65 subject rename ann 'd n'
send POST /v1/subjects/ann/verify "$PLY" "$T/a2.ply"
is "verified by it" "$STATUS $(get .subject) $(get .template_id)" "200 ann $id"
gives "404 not_found" "not by the old" send POST /v1/subjects/alice/verify "$PLY" "$T/a2.ply"

# ---- templates
ctl_exits 0 template list
is "all templates" "$(said '.templates | length')" 2
ctl_exits 0 template list ann
is "one's templates" "$(said '.templates[] | .subject + " " + .template_id')" "ann $id"
ctl_exits 66 template list nobody
ctl_exits 64 template list --compare
ctl_exits 66 template list nobody --compare
ctl_exits 0 template list ann --compare
is "one template is compared with none" "$(said '[(.pairs | length), .templates[0].fits] | @csv')" 0,
ctl_exits 0 template show "$id"
is "a template" "$(said .subject)" ann
ctl_exits 64 template export "$id"
ctl_exits 0 template export "$id" --out "$T/out.ply"
is "its file's mode" "$(stat -c %a "$T/out.ply")" 600
"$BUILD/surfacectl" compare "$T/a.ply" "$T/out.ply" >"$T/text"
is "it is the face" "$?$(sed -n 's/^decision *//p' "$T/text")" 0match
is "an event of it" "$(sql "SELECT count(*) FROM $ENTRIES WHERE kind = 'export_template'")" 1
ctl_exits 66 template export 00000000000000000000000000000000 --out "$T/none.ply"
ok "no file" test ! -e "$T/none.ply"
ctl_exits 64 template delete "$id"
for one in 'subject erase ann' "template delete $id"; do
    # shellcheck disable=SC2086 # words
    ctl_exits 0 $one --dry-run
    is "$one would" "$(said '[.subject, .templates, .deleted] | @csv')" '"ann",1,false'
done
"$BUILD/surfacectl" --db "$DB" subject erase ann --dry-run >"$T/text"
is "in words" "$(cat "$T/text")" 'this deletes subject ann with 1 template; nothing was changed'
ctl_exits 0 template show "$id"

# ---- due
ctl_exits 0 purge --dry-run
is "nobody is due" "$(said '[.due, .kept] | tojson') $(said .erased)" '[[],[]] 0'
for one in bob carol dan; do
    ctl_exits 0 subject set $one --expires 1s
done
sleep 1.1
ctl_exits 0 subject hold carol
ctl_exits 0 purge --dry-run
is "due" "$(said '[.due, .kept] | tojson') $(said .erased)" '[["bob","dan"],["carol"]] 0'
ctl_exits 64 purge
ok "it says what is missing" grep -q -e '--yes' "$T/ctl.err"
ctl_exits 0 purge --yes
is "erased" "$(said .erased)" 2
ctl_exits 0 subject list
is "who is left" "$(said '[.subjects[].subject] | join(" ")')" 'ann carol'
gives "404 not_found" "gone for the daemon too" req GET /v1/subjects/bob

ctl_exits 0 subject release carol
ctl_exits 0 subject erase carol --yes
ok "a receipt" matches "$(said '[.subject, .digest, .signature] | join(" ")')" \
    '^carol [0-9a-f]{64} [0-9a-f]{128}$'

# ---- room
ctl_exits 0 vacuum
ok "no more than before" test "$(said .bytes_after)" -le "$(said .bytes_before)"
send POST /v1/subjects/ann/verify "$PLY" "$T/a2.ply"
is "the daemon goes on" "$STATUS $(get .decision)" '200 match'
ctl_exits 0 check-database

# ---- the shell
if command -v bash >/dev/null 2>&1; then
    # completes WANTED WORD...: what the last word can become
    completes() {
        f_wanted=$1
        shift
        # shellcheck disable=SC2016 # the variables are bash's
        is "completion of $*" "$(bash -c '. packaging/surfacectl.bash
            COMP_WORDS=("$0" "$@") COMP_CWORD=$#
            _surfacectl
            echo "${COMPREPLY[*]}"' "$BUILD/surfacectl" "$@")" "$f_wanted"
    }
    completes 'scan stats subject' s
    completes 'disable enable erase hold list release rename set show' subject ''
    completes 'release rename' --db x subject re
    completes '--consent' subject set alice --cons
    completes 'auto mm cm m in um' verify --units ''
    completes "$T/a.ply $T/a2.ply" verify alice "$T/a"
    completes "$T/a.ply $T/a2.ply" --key "$T/a"
fi
"$BUILD/surfacectl" --help >"$T/text"
for code in 0 1 2 64 65 66 70 71 74 75 77; do
    ok "the manual has exit code $code" grep -q "^\.It $code$" man/surfacectl.1
    ok "--help too" grep -q "^ *$code  " "$T/text"
done

# ---- every command: help with an example and the exit codes
"$BUILD/surfacectl" --help | awk '/^Commands/ { on = 1; next } /^$/ { on = 0 } on' |
    cut -c 3-21 | sed 's/ *$//' >"$T/commands"
ok "there are commands" test "$(wc -l <"$T/commands")" -gt 30
while read -r command; do
    # shellcheck disable=SC2086 # two words
    "$BUILD/surfacectl" $command --help >"$T/text" 2>&1
    is "help of $command" $? 0
    for part in '^Usage: surfacectl' '^Example:' '^Exit codes:' '--json'; do
        ok "help of $command has $part" grep -q -e "$part" "$T/text"
    done
    ok "the manual has $command" grep -q "^\.It Ic $(echo "$command" | sed 's/ / Cm /')" \
        man/surfacectl.1
    ok "help of $command is not too wide" test -z "$(sed '/^Example/,$d' "$T/text" | grep '.\{91\}')"
    # What its text and its example name is in its list of options, and that in the manual.
    sed -n '/^Options/,/^$/s/^  \(-[a-z]\), /  \1 \n  /p; /^Options/,/^$/p' "$T/text" |
        sed -n 's/^  \(-[-a-z]*\).*/\1/p' | sort -u >"$T/options"
    sed '/^Options/,/^$/d; s/ and of surfaced//' "$T/text" | grep -oE '(^|[][ (|])--?[a-z][-a-z]*' |
        tr -d '[](| ' | sort -u >"$T/named"
    is "$command: options that are not listed" "$(comm -23 "$T/named" "$T/options" | tr '\n' ' ')" ''
    sed -n 's/^--/-/p' "$T/options" | while read -r option; do
        grep -q -e "Fl $option\b" man/surfacectl.1 || echo "$option"
    done >"$T/lacking"
    is "$command: options that the manual lacks" "$(cat "$T/lacking")" ''
done <"$T/commands"
"$BUILD/surfacectl" attempts --help >"$T/text"
ok "help of a group" grep -q "^  attempts list" "$T/text"
finish
