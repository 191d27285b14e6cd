/* fill: what is missing in a scan, restored. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cloudpoints.h"
#include "cloudunit.h"
#include "fill.h"
#include "lattice.h"
#include "mem.h"
#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_sample.h"

struct filled {
    struct cloudpoints scan; /* as in the file; its unit once it was found */
    struct fill fill;
};

/* A number with as many digits as bring back the same double. */
static void print_exact(FILE *to, double x, char end)
{
    char text[32];

    for (int digits = 15; digits <= 17; digits++) {
        (void)snprintf(text, sizeof text, "%.*g", digits, x);
        if (strtod(text, NULL) == x)
            break;
    }
    (void)fprintf(to, "%s%c", text, end);
}

static void print_point(FILE *to, double x, double y, double z, int restored)
{
    print_exact(to, x, ' ');
    print_exact(to, y, ' ');
    print_exact(to, z, ' ');
    (void)fprintf(to, "%d\n", restored);
}

/* The scan's points as they came, then those restored. */
static enum status write_filled(FILE *to, const void *arg, struct errinfo *e)
{
    const struct filled *f = arg;

    (void)e;
    (void)fprintf(to,
                  "ply\nformat ascii 1.0\ncomment %s\n"
                  "comment restored: 0 a point of the scan, 1 filled in\n"
                  "element vertex %zu\nproperty double x\nproperty double y\n"
                  "property double z\nproperty uchar restored\nend_header\n",
                  cloudunit_name(f->scan.unit_mm), f->scan.n + f->fill.n);
    for (size_t i = 0; i < f->scan.n; i++)
        print_point(to, f->scan.at[i].x, f->scan.at[i].y, f->scan.at[i].z, 0);
    for (uint32_t i = 0; i < f->fill.n; i++) {
        const struct ivec3 *p = &f->fill.pts[i];
        const double per = LATTICE_PER_MM * f->scan.unit_mm;

        print_point(to, p->x / per, p->y / per, p->z / per, 1);
    }
    return ST_OK;
}

/* ---- what was done */

static int by_area(const void *a, const void *b)
{
    const struct fill_hole *p = a, *q = b;

    return (p->area < q->area) - (p->area > q->area);
}

static void tell_hole(struct ctl *c, const struct fill_hole *h)
{
    const double diameter = h->diameter / LATTICE_PER_MM;
    const double area = h->area / (LATTICE_PER_MM * LATTICE_PER_MM);
    double rms, most;

    fill_error(diameter, &rms, &most);
    json_object(c->out, NULL);
    json_number(c->out, "diameter_mm", diameter);
    json_extent(c->out, "area_mm2", area);
    json_number(c->out, "restored", h->points);
    json_number(c->out, "error_rms_mm", rms);
    json_number(c->out, "error_95_mm", most);
    json_close(c->out);
    ctl_say(c, "hole         %.1f mm across, %.0f mm2: %" PRIu64 " point%s", diameter,
            area, CTL_COUNT(h->points));
    if (isnan(rms))
        ctl_say(c, "; wider than was studied, nothing is known of the error\n");
    else
        ctl_say(c, "; error about %.1f mm (root mean square), 95 %% below %.1f mm\n", rms,
                most);
}

/* The holes by their size, the largest first. */
static void tell_filled(struct ctl *c, struct filled *f)
{
    const struct fill *r = &f->fill;
    const double beyond = r->beyond / (LATTICE_PER_MM * LATTICE_PER_MM);

    if (r->nholes > 0)
        qsort(r->hole, r->nholes, sizeof *r->hole, by_area);
    json_text(c->out, "file", c->dir);
    json_number(c->out, "points", (double)f->scan.n);
    json_number(c->out, "restored", r->n);
    ctl_say(c,
            "restored     %" PRIu64 " point%s in %" PRIu64
            " hole%s, beside %zu of the scan\n",
            CTL_COUNT(r->n), CTL_COUNT(r->nholes), f->scan.n);
    json_array(c->out, "holes");
    for (uint32_t i = 0; i < r->nholes; i++)
        tell_hole(c, &r->hole[i]);
    json_close(c->out);
    json_extent(c->out, "beyond_mm2", beyond);
    ctl_say(c,
            "beyond       %.0f mm2 beyond the outline, not filled\n"
            "file         %s\n",
            beyond, c->dir);
}

/* The scan's points in millimetres, as a face; from that what is missing. */
static enum status restore(struct ctl *c, struct filled *f)
{
    struct scan_found found;
    struct cloudpoints mm = {.at = mem_array(f->scan.n, sizeof *mm.at),
                             .read = f->scan.n,
                             .n = f->scan.n,
                             .unit_mm = f->scan.unit_mm};
    struct scratch scratch = {0};
    struct face face = {0};
    enum status st;

    if (mm.at == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    for (size_t i = 0; i < mm.n; i++)
        mm.at[i] = f->scan.at[i];
    if ((st = ctl_sample_build(c, c->args[0], &mm, false, c->work, &face, &found)) ==
            ST_OK &&
        (st = fill_holes(&face.surface, (uint32_t)(FACE_MAX_POINTS - f->scan.n), &scratch,
                         &f->fill)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0],
                          st == ST_ELIMIT ? "filled, it would have too many points"
                                          : status_message(st));
    f->scan.unit_mm = found.unit_mm;
    cloudpoints_free(&mm);
    scratch_free(&scratch);
    face_free(&face);
    return st;
}

static enum status run(struct ctl *c)
{
    struct filled f = {.scan = {.n = 0}};
    enum status st;

    if (c->dir == NULL)
        return ctl_usage(c, "fill needs --out FILE");
    if ((st = ctl_dir_may_pipe(c, 1)) != ST_OK)
        return st;
    c->scans.axes = SCAN_AXES_SCANNER; /* the points stay where they are */
    st = ctl_sample_parse(c, c->args[0], &f.scan);
    if (st == ST_OK && (st = restore(c, &f)) == ST_OK &&
        (st = ctl_dir_file(c, c->dir, write_filled, &f)) == ST_OK)
        tell_filled(c, &f);
    fill_free(&f.fill);
    cloudpoints_free(&f.scan);
    return st;
}

const struct ctl_command ctl_fill = {
    .name = "fill",
    .args = "FILE",
    .takes = {1, 1},
    .shared = CTL_UNITS | CTL_CAMERA | CTL_MODEL | CTL_OUT | CTL_FORCE,
    .run = run,
    .summary = "restore the points that are missing in a scan's holes",
    .help =
        "A hole is where the triangles between the scan's points are much wider than the points\n"
        "round it are apart.  It is filled with points as dense as those, on the triangles.  The\n"
        "scan's points as they are, and the restored ones, marked by the property \"restored\",\n"
        "are written to the file --out (PLY; -: standard output).  For each hole it says how far\n"
        "the restored points may be off.  What lies beyond the scan's outline is not filled.\n"
        "Do not enroll a filled scan: restored points would be taken for measured ones.",
    .example = "surfacectl fill alice.ply --out filled.ply"};
