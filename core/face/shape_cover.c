#include "shape_cover.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "frame.h"
#include "grid.h"
#include "shape_work.h"

/* mm, cells: what stands WEAK in front of the face beside cells that are farther than
 * SHAPE_STRONG_MM covers it too, if there are COVER_CELLS of those; and what is HOLE cells beside or
 * between them. */
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
static uint32_t shape_cover_collect(uint8_t *mark, uint32_t i, uint32_t *list,
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
static void shape_cover_grow(const float *height, bool holes, uint8_t *cell)
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
            shape_cover_collect(mark, i, list, &n) < SHAPE_COVER_CELLS)
            continue;
        any += n;
        for (uint32_t k = 0; k < n; k++)
            cell[list[k]] = SHAPE_COVER;
    }
    for (int k = 0; k < SHAPE_HOLE && any > 0; k++)
        shape_cover_grow(height, true, cell);
    if (any == 0)
        return;
    for (uint32_t y = 0; y < GRID_NY; y++)
        close_gaps(height, cell, y * GRID_NX, GRID_NX, 1);
    for (uint32_t x = 0; x < GRID_NX; x++)
        close_gaps(height, cell, x, GRID_NY, GRID_NX);
    shape_cover_grow(height, false, cell);
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
            shape_cover_collect(mark, i, list, &n) >= SHAPE_HAIR_CELLS)
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

void shape_cover_mark(const struct shape_work *w, const float gap[GRID_N],
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
