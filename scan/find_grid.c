#include "find_grid.h"

#include <math.h>
#include <stdbool.h>

#include "mem.h"
#include "tuning.h"

#define DIGIT_BITS 11
#define DIGITS     (1u << DIGIT_BITS)
#define SUBS       (FIND_GRID_SIDE * FIND_GRID_SIDE * FIND_GRID_SIDE) /* voxels of a cell */

#define REACH_MM (FIND_REACH_CELLS * FIND_GRID_CELL_MM)
#define ALONG    (UINT64_C(2) * FIND_REACH_CELLS + 1)

_Static_assert(ALONG *ALONG *ALONG *SUBS < UINT32_MAX, "numbers of voxels have 32 bits");

struct entry {
    uint32_t voxel, point; /* numbers */
};

static struct dvec3 scaled(struct dvec3 p, double s)
{
    return (struct dvec3){p.x * s, p.y * s, p.z * s};
}

/* Also false of what is no number. */
static bool in_reach(struct dvec3 p, struct dvec3 middle)
{
    return fabs(p.x - middle.x) <= REACH_MM && fabs(p.y - middle.y) <= REACH_MM &&
           fabs(p.z - middle.z) <= REACH_MM;
}

/* Which voxel along an axis; mm from the corner. */
static uint32_t place(double x)
{
    return (uint32_t)(x * (1 / FIND_GRID_VOXEL_MM));
}

/* The corner and the size of the box of the points in reach; how many there are. */
static size_t bound(const struct dvec3 *pts, size_t n, struct dvec3 middle,
                    struct find_grid *g)
{
    struct dvec3 lo = {INFINITY, INFINITY, INFINITY};
    struct dvec3 hi = {-INFINITY, -INFINITY, -INFINITY};
    size_t in = 0;

    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = scaled(pts[i], g->unit_mm);

        if (!in_reach(p, middle))
            continue;
        in++;
        lo = (struct dvec3){p.x < lo.x ? p.x : lo.x, p.y < lo.y ? p.y : lo.y,
                            p.z < lo.z ? p.z : lo.z};
        hi = (struct dvec3){p.x > hi.x ? p.x : hi.x, p.y > hi.y ? p.y : hi.y,
                            p.z > hi.z ? p.z : hi.z};
    }
    if (in == 0)
        return 0;
    g->corner = lo;
    g->nx = (int32_t)(place(hi.x - lo.x) / FIND_GRID_SIDE + 1);
    g->ny = (int32_t)(place(hi.y - lo.y) / FIND_GRID_SIDE + 1);
    g->nz = (int32_t)(place(hi.z - lo.z) / FIND_GRID_SIDE + 1);
    return in;
}

/* The voxel of a place, mm from the corner. */
static uint32_t number_of(const struct find_grid *g, struct dvec3 p)
{
    const uint32_t x = place(p.x), y = place(p.y), z = place(p.z);
    const uint32_t cell =
        ((z / FIND_GRID_SIDE) * (uint32_t)g->ny + y / FIND_GRID_SIDE) * (uint32_t)g->nx +
        x / FIND_GRID_SIDE;

    return cell * SUBS +
           (z % FIND_GRID_SIDE * FIND_GRID_SIDE + y % FIND_GRID_SIDE) * FIND_GRID_SIDE +
           x % FIND_GRID_SIDE;
}

static void number_all(const struct dvec3 *pts, size_t n, struct dvec3 middle,
                       const struct find_grid *g, struct entry *out)
{
    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = scaled(pts[i], g->unit_mm);

        if (in_reach(p, middle))
            *out++ = (struct entry){number_of(g, vec_sub(p, g->corner)), (uint32_t)i};
    }
}

/* Sort a by voxel, points of one in their order; b is as long.  Returns the sorted one. */
static struct entry *sort(struct entry *a, struct entry *b, size_t n, uint64_t voxels)
{
    for (int shift = 0; shift < 32 && voxels >> shift != 0; shift += DIGIT_BITS) {
        struct entry *const swap = a;
        size_t at[DIGITS] = {0}, sum = 0;

        for (size_t i = 0; i < n; i++)
            at[a[i].voxel >> shift & (DIGITS - 1)]++;
        for (size_t d = 0; d < DIGITS; d++) {
            const size_t here = at[d];

            at[d] = sum;
            sum += here;
        }
        for (size_t i = 0; i < n; i++)
            b[at[a[i].voxel >> shift & (DIGITS - 1)]++] = a[i];
        a = b;
        b = swap;
    }
    return a;
}

static void count_all(const struct entry *e, size_t n, struct find_grid *g)
{
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && e[i].voxel == e[i - 1].voxel)
            continue;
        g->nvoxels++;
        g->ncells += i == 0 || e[i].voxel / SUBS != e[i - 1].voxel / SUBS;
    }
}

enum status find_grid_room(struct find_grid *g)
{
    const size_t rows = (size_t)g->ny * (size_t)g->nz;
    unsigned char *block = NULL;

    for (int pass = 0; pass < 2; pass++) {
        size_t at = 0;

        g->voxel = mem_take(block, &at, g->nvoxels, sizeof *g->voxel);
        g->cell = mem_take(block, &at, g->ncells, sizeof *g->cell);
        g->first = mem_take(block, &at, (size_t)g->ncells + 1, sizeof *g->first);
        g->row = mem_take(block, &at, rows + 1, sizeof *g->row);
        if (pass == 0 && (block = mem_array(at, 1)) == NULL)
            return ST_ENOMEM;
    }
    return ST_OK;
}

void find_grid_rows(struct find_grid *g)
{
    uint32_t row = 0;

    for (uint32_t c = 0; c < g->ncells; c++)
        while (row <= g->cell[c] / (uint32_t)g->nx)
            g->row[row++] = c;
    while (row <= (uint32_t)(g->ny * g->nz))
        g->row[row++] = g->ncells;
}

void find_grid_place(const struct find_grid *g, uint32_t c, int32_t at[3])
{
    at[0] = (int32_t)(g->cell[c] % (uint32_t)g->nx);
    at[1] = (int32_t)(g->cell[c] / (uint32_t)g->nx % (uint32_t)g->ny);
    at[2] = (int32_t)(g->cell[c] / (uint32_t)g->nx / (uint32_t)g->ny);
}

static void fill(const struct dvec3 *pts, const struct entry *e, size_t n,
                 struct find_grid *g)
{
    uint32_t voxel = 0, cell = 0;

    for (size_t i = 0, end; i < n; i = end) {
        const uint32_t number = e[i].voxel / SUBS;
        struct dvec3 sum = {0, 0, 0};
        double each;

        for (end = i; end < n && e[end].voxel == e[i].voxel; end++)
            sum = vec_along(sum, 1,
                            vec_sub(scaled(pts[e[end].point], g->unit_mm), g->corner));
        each = 1 / (double)(end - i);
        if (cell == 0 || g->cell[cell - 1] != number) {
            g->cell[cell] = number;
            g->first[cell++] = voxel;
        }
        g->voxel[voxel++] = (struct find_voxel){
            {(float)(sum.x * each), (float)(sum.y * each), (float)(sum.z * each)},
            (uint32_t)(end - i)};
    }
    g->first[cell] = voxel;
    find_grid_rows(g);
}

enum status find_grid_make(const struct dvec3 *pts, size_t n, double unit_mm,
                           struct dvec3 middle, struct find_grid *g)
{
    struct entry *block, *e;
    enum status st;
    size_t in;

    *g = (struct find_grid){.unit_mm = unit_mm};
    in = bound(pts, n, middle, g);
    if ((block = mem_array(2 * in, sizeof *block)) == NULL)
        return ST_ENOMEM;
    number_all(pts, n, middle, g, block);
    e = sort(block, block + in, in,
             (uint64_t)g->nx * (uint64_t)g->ny * (uint64_t)g->nz * SUBS);
    count_all(e, in, g);
    if ((st = find_grid_room(g)) == ST_OK)
        fill(pts, e, in, g);
    mem_free(block);
    return st;
}

void find_grid_free(struct find_grid *g)
{
    mem_free(g->voxel);
    g->voxel = NULL;
}

/* The first of the cells from a to b whose number is not below the one given. */
static uint32_t not_below(const uint32_t *cell, uint32_t a, uint32_t b, uint32_t number)
{
    while (a < b) {
        const uint32_t m = a + (b - a) / 2;

        if (cell[m] < number)
            a = m + 1;
        else
            b = m;
    }
    return a;
}

struct find_run find_grid_run(const struct find_grid *g, int32_t x0, int32_t x1,
                              int32_t y, int32_t z)
{
    uint32_t row, a, b;

    x0 = x0 > 0 ? x0 : 0;
    x1 = x1 < g->nx - 1 ? x1 : g->nx - 1;
    if (y < 0 || y >= g->ny || z < 0 || z >= g->nz || x0 > x1)
        return (struct find_run){0, 0};
    row = (uint32_t)z * (uint32_t)g->ny + (uint32_t)y;
    a = not_below(g->cell, g->row[row], g->row[row + 1],
                  row * (uint32_t)g->nx + (uint32_t)x0);
    b = a;
    while (b < g->row[row + 1] && g->cell[b] <= row * (uint32_t)g->nx + (uint32_t)x1)
        b++;
    return (struct find_run){a, b};
}
