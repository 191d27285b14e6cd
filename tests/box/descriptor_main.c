/* descriptor -- for the tests: is the descriptor of an enrolled scan in a process's memory, or in a file?
 *   descriptor PLACE FILE...
 * PLACE: a process's number, or a file.  FILE: a scan as it was enrolled.  Looks for 32 coefficients in a row, as a
 * plain descriptor and as an index of the search has them: pairs of modes, of 16 people side by side
 * (core/face/search.h).  Prints how many of the files are found.
 * Exit status: 1 if the place or a scan cannot be read. */
#include <ctype.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clouddepth.h"
#include "cloudfile.h"
#include "cloudpoints.h"
#include "errinfo.h"
#include "libsurface.h"
#include "sample.h"

#define PAIRS  16
#define STRIDE 32 /* bytes from a pair of modes to the next one */
#define FILES  16
#define BLOCK  ((size_t)1 << 20)
#define REACH  ((PAIRS - 1) * STRIDE + 2)

static unsigned char wanted[FILES][SURFACE_DESCRIPTOR];
static bool found[FILES];
static int files;

static void describe(const char *path, unsigned char out[SURFACE_DESCRIPTOR])
{
    struct surface_work *w = surface_work_new(NULL);
    const struct clouddepth_camera camera = {.scale = 0};
    const struct sample_options o = {.enrolment = true};
    struct sample_found is;
    struct surface_face *f = NULL;
    struct cloudpoints c = {.n = 0};
    struct errinfo e;

    if (w == NULL || cloudfile_read_path(path, 0, &camera, &c, &e) != ST_OK ||
        sample_build(path, &c, &o, w, &f, &is, &e) != ST_OK ||
        surface_describe(w, f, out) != SURFACE_OK) {
        (void)fprintf(stderr, "descriptor: %s: %s\n", path, e.msg);
        exit(1);
    }
    cloudpoints_free(&c);
    surface_face_free(f);
    surface_work_free(w);
}

/* In an index the modes stand in falling order. */
static bool is_indexed(const unsigned char *at, const unsigned char *d)
{
    for (size_t k = 0; k < PAIRS; k++)
        if (at[k * STRIDE] != d[2 * (PAIRS - k)] ||
            at[k * STRIDE + 1] != d[2 * (PAIRS - k) - 1])
            return false;
    return true;
}

/* Begins within the first `begin` bytes of the block. */
static void look(const unsigned char *block, size_t begin)
{
    for (size_t i = 0; i < begin; i++)
        for (int f = 0; f < files; f++)
            found[f] = found[f] || memcmp(block + i, wanted[f] + 1, 2 * PAIRS) == 0 ||
                       is_indexed(block + i, wanted[f]);
}

static void look_at(FILE *f, uint64_t from, uint64_t size)
{
    static unsigned char block[BLOCK + REACH];

    for (uint64_t at = 0; at < size; at += BLOCK) {
        size_t n;

        memset(block, 0, sizeof block);
        if (fseeko(f, (off_t)(from + at), SEEK_SET) != 0)
            return;
        n = fread(block, 1, size - at < sizeof block ? size - at : sizeof block, f);
        if (n == 0)
            return;
        look(block, n < BLOCK ? n : BLOCK);
    }
}

static void look_at_process(const char *pid)
{
    char path[64], line[400];
    uint64_t from, to;
    FILE *maps, *mem;

    (void)snprintf(path, sizeof path, "/proc/%s/maps", pid);
    maps = fopen(path, "r");
    (void)snprintf(path, sizeof path, "/proc/%s/mem", pid);
    if (maps == NULL || (mem = fopen(path, "rb")) == NULL) {
        perror(path);
        exit(1);
    }
    while (fgets(line, sizeof line, maps) != NULL)
        if (sscanf(line, "%" SCNx64 "-%" SCNx64 " rw", &from, &to) == 2 &&
            strstr(line, " rw") != NULL)
            look_at(mem, from, to - from);
    (void)fclose(maps);
    (void)fclose(mem);
}

int main(int argc, char **argv)
{
    int n = 0;
    FILE *f;

    for (files = 0; files < FILES && files + 2 < argc; files++)
        describe(argv[files + 2], wanted[files]);
    if (isdigit((unsigned char)argv[1][0])) {
        look_at_process(argv[1]);
    } else if ((f = fopen(argv[1], "rb")) == NULL) {
        perror(argv[1]);
        return 1;
    } else {
        look_at(f, 0, UINT64_C(1) << 32);
        (void)fclose(f);
    }
    for (int i = 0; i < files; i++)
        n += found[i];
    (void)printf("%d\n", n);
    return 0;
}
