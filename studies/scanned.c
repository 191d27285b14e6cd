#include "scanned.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "head.h"
#include "headpose.h"
#include "headscan.h"
#include "lab.h"
#include "lattice.h"
#include "mem.h"
#include "render.h"

static const struct {
    enum status status;
    const char *name;
} reason[SCANNED_REASONS] = {{ST_OK, "none"},
                             {ST_ENOFACE, "no face"},
                             {ST_ENOTFACE, "not a face"},
                             {ST_EQUALITY, "quality"},
                             {ST_EUNITS, "extent"},
                             {ST_ESEVERAL, "several faces"},
                             {ST_EMIRRORED, "mirrored"},
                             {ST_EINTERNAL, "other"}};

const char *scanned_reason(unsigned k)
{
    return reason[k].name;
}

static void *copy(const void *from, size_t n, size_t size)
{
    void *to = from != NULL ? mem_array(n, size) : NULL;

    if (from != NULL && to == NULL)
        lab_must(ST_ENOMEM);
    if (to != NULL)
        memcpy(to, from, n * size);
    return to;
}

void scanned_build(const struct cloudpoints *c, double unit_mm,
                   const struct scan_options *o, struct face_work *w, struct scanned *out)
{
    struct cloudpoints own = *c;
    enum status st;

    *out = (struct scanned){0};
    own.at = copy(c->at, c->n, sizeof *c->at);
    own.normal = copy(c->normal, c->n, sizeof *c->normal);
    own.index = copy(c->index, c->n, sizeof *c->index);
    own.unit_mm = unit_mm;
    st = scan_build(&own, o, w, &out->face, NULL, &out->found);
    while (st != reason[out->reason].status && out->reason + 1 < SCANNED_REASONS)
        out->reason++;
    cloudpoints_free(&own);
}

void scanned_free(struct scanned *s)
{
    face_free(&s->face);
}

void scanned_cloud(const struct headscan *s, struct cloudpoints *out)
{
    *out = (struct cloudpoints){.read = s->n, .width = s->width, .height = s->height};
    out->at = copy(s->at, s->n, sizeof *s->at);
    out->index = mem_array(s->n, sizeof *out->index);
    if (out->index == NULL)
        lab_must(ST_ENOMEM);
    for (size_t i = 0; i < s->n; i++)
        if (!isnan(s->at[i].x)) {
            out->at[out->n] = s->at[i];
            out->index[out->n++] = (uint32_t)i;
        }
    if (out->n == s->n) { /* none was dropped */
        mem_free(out->index);
        out->index = NULL;
    }
}

bool scanned_stand(const struct dvec3 *p, size_t n, bool crop, struct face_work *w,
                   struct head *out)
{
    double to[16];

    *out = (struct head){0};
    if (!headpose_find(p, n, crop, w, to))
        return false;
    for (size_t i = 0; i < n; i++)
        head_add(out, vec_transform(to, p[i]), HEAD_SKIN);
    head_measure(out);
    return true;
}

/* ---- pictures */

#define WIDE 150
#define HIGH 180

/* From 0 (far) to 1: the reports' palette. */
static unsigned by_depth(double t)
{
    static const int at[3][3] = {
        {0x30, 0x40, 0x8f}, {0x5f, 0xb7, 0xa4}, {0xfd, 0xe7, 0x25}};
    const double u = 2 * fmin(fmax(t, 0), 1);
    const int i = u < 1 ? 0 : 1;
    unsigned rgb = 0;

    for (int k = 0; k < 3; k++)
        rgb = rgb << 8 | (unsigned)(at[i][k] + (u - i) * (at[i + 1][k] - at[i][k]));
    return rgb;
}

/* The middle and the size of 98 % of the points along an axis. */
static void range(const struct cloudpoints *c, int axis, double *low, double *high)
{
    double *v = lab_alloc(c->n, sizeof *v);
    size_t n = 0;

    for (size_t i = 0; i < c->n; i += c->n / 5000 + 1)
        v[n++] = axis == 0 ? c->at[i].x : axis == 1 ? c->at[i].y : c->at[i].z;
    *low = *high = 0;
    if (n > 0) {
        (void)lab_spread(v, n); /* sorts */
        *low = v[n / 100];
        *high = v[n - 1 - n / 100];
    }
    free(v);
}

static FILE *open_picture(const struct lab *lab, const char *source, const char *name,
                          const char *what)
{
    char file[96];

    (void)snprintf(file, sizeof file, "%s_%s_%s.dat", source, name, what);
    return lab_open(lab, file);
}

void scanned_draw(const struct lab *lab, const char *source, const char *name,
                  const struct cloudpoints *c, const struct scanned *s)
{
    struct render raw = {.wide = WIDE, .high = HIGH}, face = raw;
    double low[3], high[3];
    FILE *f = open_picture(lab, source, name, "raw");

    for (int k = 0; k < 3; k++)
        range(c, k, &low[k], &high[k]);
    raw.x = (low[0] + high[0]) / 2;
    raw.y = (low[1] + high[1]) / 2;
    raw.z = (low[2] + high[2]) / 2;
    raw.per = 0.92 * fmin(WIDE / (high[0] - low[0]), HIGH / (high[1] - low[1]));
    render_begin(&raw);
    for (size_t i = 0; i < c->n; i++)
        render_point(&raw, c->at[i], c->n < 5000 ? 2 : 1,
                     by_depth((c->at[i].z - low[2]) / (high[2] - low[2])));
    raw.per = 1; /* pixels */
    render_end(&raw, f);
    lab_close(f);

    f = open_picture(lab, source, name, "face");
    face.per = HIGH / 200.0; /* 200 mm */
    if (s->reason == 0) {    /* in the frame in which its nose is the origin */
        const double *r = s->face.frame.pose.r, *t = s->face.frame.pose.t;

        face.x = -(r[0] * t[0] + r[3] * t[1] + r[6] * t[2]);
        face.y = -(r[1] * t[0] + r[4] * t[1] + r[7] * t[2]);
        face.z = -(r[2] * t[0] + r[5] * t[1] + r[8] * t[2]);
    }
    render_begin(&face);
    if (s->reason == 0)
        render_mesh(&face, &s->face.surface.mesh, s->face.surface.bridge, LATTICE_PER_MM,
                    1, 0, 0xb8c8e8);
    face.per = 1;
    render_end(&face, f);
    lab_close(f);
}
