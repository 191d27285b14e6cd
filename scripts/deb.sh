#!/bin/sh
# deb.sh: build the Debian packages into $BUILD/deb, from a copy of this tree with
# packaging/debian at its top.  Needs no root and writes only below $BUILD/deb.
set -eu
cd "$(dirname "$0")/.."
out=${BUILD:-build}/deb
# The package has its own $BUILD, in the copy: make's one, on its command line, would reach that too.
unset BUILD MAKEFLAGS MAKEOVERRIDES
for tool in dpkg-buildpackage dh; do
    command -v $tool >/dev/null || {
        echo "deb: $tool is not installed (scripts/setup deb)" >&2
        exit 1
    }
done
rm -rf "$out"/tree "$out"/*.deb "$out"/surfaced_*
mkdir -p "$out/tree"
tar -c --exclude=./build --exclude=./.git --exclude="./$(realpath --relative-to=. "$out")" . | tar -x -C "$out/tree"
cp -R packaging/debian "$out/tree/debian"
(cd "$out/tree" && dpkg-buildpackage --no-sign --build=binary)
rm -rf "$out/tree"
ls "$out"/*.deb
