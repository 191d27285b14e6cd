#!/bin/sh
# Goal: a subject has 20 templates at most, however they come: one by one, several in a form, many
# requests at once, by surfacectl, by an import.  What would be more is refused whole, and the
# scans that are there already are known as before.
. tests/box/lib.sh

for i in $(seq 0 24); do
    scan 1 "$i" "$T/$i.ply"
done

# templates SUBJECT
templates() {
    ctl template list "$1"
    said '.templates | length'
}

# form SUBJECT FILE...
form() {
    f_subject=$1
    shift
    for f_file in "$@"; do
        shift
        set -- "$@" -F "file=@$T/$f_file.ply"
    done
    req POST "/v1/subjects/$f_subject/templates?fuse=false" "$@"
}

start_daemon --no-auth
# ---- one by one, and several in a form
# shellcheck disable=SC2046 # numbers
form alice $(seq 0 17)
is "18 in a form" "$STATUS $(templates alice)" '201 18'
form alice 18 19 20
problem "3 more" 409 too_many_templates 'alice would have more than 20 templates'
is "none of them was taken" "$(templates alice)" 18
form alice 18 17 19
is "2 more, and one that is there" "$STATUS $(templates alice)" '201 20'
for n in 20 21; do
    gives "409 too_many_templates" "one more" send POST /v1/subjects/alice/templates "$PLY" "$T/$n.ply"
    send POST '/v1/subjects/alice/templates?force=true' "$PLY" "$T/$n.ply"
    problem "one more, by force" 409 too_many_templates
done
gives 200 "one that is there" send POST /v1/subjects/alice/templates "$PLY" "$T/7.ply"
send POST /v1/subjects/alice/verify "$PLY" "$T/20.ply"
is "verified" "$STATUS $(get .decision) $(get .templates_compared)" '200 match 20'
is "no failed attempts" "$(sql 'SELECT count(*) FROM attempts')" 0

# ---- by surfacectl
ctl_exits 65 enroll alice "$T/20.ply"
ok "it says so" grep -q 'more than 20 templates: delete some' "$T/ctl.err"
mkdir "$T/folder"
cp "$T/20.ply" "$T/folder/alice_a.ply"
cp "$T/21.ply" "$T/folder/bob_a.ply"
ctl enroll "$T/folder"
is "a folder: the others are enrolled" "$(said '"\(.enrolled) \(.failed)"') $(templates bob)" '1 1 1'

# ---- many at once
form carol 0 1 2 3
for i in $(seq 20); do
    beside "$i" POST /v1/subjects/carol/templates -H "$PLY" --data-binary "@$T/$((i + 3)).ply"
done
all_sent
is "16 of 20 at once" "$TALLY" '201x16 409x4'
is "carol has 20" "$(templates carol)" 20

# ---- by an import
ctl_exits 0 subject set carol --consent C-1
openssl rand -hex 32 >"$T/archive.key"
chmod 600 "$T/archive.key"
ctl_exits 0 export carol -o "$T/carol.archive" --archive-key "$T/archive.key"
ctl_exits 0 template delete "$(ctl template list carol && said '.templates[3].template_id')" --yes
ctl_exits 0 enroll carol "$T/24.ply" # another one in its place
ctl_exits 65 import "$T/carol.archive" --archive-key "$T/archive.key" --force
ok "it says so" grep -q 'carol would have more than 20 templates' "$T/ctl.err"
is "nothing was imported" "$(templates carol)" 20
ctl_exits 0 template delete "$(ctl template list carol && said '.templates[19].template_id')" --yes
ctl_exits 0 import "$T/carol.archive" --archive-key "$T/archive.key" --force
is "as many as there is room for" "$(said .templates_new) $(templates carol)" "1 20"
ctl_exits 0 check-database
finish
