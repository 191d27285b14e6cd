#include "shape_cells.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "solve.h"
#include "frame.h"
#include "grid.h"
#include "shape_work.h"

/* What covers a fitted face, cell by cell. */

/* mm: a cell is explained up to NEAR; what stands farther than STRONG in front of the face,
 * or WEAK beside such cells, covers it, if there are COVER_CELLS; and what is HOLE cells beside or
 * between them. */
#define SHAPE_NEAR_MM     2.0
#define SHAPE_STRONG_MM   3.0
#define SHAPE_WEAK_MM     1.6
#define SHAPE_COVER_CELLS 8
#define SHAPE_HOLE        6

/* mm: hair is looked for above the brows. */
#define SHAPE_BROW_Y 36.0

/* Hair: a cell differs from the mean of those beside it by more than MM, and by more than TIMES
 * the median of the cheeks, as do SHARE of the known ones up to two cells away, LEAST at least; and
 * CELLS of such cells are connected.  With 30 cells 7 of 1,400 scans of uncovered faces, once
 * fitted, had some hair. */
#define SHAPE_HAIR_MM    0.3
#define SHAPE_HAIR_TIMES 2.5
#define SHAPE_HAIR_SHARE 0.45
#define SHAPE_HAIR_LEAST 8
#define SHAPE_HAIR_CELLS 50

/* A mask covers more than this share of what is seen of the face below y in mm.  By hand. */
#define SHAPE_MASK_TOP   14.0
#define SHAPE_MASK_SHARE 0.6

/* The cells beside a cell, sideways, in four lists with an entry each; GRID_NONE: none. */
static void beside(uint32_t i, uint32_t to[4])
{
    const uint32_t x = i % GRID_NX, y = i / GRID_NX;

    to[0] = x > 0 ? i - 1 : GRID_NONE;
    to[1] = x < GRID_NX - 1 ? i + 1 : GRID_NONE;
    to[2] = y > 0 ? i - GRID_NX : GRID_NONE;
    to[3] = y < GRID_NY - 1 ? i + GRID_NX : GRID_NONE;
}

enum { WEAK = 1, STRONG = 2, SEEN = 4 };

/* The connected cells around i of which mark says WEAK or STRONG; how many are strong. */
static uint32_t shape_cells_collect(uint8_t *mark, uint32_t i, uint32_t *list,
                                    uint32_t *n)
{
    uint32_t strong = 0;

    *n = 0;
    list[(*n)++] = i;
    mark[i] |= SEEN;
    for (uint32_t at = 0; at < *n; at++) {
        uint32_t to[4];

        strong += (mark[list[at]] & STRONG) != 0;
        beside(list[at], to);
        for (int k = 0; k < 4; k++)
            if (to[k] != GRID_NONE && mark[to[k]] != 0 && !(mark[to[k]] & SEEN)) {
                mark[to[k]] |= SEEN;
                list[(*n)++] = to[k];
            }
    }
    return strong;
}

/* Cells of the face beside a covered one become covered; holes alone, or all. */
static void shape_cells_grow(const float *height, bool holes, uint8_t *cell)
{
    uint8_t before[GRID_N];

    memcpy(before, cell, sizeof before);
    for (uint32_t i = 0; i < GRID_N; i++) {
        uint32_t to[4];

        if (isnan(height[i]) || (holes && before[i] != SHAPE_EMPTY))
            continue;
        beside(i, to);
        for (int k = 0; k < 4; k++)
            if (to[k] != GRID_NONE && before[to[k]] == SHAPE_COVER)
                cell[i] = SHAPE_COVER;
    }
}

/* Cells of the face between covered ones of a row or a column (`step` apart), SHAPE_HOLE at most. */
static void close_gaps(const float *height, uint8_t *cell, uint32_t from, uint32_t n,
                       uint32_t step)
{
    uint32_t last = GRID_NONE;

    for (uint32_t k = 0; k < n; k++) {
        if (cell[from + k * step] != SHAPE_COVER)
            continue;
        for (uint32_t j = last + 1; last != GRID_NONE && k - last <= SHAPE_HOLE && j < k;
             j++)
            if (!isnan(height[from + j * step]))
                cell[from + j * step] = SHAPE_COVER;
        last = k;
    }
}

/* What stands in front of the face, and its surroundings. */
static void mark_front(const struct shape_work *w, const float *gap, const float *height,
                       uint8_t *cell)
{
    const float *scale = w->scale;
    uint8_t mark[GRID_N];
    uint32_t list[GRID_N], n, any = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        mark[i] = gap[i] > (float)SHAPE_STRONG_MM * scale[i] ? STRONG
                  : gap[i] > (float)SHAPE_WEAK_MM * scale[i] ? WEAK
                                                             : 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (mark[i] != STRONG ||
            shape_cells_collect(mark, i, list, &n) < SHAPE_COVER_CELLS)
            continue;
        any += n;
        for (uint32_t k = 0; k < n; k++)
            cell[list[k]] = SHAPE_COVER;
    }
    for (int k = 0; k < SHAPE_HOLE && any > 0; k++)
        shape_cells_grow(height, true, cell);
    if (any == 0)
        return;
    for (uint32_t y = 0; y < GRID_NY; y++)
        close_gaps(height, cell, y * GRID_NX, GRID_NX, 1);
    for (uint32_t x = 0; x < GRID_NX; x++)
        close_gaps(height, cell, x, GRID_NY, GRID_NX);
    shape_cells_grow(height, false, cell);
}

/* ---- hair */

/* How far a cell's gap is from the mean of those beside it, mm; NAN: not known. */
static float rough_at(const float *gap, uint32_t i)
{
    uint32_t to[4];
    float sum = 0.0f, n = 0.0f;

    beside(i, to);
    for (int k = 0; k < 4; k++)
        if (to[k] != GRID_NONE && !isnan(gap[to[k]])) {
            sum += gap[to[k]];
            n += 1.0f;
        }
    return n >= 2.0f ? fabsf(gap[i] - sum / n) : (float)NAN;
}

/* The median roughness of the cheeks, where a face is smooth, mm. */
static float rough_cheeks(const float *gap)
{
    enum { BINS = 64 };
    const float wide = 0.025f;
    uint32_t bin[BINS] = {0}, n = 0, k = 0;

    for (uint32_t i = grid_cell(GRID_LEFT, -48); grid_y(i) <= 8; i++) {
        const float r = fabs(grid_x(i)) >= 30 ? rough_at(gap, i) : (float)NAN;

        if (isnan(r))
            continue;
        bin[r < wide * (BINS - 1) ? (uint32_t)(r / wide) : BINS - 1]++;
        n++;
    }
    for (uint32_t sum = 0; k < BINS - 1 && 2 * (sum += bin[k]) < n;)
        k++;
    return wide * ((float)k + 0.5f);
}

/* Is most of what is around cell i rougher than limit? */
static bool is_hair(const float *rough, uint32_t i, float limit)
{
    const uint32_t x = i % GRID_NX, y = i / GRID_NX;
    uint32_t n = 0, more = 0;

    for (uint32_t v = y >= 2 ? y - 2 : 0; v <= y + 2 && v < GRID_NY; v++)
        for (uint32_t u = x >= 2 ? x - 2 : 0; u <= x + 2 && u < GRID_NX; u++) {
            const float r = rough[v * GRID_NX + u];

            n += isnan(r) ? 0 : 1;
            more += r > limit;
        }
    return more > SHAPE_HAIR_SHARE * n && n >= SHAPE_HAIR_LEAST;
}

/* hair[i]: SEEN where cell i is one of enough that are connected.  What is covered anyway says
 * nothing of the rest.  Most scans are so smooth that there can be none. */
static void find_hair(const float *gap, const float *height, const uint8_t *cell,
                      uint8_t hair[GRID_N])
{
    const uint32_t brow = grid_cell(GRID_LEFT, SHAPE_BROW_Y + GRID_MM);
    uint8_t mark[GRID_N] = {0};
    uint32_t list[GRID_N], n = 0;
    float rough[GRID_N], limit;

    memset(hair, 0, GRID_N);
    for (uint32_t i = brow - 2 * GRID_NX; i < GRID_N; i++) {
        rough[i] = cell[i] == SHAPE_COVER ? (float)NAN : rough_at(gap, i);
        n += rough[i] > (float)SHAPE_HAIR_MM;
    }
    if (n < SHAPE_HAIR_SHARE * SHAPE_HAIR_CELLS)
        return;
    limit = fmaxf((float)SHAPE_HAIR_TIMES * rough_cheeks(gap), (float)SHAPE_HAIR_MM);
    for (uint32_t i = brow; i < GRID_N; i++)
        mark[i] = !isnan(height[i]) && is_hair(rough, i, limit) ? STRONG : 0;
    for (uint32_t i = brow; i < GRID_N; i++)
        if (mark[i] == STRONG &&
            shape_cells_collect(mark, i, list, &n) >= SHAPE_HAIR_CELLS)
            for (uint32_t k = 0; k < n; k++)
                hair[list[k]] = SEEN;
}

/* ---- masks */

/* Where most of the face below the eyes is covered, all is, from the cover's upper rim down: what
 * seems skin there is where cloth lies on it, or the fit was bent to the cloth. */
static void mark_mask(const float *z, uint8_t *cell)
{
    const uint32_t top = grid_cell(GRID_LEFT, SHAPE_MASK_TOP) / GRID_NX * GRID_NX;
    uint32_t seen = 0, covered = 0;

    for (uint32_t i = 0; i < top; i++)
        if (!isnan(z[i])) {
            seen++;
            covered += cell[i] == SHAPE_COVER;
        }
    if (covered <= SHAPE_MASK_SHARE * seen)
        return;
    for (uint32_t x = 0; x < GRID_NX; x++) {
        bool below = false;

        for (uint32_t i = top + x; i >= GRID_NX;) {
            i -= GRID_NX;
            below = below || cell[i] == SHAPE_COVER;
            if (below && !isnan(z[i]))
                cell[i] = SHAPE_COVER;
        }
    }
}

/* shape_cover_mark(w, gap, z, height, cell): mark the cells of what covers the face.
 * gap     how far in front of the fitted face at right angles, mm; NAN: no points
 * z       height of the points, mm; NAN: none
 * height  of the fitted face, mm; NAN off it
 * cell    enum shape_cell; those of a cover become SHAPE_COVER
 * A cover is
 * - more than SHAPE_STRONG_MM in front of the face (times the cell's rest over the mean of all),
 *   with what is beside it, sideways, of more than SHAPE_WEAK_MM, if there are SHAPE_COVER_CELLS
 *   strong cells; then empty ones up to SHAPE_HOLE cells from a strong one, and what is between
 *   such cells, SHAPE_HOLE at most; then all beside;
 * - above the brows what is as rough as hair;
 * - all below its upper rim, where it covers most of the face below the eyes: a mask. */
static void shape_cover_mark(const struct shape_work *w, const float gap[GRID_N],
                             const float z[GRID_N], const float height[GRID_N],
                             uint8_t cell[GRID_N])
{
    uint8_t hair[GRID_N];

    mark_front(w, gap, height, cell);
    find_hair(gap, height, cell, hair);
    for (uint32_t i = 0; i < GRID_N; i++)
        cell[i] = hair[i] ? SHAPE_COVER : cell[i];
    mark_mask(z, cell);
}

/* mm: the most that a cell adds to the residual. */
#define SHAPE_RESIDUAL_MM 5.0

/* Mean square below which a relief is rounding: the surface is a quadric. */
#define SHAPE_FLAT_MM2 1e-6

/* mm: the place round an eye, beside the nose; the share of it that must be skin before it is
 * compared with an eye.  Of 1,400 scans of faces, up to 45 % of some cut out, one in
 * 700 has less. */
#define SHAPE_EYE_LEFT   4
#define SHAPE_EYE_RIGHT  54
#define SHAPE_EYE_BOTTOM 10
#define SHAPE_EYE_TOP    54
#define SHAPE_EYE_LEAST  0.15

/* The mean square of what the best quadric leaves of z over n cells. */
static double relief(const float *z, const uint32_t *cell, uint32_t n)
{
    struct solve_normal sum;
    double x[6], zz = 0;

    memset(&sum, 0, sizeof sum);
    for (uint32_t i = 0; i < n; i++) {
        const double u = grid_x(cell[i]) / 64, v = grid_y(cell[i]) / 82;
        const double j[6] = {1, u, v, u * u, u * v, v * v}, h = (double)z[cell[i]];

        solve_add(&sum, j, h, 1);
        zz += h * h;
    }
    if (n < 6 || !solve_equations(&sum, 0, x))
        return 0;
    for (int k = 0; k < 6; k++)
        zz += sum.g[k] * x[k];
    return zz > 0 ? zz / n : 0;
}

/* How a surface of heights z and one of heights h are alike over n cells: the correlation of
 * what their best quadrics leave. */
static double correlation(const float *z, const float *h, const uint32_t *cell,
                          uint32_t n)
{
    struct solve_normal a, b;
    double x[6], y[6], zz = 0, zh = 0, hh = 0;

    memset(&a, 0, sizeof a);
    memset(&b, 0, sizeof b);
    for (uint32_t i = 0; i < n; i++) {
        const double u = grid_x(cell[i]) / 64, v = grid_y(cell[i]) / 82;
        const double j[6] = {1, u, v, u * u, u * v, v * v};
        const double p = (double)z[cell[i]], q = (double)h[cell[i]];

        solve_add(&a, j, p, 1);
        for (int k = 0; k < 6; k++)
            b.g[k] += j[k] * q;
        zz += p * p;
        zh += p * q;
        hh += q * q;
    }
    memcpy(b.h, a.h, sizeof b.h); /* of the same cells */
    if (!solve_equations(&a, 0, x) || !solve_equations(&b, 0, y))
        return -1;
    for (int k = 0; k < 6; k++) {
        zz += a.g[k] * x[k];
        zh += a.g[k] * y[k];
        hh += b.g[k] * y[k];
    }
    return zz > SHAPE_FLAT_MM2 * n && hh > 0 ? zh / sqrt(zz * hh) : 0;
}

/* The likeness round an eye, to the right or to the left of the nose (side -1). */
static double eye(const struct shape_work *w, const float *z, const uint8_t *cell,
                  double side)
{
    uint32_t list[GRID_N], n = 0, all = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double x = side * grid_x(i), y = grid_y(i);

        if (isnan(w->mean[i]) || x < SHAPE_EYE_LEFT || x > SHAPE_EYE_RIGHT ||
            y < SHAPE_EYE_BOTTOM || y > SHAPE_EYE_TOP)
            continue;
        all++;
        if (cell[i] == SHAPE_SKIN)
            list[n++] = i;
    }
    return n < SHAPE_EYE_LEAST * all ? (double)NAN : correlation(z, w->mean, list, n);
}

/* The lesser of both; of one that is not seen nothing is known, if the other looks like an eye. */
static double eyes(const struct shape_work *w, const float *z, const uint8_t *cell)
{
    const double left = eye(w, z, cell, -1), right = eye(w, z, cell, 1);

    if (isnan(left) || isnan(right))
        return fmax(left, right) > 0 ? SHAPE_EYE_UNKNOWN : -1; /* of NAN and x: x */
    return fmin(left, right);
}

/* The likeness of the forehead to the fitted one. */
static double forehead(const struct shape_work *w, const float *z,
                       const struct shape_fit *f)
{
    uint32_t list[GRID_N], n = 0, all = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(w->mean[i]) || grid_region_of(i) != SURFACE_FOREHEAD)
            continue;
        all++;
        if (f->cell[i] == SHAPE_SKIN)
            list[n++] = i;
    }
    return n < SHAPE_EYE_LEAST * all ? -1 : correlation(z, f->height, list, n);
}

static double detail(const struct shape_work *w, const float *z, const uint8_t *cell)
{
    float over[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        over[i] = cell[i] == SHAPE_SKIN || cell[i] == SHAPE_APART ? z[i] - w->mean[i]
                                                                  : (float)NAN;
    return shape_detail(w->fine, w->over_rest, over);
}

/* What is not explained of the face that no cover hides, mm^2: the gap, up to SHAPE_REST_MM, as
 * the mean of each cell and those around it, so that noise counts little; squared, in terms of
 * the cell's rest, and averaged. */
static double unexplained(const struct shape_work *w, const float *gap,
                          const uint8_t *cell)
{
    enum { WIDE = GRID_NX + 2 }; /* with a rim of no cells */
    const float most = (float)SHAPE_REST_MM;
    float in[(GRID_NY + 2) * WIDE] = {0.0f}, seen[(GRID_NY + 2) * WIDE] = {0.0f};
    float all = 0.0f;
    uint32_t n = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t at = (i / GRID_NX + 1) * WIDE + i % GRID_NX + 1;

        if (cell[i] != SHAPE_SKIN && cell[i] != SHAPE_APART)
            continue;
        in[at] = gap[i] > most ? most : gap[i] < -most ? -most : gap[i];
        seen[at] = 1.0f;
    }
    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t at = i / GRID_NX * WIDE + i % GRID_NX;
        float sum = 0.0f, count = 0.0f;

        if (cell[i] != SHAPE_SKIN && cell[i] != SHAPE_APART)
            continue;
        for (uint32_t k = 0; k < 9; k++) {
            sum += in[at + k / 3 * WIDE + k % 3];
            count += seen[at + k / 3 * WIDE + k % 3];
        }
        sum *= w->over_rest[i] / count;
        all += sum * sum;
        n++;
    }
    return n > 0 ? (double)all / n : 0.0;
}

/* Skin, or what is not explained; how many cells are near the face, and behind it. */
static void classify(const struct shape_work *w, const float *gap, uint8_t *cell,
                     uint32_t *near, uint32_t *behind)
{
    *near = *behind = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        const float far = fabsf(gap[i]);

        cell[i] = SHAPE_EMPTY;
        if (isnan(far))
            continue;
        *near += far < (float)SHAPE_NEAR_MM;
        *behind += gap[i] < (float)-SHAPE_STRONG_MM;
        cell[i] = far < (float)SHAPE_STRONG_MM * w->scale[i] ? SHAPE_SKIN : SHAPE_APART;
    }
}

/* What covers the face is no noise of what is left of it. */
static double residual(const float *gap, const uint8_t *cell)
{
    double sum = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const float left = fminf(fabsf(gap[i]), (float)SHAPE_RESIDUAL_MM);

        if (isnan(gap[i]) || cell[i] == SHAPE_COVER)
            continue;
        sum += (double)left * (double)left;
        n++;
    }
    return n > 0 ? sqrt(sum / n) : 0;
}

void shape_cells_rate(const struct shape_work *w, const float over[GRID_N],
                      struct shape_fit *fit)
{
    float gap[GRID_N], *const z = fit->z;
    uint32_t skin[GRID_N], near, behind;
    double a = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        gap[i] = over[i] * w->normal[i][2];
        z[i] = fit->height[i] + over[i];
    }
    classify(w, gap, fit->cell, &near, &behind);
    shape_cover_mark(w, gap, z, fit->height, fit->cell);
    fit->residual_mm = residual(gap, fit->cell);
    fit->skin = fit->cover = fit->apart = 0;
    for (uint32_t i = 0; i < GRID_N; i++) {
        fit->cover += fit->cell[i] == SHAPE_COVER;
        fit->apart += fit->cell[i] == SHAPE_APART;
        if (fit->cell[i] == SHAPE_SKIN)
            skin[fit->skin++] = i;
    }
    for (uint32_t k = 0; k < w->modes->n; k++)
        a += fit->a[k] * fit->a[k];
    fit->support = (near - 2.0 * behind - 4 * a) / w->cells;
    fit->eyes = eyes(w, z, fit->cell);
    fit->forehead = forehead(w, z, fit);
    fit->detail = detail(w, z, fit->cell);
    fit->likeness = 0.5 * log((relief(fit->height, skin, fit->skin) + SHAPE_RELIEF_MM2) /
                              (unexplained(w, gap, fit->cell) + SHAPE_REST_MM2));
}
