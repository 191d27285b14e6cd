#!/bin/sh
# check_install.sh: after `make install` into an empty folder a program of its own builds and
# runs with the installed library, and all other files are where they belong.
set -eu
cd "$(dirname "$0")/.."
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
make -s install DESTDIR="$place" PREFIX=/usr
cat >"$place/try.c" <<'END'
#include <surface/face.h>
#include <stdio.h>
int main(void)
{
    struct face_work *w = face_work_new(NULL);
    struct face f = {0};
    struct dvec3 p[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    enum status st = face_build(p, 3, w, &f, NULL);

    printf("%s: %s\n", FACE_ENGINE, status_message(st));
    face_free(&f);
    face_work_free(w);
    return st != ST_ETOOFEW;
}
END
flags="-I$place/usr/include -I$place/usr/include/surface -L$place/usr/lib -lsurface -lm"
if command -v pkg-config >/dev/null 2>&1; then
    flags=$(PKG_CONFIG_PATH=$place/usr/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$place \
        PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1 \
        pkg-config --cflags --libs --static surface)
fi
# shellcheck disable=SC2086 # several flags
${CC:-gcc} -std=c11 -o "$place/try" "$place/try.c" $flags
"$place/try"
for file in usr/bin/surfacectl usr/sbin/surfaced usr/lib/libsurface.a \
    usr/lib/pkgconfig/surface.pc usr/share/man/man8/surfaced.8 \
    usr/share/man/man1/surfacectl.1 usr/share/man/man5/surfaced.conf.5 etc/surfaced.conf \
    usr/lib/systemd/system/surfaced.service usr/lib/systemd/system/surfaced.socket \
    usr/lib/sysusers.d/surfaced.conf; do
    [ -s "$place/$file" ] || { echo "not installed: $file"; exit 1; }
done
! grep -lE "@(PREFIX|LIBDIR|VERSION)@" "$place"/usr/lib/pkgconfig/surface.pc
