#!/bin/sh
# check_install.sh: after `make install` into an empty folder the programs of docs/library.md
# build and run with the installed library on raw scans, linked with the archive, with the shared
# library, and from Python, and free what they make; all other files are where they belong.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
lib=$place/usr/lib
make -s install DESTDIR="$place" PREFIX=/usr

scripts/example.sh c docs/library.md >"$place/compare.c"
scripts/example.sh python docs/library.md >"$place/compare.py"
{
    sed '/^int main/,$d' "$place/compare.c"
    scripts/example.sh C docs/library.md
} >"$place/who.c"

# Raw scans of heads, in metres and any axes, as the lines that the programs read.
scan() {
    "$build/headscan" --kind head --seed "$2" --unit 1000 "made-up:$1" -o "$place/$3.ply"
    python3 - "$place/$3.ply" >"$place/$3.xyz" <<'END'
import re
import struct
import sys

header, points = open(sys.argv[1], "rb").read().split(b"end_header\n", 1)
n = int(re.search(rb"element vertex (\d+)", header)[1])
kind = "f" if re.search(rb"property float x", header) else "d"
for point in struct.iter_unpack("<3" + kind, points[:3 * n * struct.calcsize(kind)]):
    print(*point)
END
}
scan 1 1 alice-1
scan 1 2 alice-2
scan 2 3 bob-1
scan 3 4 carol-1

# Run a program: it accepts the second scan of one person and not that of another.
try() {
    if ! "$@" "$place/alice-1.xyz" "$place/alice-2.xyz" "$place/bob-1.xyz" >"$place/out" ||
        ! grep -q 'alice-2.xyz: match' "$place/out" ||
        ! grep -q 'bob-1.xyz: no match' "$place/out"; then
        cat "$place/out"
        exit 1
    fi
}

static="-I$place/usr/include $lib/libsurface.a -lm"
shared="-I$place/usr/include -L$lib -lsurface"
if command -v pkg-config >/dev/null 2>&1; then
    shared=$(PKG_CONFIG_PATH=$lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$place \
        PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1 \
        pkg-config --cflags --libs surface)
fi
# A name of the program's own cannot clash with one inside the library.
echo 'int face_build(void); int face_build(void) { return 0; }' >"$place/clash.c"
# shellcheck disable=SC2086 # several flags
${CC:-gcc} -std=c11 -Wall -Werror -fsanitize=address -o "$place/static" "$place/compare.c" "$place/clash.c" $static
# shellcheck disable=SC2086 # several flags
${CC:-gcc} -std=c11 -Wall -Werror -o "$place/shared" "$place/compare.c" "$place/clash.c" $shared
# shellcheck disable=SC2086 # several flags
${CC:-gcc} -std=c11 -Wall -Werror -fsanitize=address -o "$place/who" "$place/who.c" $static
for probe in alice-2 carol-1; do
    "$place/who" "$place/$probe.xyz" "$place/alice-1.xyz" "$place/bob-1.xyz" || exit 1
done >"$place/out"
if ! grep -q 'alice-2.xyz: .*/alice-1.xyz, score' "$place/out" ||
    ! grep -q 'carol-1.xyz: nobody, score .* threshold 8.0 among 2$' "$place/out"; then
    cat "$place/out"
    exit 1
fi
try "$place/static"
try env LD_LIBRARY_PATH="$lib" "$place/shared"
try env LD_LIBRARY_PATH="$lib" python3 "$place/compare.py"
# Of the archive's program the address sanitizer reports each leak, also of one that fails; of Python's
# the memory must not grow with the probes, of which each has 0.26 MB.
: >"$place/empty.xyz"
"$place/static" "$place/alice-1.xyz" "$place/alice-2.xyz" "$place/empty.xyz" >"$place/out" && exit 1
[ $? -eq 2 ] || exit 1
LD_LIBRARY_PATH="$lib" python3 - "$place" <<'END'
import resource
import subprocess
import sys

place = sys.argv[1]
most = []
for probes in 2, 42:
    subprocess.run(["python3", f"{place}/compare.py", *[f"{place}/alice-1.xyz"] * (1 + probes)], check=True,
                   stdout=subprocess.DEVNULL)
    most.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
if most[1] > most[0] + 4096:
    sys.exit(f"compare.py: {most[0]} KB with 2 probes, {most[1]} KB with 42: it keeps its faces")
END

# Archive and shared library export what the header declares, and no other header is installed.
grep -oE 'surface_[a-z_]+\(' "$place/usr/include/surface.h" | tr -d '(' | sort -u >"$place/declared"
nm -g --defined-only "$lib/libsurface.a" | awk 'NF == 3 { print $3 }' | sort >"$place/archive"
nm -D --defined-only "$lib/libsurface.so" | awk '$2 == "T" { sub(/@.*/, "", $3); print $3 }' |
    sort >"$place/object"
for kind in archive object; do
    diff "$place/declared" "$place/$kind" || {
        echo "the $kind does not export what its header declares"
        exit 1
    }
done
[ "$(find "$place/usr/include" -type f)" = "$place/usr/include/surface.h" ] || {
    echo "more than one header is installed"
    exit 1
}
for file in usr/bin/surfacectl usr/bin/surfacelab usr/sbin/surfaced usr/lib/libsurface.a usr/lib/libsurface.so \
    usr/lib/pkgconfig/surface.pc usr/share/man/man8/surfaced.8 \
    usr/share/man/man1/surfacectl.1 usr/share/man/man1/surfacelab.1 usr/share/man/man3/surface.3 \
    usr/share/bash-completion/completions/surfacectl \
    usr/share/man/man5/surfaced.conf.5 etc/surfaced.conf \
    usr/lib/systemd/system/surfaced.service usr/lib/systemd/system/surfaced.socket \
    usr/lib/sysusers.d/surfaced.conf; do
    [ -s "$place/$file" ] || {
        echo "not installed: $file"
        exit 1
    }
done
! grep -lE "@(PREFIX|LIBDIR|VERSION)@" "$lib"/pkgconfig/surface.pc
