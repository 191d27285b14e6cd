#include "find_grid.h"

#include <math.h>
#include <stdbool.h>

#include "mem.h"

#define FIND_GRID_MM  5    /* side of a cube */
#define FIND_REACH_MM 4000 /* of points from the median */

#define DIGIT_BITS 11
#define DIGITS     (1u << DIGIT_BITS)
#define ALONG      (UINT64_C(2) * FIND_REACH_MM / FIND_GRID_MM + 1)

_Static_assert(ALONG *ALONG *ALONG < UINT32_MAX, "numbers of cubes have 32 bits");

struct find_grid_entry {
    uint32_t cube, point; /* numbers */
};

static struct dvec3 scaled(struct dvec3 p, double s)
{
    return (struct dvec3){p.x * s, p.y * s, p.z * s};
}

/* Also false of what is no number. */
static bool in_reach(struct dvec3 p, struct dvec3 middle)
{
    return fabs(p.x - middle.x) <= FIND_REACH_MM &&
           fabs(p.y - middle.y) <= FIND_REACH_MM && fabs(p.z - middle.z) <= FIND_REACH_MM;
}

/* The box of the points in reach; how many there are. */
static size_t bound(const struct dvec3 *pts, size_t n, double unit_mm,
                    struct dvec3 middle, struct find_grid *g)
{
    struct dvec3 lo = {INFINITY, INFINITY, INFINITY};
    struct dvec3 hi = {-INFINITY, -INFINITY, -INFINITY};
    size_t in = 0;

    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = scaled(pts[i], unit_mm);

        if (!in_reach(p, middle))
            continue;
        in++;
        lo = (struct dvec3){p.x < lo.x ? p.x : lo.x, p.y < lo.y ? p.y : lo.y,
                            p.z < lo.z ? p.z : lo.z};
        hi = (struct dvec3){p.x > hi.x ? p.x : hi.x, p.y > hi.y ? p.y : hi.y,
                            p.z > hi.z ? p.z : hi.z};
    }
    if (in > 0) {
        g->corner = lo;
        g->size[0] = hi.x - lo.x;
        g->size[1] = hi.y - lo.y;
        g->size[2] = hi.z - lo.z;
    }
    return in;
}

static uint32_t along(double mm)
{
    return (uint32_t)(mm * (1.0 / FIND_GRID_MM));
}

static void number_all(const struct dvec3 *pts, size_t n, double unit_mm,
                       struct dvec3 middle, const struct find_grid *g,
                       struct find_grid_entry *out)
{
    const uint32_t nx = along(g->size[0]) + 1, ny = along(g->size[1]) + 1;

    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = scaled(pts[i], unit_mm), q = vec_sub(p, g->corner);

        if (in_reach(p, middle))
            *out++ = (struct find_grid_entry){
                (along(q.z) * ny + along(q.y)) * nx + along(q.x), (uint32_t)i};
    }
}

/* Sort a by cube, points of one in their order; b is as long.  Returns the sorted one. */
static struct find_grid_entry *sort(struct find_grid_entry *a, struct find_grid_entry *b,
                                    size_t n)
{
    uint32_t last = 0;

    for (size_t i = 0; i < n; i++)
        last = a[i].cube > last ? a[i].cube : last;
    for (int shift = 0; shift < 32 && last >> shift != 0; shift += DIGIT_BITS) {
        struct find_grid_entry *const swap = a;
        size_t at[DIGITS] = {0}, sum = 0;

        for (size_t i = 0; i < n; i++)
            at[a[i].cube >> shift & (DIGITS - 1)]++;
        for (size_t d = 0; d < DIGITS; d++) {
            const size_t here = at[d];

            at[d] = sum;
            sum += here;
        }
        for (size_t i = 0; i < n; i++)
            b[at[a[i].cube >> shift & (DIGITS - 1)]++] = a[i];
        a = b;
        b = swap;
    }
    return a;
}

static void take_means(const struct dvec3 *pts, double unit_mm,
                       const struct find_grid_entry *e, size_t n, struct find_grid *g)
{
    for (size_t i = 0, end; i < n; i = end) {
        struct dvec3 sum = {0, 0, 0};

        for (end = i; end < n && e[end].cube == e[i].cube; end++)
            sum =
                vec_along(sum, 1, vec_sub(scaled(pts[e[end].point], unit_mm), g->corner));
        g->at[g->n++] = scaled(sum, 1 / (double)(end - i));
    }
}

enum status find_grid_make(const struct dvec3 *pts, size_t n, double unit_mm,
                           struct dvec3 middle, struct find_grid *g)
{
    struct find_grid_entry *block, *e;
    size_t in, cubes = 0;

    *g = (struct find_grid){.n = 0};
    in = bound(pts, n, unit_mm, middle, g);
    if ((block = mem_array(2 * in, sizeof *block)) == NULL)
        return ST_ENOMEM;
    number_all(pts, n, unit_mm, middle, g, block);
    e = sort(block, block + in, in);
    for (size_t i = 0; i < in; i++)
        cubes += i == 0 || e[i].cube != e[i - 1].cube;
    if ((g->at = mem_array(cubes, sizeof *g->at)) != NULL)
        take_means(pts, unit_mm, e, in, g);
    mem_free(block);
    return g->at != NULL ? ST_OK : ST_ENOMEM;
}

void find_grid_free(struct find_grid *g)
{
    mem_free(g->at);
    *g = (struct find_grid){.n = 0};
}
