#include "thin.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "mem.h"

/* Squares a side.  The view goes round: the squares of a wider one are taken together, which
 * no face is at any size tried. */
#define SIDE    512
#define SQUARES ((size_t)SIDE * SIDE)

/* Squares in which the area of the view is counted, mm; the sizes tried, from what would do
 * for an area covered all over; and halvings of that range: within 3 % of the best size. */
#define AREA_MM 4.0f
#define LEAST   0.25f
#define MOST    2.0f
#define HALVED  6

struct squares {
    float per_mm;
    uint8_t round, *seen; /* [SQUARES] in which round */
};

/* Beyond that (a kilometre) nothing need be told apart. */
static inline float limited(float v)
{
    return v > -1e6f ? v < 1e6f ? v : 1e6f : -1e6f;
}

static inline uint32_t square_of(float per_mm, const struct thin_point *p)
{
    const int32_t i = (int32_t)floorf(limited(p->x * per_mm));
    const int32_t j = (int32_t)floorf(limited(p->y * per_mm));

    return ((uint32_t)j % SIDE) * SIDE + (uint32_t)i % SIDE;
}

/* How many squares of size mm have points: most + 1 where there are more than that. */
static size_t count(struct squares *s, float size, const struct thin_point *p, size_t n,
                    size_t most)
{
    const float per_mm = 1 / size;
    size_t k = 0;

    s->round++;
    for (size_t i = 0; i < n && k <= most; i++) {
        uint8_t *seen = &s->seen[square_of(per_mm, &p[i])];

        k += *seen != s->round;
        *seen = s->round;
    }
    return k;
}

/* The size of the squares. */
static float choose(struct squares *s, const struct thin_point *p, size_t n, size_t most)
{
    const size_t area = count(s, AREA_MM, p, n, n);
    const float whole = AREA_MM * sqrtf((float)area / (float)most);
    float few = LEAST * whole, enough = MOST * whole;

    while (count(s, enough, p, n, most) > most)
        enough *= 2;
    for (int k = 0; k < HALVED; k++) {
        const float size = sqrtf(few * enough);

        if (count(s, size, p, n, most) > most)
            few = size;
        else
            enough = size;
    }
    return enough;
}

/* Square of the distance from the middle of the square. */
static inline float off(const struct thin_point *p, float per_mm)
{
    const float x = p->x * per_mm, y = p->y * per_mm;
    const float u = x - floorf(x) - 0.5f, v = y - floorf(y) - 0.5f;

    return u * u + v * v;
}

/* Is a to be kept rather than b?  Whatever the order, also where both are as far off. */
static bool rather(const struct thin_point *a, const struct thin_point *b, float per_mm)
{
    const float da = off(a, per_mm), db = off(b, per_mm);

    if (da != db)
        return da < db;
    if (a->z != b->z)
        return a->z > b->z;
    return a->x != b->x ? a->x < b->x : a->y < b->y;
}

static size_t keep(struct thin_point *p, size_t n, float size, uint32_t *best)
{
    const float per_mm = 1 / size;
    size_t kept = 0;

    memset(best, 0xFF, SQUARES * sizeof *best);
    for (size_t i = 0; i < n; i++) {
        uint32_t *b = &best[square_of(per_mm, &p[i])];

        if (*b == UINT32_MAX || rather(&p[i], &p[*b], per_mm))
            *b = (uint32_t)i;
    }
    for (size_t i = 0; i < n; i++)
        if (best[square_of(per_mm, &p[i])] == i)
            p[kept++] = p[i];
    return kept;
}

enum status thin_points(struct thin_point *p, size_t *n, size_t most)
{
    struct squares s = {0};
    uint32_t *best;

    if (*n <= most)
        return ST_OK;
    s.seen = mem_array(SQUARES, sizeof *s.seen);
    best = mem_array(SQUARES, sizeof *best);
    if (s.seen != NULL && best != NULL) {
        memset(s.seen, 0, SQUARES * sizeof *s.seen);
        *n = keep(p, *n, choose(&s, p, *n, most), best);
    }
    mem_free(s.seen);
    mem_free(best);
    return s.seen != NULL && best != NULL ? ST_OK : ST_ENOMEM;
}
