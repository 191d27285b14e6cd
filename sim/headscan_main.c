/* headscan -- render a head, or a frontal scan, as another scanner would deliver it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "errinfo.h"
#include "face.h"
#include "headscan.h"
#include "outfile.h"
#include "pose.h"
#include "readfile.h"
#include "scan.h"

static const char usage[] =
    "usage: headscan --kind KIND [OPTION]... IN -o OUT\n"
    "Write a scan of a made-up head, or a frontal scan with something that covers the face.\n"
    "  IN             made-up:N, a made-up head; or a frontal scan in mm\n"
    "  --kind KIND    head, bust, half, depth, grid, behind;\n"
    "                 glasses, mask, scarf, hand, fringe, beard, cap\n"
    "  --seed N       of all that is drawn (0)\n"
    "  --yaw D        turned by D degrees (drawn at random)\n"
    "  --agreed       x to the image's right, y up, z towards the scanner (the kind's axes)\n"
    "  --unit MM      mm in a unit of the coordinates (the kind's: 1 or 1000)\n"
    "  --mirrored     the mirror image\n"
    "  -o OUT         .ply (binary), or .pcd (with the grid of a depth camera); replaced if it\n"
    "                 exists, but never IN\n";

#define FILE_LIMIT ((size_t)1 << 28)

struct command {
    const char *kind, *in, *out;
    double seed, yaw, unit_mm; /* NAN: the kind's */
    bool agreed, mirrored;
};

static int headscan_main_fail(const char *what, const char *which)
{
    (void)fprintf(stderr, "headscan: %s%s\n", what, which);
    return 1;
}

static bool read_number(const char *text, double *value)
{
    char *end;

    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

static bool read_option(struct command *c, const char *name, const char *value)
{
    if (strcmp(name, "--seed") == 0)
        return read_number(value, &c->seed);
    if (strcmp(name, "--yaw") == 0)
        return read_number(value, &c->yaw);
    if (strcmp(name, "--unit") == 0)
        return read_number(value, &c->unit_mm) && c->unit_mm > 0;
    if (strcmp(name, "--kind") == 0)
        c->kind = value;
    else if (strcmp(name, "-o") == 0)
        c->out = value;
    else
        return false;
    return true;
}

static bool read_command(int argc, char **argv, struct command *c)
{
    *c = (struct command){.yaw = (double)NAN, .unit_mm = (double)NAN};
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--mirrored") == 0)
            c->mirrored = true;
        else if (strcmp(argv[i], "--agreed") == 0)
            c->agreed = true;
        else if (argv[i][0] != '-' && c->in == NULL)
            c->in = argv[i];
        else if (i + 1 == argc || !read_option(c, argv[i], argv[i + 1]))
            return false;
        else
            i++;
    }
    return c->kind != NULL && c->in != NULL && c->out != NULL;
}

/* ---- the head */

static int headscan_main_read_points(const char *path, struct cloudpoints *out)
{
    static const struct cloudfile_options options = {.max_points = CLOUDFILE_POINTS,
                                                     .max_bytes = FILE_LIMIT};
    unsigned char *bytes = NULL;
    struct errinfo e;
    enum status st;
    size_t n;

    if ((st = readfile_all(path, FILE_LIMIT, &bytes, &n, &e)) == ST_OK)
        st = cloudfile_read(bytes, n, &options, out, &e);
    free(bytes);
    return st == ST_OK ? 0 : headscan_main_fail(e.msg, "");
}

/* A made-up head, or the points of a frontal scan, moved to the canonical frame. */
static int read_head(const char *path, struct surface_work *w, struct head *out,
                     bool *crop)
{
    static const struct scan_options how = {.axes = SCAN_AXES_SCANNER};
    struct surface_face face = {0};
    struct surface_found found;
    struct cloudpoints c;
    double frame[16];
    bool there;

    if (strncmp(path, "made-up:", 8) == 0) {
        head_make_up(strtoull(path + 8, NULL, 10), out);
        return 0;
    }
    if (headscan_main_read_points(path, &c) != 0)
        return 1;
    *crop = true;
    for (size_t i = 0; i < c.n; i++)
        head_add(out, c.at[i], HEAD_SKIN);
    if ((there = scan_build(&c, &how, w, &face, NULL, &found) == ST_OK)) {
        pose_to_matrix(&face.frame.pose, frame);
        head_move(out, frame);
        head_measure(out);
    }
    face_free(&face);
    cloudpoints_free(&c);
    return there ? 0 : headscan_main_fail(path, ": no face was found");
}

/* ---- the file */

/* Four bytes, the lowest first, on any machine. */
static void put_float(FILE *f, double value)
{
    const float single = (float)value;
    uint32_t bits;

    memcpy(&bits, &single, sizeof bits);
    for (int i = 0; i < 4; i++)
        (void)fputc((int)(bits >> (8 * i) & 255), f);
}

struct file {
    const struct headscan *scan;
    bool pcd;
};

/* Of an organised cloud PLY has (0, 0, 0) where there is no value, PCD has NaN. */
static enum status write_scan(FILE *f, const void *arg, struct errinfo *e)
{
    const struct file *to = arg;
    const struct headscan *s = to->scan;

    (void)e;
    if (to->pcd)
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
        const bool none = isnan(s->at[i].x) && !to->pcd;

        put_float(f, none ? 0 : s->at[i].x);
        put_float(f, none ? 0 : s->at[i].y);
        put_float(f, none ? 0 : s->at[i].z);
    }
    return ST_OK;
}

/* Returns false if there is no such kind. */
static bool options_of(const struct command *c, bool crop, struct headscan_options *o)
{
    if (!headscan_kind(c->kind, (uint64_t)c->seed, crop, o))
        return false;
    o->yaw = isnan(c->yaw) ? o->yaw : c->yaw;
    o->unit_mm = isnan(c->unit_mm) ? o->unit_mm : c->unit_mm;
    o->down = o->down && !c->agreed;
    o->mirrored = c->mirrored;
    return true;
}

int main(int argc, char **argv)
{
    struct surface_work *w = surface_work_new(NULL);
    struct head h = {0};
    struct headscan_options o;
    struct headscan s = {0};
    struct file to = {.scan = &s};
    struct command c;
    struct errinfo e;
    bool crop = false;
    int rc;

    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        (void)fputs(usage, stdout);
        rc = outfile_flush(stdout) ? 0 : 1;
    } else if (!read_command(argc, argv, &c) || !options_of(&c, false, &o)) {
        (void)fputs(usage, stderr);
        rc = 2;
    } else if (w == NULL) {
        rc = headscan_main_fail("out of memory", "");
    } else if (outfile_not_read(c.out, c.in, &e) != ST_OK) {
        rc = headscan_main_fail(e.msg, "");
    } else if ((rc = read_head(c.in, w, &h, &crop)) == 0) {
        (void)options_of(&c, crop, &o);
        headscan_render(&h, &o, &s);
        to.pcd = strstr(c.out, ".pcd") != NULL;
        if (outfile_write(c.out, true, write_scan, &to, &e) != ST_OK)
            rc = headscan_main_fail(e.msg, "");
    }
    headscan_free(&s);
    head_free(&h);
    surface_work_free(w);
    return rc;
}
