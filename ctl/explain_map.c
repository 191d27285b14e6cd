#include "explain_map.h"

#include <math.h>
#include <string.h>

#include "explain_color.h"
#include "lattice.h"
#include "mem.h"

#define PIXEL_MM    0.25
#define SIDE_PIXELS 2000 /* at most; larger surfaces get larger pixels */

struct corner {
    double x, y, z; /* on the template; x and y in pixels, z in mm */
    double light;   /* 0..1 */
    double value[EXPLAIN_KINDS];
};

struct canvas {
    const struct explanation *x;
    struct dvec3 *at;             /* [nv] the probe's vertices on the template, mm */
    struct dvec3 *normal;         /* [nv] of the surface there, of any length */
    double *value[EXPLAIN_KINDS]; /* [nv] */
    float *depth;                 /* [h * w] height of what was painted last */
    struct explain_map *map;
};

static bool drawn(const struct face *f, uint32_t t)
{
    return !mesh_is_ghost(&f->surface.mesh, t) && !f->surface.bridge[t];
}

/* The vertices on the template, and the sums of their triangles' normals. */
static enum status place(struct canvas *c)
{
    const struct face *f = &c->x->probe;
    const struct mesh *m = &f->surface.mesh;

    for (uint32_t v = 0; v < m->nv; v++)
        c->at[v] = (struct dvec3){m->xy[v].x / LATTICE_PER_MM,
                                  m->xy[v].y / LATTICE_PER_MM, m->z[v] / LATTICE_PER_MM};
    if (explain_at(c->x, c->at, m->nv, c->value) != ST_OK)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < m->nv; v++)
        c->normal[v] = (struct dvec3){0, 0, 0};
    for (uint32_t k = 0; k < m->nt; k++) {
        struct dvec3 p, q, r, n;

        if (!drawn(f, k))
            continue;
        p = c->at[m->org[3 * k]];
        q = c->at[m->org[3 * k + 1]];
        r = c->at[m->org[3 * k + 2]];
        q = (struct dvec3){q.x - p.x, q.y - p.y, q.z - p.z};
        r = (struct dvec3){r.x - p.x, r.y - p.y, r.z - p.z};
        n = (struct dvec3){q.y * r.z - q.z * r.y, q.z * r.x - q.x * r.z,
                           q.x * r.y - q.y * r.x};
        for (uint32_t h = 3 * k; h < 3 * k + 3; h++) {
            c->normal[m->org[h]].x += n.x;
            c->normal[m->org[h]].y += n.y;
            c->normal[m->org[h]].z += n.z;
        }
    }
    return ST_OK;
}

/* The pixels: as many as the surface needs, all of them empty. */
static enum status prepare(struct canvas *c)
{
    struct dvec3 lo = {INFINITY, INFINITY, 0}, hi = {-INFINITY, -INFINITY, 0};
    struct explain_map *map = c->map;
    size_t n;

    for (uint32_t v = 0; v < c->x->probe.surface.mesh.nv; v++) {
        lo = (struct dvec3){fmin(lo.x, c->at[v].x), fmin(lo.y, c->at[v].y), 0};
        hi = (struct dvec3){fmax(hi.x, c->at[v].x), fmax(hi.y, c->at[v].y), 0};
    }
    map->pixel_mm = fmax(PIXEL_MM, fmax(hi.x - lo.x, hi.y - lo.y) / SIDE_PIXELS);
    map->w = (uint32_t)((hi.x - lo.x) / map->pixel_mm) + 2;
    map->h = (uint32_t)((hi.y - lo.y) / map->pixel_mm) + 2;
    map->x_mm = lo.x;
    map->y_mm = lo.y;
    n = (size_t)map->w * map->h;
    if ((c->depth = mem_array(n, sizeof *c->depth)) == NULL)
        return ST_ENOMEM;
    for (int k = 0; k < EXPLAIN_KINDS; k++) {
        if ((map->rgba[k] = mem_array(n, sizeof *map->rgba[k])) == NULL)
            return ST_ENOMEM;
        memset(map->rgba[k], 0, n * sizeof *map->rgba[k]);
    }
    for (size_t i = 0; i < n; i++)
        c->depth[i] = -INFINITY;
    return ST_OK;
}

static struct corner corner_at(const struct canvas *c, uint32_t v)
{
    const struct dvec3 p = c->at[v], n = c->normal[v], sun = {-0.3, 0.5, 0.8124};
    const double length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    const double light = n.x * sun.x + n.y * sun.y + n.z * sun.z;

    struct corner to = {.x = (p.x - c->map->x_mm) / c->map->pixel_mm,
                        .y = (p.y - c->map->y_mm) / c->map->pixel_mm,
                        .z = p.z,
                        .light = length > 0 ? fmax(0, light / length) : 1};

    for (int k = 0; k < EXPLAIN_KINDS; k++)
        to.value[k] = c->value[k][v];
    return to;
}

/* The pixel i, at the shares a, b, d of a triangle's corners. */
static void paint(const struct canvas *c, size_t i, const struct corner *p, double a,
                  const struct corner *q, double b, const struct corner *r, double d)
{
    const double z = a * p->z + b * q->z + d * r->z;
    const double light = a * p->light + b * q->light + d * r->light;

    if (z <= (double)c->depth[i])
        return;
    c->depth[i] = (float)z;
    for (int k = 0; k < EXPLAIN_KINDS; k++) {
        uint8_t *rgba = c->map->rgba[k][i];

        explain_color((enum explain_kind)k,
                      a * p->value[k] + b * q->value[k] + d * r->value[k],
                      explain_end((enum explain_kind)k), rgba);
        for (int l = 0; l < 3; l++) /* little enough that the scale can still be read */
            rgba[l] = (uint8_t)lround(rgba[l] * fmin(1, 0.74 + 0.32 * light));
        rgba[3] = 255;
    }
}

/* Every pixel whose middle lies in the triangle. */
static void fill(const struct canvas *c, const struct corner p, const struct corner q,
                 const struct corner r)
{
    const double twice = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    const double x0 = ceil(fmin(p.x, fmin(q.x, r.x))), x1 = fmax(p.x, fmax(q.x, r.x));
    const double y0 = ceil(fmin(p.y, fmin(q.y, r.y))), y1 = fmax(p.y, fmax(q.y, r.y));

    if (twice <= 0) /* seen from behind, where the probe turned it there */
        return;
    for (double y = y0; y <= y1; y++)
        for (double x = x0; x <= x1; x++) {
            const double a = ((q.x - x) * (r.y - y) - (q.y - y) * (r.x - x)) / twice;
            const double b = ((r.x - x) * (p.y - y) - (r.y - y) * (p.x - x)) / twice;
            const double d = 1 - a - b;

            if (a >= 0 && b >= 0 && d >= 0)
                paint(c, (size_t)y * c->map->w + (size_t)x, &p, a, &q, b, &r, d);
        }
}

enum status explain_map(const struct explanation *x, struct explain_map *out)
{
    const struct mesh *m = &x->probe.surface.mesh;
    struct canvas c = {.x = x, .map = out};
    bool room;
    enum status st = ST_ENOMEM;

    memset(out, 0, sizeof *out);
    c.at = mem_array(m->nv, sizeof *c.at);
    c.normal = mem_array(m->nv, sizeof *c.normal);
    room = c.at != NULL && c.normal != NULL;
    for (int k = 0; k < EXPLAIN_KINDS; k++) {
        c.value[k] = mem_array(m->nv, sizeof *c.value[k]);
        room = room && c.value[k] != NULL;
    }
    if (room && (st = place(&c)) == ST_OK)
        st = prepare(&c);
    for (uint32_t t = 0; st == ST_OK && t < m->nt; t++)
        if (drawn(&x->probe, t))
            fill(&c, corner_at(&c, m->org[3 * t]), corner_at(&c, m->org[3 * t + 1]),
                 corner_at(&c, m->org[3 * t + 2]));
    if (st != ST_OK)
        explain_map_free(out);
    for (int k = 0; k < EXPLAIN_KINDS; k++)
        mem_free(c.value[k]);
    mem_free(c.depth);
    mem_free(c.normal);
    mem_free(c.at);
    return st;
}

void explain_map_free(struct explain_map *map)
{
    for (int k = 0; k < EXPLAIN_KINDS; k++)
        mem_free(map->rgba[k]);
    memset(map, 0, sizeof *map);
}
