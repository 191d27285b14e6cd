#include "flips.h"

bool flips_find(struct flips *f, uint32_t *he, struct ivec2 q, bool *on_edge)
{
    const struct mesh *m = f->m;
    const struct ivec2 *xy = m->xy;
    const uint32_t *org = m->org;
    uint32_t h = *he;
    int64_t s, sn, sp;

    /* From a ghost triangle look inwards, through its finite edge. */
    while (org[h] == f->ghost || mesh_dest(m, h) == f->ghost)
        h = mesh_next(h);
    if (org[mesh_prev(h)] == f->ghost)
        h = m->twin[h];
    s = orient2d(xy[org[h]], xy[mesh_dest(m, h)], q);
    if (s < 0)
        h = m->twin[h];
    *on_edge = true;
    while (f->work <= f->limit) {
        const uint32_t n = mesh_next(h), p = mesh_prev(h);

        if (org[p] == f->ghost) { /* strictly outside this hull edge */
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
        f->work++;
    }
    return false;
}

/* Cut the triangle of h in three at vertex q; h keeps its place.  Afterwards the three
 * edges that face q are h, and the next and previous edges' new places. */
static void split(struct mesh *m, uint32_t h, uint32_t q)
{
    const uint32_t n = mesh_next(h), p = mesh_prev(h);
    const uint32_t a = m->org[h], b = m->org[n], c = m->org[p];
    const uint32_t bc = 3 * m->nt, ca = bc + 3;

    m->org[bc] = b; /* triangle b c q */
    m->org[bc + 1] = c;
    m->org[bc + 2] = q;
    m->org[ca] = c; /* triangle c a q */
    m->org[ca + 1] = a;
    m->org[ca + 2] = q;
    m->org[p] = q; /* triangle a b q stays where abc was */
    flips_link(m, bc, m->twin[n]);
    flips_link(m, ca, m->twin[p]);
    flips_link(m, n, bc + 2);
    flips_link(m, bc + 1, ca + 2);
    flips_link(m, ca + 1, p);
    m->out[a] = h;
    m->out[b] = bc;
    m->out[c] = ca;
    m->out[q] = p;
    m->nt += 2;
}

void flips_insert(struct flips *f, uint32_t he, bool on_edge, uint32_t v)
{
    struct mesh *m = f->m;
    const struct ivec2 q = m->xy[v];
    uint32_t h = he, stop;

    split(m, h, v);
    if (on_edge) { /* the triangle over h is flat */
        flips_flip(m, h);
        f->work++;
    }
    /* Go round v once; `stop` ends the last of the edges that face it. */
    stop = m->org[h];
    for (;;) {
        if (flips_must(m, f->ghost, h, q)) {
            flips_flip(m, h);
            f->work++;
            continue;
        }
        if (mesh_dest(m, h) == stop)
            break;
        h = mesh_next(m->twin[mesh_next(h)]);
    }
}
