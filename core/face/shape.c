#include "shape.h"

#include <math.h>
#include <string.h>

#include "pose.h"
#include "heights.h"
#include "shape_cells.h"
#include "shape_map.h"
#include "shape_solve.h"

/* The passes of a fit: {limit in mm, prior (shape_solve.h)}; the first SHAPE_PART_PASSES see a part of
 * the face alone.  Neighbouring cells are alike, so that the prior is stronger than 1: with a
 * third of it the worst of 20 faces with glasses has no more support than the best of 200 things
 * that are no faces; with twice as much 88 % of the cells of masks are recognised instead of 96. */
/* clang-format off */
#define SHAPE_PASSES { {12, 100, 88}, {12, 100, 88}, {8, 50, 88}, {8, 50, 88}, {5, 20, 88}, {5, 20, 88}, {3, 10, 88}, {3, 10, 88} }
#define SHAPE_ROUGH { {25, 100, 8}, {18, 100, 16} }
#define SHAPE_SEEK { {12, 100, 16}, {12, 100, 16}, {8, 50, 16} }
#define SHAPE_QUICK { {12, 100, 48}, {12, 100, 48}, {8, 50, 48}, {8, 50, 48}, {5, 20, 48}, {3, 10, 48} }
#define SHAPE_FILL 1
#define SHAPE_WORTH_MM 2.5
#define SHAPE_WORTH_COST 2.5
/* clang-format on */
#define SHAPE_PART_PASSES 4

/* The same for a face that stands alone, near its pose. */
/* clang-format off */
#define SHAPE_PLACE { {12, 100, 88}, {8, 50, 88}, {5, 20, 88}, {3, 10, 88}, {3, 10, 88} }
/* clang-format on */

/* The prior on the motion, 1 / mm^2 (shape_solve.h): next to none.  By hand. */
#define SHAPE_TIE 1e-2

/* The limit in front of the face is this share of the one behind: what covers a face lies in
 * front of it. */
#define SHAPE_FRONT 0.7

/* What a cover explains (shape.c): nothing up to MM in front of the fit, a cell from twice that on.
 * A fit from a part of the face is taken where it explains GAIN cells more.
 * So the right half is chosen for 39 of 40 masks and all of 40 pairs of glasses; of 150 whole faces
 * of real people without either the most that a part gains is 34, of 160 simulated ones 4. */
#define SHAPE_COVER_MM 3.0
#define SHAPE_GAIN     36.0

/* Cells that are seen and not explained, up to which nothing else is tried where nothing covers the
 * face: of 274 real and simulated scans where a fit from a part gained so much the least had 182. */
#define SHAPE_LITTLE 120.0

/* A part is fitted by all modes unless a quick fit from it explains so many cells less than one from
 * the whole: of 269 parts that gained enough two do; or is the same face, whose heights differ by less
 * than SAME (root mean square): of 1,465 parts 520 are, and none of the 215 that were taken. */
#define SHAPE_LESS    4.0
#define SHAPE_SAME_MM 0.5

/* Share of skin among the cells with points, and worth (shape.c), that need no other start: most
 * scans of uncovered faces of real people have both. */
#define SHAPE_GOOD       0.95
#define SHAPE_GOOD_WORTH 540.0

struct shape_pass {
    float limit_mm; /* beyond which a cell counts nothing */
    double prior;   /* on the coefficients (shape_solve.h) */
    uint32_t modes; /* at most */
};

/* Parts of the face that something may cover, to start from the others. */
enum part { WHOLE, NO_EYES, UPPER, LOWER, LEFT, RIGHT, PARTS };

static bool in_part(enum part p, uint32_t cell)
{
    const double x = grid_x(cell), y = grid_y(cell);

    switch (p) {
    case NO_EYES:
        return y < 8 || y > 48;
    case UPPER:
        return y > 14;
    case LOWER:
        return y < 40;
    case LEFT:
        return x < 6;
    case RIGHT:
        return x > -6;
    default:
        return true;
    }
}

/* How much a cell counts whose points are r in front of the surface: all up to half of the
 * limit, nothing beyond it, nor if r is no number. */
static inline float trust(float r, float limit)
{
    const float far = fabsf(r) / (r > 0.0f ? limit * (float)SHAPE_FRONT : limit);
    const float t = 2.0f - 2.0f * far, most = t < 1.0f ? t : 1.0f;

    return t > 0.0f ? most : 0.0f;
}

/* The weights of the cells, where the points are over[] in front of the surface height, and how
 * far they are above the mean face.  Only cells for which in[] is 1 count. */
static void shape_weigh(const struct shape_work *w, const float *height,
                        const float *over, const float *in, float limit, float *weight,
                        float *above)
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        weight[i] = in[i] * trust(over[i] * w->normal[i][2], limit);
        above[i] = height[i] - w->mean[i] + over[i];
    }
}

/* What the fit explains, in cells, where the points are over[] in front of it; less by so much as
 * the coefficients are larger than faces' are. */
static double worth_of(const struct shape_work *w, const float *over, const double *a)
{
    double sum = 0.0, square = 0.0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double r = (double)(over[i] * w->normal[i][2]) / SHAPE_WORTH_MM;

        sum += r * r < 1.0 ? (1.0 - r * r) * (1.0 - r * r) : 0.0; /* NAN is not */
    }
    for (uint32_t k = 0; k < w->modes->n; k++)
        square += a[k] * a[k];
    return sum - SHAPE_WORTH_COST * square;
}

/* What a cover explains, in cells: skin is never so far in front of what the rest of the face says.
 * It separates a face of which a part is covered from one that is bent to pass through the cover, and
 * says nothing where the pose is not known. */
static double covered(const struct shape_work *w, const float *over)
{
    double sum = 0.0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double r = (double)(over[i] * w->normal[i][2]);

        if (r > SHAPE_COVER_MM) /* NAN is not */
            sum += fmin(r / SHAPE_COVER_MM - 1.0, 1.0);
    }
    return sum;
}

/* What is fitted to, in the frame of the start: points, or samples of a surface. */
struct target {
    struct shape_points *points; /* near the face */
    const struct heights *samples;
};

/* How far the target, moved by pose, is in front of the surface height. */
static void shape_look(const struct target *t, const struct pose *pose,
                       const float *height, float *over)
{
    if (t->samples == NULL) {
        shape_map_make(t->points, pose, height, over);
        for (int k = 0; k < SHAPE_FILL; k++)
            shape_map_fill(height, over);
        return;
    }
    heights_at(t->samples, pose, over);
    for (uint32_t i = 0; i < GRID_N; i++)
        over[i] -= height[i];
}

/* Fit in passes, from the mean face; the first SHAPE_PART_PASSES see the part alone.  out->pose
 * then moves the target.  The cells are rated if more than `least` is explained; else all with points
 * count as skin. */
static enum status fit_from(struct shape_work *w, const struct target *t, enum part part,
                            const struct shape_pass *pass, uint32_t passes, double least,
                            struct shape_fit *out)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct dvec3 centre = {0, 0, -POSE_LEVER_MM};
    struct shape_solve *solve = scratch_need(&w->solve, sizeof *solve);
    float over[GRID_N], above[GRID_N], weight[GRID_N], in[GRID_N];
    struct shape_solution by;

    if (solve == NULL)
        return ST_ENOMEM;
    solve->width = 0;
    for (uint32_t i = 0; i < GRID_N; i++)
        in[i] = in_part(part, i) ? 1.0f : 0.0f;
    memset(out->a, 0, sizeof out->a);
    memcpy(out->height, w->mean, sizeof out->height);
    out->pose = still;
    shape_look(t, &out->pose, out->height, over);
    for (uint32_t k = 0; k < passes; k++) {
        const struct shape_prior prior = {pass[k].prior, SHAPE_TIE, pass[k].modes};

        for (uint32_t i = 0; k == SHAPE_PART_PASSES && i < GRID_N; i++)
            in[i] = 1.0f;
        shape_weigh(w, out->height, over, in, pass[k].limit_mm, weight, above);
        shape_solve(&w->basis, above, weight, &prior, solve, &by);
        memcpy(out->a, by.a, sizeof out->a);
        shape_bend(&w->basis, w->mean, out->a, pass[k].modes, out->height);
        pose_move(&out->pose, centre, by.x);
        shape_look(t, &out->pose, out->height, over);
    }
    out->worth = worth_of(w, over, out->a);
    out->explained = out->worth + covered(w, over);
    out->skin = out->cover = out->apart = 0;
    for (uint32_t i = 0; i < GRID_N; i++)
        out->skin += isnan(over[i]) ? 0 : 1;
    if (out->explained > least)
        shape_cells_rate(w, over, out);
    return ST_OK;
}

enum status shape_seek(struct shape_work *w, const struct dvec3 *pts, size_t n,
                       const struct pose *start, bool close, struct shape_fit *out)
{
    static const struct shape_pass rough[] = SHAPE_ROUGH, fine[] = SHAPE_SEEK;
    struct shape_points p;
    enum status st = shape_map_points(pts, n, start, w->mean, &w->points, &p);

    if (st == ST_OK)
        st = fit_from(w, &(struct target){.points = &p}, WHOLE, close ? fine : rough,
                      close ? sizeof fine / sizeof *fine : sizeof rough / sizeof *rough,
                      close ? -INFINITY : INFINITY, out);
    out->pose = pose_follow(&out->pose, start);
    return st;
}

static const struct shape_pass passes[] = SHAPE_PASSES;

/* The fit from a start. */
static enum status fit_start(struct shape_work *w, const struct dvec3 *pts, size_t n,
                             const struct pose *start, struct shape_fit *out)
{
    struct shape_points p;
    enum status st = shape_map_points(pts, n, start, w->mean, &w->points, &p);

    if (st == ST_OK)
        st = fit_from(w, &(struct target){.points = &p}, WHOLE, passes,
                      sizeof passes / sizeof *passes, -INFINITY, out);
    out->pose = pose_follow(&out->pose, start);
    return st;
}

/* By few modes: whether the fit from a start may explain more than another. */
static enum status fit_quickly(struct shape_work *w, struct shape_points *p,
                               enum part part, struct shape_fit *out)
{
    static const struct shape_pass quick[] = SHAPE_QUICK;

    return fit_from(w, &(struct target){.points = p}, part, quick,
                    sizeof quick / sizeof *quick, INFINITY, out);
}

static uint32_t seen(const struct shape_fit *f)
{
    return f->skin + f->cover + f->apart;
}

/* What is explained of a whole face: at a size at which more of the grid is seen more is not
 * explained for that. */
static double shape_share(const struct shape_work *w, const struct shape_fit *f)
{
    return f->explained * w->cells / (seen(f) + 1);
}

/* Is so much explained that no other fit needs to be tried? */
static bool good(const struct shape_fit *f)
{
    return (f->skin >= SHAPE_GOOD * seen(f) && f->worth >= SHAPE_GOOD_WORTH) ||
           (f->cover == 0 && seen(f) - f->explained < SHAPE_LITTLE);
}

/* Are both the same face? */
static bool shape_same(const struct shape_work *w, const struct shape_fit *a,
                       const struct shape_fit *b)
{
    float sum = 0.0f;

    for (uint32_t r = 0; r < w->basis.cells; r++) {
        const uint32_t i = w->basis.cell[r];
        const float d = a->height[i] - b->height[i];

        sum += d * d;
    }
    return sum < (float)(SHAPE_SAME_MM * SHAPE_SAME_MM) * (float)w->basis.cells;
}

/* The fits that begin with a part, at *out's size, where the whole is fitted quickly; *out becomes one
 * that explains more. */
static enum status fit_parts(struct shape_work *w, const struct dvec3 *pts, size_t n,
                             const struct pose *start, struct shape_fit *whole,
                             struct shape_fit *out)
{
    double least = out->explained + SHAPE_GAIN;
    const double size = out->size;
    struct shape_points p;
    enum status st = shape_map_points(pts, n, start, w->mean, &w->points, &p);
    struct shape_fit one;

    if (st == ST_OK)
        st = fit_quickly(w, &p, WHOLE, whole);
    for (enum part part = WHOLE + 1; st == ST_OK && part < PARTS; part++) {
        if ((st = fit_quickly(w, &p, part, &one)) != ST_OK ||
            !(one.explained > whole->explained - SHAPE_LESS) ||
            shape_same(w, &one, whole))
            continue;
        st = fit_from(w, &(struct target){.points = &p}, part, passes,
                      sizeof passes / sizeof *passes, least, &one);
        if (st != ST_OK || !(one.explained > least))
            continue;
        *out = one;
        out->pose = pose_follow(&one.pose, start);
        out->size = size;
        least = one.explained;
    }
    return st;
}

/* The fits to heads of other sizes, where one of the mean face's is fitted quickly; *out becomes one
 * that explains more.  The first two say whether the others are worth a look. */
static enum status fit_sizes(struct shape_work *w, const struct dvec3 *pts, size_t n,
                             const struct pose *of_one, const struct shape_fit *whole,
                             struct shape_fit *out)
{
    static const double size[] = SHAPE_SIZES;
    double least = shape_share(w, out) + SHAPE_SIZE_GAIN;
    struct shape_fit best, one;
    struct shape_points p;
    struct pose start;
    enum status st = ST_OK;

    best.size = 1;
    for (size_t k = 0; st == ST_OK && k < sizeof size / sizeof *size; k++) {
        if (k == 2 && best.size == 1)
            return ST_OK;
        start = pose_scale(of_one, 1 / size[k]);
        st = shape_map_points(pts, n, &start, w->mean, &w->points, &p);
        if (st == ST_OK)
            st = fit_quickly(w, &p, WHOLE, &one);
        if (st != ST_OK || !(shape_share(w, &one) > shape_share(w, whole)))
            continue;
        st = fit_start(w, pts, n, &start, &one);
        if (st != ST_OK || !(shape_share(w, &one) > least))
            continue;
        best = one;
        best.size = size[k];
        least = shape_share(w, &one);
    }
    if (st != ST_OK || best.size == 1)
        return st;
    *out = best;
    return good(out) ? ST_OK : fit_parts(w, pts, n, &best.pose, &one, out);
}

enum status shape_fit(struct shape_work *w, const struct dvec3 *pts, size_t n,
                      const struct pose *start, uint32_t nstart, bool hard,
                      struct shape_fit *out)
{
    struct shape_fit one;
    enum status st = ST_OK;
    uint32_t best = 0;

    out->worth = -INFINITY;
    out->skin = out->cover = out->apart = 0;
    for (uint32_t i = 0; st == ST_OK && i < nstart; i++) {
        if ((st = fit_start(w, pts, n, &start[i], &one)) != ST_OK ||
            !(one.worth > out->worth))
            continue;
        *out = one;
        best = i;
    }
    out->size = 1;
    return st == ST_OK && hard ? shape_fit_harder(w, pts, n, &start[best], out) : st;
}

enum status shape_fit_harder(struct shape_work *w, const struct dvec3 *pts, size_t n,
                             const struct pose *start, struct shape_fit *fit)
{
    struct shape_fit whole;
    enum status st = ST_OK;

    if (!good(fit))
        st = fit_parts(w, pts, n, start, &whole, fit);
    if (st == ST_OK && !good(fit))
        st = fit_sizes(w, pts, n, start, &whole, fit);
    return st;
}

enum status shape_place(struct shape_work *w, const struct surface *f,
                        const struct pose *start, struct shape_fit *out)
{
    static const struct shape_pass pass[] = SHAPE_PLACE;
    struct heights samples;
    enum status st = heights_take(f, start, &w->points, &samples);

    if (st == ST_OK)
        st = fit_from(w, &(struct target){.samples = &samples}, WHOLE, pass,
                      sizeof pass / sizeof *pass, -INFINITY, out);
    if (st != ST_OK)
        return st;
    out->pose = pose_follow(&out->pose, start);
    out->size = 1;
    return ST_OK;
}
