#include "place.h"

#include <math.h>
#include <stdbool.h>

#include "heights.h"
#include "pose.h"
#include "shape.h"
#include "vec.h"
#include "face_work.h"

/* Support from which on a face lies where it was fitted. */
#define FACE_SURE 0.6

/* Where a face is looked for: where it lies, as what comes from a search does; with its centre at the
 * mean face's, as most do; anywhere.  Where one start leads to where one before it did, within MM and 3
 * degrees (1 + 2 cos), and LIKELY is supported, that is where the face is: of children, who have less
 * at the mean face's size, this is not sure. */
#define FACE_SAME_MM    4.0
#define FACE_SAME_TRACE 2.9973
#define FACE_LIKELY     0.35
enum { STARTS = 3 };

/* What is not explained to SURE is tried at other sizes, and a head taken for one of another size
 * where that explains GAIN cells more: with less adults of two scans have two sizes, with more
 * children look like each other.  STEP: of the sizes about the best. */
#define FACE_SIZE_SURE 0.8
#define FACE_SIZE_GAIN 120.0
#define FACE_SIZE_STEP 0.04

/* Returns the number of cells of the face with points. */
static double seen(const struct shape_fit *fit)
{
    return fit->skin + fit->cover + fit->apart;
}

/* The share of what is seen that a face's shape explains. */
static double support(const struct surface_work *w, const struct shape_fit *fit)
{
    return seen(fit) > 0 ? fit->support * w->shape.cells / seen(fit) : -1;
}

/* What a fit explains, in cells of a whole face. */
static double worth(const struct surface_work *w, const struct shape_fit *fit)
{
    return place_explained(fit) * w->shape.cells;
}

/* shape_place() as if the head were so large, from the start; *fit becomes what is plainly a face and
 * worth more. */
static enum status try_size(struct surface_face *f, struct surface_work *w,
                            const struct pose *start, double size, struct shape_fit *fit)
{
    const struct pose shrunk = pose_scale(start, 1 / size);
    struct shape_fit one;
    const enum status st = shape_place(&w->shape, &f->surface, &shrunk, &one);

    if (st != ST_OK || !(worth(w, &one) > worth(w, fit)) || support(w, &one) < FACE_SURE)
        return st;
    *fit = one;
    fit->size = size;
    return ST_OK;
}

/* What shape_place() is worth at the size; 0: it is no face. */
static enum status worth_at(struct surface_face *f, struct surface_work *w,
                            const struct pose *start, double size, double *out)
{
    struct shape_fit fit = {.worth = 0};
    const enum status st = try_size(f, w, start, size, &fit);

    *out = worth(w, &fit);
    return st;
}

/* The fit at the size where the worth is greatest, by the parabola through three. */
static enum status refine_size(struct surface_face *f, struct surface_work *w,
                               struct shape_fit *fit)
{
    const struct pose start = pose_scale(&fit->pose, fit->size);
    const double size = fit->size;
    double less, more, bend, way;
    enum status st = worth_at(f, w, &start, size * (1 - FACE_SIZE_STEP), &less);

    if (st == ST_OK)
        st = worth_at(f, w, &start, size * (1 + FACE_SIZE_STEP), &more);
    if (st != ST_OK || !(less > 0 && more > 0))
        return st;
    bend = 2 * worth(w, fit) - less - more;
    way = fmax(-1, fmin((more - less) / (2 * fmax(bend, 1)), 1));
    return try_size(f, w, &start, size * (1 + way * FACE_SIZE_STEP), fit);
}

/* What is hardly a face as large as the model's may be a child's; from where it is, or, where that is
 * not known, from each start.  The first two sizes say whether the others are worth a look. */
static enum status try_sizes(struct surface_face *f, struct surface_work *w,
                             const struct pose start[STARTS], bool lost,
                             struct shape_fit *fit)
{
    static const double size[] = SHAPE_SIZES;
    const struct pose own[1] = {fit->pose};
    const struct pose *from = lost ? start : own;
    const size_t n = lost ? STARTS : 1;
    struct shape_fit best = *fit;
    enum status st = ST_OK;

    for (size_t k = 0; st == ST_OK && k < n * (sizeof size / sizeof *size); k++) {
        if (!lost && k == 2 && best.size == 1)
            return ST_OK;
        st = try_size(f, w, &from[k % n], size[k / n], &best);
    }
    if (st != ST_OK || !(worth(w, &best) > worth(w, fit) + FACE_SIZE_GAIN))
        return st;
    *fit = best;
    return refine_size(f, w, fit);
}

/* Where the k-th start is. */
static enum status start_at(struct surface_face *f, struct surface_work *w, int k,
                            struct pose *out)
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct dvec3 from = pose_centre(&f->surface.mesh);
    const struct dvec3 way = vec_sub(w->mean.axes.centre, from);
    enum status st;

    *out = still;
    if (k == 1)
        *out = (struct pose){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {way.x, way.y, way.z}};
    if (k < 2)
        return ST_OK;
    scratch_exchange(&w->measure.scratch, &w->align.field);
    st = frame_find(&w->mean, &f->surface, &w->align, &f->frame);
    scratch_exchange(&w->measure.scratch, &w->align.field);
    *out = f->frame.pose;
    return st;
}

enum status place_encode(const struct surface_face *f, const struct shape_fit *fit,
                         struct surface_work *w, struct encoding *out)
{
    float z[GRID_N];
    enum status st;

    scratch_exchange(&w->measure.scratch, &w->shape.points);
    st = heights_of(&f->surface, &fit->pose, &w->shape.points, z);
    scratch_exchange(&w->measure.scratch, &w->shape.points);
    return st != ST_OK
               ? st
               : encode_heights(&w->encode, z,
                                encode_noise(fit->residual_mm, (double)f->step_mm),
                                &w->normal, out);
}

static bool place_same(const struct pose *a, const struct pose *b)
{
    const struct pose d = pose_after(a, b);
    const double *t = d.t;

    return t[0] * t[0] + t[1] * t[1] + t[2] * t[2] < FACE_SAME_MM * FACE_SAME_MM &&
           d.r[0] + d.r[4] + d.r[8] > FACE_SAME_TRACE;
}

/* The frame, and the fit that it is of; with the builders' block to take heights in. */
static enum status place(struct surface_face *f, struct surface_work *w,
                         struct shape_fit *fit)
{
    struct pose start[STARTS];
    struct shape_fit one;
    enum status st = ST_OK;
    bool lost = true;

    fit->worth = -INFINITY;
    fit->skin = fit->cover = fit->apart = 0;
    for (int k = 0; st == ST_OK && k < STARTS && lost; k++) {
        if ((st = start_at(f, w, k, &start[k])) != ST_OK ||
            (st = shape_place(&w->shape, &f->surface, &start[k], &one)) != ST_OK)
            continue;
        lost = k == 0 || !place_same(&one.pose, &fit->pose);
        if (one.worth > fit->worth)
            *fit = one;
        lost = support(w, fit) < (lost ? FACE_SURE : FACE_LIKELY);
    }
    if (st == ST_OK && support(w, fit) < FACE_SIZE_SURE)
        st = try_sizes(f, w, start, lost, fit);
    if (st != ST_OK)
        return st;
    f->frame = (struct frame){
        .pose = fit->pose, .mean_id = w->mean.mean_id, .support = support(w, fit)};
    place_keep(fit, &f->frame);
    return ST_OK;
}

enum status place_find(struct surface_face *f, struct surface_work *w)
{
    struct shape_fit fit;
    enum status st;

    scratch_exchange(&w->measure.scratch, &w->shape.points);
    st = place(f, w, &fit);
    scratch_exchange(&w->measure.scratch, &w->shape.points);
    return st == ST_OK ? place_encode(f, &fit, w, &f->encoding) : st;
}

double place_size(const struct pose *pose)
{
    const double *r = pose->r;

    return 1 / sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
}

double place_explained(const struct shape_fit *fit)
{
    return fit->worth / (seen(fit) + 1);
}

void place_keep(const struct shape_fit *fit, struct frame *out)
{
    out->seen = (float)seen(fit);
    out->explained = (float)place_explained(fit);
}

enum status place_at(const struct surface_face *f, double size, struct surface_work *w,
                     struct shape_fit *fit)
{
    const struct pose start =
        pose_scale(&f->frame.pose, place_size(&f->frame.pose) / size);
    enum status st;

    scratch_exchange(&w->measure.scratch, &w->shape.points);
    st = shape_place(&w->shape, &f->surface, &start, fit);
    scratch_exchange(&w->measure.scratch, &w->shape.points);
    fit->size = size;
    return st;
}
