#include "minimal_places.h"

#include <stdbool.h>
#include <string.h>

#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "surface.h"
#include "tuning.h"

#define NO_GAP (-1.0f) /* the weight of a place without one, while weights are summed */
#define MM     ((float)(1 / LATTICE_PER_MM))

size_t minimal_places_layout(struct minimal_pair *p, unsigned char *block)
{
    const size_t na = p->tmpl->mesh.nv, nb = p->probe->mesh.nv;
    const size_t n = na + nb + MINIMAL_LANES;
    size_t at = 0;

    p->point = mem_take(block, &at, nb, sizeof *p->point);
    p->normal = mem_take(block, &at, nb, sizeof *p->normal);
    p->spot = mem_take(block, &at, nb, sizeof *p->spot);
    p->height = mem_take(block, &at, nb, sizeof *p->height);
    p->under = mem_take(block, &at, na, sizeof *p->under);
    p->places.gap = mem_take(block, &at, n, sizeof *p->places.gap);
    p->places.weight = mem_take(block, &at, n, sizeof *p->places.weight);
    for (int k = 0; k < 5; k++)
        p->places.by[k] = mem_take(block, &at, n, sizeof *p->places.by[k]);
    return at;
}

/* The normals at the probe's vertices. */
static void normals(struct minimal_pair *p)
{
    const struct mesh *m = &p->probe->mesh;

    memset(p->normal, 0, m->nv * sizeof *p->normal);
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t a = m->org[3 * t], b = m->org[3 * t + 1], c = m->org[3 * t + 2];
        float ux, uy, uz, vx, vy, vz;
        minimal_lanes n;

        if (p->probe->bridge[t])
            continue;
        ux = MM * (float)(m->xy[b].x - m->xy[a].x);
        uy = MM * (float)(m->xy[b].y - m->xy[a].y);
        uz = MM * (float)(m->z[b] - m->z[a]);
        vx = MM * (float)(m->xy[c].x - m->xy[a].x);
        vy = MM * (float)(m->xy[c].y - m->xy[a].y);
        vz = MM * (float)(m->z[c] - m->z[a]);
        n = (minimal_lanes){uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx, 0};
        p->normal[a] += n;
        p->normal[b] += n;
        p->normal[c] += n;
    }
}

void minimal_places_begin(struct minimal_pair *p)
{
    const struct mesh *m = &p->probe->mesh;

    for (uint32_t v = 0; v < m->nv; v++)
        p->point[v] = (struct align_point){lattice_to_mm(m->xy[v], m->z[v]), 0.0f,
                                           ALIGN_FIELD_NONE};
    align_field_make(p->tmpl, NULL, &p->field);
    p->stride = m->nv > MINIMAL_FEW ? m->nv / MINIMAL_FEW : 1;
    normals(p);
}

/* Where a place is, from the centre (mm), and the slopes of the other surface there. */
struct place {
    float x, y, z, zx, zy;
};

static inline void put(struct minimal_places *p, uint32_t i, struct place at, float gap,
                       float weight)
{
    p->gap[i] = gap;
    p->weight[i] = weight;
    p->by[0][i] = at.y + at.z * at.zy;
    p->by[1][i] = -at.x - at.z * at.zx;
    p->by[2][i] = at.y * at.zx - at.x * at.zy;
    p->by[3][i] = -at.zx;
    p->by[4][i] = -at.zy;
}

static void put_none(struct minimal_places *p, uint32_t i, float weight)
{
    put(p, i, (struct place){0, 0, 0, 0, 0}, 0, weight);
}

/* Up to a multiple of the lanes. */
static void pad(struct minimal_places *p)
{
    while (p->n % MINIMAL_LANES != 0)
        put_none(p, p->n++, 0);
}

/* The place of one of the probe's vertices, at q (mm), over the triangle t. */
static inline void put_over(struct minimal_pair *p, uint32_t i, struct dvec3 q,
                            const struct align_corners *t, float weight)
{
    const float *a = t->at[0], *b = t->at[1], *c = t->at[2];
    const float ex = b[0] - a[0], ey = b[1] - a[1], ez = b[2] - a[2];
    const float fx = c[0] - a[0], fy = c[1] - a[1], fz = c[2] - a[2];
    const float over = 1 / (ex * fy - ey * fx);
    const float zx = (ez * fy - fz * ey) * over, zy = (fz * ex - ez * fx) * over;
    const struct place at = {(float)(q.x - p->centre.x), (float)(q.y - p->centre.y),
                             (float)(q.z - p->centre.z), zx, zy};

    put(&p->places, i, at, MM * (zx * a[0] + zy * a[1] - a[2]), weight);
}

/* The template's triangle under q, to which the probe's vertex v has moved; false where there
 * is none, or it bridges.  The first time it is looked for from the nearest ancestor's. */
static inline bool find(struct minimal_pair *p, uint32_t v, struct dvec3 q,
                        struct align_corners *out)
{
    uint32_t near = v;

    while (near > 0 && p->point[near].triangle == ALIGN_FIELD_NONE)
        near = p->probe->mesh.parent[near];
    p->point[v].triangle = p->point[near].triangle != ALIGN_FIELD_NONE
                               ? p->point[near].triangle
                               : p->field.first;
    return align_field_find(&p->field, &p->point[v], q, out);
}

double minimal_places_few(struct minimal_pair *p, const struct align_pose *pose)
{
    const float up[3] = {(float)pose->r[6], (float)pose->r[7], (float)pose->r[8]};
    uint32_t *const n = &p->places.n;
    double sum = 0;

    *n = 0;
    for (uint32_t v = 0; v < p->probe->mesh.nv; v += p->stride) {
        const struct dvec3 q = align_pose_apply(pose, p->point[v].p);
        const minimal_lanes normal = p->normal[v];
        const float area = normal[0] * up[0] + normal[1] * up[1] + normal[2] * up[2];
        struct align_corners t;

        if (!find(p, v, q, &t) || !(area > 0))
            continue;
        put_over(p, (*n)++, q, &t, area);
        sum += (double)area;
    }
    pad(&p->places);
    return sum;
}

/* The probe's vertices over the template. */
static void probe_side(struct minimal_pair *p, const struct align_pose *pose)
{
    for (uint32_t v = 0; v < p->probe->mesh.nv; v++) {
        const struct dvec3 q = align_pose_apply(pose, p->point[v].p);
        struct align_corners t;

        p->spot[v] =
            (struct minimal_spot){(float)(q.x - p->centre.x), (float)(q.y - p->centre.y)};
        p->height[v] = (float)(q.z - p->centre.z);
        if (find(p, v, q, &t))
            put_over(p, v, q, &t, 0);
        else
            put_none(&p->places, v, NO_GAP);
    }
}

/* A triangle of twice the area `area` between the places v, if all have a gap. */
static inline void weigh(float *weight, const uint32_t v[3], float area)
{
    if ((weight[v[0]] >= 0) & (weight[v[1]] >= 0) & (weight[v[2]] >= 0) & (area > 0))
        for (int i = 0; i < 3; i++)
            weight[v[i]] += area;
}

/* Twice the area of abc, seen from above. */
static inline float turn(struct minimal_spot a, struct minimal_spot b,
                         struct minimal_spot c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static void probe_weights(struct minimal_pair *p)
{
    const struct mesh *m = &p->probe->mesh;

    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];

        if (!p->probe->bridge[t])
            weigh(p->places.weight, v, turn(p->spot[v[0]], p->spot[v[1]], p->spot[v[2]]));
    }
}

/* walk(p, at, q): the moved probe's triangle under q, from triangle *at, which becomes the last
 * one seen; UINT32_MAX outside, or where the walk is too long: where the turn has overturned
 * triangles it may go in circles. */
static uint32_t walk(const struct minimal_pair *p, uint32_t *at, struct minimal_spot q)
{
    const struct mesh *m = &p->probe->mesh;
    uint32_t t = *at;

    for (int steps = 0; steps < MINIMAL_WALK; steps++) {
        const uint32_t *v = &m->org[3 * t];
        struct minimal_spot a, b, c;

        if (__builtin_expect((v[0] == m->nv) | (v[1] == m->nv) | (v[2] == m->nv), 0))
            return UINT32_MAX;
        a = p->spot[v[0]];
        b = p->spot[v[1]];
        c = p->spot[v[2]];
        *at = t;
        if (turn(a, b, q) < 0)
            t = m->twin[3 * t] / 3;
        else if (turn(b, c, q) < 0)
            t = m->twin[3 * t + 1] / 3;
        else if (turn(c, a, q) < 0)
            t = m->twin[3 * t + 2] / 3;
        else
            return t;
    }
    return UINT32_MAX;
}

/* The template's vertex v, at q and the height z, under or over triangle t of the moved
 * probe. */
static inline void put_under(struct minimal_pair *p, const struct align_pose *pose,
                             uint32_t v, struct minimal_spot q, float z, uint32_t t)
{
    const uint32_t *c = &p->probe->mesh.org[3 * t], i = p->probe->mesh.nv + v;
    const struct minimal_spot a = p->spot[c[0]], b = p->spot[c[1]], d = p->spot[c[2]];
    const float za = p->height[c[0]], zb = p->height[c[1]], zd = p->height[c[2]];
    const minimal_lanes n = p->normal[c[0]] + p->normal[c[1]] + p->normal[c[2]];
    const double *r = pose->r;
    const float nx = (float)r[0] * n[0] + (float)r[1] * n[1] + (float)r[2] * n[2];
    const float ny = (float)r[3] * n[0] + (float)r[4] * n[1] + (float)r[5] * n[2];
    const float nz = (float)r[6] * n[0] + (float)r[7] * n[1] + (float)r[8] * n[2];
    const float area = turn(a, b, d), over = 1 / nz;
    float above;

    if (!(area > 0) || !(nz > 0)) {
        put_none(&p->places, i, NO_GAP);
        return;
    }
    above = za + (turn(a, q, d) * (zb - za) + turn(a, b, q) * (zd - za)) / area;
    put(&p->places, i, (struct place){q.x, q.y, above, -nx * over, -ny * over}, above - z,
        0);
}

/* The template's vertices under the moved probe. */
static void template_side(struct minimal_pair *p, const struct align_pose *pose)
{
    const struct mesh *ma = &p->tmpl->mesh, *mb = &p->probe->mesh;
    uint32_t first = 0;

    while (mesh_is_ghost(mb, first))
        first++;
    for (uint32_t v = 0; v < ma->nv; v++) {
        const struct dvec3 at = vec_sub(lattice_to_mm(ma->xy[v], ma->z[v]), p->centre);
        const struct minimal_spot q = {(float)at.x, (float)at.y};
        uint32_t t;

        p->under[v] = v > 0 ? p->under[ma->parent[v]] : first;
        t = walk(p, &p->under[v], q);
        if (t != UINT32_MAX && !p->probe->bridge[t])
            put_under(p, pose, v, q, (float)at.z, t);
        else
            put_none(&p->places, mb->nv + v, NO_GAP);
    }
}

static void template_weights(struct minimal_pair *p)
{
    const struct mesh *m = &p->tmpl->mesh;

    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t *v = &m->org[3 * t];
        const struct ivec2 a = m->xy[v[0]], b = m->xy[v[1]], c = m->xy[v[2]];

        if (!p->tmpl->bridge[t])
            weigh(p->places.weight + p->probe->mesh.nv, v,
                  MM * MM *
                      ((float)(b.x - a.x) * (float)(c.y - a.y) -
                       (float)(b.y - a.y) * (float)(c.x - a.x)));
    }
}

double minimal_places_all(struct minimal_pair *p, const struct align_pose *pose)
{
    struct minimal_places *out = &p->places;
    double sum = 0;

    probe_side(p, pose);
    probe_weights(p);
    template_side(p, pose);
    template_weights(p);
    out->n = p->probe->mesh.nv + p->tmpl->mesh.nv;
    for (uint32_t i = 0; i < out->n; i++) {
        out->weight[i] = out->weight[i] > 0 ? out->weight[i] : 0;
        sum += (double)out->weight[i];
    }
    pad(out);
    return sum;
}
