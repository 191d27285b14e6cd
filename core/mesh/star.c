#include "star.h"

#include "mesh.h"
#include "predicates.h"

/* fill(m, s, i, j, parent): fill the polygon ring[i .. j], whose side j -> i is the edge
 * `parent` of what lies beyond it.  At most STAR_MAX deep. */
static void star_fill(const struct mesh *m, struct star *s, uint32_t i, uint32_t j,
                      uint32_t parent)
{
    const struct ivec2 a = m->xy[s->ring[j]], b = m->xy[s->ring[i]];
    const uint32_t t = s->ntri++;
    uint32_t best = STAR_NONE;

    for (uint32_t k = i + 1; k < j; k++) {
        const struct ivec2 p = m->xy[s->ring[k]];

        if (orient2d(a, b, p) > 0 &&
            (best == STAR_NONE || incircle(a, b, m->xy[s->ring[best]], p)))
            best = k;
    }
    s->corner[t][0] = (uint8_t)j;
    s->corner[t][1] = (uint8_t)i;
    s->corner[t][2] = (uint8_t)best;
    s->mate[t][0] = parent;
    s->mate[t][1] = best == i + 1 ? STAR_RING + i : 3 * s->ntri;
    if (best > i + 1)
        star_fill(m, s, i, best, 3 * t + 1);
    s->mate[t][2] = j == best + 1 ? STAR_RING + best : 3 * s->ntri;
    if (j > best + 1)
        star_fill(m, s, best, j, 3 * t + 2);
}

bool star_find(const struct mesh *m, uint32_t v, struct star *s)
{
    const uint32_t first = m->out[v];
    uint32_t h = first;

    if (first == STAR_NONE)
        return false;
    s->v = v;
    s->n = 0;
    do {
        const uint32_t to = mesh_dest(m, h);

        if (to == m->nv || s->n == STAR_MAX)
            return false;
        s->ring[s->n] = to;
        s->edge[s->n++] = mesh_next(h);
        h = mesh_turn(m, h);
    } while (h != first);
    s->ntri = 0;
    star_fill(m, s, 0, s->n - 1, STAR_RING + s->n - 1);
    return true;
}

/* The first half-edge of the i-th triangle round the vertex. */
static uint32_t slot(const struct star *s, uint32_t i)
{
    return s->edge[i] - s->edge[i] % 3;
}

void star_remove(struct mesh *m, const struct star *s)
{
    uint32_t outer[STAR_MAX];

    for (uint32_t i = 0; i < s->n; i++)
        outer[i] = m->twin[s->edge[i]];
    for (uint32_t i = s->ntri; i < s->n; i++)
        for (uint32_t k = 0; k < 3; k++)
            m->org[slot(s, i) + k] = m->twin[slot(s, i) + k] = STAR_NONE;
    for (uint32_t t = 0; t < s->ntri; t++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t h = slot(s, t) + k, mate = s->mate[t][k];
            const uint32_t v = s->ring[s->corner[t][k]];

            m->org[h] = v;
            m->out[v] = h;
            if (mate >= STAR_RING) {
                m->twin[h] = outer[mate - STAR_RING];
                m->twin[outer[mate - STAR_RING]] = h;
            } else {
                m->twin[h] = slot(s, mate / 3) + mate % 3;
            }
        }
    m->out[s->v] = STAR_NONE;
}
