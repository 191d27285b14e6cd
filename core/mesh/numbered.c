#include "numbered.h"

#include <stdint.h>
#include <stdlib.h>

#include "delaunay.h"
#include "mesh.h"

/* The points by row; in a row from left to right, in a place by number (z). */
static int by_row(const void *a, const void *b)
{
    const struct ivec3 *p = a, *q = b;

    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return (p->z > q->z) - (p->z < q->z);
}

/* Move each point to the first place right of its predecessor in the row, if it is not there
 * already. */
static void separate(struct ivec3 *pts, struct ivec3 *numbered, size_t n)
{
    qsort(numbered, n, sizeof *numbered, by_row);
    for (size_t i = 1; i < n; i++) {
        const struct ivec3 before = numbered[i - 1];
        struct ivec3 *p = &numbered[i];

        if (p->y == before.y && p->x <= before.x) {
            p->x = before.x + 1;
            pts[p->z].x = p->x;
        }
    }
}

/* The heights of m, a triangulation of n points, are their numbers. */
static void renumber(struct mesh *m, const struct ivec3 *pts)
{
    const uint32_t nv = m->nv;

    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t v = m->org[h];

        m->org[h] = v == nv ? nv : (uint32_t)m->z[v];
        m->out[m->org[h]] = h;
    }
    for (uint32_t v = 0; v < nv; v++) {
        m->xy[v] = (struct ivec2){pts[v].x, pts[v].y};
        m->z[v] = pts[v].z;
    }
}

enum status numbered_build(struct ivec3 *pts, size_t n, struct scratch *s,
                           struct mesh *out)
{
    struct ivec3 *const numbered = pts + n;
    enum status st;

    /* A point that stands alone keeps its height: its number. */
    for (size_t i = 0; i < n; i++)
        numbered[i] = (struct ivec3){pts[i].x, pts[i].y, (int32_t)i};
    st = delaunay_build(numbered, n, s, out);
    if (st == ST_OK && out->nv < n) {
        separate(pts, numbered, n);
        st = delaunay_build(numbered, n, s, out);
    }
    if (st == ST_OK)
        renumber(out, pts);
    return st;
}
