/* fill: what is missing in a scan, restored. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lab.h"
#include "cloudfile.h"
#include "cloudpoints.h"
#include "cloudunit.h"
#include "fill.h"
#include "lattice.h"
#include "mem.h"

struct filled {
    struct cloudpoints scan; /* as in the file; its unit once it was found */
    struct fill fill;
};

/* 17 digits bring back the same double. */
static void print_point(FILE *to, double x, double y, double z, int restored)
{
    (void)fprintf(to, "%.17g %.17g %.17g %d\n", x, y, z, restored);
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

static void print_hole(struct lab *c, const struct fill_hole *h)
{
    const double diameter = h->diameter / LATTICE_PER_MM;
    const double area = h->area / (LATTICE_PER_MM * LATTICE_PER_MM);
    double rms, most;

    fill_error(diameter, &rms, &most);
    json_object(c->report, NULL);
    json_number(c->report, "diameter_mm", diameter);
    json_extent(c->report, "area_mm2", area);
    json_number(c->report, "restored", h->points);
    json_number(c->report, "error_rms_mm", rms);
    json_number(c->report, "error_95_mm", most);
    json_close(c->report);
    lab_say(c, "hole         %.1f mm across, %.0f mm2, points restored: %" PRIu32,
            diameter, area, h->points);
    if (isnan(rms))
        lab_say(c, "; wider than any studied hole: the error is unknown\n");
    else
        lab_say(c, "; error about %.1f mm (root mean square), 95 %% below %.1f mm\n", rms,
                most);
}

/* The holes by their size, the largest first. */
static void print_filled(struct lab *c, struct filled *f)
{
    const struct fill *r = &f->fill;
    const double beyond = r->beyond / (LATTICE_PER_MM * LATTICE_PER_MM);

    if (r->nholes > 0)
        qsort(r->hole, r->nholes, sizeof *r->hole, by_area);
    json_text(c->report, "file", c->out);
    json_number(c->report, "points", (double)f->scan.n);
    json_number(c->report, "restored", r->n);
    lab_say(c,
            "restored     points: %" PRIu32 ", holes: %" PRIu32
            ", points of the scan: %zu\n",
            r->n, r->nholes, f->scan.n);
    json_array(c->report, "holes");
    for (uint32_t i = 0; i < r->nholes; i++)
        print_hole(c, &r->hole[i]);
    json_close(c->report);
    json_extent(c->report, "beyond_mm2", beyond);
    lab_say(c,
            "beyond       %.0f mm2 beyond the outline, not filled\n"
            "file         %s\n",
            beyond, c->out);
}

/* The scan's points in millimetres, as a face; from that what is missing. */
static enum status lab_fill_restore(struct lab *c, struct filled *f)
{
    struct surface_found found;
    struct cloudpoints mm = {.at = mem_array(f->scan.n, sizeof *mm.at),
                             .read = f->scan.n,
                             .n = f->scan.n,
                             .unit_mm = f->scan.unit_mm};
    struct scratch scratch = {0};
    struct surface_face face = {0};
    enum status st;

    if (mm.at == NULL)
        return errinfo_memory(&c->e);
    for (size_t i = 0; i < mm.n; i++)
        mm.at[i] = f->scan.at[i];
    if ((st = lab_scan_build(c, c->args[0], &mm, false, c->work, &face, &found, &c->e)) ==
            ST_OK &&
        (st = fill_holes(&face.surface, (uint32_t)(CLOUDFILE_POINTS - f->scan.n),
                         &scratch, &f->fill)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0],
                          st == ST_ELIMIT ? "filled, it would have too many points"
                                          : status_message(st));
    f->scan.unit_mm = found.unit_mm;
    cloudpoints_free(&mm);
    scratch_free(&scratch);
    face_free(&face);
    return st;
}

enum status lab_fill(struct lab *c)
{
    struct filled f = {.scan = {.n = 0}};
    enum status st;

    if (c->out == NULL)
        return lab_usage(c, "fill needs --out FILE");
    if ((st = lab_may_pipe(c)) != ST_OK)
        return st;
    c->frontal = true; /* the points stay where they are */
    st = lab_scan_parse(c, c->args[0], &f.scan, &c->e);
    if (st == ST_OK && (st = lab_fill_restore(c, &f)) == ST_OK &&
        (st = lab_write(c, c->out, write_filled, &f)) == ST_OK)
        print_filled(c, &f);
    fill_free(&f.fill);
    cloudpoints_free(&f.scan);
    return st;
}
