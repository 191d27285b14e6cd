/* headscan -- render a head, or a frontal scan, as another scanner would deliver it. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cloudfile.h"
#include "errinfo.h"
#include "face.h"
#include "headscan.h"
#include "outfile.h"
#include "pose.h"
#include "scan.h"

static const char usage[] =
    "usage: headscan --kind KIND [OPTION]... IN -o OUT\n"
    "Write a scan of the head in IN as another scanner would deliver it, or of a frontal scan\n"
    "with something that covers the face.\n"
    "  IN             points in mm: of a head from all sides (it may stand anyhow), or of the\n"
    "                 front of a face; or made-up:N, a made-up head\n"
    "  --kind KIND    head, bust, round, half, depth, grid, behind, two;\n"
    "                 glasses, mask, scarf, hand, fringe, beard, cap\n"
    "  --seed N       of all that is drawn (0)\n"
    "  --other FILE   the second head of `two` (IN)\n"
    "  --yaw D        turned by D degrees (drawn at random)\n"
    "  --axes A       agreed, down, z-up, any\n"
    "  --unit U       um, mm, cm, m, in\n"
    "  --mirrored     the mirror image\n"
    "  -o OUT         .ply (binary), or .pcd (with the grid of a depth camera); replaced if it\n"
    "                 exists, but never IN or FILE\n";

#define FILE_LIMIT ((size_t)1 << 28)

struct command {
    unsigned kind;
    double seed, yaw, unit_mm; /* NAN: drawn */
    int axes;                  /* -1: the kind's */
    bool mirrored;
    const char *in, *other, *out;
};

static int headscan_main_fail(const char *what, const char *which)
{
    (void)fprintf(stderr, "headscan: %s%s\n", what, which);
    return 1;
}

/* The place of a word in a list that ends with NULL; -1. */
static int headscan_main_find(const char *const *list, const char *word)
{
    for (int i = 0; list[i] != NULL; i++)
        if (strcmp(list[i], word) == 0)
            return i;
    return -1;
}

static bool read_number(const char *text, double *value)
{
    char *end;

    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

static bool read_unit(const char *word, double *mm)
{
    static const char *const names[] = {"um", "mm", "cm", "m", "in", NULL};
    static const double size[] = {0.001, 1, 10, 1000, 25.4};
    const int i = headscan_main_find(names, word);

    *mm = i >= 0 ? size[i] : 0;
    return i >= 0;
}

static bool read_kind(const char *word, unsigned *kind)
{
    for (*kind = 0; *kind < HEADSCAN_KINDS; ++*kind)
        if (strcmp(headscan_name(*kind), word) == 0)
            return true;
    return false;
}

static bool read_option(struct command *c, const char *name, const char *value)
{
    static const char *const axes[] = {"agreed", "down", "z-up", "any", NULL};

    if (strcmp(name, "--seed") == 0)
        return read_number(value, &c->seed);
    if (strcmp(name, "--yaw") == 0)
        return read_number(value, &c->yaw);
    if (strcmp(name, "--kind") == 0)
        return read_kind(value, &c->kind);
    if (strcmp(name, "--unit") == 0)
        return read_unit(value, &c->unit_mm);
    if (strcmp(name, "--axes") == 0)
        return (c->axes = headscan_main_find(axes, value)) >= 0;
    if (strcmp(name, "--other") == 0)
        c->other = value;
    else if (strcmp(name, "-o") == 0)
        c->out = value;
    else
        return false;
    return true;
}

static bool read_command(int argc, char **argv, struct command *c)
{
    *c = (struct command){
        .kind = HEADSCAN_KINDS, .yaw = (double)NAN, .unit_mm = (double)NAN, .axes = -1};
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--mirrored") == 0)
            c->mirrored = true;
        else if (argv[i][0] != '-' && c->in == NULL)
            c->in = argv[i];
        else if (i + 1 == argc || !read_option(c, argv[i], argv[i + 1]))
            return false;
        else
            i++;
    }
    return c->kind < HEADSCAN_KINDS && c->in != NULL && c->out != NULL;
}

/* ---- the head */

static int headscan_main_read_points(const char *path, struct cloudpoints *out)
{
    static const struct cloudfile_options options = {.max_points = CLOUDFILE_POINTS,
                                                     .max_bytes = FILE_LIMIT};
    FILE *f = fopen(path, "rb");
    unsigned char *bytes;
    struct errinfo e;
    size_t n;

    if (f == NULL)
        return headscan_main_fail(path, ": cannot be read");
    bytes = head_alloc(FILE_LIMIT + 1, 1);
    n = fread(bytes, 1, FILE_LIMIT, f);
    (void)fclose(f);
    if (cloudfile_read(bytes, n, &options, out, &e) != ST_OK) {
        free(bytes);
        return headscan_main_fail(path, ": no scan");
    }
    free(bytes);
    return 0;
}

/* Larger than a face: a whole head. */
static bool is_head(const struct cloudpoints *c)
{
    struct dvec3 lo = c->at[0], hi = lo;

    for (size_t i = 0; i < c->n; i++) {
        const struct dvec3 p = c->at[i];

        lo = (struct dvec3){fmin(lo.x, p.x), fmin(lo.y, p.y), fmin(lo.z, p.z)};
        hi = (struct dvec3){fmax(hi.x, p.x), fmax(hi.y, p.y), fmax(hi.z, p.z)};
    }
    hi = vec_sub(hi, lo);
    return vec_dot(hi, hi) > 300.0 * 300.0;
}

/* The head stands anyhow, a crop as its scanner saw it; to the canonical frame. */
static int read_head(const char *path, struct surface_work *w, struct head *out,
                     bool *crop)
{
    struct surface_face face = {0};
    struct surface_found found;
    struct scan_options how = {.axes = SCAN_AXES_AUTO};
    struct cloudpoints c;
    double frame[16];
    bool there;

    *crop = false;
    if (strncmp(path, "made-up:", 8) == 0) {
        head_make_up(strtoull(path + 8, NULL, 10), out);
        return 0;
    }
    if (headscan_main_read_points(path, &c) != 0)
        return 1;
    *crop = !is_head(&c);
    *out = (struct head){0};
    for (size_t i = 0; i < c.n; i++)
        head_add(out, c.at[i], HEAD_SKIN);
    if (*crop)
        how.axes = SCAN_AXES_SCANNER;
    if ((there = scan_build(&c, &how, w, &face, NULL, &found) == ST_OK)) {
        pose_to_matrix(&face.frame.pose, frame);
        head_move(out, found.view);
        head_move(out, frame);
        head_measure(out);
    }
    face_free(&face);
    cloudpoints_free(&c);
    return there ? 0 : headscan_main_fail(path, ": no face was found");
}

/* ---- the file */

/* Two names of one file? */
static bool is_same(const char *a, const char *b)
{
    struct stat one, other;

    return a != NULL && stat(a, &one) == 0 && stat(b, &other) == 0 &&
           one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

/* Four bytes, the lowest first, on any machine. */
static void put_float(FILE *f, double value)
{
    const float single = (float)value;
    uint32_t bits;

    memcpy(&bits, &single, sizeof bits);
    for (int i = 0; i < 4; i++)
        (void)fputc((int)(bits >> (8 * i) & 255), f);
}

/* Of an organised cloud PLY has (0, 0, 0) where there is no value, PCD has NaN. */
static int write_scan(const struct headscan *s, const char *path)
{
    const char *dot = strrchr(path, '.');
    const bool pcd = dot != NULL && strcmp(dot, ".pcd") == 0;
    FILE *f = fopen(path, "wb");
    int bad;

    if (f == NULL)
        return headscan_main_fail(path, ": cannot be written");
    if (pcd)
        (void)fprintf(f,
                      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
                      "COUNT 1 1 1\nWIDTH %zu\nHEIGHT %u\nVIEWPOINT 0 0 0 1 0 0 0\n"
                      "POINTS %zu\nDATA binary\n",
                      s->width > 0 ? s->width : s->n, s->width > 0 ? s->height : 1, s->n);
    else
        (void)fprintf(f,
                      "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n"
                      "property float x\nproperty float y\nproperty float z\n"
                      "end_header\n",
                      s->n);
    for (size_t i = 0; i < s->n; i++) {
        const bool none = isnan(s->at[i].x) && !pcd;

        put_float(f, none ? 0 : s->at[i].x);
        put_float(f, none ? 0 : s->at[i].y);
        put_float(f, none ? 0 : s->at[i].z);
    }
    bad = ferror(f);
    if (fclose(f) != 0 || bad)
        return headscan_main_fail(path, ": could not all be written");
    return 0;
}

static void options_of(const struct command *c, bool crop, struct headscan_options *o)
{
    headscan_kind(c->kind, (uint64_t)c->seed, crop, o);
    o->yaw = isnan(c->yaw) ? o->yaw : c->yaw;
    o->unit_mm = isnan(c->unit_mm) ? o->unit_mm : c->unit_mm;
    o->axes = c->axes < 0 ? o->axes : (enum headscan_axes)c->axes;
    o->mirrored = c->mirrored;
}

int main(int argc, char **argv)
{
    struct surface_work *w = surface_work_new(NULL);
    struct head h = {0}, other = {0};
    struct headscan_options o;
    struct headscan s = {0};
    struct command c;
    bool crop = false, ignore;
    int rc;

    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        (void)fputs(usage, stdout);
        rc = outfile_flush(stdout) ? 0 : 1;
    } else if (!read_command(argc, argv, &c)) {
        (void)fputs(usage, stderr);
        rc = 2;
    } else if (w == NULL) {
        rc = headscan_main_fail("out of memory", "");
    } else if (is_same(c.in, c.out) || is_same(c.other, c.out)) {
        rc =
            headscan_main_fail(c.out, ": is read, and not replaced; choose another name");
    } else if ((rc = read_head(c.in, w, &h, &crop)) == 0 &&
               (c.other == NULL || (rc = read_head(c.other, w, &other, &ignore)) == 0)) {
        options_of(&c, crop, &o);
        headscan_render(&h, c.other != NULL ? &other : &h, &o, &s);
        rc = write_scan(&s, c.out);
    }
    headscan_free(&s);
    head_free(&h);
    head_free(&other);
    surface_work_free(w);
    return rc;
}
