#!/bin/sh
# check_install.sh: after `make install` into an empty folder a program of its own builds and
# runs with the installed library, and all other files are where they belong.
set -eu
cd "$(dirname "$0")/.."
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
make -s install DESTDIR="$place" PREFIX=/usr
# The program enrols one scan and compares with it another of the same subject and one of
# another subject.  It has a face_build() of its own: names inside the library cannot clash.
cat >"$place/try.c" <<'END'
#include <stdio.h>
#include <surface.h>

#define MOST 5000

int face_build(void);
int face_build(void)
{
    return 0;
}

static struct surface_face *read_face(struct surface_work *work, const char *path)
{
    static double points[MOST][3];
    struct surface_face *face;
    struct surface_quality quality;
    enum surface_status st;
    FILE *f = fopen(path, "r");
    size_t n = 0, bad;

    if (f == NULL)
        return NULL;
    while (n < MOST && fscanf(f, "%lf %lf %lf", &points[n][0], &points[n][1],
                              &points[n][2]) == 3)
        n++;
    fclose(f);
    st = surface_face_new(work, (const double(*)[3])points, n, &face, &bad);
    printf("%s: %zu points: %s", path, n, surface_message(st));
    if (st == SURFACE_OK) {
        surface_face_quality(face, &quality);
        printf(", %zu kept, quality %.2f", quality.points, quality.score);
    }
    printf("\n");
    return face;
}

int main(int argc, char **argv)
{
    struct surface_work *work = surface_work_new();
    struct surface_face *face[3] = {NULL, NULL, NULL};
    struct surface_comparison same, other;
    char engine[SURFACE_ENGINE_SIZE];
    int i, good;

    surface_engine(engine);
    for (i = 0; i < 3 && i + 1 < argc && work != NULL; i++)
        if ((face[i] = read_face(work, argv[i + 1])) == NULL)
            return 1;
    if (face[2] == NULL ||
        surface_compare(work, face[0], face[1], &same) != SURFACE_OK ||
        surface_compare(work, face[0], face[2], &other) != SURFACE_OK)
        return 1;
    printf("%s: %.1f and %.1f, threshold %.1f\n", engine, same.score, other.score,
           same.threshold);
    good = same.decision == SURFACE_MATCH && other.decision == SURFACE_NO_MATCH &&
           same.disparity_mm > 0 && same.overlap > 0.5 && face_build() == 0;
    for (i = 0; i < 3; i++)
        surface_face_free(face[i]);
    surface_work_free(work);
    return good ? 0 : 1;
}
END
build=${BUILD:-build}
"$build/facegen" --subject 1 --format xyz -o "$place/a.xyz"
"$build/facegen" --subject 1 --scan 1 --yaw 10 --format xyz -o "$place/b.xyz"
"$build/facegen" --subject 2 --format xyz -o "$place/c.xyz"
flags="-I$place/usr/include -L$place/usr/lib -lsurface -lm"
if command -v pkg-config >/dev/null 2>&1; then
    flags=$(PKG_CONFIG_PATH=$place/usr/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$place \
        PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1 \
        pkg-config --cflags --libs --static surface)
fi
# shellcheck disable=SC2086 # several flags
${CC:-gcc} -std=c11 -o "$place/try" "$place/try.c" $flags
"$place/try" "$place/a.xyz" "$place/b.xyz" "$place/c.xyz"

# The archive exports what the header declares, and no other header is installed.
nm -g --defined-only "$place/usr/lib/libsurface.a" | awk 'NF == 3 { print $3 }' | sort \
    >"$place/exported"
grep -oE 'surface_[a-z_]+\(' "$place/usr/include/surface.h" | tr -d '(' | sort -u \
    >"$place/declared"
diff "$place/declared" "$place/exported" ||
    { echo "the library does not export what its header declares"; exit 1; }
[ "$(find "$place/usr/include" -type f)" = "$place/usr/include/surface.h" ] ||
    { echo "more than one header is installed"; exit 1; }
for file in usr/bin/surfacectl usr/bin/surfacelab usr/sbin/surfaced usr/lib/libsurface.a \
    usr/lib/pkgconfig/surface.pc usr/share/man/man8/surfaced.8 \
    usr/share/man/man1/surfacectl.1 usr/share/man/man1/surfacelab.1 usr/share/man/man5/surfaced.conf.5 etc/surfaced.conf \
    usr/lib/systemd/system/surfaced.service usr/lib/systemd/system/surfaced.socket \
    usr/lib/sysusers.d/surfaced.conf; do
    [ -s "$place/$file" ] || { echo "not installed: $file"; exit 1; }
done
! grep -lE "@(PREFIX|LIBDIR|VERSION)@" "$place"/usr/lib/pkgconfig/surface.pc
