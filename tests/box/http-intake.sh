#!/bin/sh
# Goal: enrolments do not fill the disk.  Nothing is added where the disk has less room than the reserve,
# while verifications go on.
# The second part has a small file system of its own, where the tests may mount one.
. tests/box/lib.sh

for i in $(seq 0 9); do
    scan 1 "$i" "$T/$i.ply"
done
scan 2 0 "$T/other.ply"
enroll() {
    send POST "/v1/subjects/$1/templates" "$PLY" "$T/$2.ply"
}
trap 'umount -l "$T/disk" 2>/dev/null; cleanup' EXIT

start_daemon --no-auth
for i in $(seq 0 9); do
    gives 201 "no limit, $i" enroll dave "$i"
done
is "there is room" "$(metric surfaced_storage_full)" 0
stop_daemon

# ---- the reserve: more than any disk has
start_daemon --no-auth --disk-reserve 1000000G
enroll alice 0
problem "an enrolment" 503 storage_full 'try again later'
again "not soon" 60
ok "the log says how much is free" grep -Eq 'fault="[0-9]+ MB are free .* disk-reserve keeps 1024000000 MB' "$LOG"
gives "503 storage_full" "a subject" req POST /v1/subjects -H "$JSON" -d '{"subject": "erin"}'
send POST /v1/subjects/dave/verify "$PLY" "$T/other.ply"
is "a verification" "$STATUS $(get .decision)" '200 no_match'
for i in 1 2 3; do
    req POST "/v1/subjects/frank$i/templates?fuse=false" -F "file=@$T/0.ply" -F "file=@$T/other.ply"
    problem "several files, $i" 503 storage_full
    again "several files, $i: not soon" 60
done
gives 200 "it is ready" req GET /readyz
is "as metrics" "$(metric surfaced_storage_full) $(metric surfaced_enrollments_refused_total)" '1 5'
gives 200 "an erasure" req DELETE /v1/subjects/dave
stop_daemon

# ---- a disk that fills up
mkdir "$T/disk"
if ! mount -t tmpfs -o size=24m tmpfs "$T/disk" 2>"$T/mount"; then
    echo "SKIP $0: not permitted to mount a small file system"
    finish
fi
DB=$T/disk/faces.db
start_daemon --no-auth --disk-reserve 8M
gives 201 "with room" enroll alice 0
head -c 16M /dev/zero >"$T/disk/else"
gives "503 storage_full" "without" enroll alice 1
for _ in $(seq 100); do
    send POST /v1/subjects/alice/verify "$PLY" "$T/9.ply"
    [ "$STATUS" = 200 ] || break
done
is "100 verifications" "$STATUS $(get .decision)" '200 match'
rm "$T/disk/else"
gives 201 "with room again" enroll alice 1
is "the gauge" "$(metric surfaced_storage_full)" 0
finish
