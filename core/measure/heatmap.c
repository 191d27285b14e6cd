#include "heatmap.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "lattice.h"
#include "locate.h"
#include "mem.h"
#include "surface.h"

/* A point sent, on the lattice. */
struct sent {
    struct ivec3 p;
    uint32_t i; /* its number */
};

/* Morton's order: by the highest bit in which x or y differ, so that points that follow each
 * other are near each other, however the points are spread. */
static int by_place(const void *a, const void *b)
{
    const struct ivec3 p = ((const struct sent *)a)->p, q = ((const struct sent *)b)->p;
    const uint32_t far = UINT32_C(1) << 31; /* puts negative numbers first */
    const uint32_t px = (uint32_t)p.x ^ far, qx = (uint32_t)q.x ^ far, dx = px ^ qx;
    const uint32_t py = (uint32_t)p.y ^ far, qy = (uint32_t)q.y ^ far, dy = py ^ qy;

    return dx < dy && dx < (dx ^ dy) ? (py > qy) - (py < qy) : (px > qx) - (px < qx);
}

/* The points, moved, that stay on the lattice; sorted.  Returns how many. */
static uint32_t heatmap_load(const struct dvec3 *pts, size_t n,
                             const double transform[16], struct sent *sent)
{
    uint32_t k = 0;

    for (size_t i = 0; i < n; i++) {
        const struct dvec3 moved = vec_transform(transform, pts[i]);

        if (lattice_from_mm(&moved, 1, LATTICE_PER_MM, &sent[k].p, NULL) == ST_OK)
            sent[k++].i = (uint32_t)i;
    }
    qsort(sent, k, sizeof *sent, by_place);
    return k;
}

/* measured[v]: a triangle round vertex v does not bridge.  (Any number of points may be sent
 * at one vertex, and it may have any number of triangles.) */
static void mark_measured(const struct surface *s, uint8_t *measured)
{
    memset(measured, 0, s->mesh.nv);
    for (uint32_t h = 0; h < 3 * s->mesh.nt; h++) /* (Ghosts bridge.) */
        if (!s->bridge[h / 3])
            measured[s->mesh.org[h]] = 1;
}

/* gap(s, measured, at, p): NAN where p, located at `at`, is not covered.  The half-edge that
 * decides on the rounding is the triangle's first, or the edge's: not the walk's. */
static double gap(const struct surface *s, const uint8_t *measured, struct location at,
                  struct ivec3 p)
{
    const struct mesh *m = &s->mesh;
    const uint32_t twin = m->twin[at.he];
    bool covered = !s->bridge[at.he / 3];

    switch (at.where) {
    case LOCATE_INSIDE:
        at.he -= at.he % 3;
        break;
    case LOCATE_EDGE:
        covered = covered || !s->bridge[twin / 3];
        at.he = twin < at.he && !mesh_is_ghost(m, twin / 3) ? twin : at.he;
        break;
    case LOCATE_VERTEX:
        covered = measured[m->org[at.he]];
        break;
    default:
        covered = false;
    }
    return covered
               ? (p.z - locate_height(m, at, (struct ivec2){p.x, p.y})) / LATTICE_PER_MM
               : (double)NAN;
}

struct heatmap_work {
    struct sent *sent;
    struct location *loc;
    struct ivec2 *xy;
    uint32_t *parent;
    uint8_t *measured;
};

/* w's arrays in block for n points and nv vertices; returns the bytes needed. */
static size_t heatmap_layout(struct heatmap_work *w, size_t n, size_t nv,
                             unsigned char *block)
{
    size_t at = 0;

    w->sent = mem_take(block, &at, n, sizeof *w->sent);
    w->loc = mem_take(block, &at, n, sizeof *w->loc);
    w->xy = mem_take(block, &at, n, sizeof *w->xy);
    w->parent = mem_take(block, &at, n, sizeof *w->parent);
    w->measured = mem_take(block, &at, nv, sizeof *w->measured);
    return at;
}

enum status heatmap_gaps(const struct surface *tmpl, const struct dvec3 *pts, size_t n,
                         const double transform[16], double *gap_mm)
{
    struct heatmap_work w;
    unsigned char *block = mem_array(heatmap_layout(&w, n, tmpl->mesh.nv, NULL), 1);
    struct mesh line; /* the points as a tree without branches */
    enum status st = ST_OK;

    for (size_t i = 0; i < n; i++)
        gap_mm[i] = NAN;
    if (block == NULL)
        return ST_ENOMEM;
    (void)heatmap_layout(&w, n, tmpl->mesh.nv, block);
    line = (struct mesh){
        .nv = heatmap_load(pts, n, transform, w.sent), .xy = w.xy, .parent = w.parent};
    for (uint32_t k = 0; k < line.nv; k++) {
        w.xy[k] = (struct ivec2){w.sent[k].p.x, w.sent[k].p.y};
        w.parent[k] = k > 0 ? k - 1 : 0;
    }
    mark_measured(tmpl, w.measured);
    if (line.nv > 0)
        st = locate_mesh(&tmpl->mesh, &line, w.loc);
    for (uint32_t k = 0; st == ST_OK && k < line.nv; k++)
        gap_mm[w.sent[k].i] = gap(tmpl, w.measured, w.loc[k], w.sent[k].p);
    mem_free(block);
    return st;
}
