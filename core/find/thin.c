#include "thin.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "mem.h"

/* Squares a side.  The view goes round: the squares of a wider one are taken together, which
 * no face is at any size tried. */
#define SIDE    256
#define SQUARES ((size_t)SIDE * SIDE)

/* Squares in which the area of the view is counted, mm; sizes tried at most; and the share of
 * the points wanted that is enough. */
#define AREA_MM 4.0
#define TRIES   8
#define ENOUGH  0.96

/* Heights are added up in these parts of a mm, as integers: exact, whatever their order. */
#define PARTS 65536.0

struct squares {
    uint8_t round, *seen; /* [SQUARES] in which round */
};

/* In squares, so far right of the first that it is positive.  Beyond a million nothing need be
 * separated. */
static inline double along(float mm, double per_mm)
{
    const double v = (double)mm * per_mm;

    return (v > -1e6 ? v < 1e6 ? v : 1e6 : -1e6) + 4096.0 * SIDE;
}

static inline uint32_t square_of(const struct thin_point *p, double per_mm)
{
    const int32_t i = (int32_t)along(p->x, per_mm), j = (int32_t)along(p->y, per_mm);

    return (uint32_t)j % SIDE * SIDE + (uint32_t)i % SIDE;
}

/* How many squares of this size have points. */
static size_t thin_count(struct squares *s, double size, const struct thin_point *p,
                         size_t n)
{
    const double per_mm = 1 / size;
    size_t k = 0;

    s->round++;
    for (size_t i = 0; i < n; i++) {
        uint8_t *seen = &s->seen[square_of(&p[i], per_mm)];

        k += *seen != s->round;
        *seen = s->round;
    }
    return k;
}

/* The size of the squares, by what would do for the area if it were covered all over. */
static double thin_choose(struct squares *s, const struct thin_point *p, size_t n,
                          size_t most)
{
    const double wanted = (1 + ENOUGH) / 2 * (double)most;
    const size_t area = thin_count(s, AREA_MM, p, n);
    double size = AREA_MM * sqrt((double)area / wanted), few = 0, enough = 0;

    for (int tries = 0; tries < TRIES || enough == 0; tries++) {
        const size_t k = thin_count(s, size, p, n);

        if (k <= most)
            enough = size;
        else
            few = size;
        if (k <= most && (double)k >= ENOUGH * (double)most)
            break;
        size *= sqrt((double)k / wanted);
        if (few > 0 && enough > 0 && !(size > few && size < enough))
            size = sqrt(few * enough);
    }
    return enough;
}

/* Square of the distance from the middle of the square. */
static inline double off(const struct thin_point *p, double per_mm)
{
    const double x = along(p->x, per_mm), y = along(p->y, per_mm);
    const double u = x - (int32_t)x - 0.5, v = y - (int32_t)y - 0.5;

    return u * u + v * v;
}

/* Is a to be kept rather than b?  Whatever the order, also where both are as far off. */
static bool rather(const struct thin_point *a, const struct thin_point *b, double per_mm)
{
    const double da = off(a, per_mm), db = off(b, per_mm);

    if (da != db)
        return da < db;
    if (a->z != b->z)
        return a->z > b->z;
    return a->x != b->x ? a->x < b->x : a->y < b->y;
}

/* Of the points that one of them stands for. */
struct mean {
    int64_t sum, n; /* of the heights over it */
};

/* The sums over each square, of its point, which is best[]. */
static void add_up(const struct thin_point *p, size_t n, double size, double near_mm,
                   const uint32_t *best, struct mean *mean)
{
    const double per_mm = 1 / size;

    for (size_t i = 0; i < n; i++)
        mean[best[square_of(&p[i], per_mm)]] = (struct mean){0, 0};
    for (size_t i = 0; i < n; i++) {
        const uint32_t b = best[square_of(&p[i], per_mm)];
        const double up = (double)p[i].z - (double)p[b].z;

        if (fabs(up) <= near_mm) {
            mean[b].sum += (int64_t)(up * PARTS);
            mean[b].n++;
        }
    }
}

static size_t thin_keep(struct thin_point *p, size_t n, double size, double near_mm,
                        uint32_t *best, struct mean *mean)
{
    const double per_mm = 1 / size;
    size_t kept = 0;

    memset(best, 0xFF, SQUARES * sizeof *best);
    for (size_t i = 0; i < n; i++) {
        uint32_t *b = &best[square_of(&p[i], per_mm)];

        if (*b == UINT32_MAX || rather(&p[i], &p[*b], per_mm))
            *b = (uint32_t)i;
    }
    add_up(p, n, size, near_mm, best, mean);
    for (size_t i = 0; i < n; i++) {
        if (best[square_of(&p[i], per_mm)] != i)
            continue;
        p[kept] = p[i];
        p[kept++].off = (float)((double)mean[i].sum / (PARTS * (double)mean[i].n));
    }
    return kept;
}

enum status thin_points(struct thin_point *p, size_t *n, size_t most, double near_mm)
{
    struct squares s = {0};
    struct mean *mean;
    uint32_t *best;
    bool room;

    if (*n <= most)
        return ST_OK;
    s.seen = mem_array(SQUARES, sizeof *s.seen);
    best = mem_array(SQUARES, sizeof *best);
    mean = mem_array(*n, sizeof *mean); /* few are used, and touched */
    if ((room = s.seen != NULL && best != NULL && mean != NULL)) {
        memset(s.seen, 0, SQUARES * sizeof *s.seen);
        *n = thin_keep(p, *n, thin_choose(&s, p, *n, most), near_mm, best, mean);
    }
    mem_free(s.seen);
    mem_free(best);
    mem_free(mean);
    return room ? ST_OK : ST_ENOMEM;
}
