#include "pair.h"

#include <math.h>

#include "heights.h"
#include "place.h"
#include "pose.h"
#include "shape_work.h"
#include "face_work.h"

/* Sizes that differ by less are one but for rounding. */
#define PAIR_SAME 1e-6

static struct pair_side as_it_is(const struct surface_face *f)
{
    return (struct pair_side){&f->surface, &f->encoding, f->frame.pose};
}

/* How many cells more than at the size of the other scan one explains at its own. */
static double gain(const struct surface_face *f, const struct shape_fit *other)
{
    return (double)f->frame.seen * ((double)f->frame.explained - place_explained(other));
}

/* The side becomes f as the fit lays it. */
static enum status pair_take(const struct surface_face *f, const struct shape_fit *fit,
                             struct surface_work *w, struct pair_side *side,
                             struct encoding *encoding)
{
    side->pose = fit->pose;
    side->encoding = encoding;
    return place_encode(f, fit, w, encoding);
}

enum status pair_make(const struct surface_face *tmpl, const struct surface_face *probe,
                      struct surface_work *w, struct pair *out)
{
    const double size = place_size(&tmpl->frame.pose),
                 other = place_size(&probe->frame.pose);
    struct shape_fit at_other[2];
    enum status st;

    out->tmpl = as_it_is(tmpl);
    out->probe = as_it_is(probe);
    if (fabs(size - other) < PAIR_SAME || tmpl->encoding.n == 0 || probe->encoding.n == 0)
        return ST_OK;
    if (tmpl->surface.mesh.nv == 0 || probe->surface.mesh.nv == 0)
        return ST_EINVAL;
    if ((st = place_at(tmpl, other, w, &at_other[0])) != ST_OK ||
        (st = place_at(probe, size, w, &at_other[1])) != ST_OK)
        return st;
    if (gain(tmpl, &at_other[0]) > gain(probe, &at_other[1]))
        return pair_take(probe, &at_other[1], w, &out->probe, &out->other);
    return pair_take(tmpl, &at_other[0], w, &out->tmpl, &out->other);
}

enum status pair_again(const struct surface_face *probe, const double transform[16],
                       struct surface_work *w, struct pair *io)
{
    struct surface_face moved = *probe;
    const double size = place_size(&io->tmpl.pose);
    const struct pose tmpl = pose_unscaled(&io->tmpl.pose);
    struct shape_fit fit;
    struct pose onto;
    enum status st;

    pose_from_matrix(transform, &onto);
    moved.frame.pose = pose_follow(&tmpl, &onto);
    if ((st = place_at(&moved, size, w, &fit)) != ST_OK)
        return st;
    io->probe.pose = fit.pose;
    io->probe.encoding = &io->again;
    return place_encode(probe, &fit, w, &io->again);
}

enum status pair_heights(const struct pair_side *s, struct surface_work *w,
                         float z[GRID_N])
{
    return heights_of(s->surface, &s->pose, &w->measure.scratch, z);
}
