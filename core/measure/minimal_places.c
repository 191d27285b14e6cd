#include "minimal_places.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "pose.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "surface.h"

/* Triangles passed on the way to a vertex before it counts as having no gap.  In two scans
 * alike it is one or two; between overturned triangles a walk may go in circles. */
#define MINIMAL_WALK 400

#define NO_GAP (-1.0f) /* the weight of a place without one, while weights are summed */
#define NONE   UINT32_MAX

static void side_layout(struct minimal_side *s, size_t *at, unsigned char *block)
{
    const size_t n = s->surface->mesh.nv;

    s->spot = mem_take(block, at, n, sizeof *s->spot);
    s->height = mem_take(block, at, n, sizeof *s->height);
    s->under = mem_take(block, at, n, sizeof *s->under);
}

size_t minimal_places_layout(struct minimal_pair *p, unsigned char *block)
{
    const size_t na = p->tmpl.surface->mesh.nv, nb = p->probe.surface->mesh.nv;
    const size_t n = na + nb + MINIMAL_LANES;
    size_t at = 0;

    side_layout(&p->tmpl, &at, block);
    side_layout(&p->probe, &at, block);
    p->point = mem_take(block, &at, nb, sizeof *p->point);
    p->normal = mem_take(block, &at, nb, sizeof *p->normal);
    p->places.gap = mem_take(block, &at, n, sizeof *p->places.gap);
    p->places.weight = mem_take(block, &at, n, sizeof *p->places.weight);
    for (int k = 0; k < 5; k++)
        p->places.by[k] = mem_take(block, &at, n, sizeof *p->places.by[k]);
    return at;
}

/* The normals at the probe's vertices. */
static void normals(struct minimal_pair *p)
{
    const struct mesh *m = &p->probe.surface->mesh;

    memset(p->normal, 0, m->nv * sizeof *p->normal);
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        struct dvec3 n;
        minimal_lanes f;

        if (p->probe.surface->bridge[t])
            continue;
        n = vec_cross(vec_sub(p->point[v[1]], p->point[v[0]]),
                      vec_sub(p->point[v[2]], p->point[v[0]]));
        f = (minimal_lanes){(float)n.x, (float)n.y, (float)n.z, 0};
        for (int i = 0; i < 3; i++)
            p->normal[v[i]] += f;
    }
}

/* The side's vertex v is at q (mm). */
static inline void set_down(struct minimal_side *s, uint32_t v, struct dvec3 q,
                            struct dvec3 centre)
{
    s->spot[v] = (struct minimal_spot){(float)(q.x - centre.x), (float)(q.y - centre.y)};
    s->height[v] = (float)(q.z - centre.z);
}

void minimal_places_begin(struct minimal_pair *p)
{
    const struct mesh *a = &p->tmpl.surface->mesh, *b = &p->probe.surface->mesh;

    for (uint32_t v = 0; v < a->nv; v++)
        set_down(&p->tmpl, v, lattice_to_mm(a->xy[v], a->z[v]), p->centre);
    for (uint32_t v = 0; v < b->nv; v++)
        p->point[v] = lattice_to_mm(b->xy[v], b->z[v]);
    memset(p->tmpl.under, 0xff, a->nv * sizeof *p->tmpl.under);
    memset(p->probe.under, 0xff, b->nv * sizeof *p->probe.under);
    p->stride = b->nv > MINIMAL_FEW ? b->nv / MINIMAL_FEW : 1;
    normals(p);
}

/* Twice the area of abc, seen from above. */
static inline float minimal_places_turn(struct minimal_spot a, struct minimal_spot b,
                                        struct minimal_spot c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* walk(s, at, q): the side's triangle under or over q, from triangle *at, which becomes the
 * last one seen; NONE outside, or where the walk is too long: where the turn has overturned
 * triangles it may go in circles. */
static uint32_t minimal_places_walk(const struct minimal_side *s, uint32_t *at,
                                    struct minimal_spot q)
{
    const struct mesh *m = &s->surface->mesh;
    uint32_t t = *at;

    for (int steps = 0; steps < MINIMAL_WALK; steps++) {
        const uint32_t *v = &m->org[3 * t];
        struct minimal_spot a, b, c;

        if (__builtin_expect((v[0] == m->nv) | (v[1] == m->nv) | (v[2] == m->nv), 0))
            return NONE;
        a = s->spot[v[0]];
        b = s->spot[v[1]];
        c = s->spot[v[2]];
        *at = t;
        if (minimal_places_turn(a, b, q) < 0)
            t = m->twin[3 * t] / 3;
        else if (minimal_places_turn(b, c, q) < 0)
            t = m->twin[3 * t + 1] / 3;
        else if (minimal_places_turn(c, a, q) < 0)
            t = m->twin[3 * t + 2] / 3;
        else
            return t;
    }
    return NONE;
}

/* find(own, other, v): the other side's triangle under or over own's vertex v; NONE: there is
 * none, or it bridges.  The first time it is looked for from the nearest ancestor's. */
static inline uint32_t minimal_places_find(struct minimal_side *own,
                                           const struct minimal_side *other, uint32_t v)
{
    uint32_t near = v, t;

    while (near > 0 && own->under[near] == NONE)
        near = own->surface->mesh.parent[near];
    t = own->under[near];
    if (t == NONE)
        for (t = 0; mesh_is_ghost(&other->surface->mesh, t); t++)
            ;
    own->under[v] = t;
    t = minimal_places_walk(other, &own->under[v], own->spot[v]);
    return t != NONE && !other->surface->bridge[t] ? t : NONE;
}

/* A surface under or over a spot: its height (from the centre) and slopes. */
struct plane {
    float z, zx, zy;
};

static inline struct plane plane_at(const struct minimal_side *s, uint32_t t,
                                    struct minimal_spot q)
{
    const uint32_t *v = s->surface->mesh.org + 3 * t;
    const struct minimal_spot a = s->spot[v[0]], b = s->spot[v[1]], c = s->spot[v[2]];
    const float z = s->height[v[0]], ez = s->height[v[1]] - z, fz = s->height[v[2]] - z;
    const float over = 1 / minimal_places_turn(a, b, c);
    const float zx = (ez * (c.y - a.y) - fz * (b.y - a.y)) * over;
    const float zy = (fz * (b.x - a.x) - ez * (c.x - a.x)) * over;

    return (struct plane){z + zx * (q.x - a.x) + zy * (q.y - a.y), zx, zy};
}

/* The slopes of the moved probe: its triangles' own are noise. */
static inline void smooth(const struct minimal_pair *p, const struct pose *pose,
                          uint32_t t, struct plane *f)
{
    const uint32_t *v = p->probe.surface->mesh.org + 3 * t;
    const minimal_lanes n = p->normal[v[0]] + p->normal[v[1]] + p->normal[v[2]];
    const double *r = pose->r;
    const float nx = (float)r[0] * n[0] + (float)r[1] * n[1] + (float)r[2] * n[2];
    const float ny = (float)r[3] * n[0] + (float)r[4] * n[1] + (float)r[5] * n[2];
    const float nz = (float)r[6] * n[0] + (float)r[7] * n[1] + (float)r[8] * n[2];
    const float over = -1 / nz;

    f->zx = nz > 0 ? nx * over : 0;
    f->zy = nz > 0 ? ny * over : 0;
}

/* Place i, at q and the probe's height z there, with the other surface's slopes. */
static inline void minimal_places_put(struct minimal_places *p, uint32_t i,
                                      struct minimal_spot q, float z, struct plane f,
                                      float gap, float weight)
{
    p->gap[i] = gap;
    p->weight[i] = weight;
    p->by[0][i] = q.y + z * f.zy;
    p->by[1][i] = -q.x - z * f.zx;
    p->by[2][i] = q.y * f.zx - q.x * f.zy;
    p->by[3][i] = -f.zx;
    p->by[4][i] = -f.zy;
}

static void put_none(struct minimal_places *p, uint32_t i, float weight)
{
    minimal_places_put(p, i, (struct minimal_spot){0, 0}, 0, (struct plane){0, 0, 0}, 0,
                       weight);
}

/* Up to a multiple of the lanes. */
static void pad(struct minimal_places *p)
{
    while (p->n % MINIMAL_LANES != 0)
        put_none(p, p->n++, 0);
}

/* The probe's vertex v becomes place i.  Returns whether there is a gap; else it does not. */
static inline bool put_over(struct minimal_pair *p, const struct pose *pose, uint32_t v,
                            uint32_t i, float weight)
{
    const struct dvec3 q = pose_apply(pose, p->point[v]);
    struct plane f;
    uint32_t t;

    set_down(&p->probe, v, q, p->centre);
    t = minimal_places_find(&p->probe, &p->tmpl, v);
    if (t == NONE)
        return false;
    f = plane_at(&p->tmpl, t, p->probe.spot[v]);
    minimal_places_put(&p->places, i, p->probe.spot[v], p->probe.height[v], f,
                       p->probe.height[v] - f.z, weight);
    return true;
}

double minimal_places_few(struct minimal_pair *p, const struct pose *pose)
{
    const float up[3] = {(float)pose->r[6], (float)pose->r[7], (float)pose->r[8]};
    uint32_t *const n = &p->places.n;
    double sum = 0;

    *n = 0;
    for (uint32_t v = 0; v < p->probe.surface->mesh.nv; v += p->stride) {
        const minimal_lanes normal = p->normal[v];
        const float area = normal[0] * up[0] + normal[1] * up[1] + normal[2] * up[2];

        if (area > 0 && put_over(p, pose, v, *n, area)) {
            sum += (double)area;
            ++*n;
        }
    }
    pad(&p->places);
    return sum;
}

/* The template's vertices, under the moved probe. */
static void template_side(struct minimal_pair *p, const struct pose *pose)
{
    const uint32_t nb = p->probe.surface->mesh.nv;

    for (uint32_t v = 0; v < p->tmpl.surface->mesh.nv; v++) {
        const struct minimal_spot q = p->tmpl.spot[v];
        const uint32_t t = minimal_places_find(&p->tmpl, &p->probe, v);
        struct plane f;

        if (t == NONE) {
            put_none(&p->places, nb + v, NO_GAP);
            continue;
        }
        f = plane_at(&p->probe, t, q);
        smooth(p, pose, t, &f);
        minimal_places_put(&p->places, nb + v, q, f.z, f, f.z - p->tmpl.height[v], 0);
    }
}

/* The weights of a side's vertices. */
static void minimal_places_weigh(const struct minimal_side *s, float *weight)
{
    const struct mesh *m = &s->surface->mesh;

    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        float area;

        if (s->surface->bridge[t])
            continue;
        area = minimal_places_turn(s->spot[v[0]], s->spot[v[1]], s->spot[v[2]]);
        if ((weight[v[0]] >= 0) & (weight[v[1]] >= 0) & (weight[v[2]] >= 0) & (area > 0))
            for (int i = 0; i < 3; i++)
                weight[v[i]] += area;
    }
}

double minimal_places_all(struct minimal_pair *p, const struct pose *pose)
{
    const uint32_t nb = p->probe.surface->mesh.nv;
    struct minimal_places *out = &p->places;
    double sum = 0;

    for (uint32_t v = 0; v < nb; v++)
        if (!put_over(p, pose, v, v, 0))
            put_none(out, v, NO_GAP);
    template_side(p, pose);
    minimal_places_weigh(&p->probe, out->weight);
    minimal_places_weigh(&p->tmpl, out->weight + nb);
    out->n = nb + p->tmpl.surface->mesh.nv;
    for (uint32_t i = 0; i < out->n; i++) {
        out->weight[i] = out->weight[i] > 0 ? out->weight[i] : 0;
        sum += (double)out->weight[i];
    }
    pad(out);
    return sum;
}
