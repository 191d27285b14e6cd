#include "insert.h"

#include "arm.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "predicates.h"

/* So far from all of the lattice that its arm is long (arm.h). */
#define GHOST_AT (2 * LATTICE_MAX)

size_t insert_start(struct insert *in, unsigned char *block)
{
    const size_t most = 2 * (size_t)in->ghost + 2; /* triangles, and two more */
    size_t at = 0;

    in->work = 0;
    in->edge = mem_take(block, &at, most, sizeof *in->edge);
    in->inside = mem_take(block, &at, most, sizeof *in->inside);
    in->stack = mem_take(block, &at, most, sizeof *in->stack);
    if (block != NULL)
        in->m->xy[in->ghost] = (struct ivec2){GHOST_AT, GHOST_AT};
    return at;
}

bool insert_find(struct insert *in, uint32_t *he, struct ivec2 q, bool *on_edge)
{
    const struct mesh *m = in->m;
    const struct ivec2 *xy = m->xy;
    const uint32_t *org = m->org;
    uint32_t h = *he;
    int64_t s, sn, sp;

    /* From a ghost triangle look inwards, through its finite edge. */
    while (org[h] == in->ghost || mesh_dest(m, h) == in->ghost)
        h = mesh_next(h);
    if (org[mesh_prev(h)] == in->ghost)
        h = m->twin[h];
    s = orient2d(xy[org[h]], xy[mesh_dest(m, h)], q);
    if (s < 0)
        h = m->twin[h];
    *on_edge = true;
    while (in->work <= in->limit) {
        const uint32_t n = mesh_next(h), p = mesh_prev(h);

        if (org[p] == in->ghost) { /* strictly outside this hull edge */
            *he = h;
            *on_edge = false;
            return true;
        }
        sn = orient2d(xy[org[n]], xy[org[p]], q);
        sp = orient2d(xy[org[p]], xy[org[h]], q);
        if (sn >= 0 && sp >= 0) {
            *he = sn == 0 ? n : sp == 0 ? p : h;
            *on_edge = sn == 0 || sp == 0 || s == 0;
            return true;
        }
        h = m->twin[sn < 0 ? n : p];
        s = 1;
        in->work++;
    }
    return false;
}

/* A corner as it is seen from the point that is inserted. */
struct insert_corner {
    uint32_t v;
    struct arm arm;
};

static inline struct insert_corner insert_corner(const struct ivec2 *xy, uint32_t v,
                                                 struct ivec2 q)
{
    return (struct insert_corner){v, arm_to(q, xy[v])};
}

/* Does the circle of the triangle b, a, c hold q, which lies to the left of a -> b?  Where
 * corners are far, or the ghost, or q lies on the circle. */
static bool holds_exactly(const struct insert *in, uint32_t a, uint32_t b, uint32_t c,
                          struct ivec2 q)
{
    const struct ivec2 *xy = in->m->xy;

    if (c == in->ghost) /* q is inside the hull edge a -> b */
        return false;
    if (a == in->ghost)
        return orient2d(xy[c], xy[b], q) > 0;
    if (b == in->ghost)
        return orient2d(xy[a], xy[c], q) > 0;
    return incircle(xy[a], xy[b], q, xy[c]);
}

/* Find the triangles whose circles hold q, beyond the edges on the stack, the first of which
 * starts at x: into in->inside, from n on.  in->edge becomes the edges of the hole that they
 * leave, counter-clockwise, as seen from outside; returns how many.  Each edge starts where
 * the one before it ends. */
static uint32_t dig(struct insert *in, uint32_t n, uint32_t depth, uint32_t x,
                    struct ivec2 q)
{
    const struct mesh *m = in->m;
    const struct ivec2 *const xy = m->xy;
    const uint32_t *const org = m->org, *const twin = m->twin;
    uint32_t *const edge = in->edge, *const inside = in->inside, *const stack = in->stack;
    struct insert_corner a = insert_corner(xy, x, q);
    uint32_t edges = 0;

    while (depth > 0) {
        uint32_t h = stack[--depth];
        struct insert_corner b = insert_corner(xy, org[h], q);
        int64_t ab = arm_cross(&a.arm, &b.arm);

        for (;;) {
            const uint32_t t = h / 3;
            const uint32_t *const v = &org[3 * t];
            const struct insert_corner c =
                insert_corner(xy, v[0] + v[1] + v[2] - a.v - b.v, q);
            const int64_t bc = arm_cross(&b.arm, &c.arm), ca = arm_cross(&c.arm, &a.arm);
            const int64_t det = arm_incircle(&a.arm, &b.arm, &c.arm, ab, bc, ca);
            uint32_t next;

            if (det > 0 || (det == 0 && !holds_exactly(in, a.v, b.v, c.v, q)))
                break;
            next = mesh_next(h);
            inside[n++] = t;
            stack[depth++] = twin[9 * t + 3 - h - next]; /* the third of its edges */
            h = twin[next];
            b = c;
            ab = -ca;
        }
        edge[edges++] = h;
        a = b;
    }
    return edges;
}

void insert_point(struct insert *in, uint32_t he, bool on_edge, uint32_t v)
{
    struct mesh *m = in->m;
    uint32_t *const org = m->org, *const twin = m->twin, *const out = m->out;
    uint32_t edges, n = 0, depth = 0, t, x, h;

    in->inside[n++] = he / 3;
    in->stack[depth++] = twin[mesh_prev(he)];
    in->stack[depth++] = twin[mesh_next(he)];
    in->stack[depth++] = twin[he];
    if (on_edge) { /* both of its triangles */
        h = twin[he];
        in->inside[n++] = h / 3;
        in->stack[depth - 1] = twin[mesh_prev(h)];
        in->stack[depth++] = twin[mesh_next(h)];
    }
    edges = dig(in, n, depth, org[he], m->xy[v]);
    in->work += edges;
    in->inside[edges - 2] = m->nt++;
    in->inside[edges - 1] = m->nt++;
    t = in->inside[edges - 1];
    x = org[he];
    for (uint32_t i = 0; i < edges; i++) {
        const uint32_t before = 3 * t;

        t = in->inside[i];
        h = in->edge[i];
        out[x] = 3 * t;
        org[3 * t] = x;
        org[3 * t + 1] = x = org[h];
        org[3 * t + 2] = v;
        twin[3 * t] = h;
        twin[h] = 3 * t;
        twin[3 * t + 2] = before + 1;
        twin[before + 1] = 3 * t + 2;
    }
    out[v] = 3 * t + 2;
}
