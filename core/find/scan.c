#include "scan.h"

#include <math.h>

#include "aspect.h"
#include "cloudpoints.h"
#include "crop.h"
#include "face.h"
#include "face_work.h"
#include "find.h"
#include "gate.h"
#include "lattice.h"
#include "mem.h"
#include "mirror.h"
#include "place.h"
#include "quality.h"
#include "series.h"
#include "shape.h"
#include "sight.h"
#include "step.h"
#include "vec.h"

/* A face that is turned by more than SURFACE_YAW_DEG is enrolled where so much of the side
 * to which it is turned is seen nevertheless, as of a frontal scan in other axes.  Of half
 * profiles from 35 degrees on 0.73 at most is, of frontal scans 0.93 and more. */
#define SCAN_FAR_SIDE 0.8

/* The proportions are looked at of a face that looks so far (the cosine of 20 degrees) past the camera at
 * most, and that is explained to so much. */
#define SCAN_ASPECT_FACING  0.94
#define SCAN_ASPECT_SUPPORT 0.6

/* Where something covers the face, or the upper part of it is not there, the search often takes the mouth
 * or the chin for the nose: the head turned down about its middle.  Where less than SUPPORT of the face is
 * explained, and more than COVER of it seems covered or less than SEEN is there, its first POSES are also
 * tried turned up, by 15 and by 30 degrees (tangents of half of that): what explains more, and LEAST at
 * least, is taken.  Of 95 others two would gain more than 5 cells. */
/* clang-format off */
#define SCAN_UP         { 0.1317, 0.2679 }
/* clang-format on */
#define SCAN_UP_SUPPORT 0.6
#define SCAN_UP_COVER   0.1
#define SCAN_UP_SEEN    0.6
#define SCAN_UP_LEAST   0.3
#define SCAN_UP_POSES   2

/* mm: the longest sides by which points in none of the usual units are looked at, of a head, of a face cut
 * out and of a bust: most faces are found at 0.8 to 1.25 times their size.  Not of points that a usual unit
 * makes as large as a head, and a face at a scale so near to a usual one would have been found by that. */
#define SCAN_SIDES                                                                       \
    {                                                                                    \
        260, 160, 420                                                                    \
    }
#define SCAN_USUAL_MIN_MM 130.0
#define SCAN_USUAL_MAX_MM 300.0
#define SCAN_SCALE        1.6
#define SCAN_SCALE_POINTS 5000

/* The scale of a face that was found is told to a step of REFINE, of REFINED to either side. */
#define SCAN_REFINE  0.05
#define SCAN_REFINED 5

/* Support from which on a face is where it lay in another frame, and from which on, uncovered, it
 * has hardly moved. */
#define SCAN_NEAR  0.45
#define SCAN_STILL 0.7

static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

/* One call. */
struct scan {
    struct cloudpoints *c;
    const struct scan_options *o;
    struct surface_work *w;
    struct shape_work *shape; /* w's */
    struct surface_face *out;
    size_t *bad;
    struct surface_found *found;
    struct shape_fit fit; /* the latest */
    struct pose view;     /* its pose, in mm */
};

/* ---- what is found */

static void measure_extent(const struct cloudpoints *c, double extent[3])
{
    struct dvec3 lo = {INFINITY, INFINITY, INFINITY};
    struct dvec3 hi = {-INFINITY, -INFINITY, -INFINITY};

    for (size_t i = 0; i < c->n; i++) {
        const struct dvec3 p = c->at[i];

        lo = (struct dvec3){p.x < lo.x ? p.x : lo.x, p.y < lo.y ? p.y : lo.y,
                            p.z < lo.z ? p.z : lo.z};
        hi = (struct dvec3){p.x > hi.x ? p.x : hi.x, p.y > hi.y ? p.y : hi.y,
                            p.z > hi.z ? p.z : hi.z};
    }
    extent[0] = c->n > 0 ? hi.x - lo.x : 0;
    extent[1] = c->n > 0 ? hi.y - lo.y : 0;
    extent[2] = c->n > 0 ? hi.z - lo.z : 0;
}

static void scan_begin(struct scan *s)
{
    *s->found = (struct surface_found){.unit_found = s->c->unit_mm == 0,
                                       .head_size = 1,
                                       .yaw_deg = (double)NAN,
                                       .pitch_deg = (double)NAN,
                                       .roll_deg = (double)NAN};
    measure_extent(s->c, s->found->extent);
    s->out->quality = (struct surface_quality){0};
    s->out->frame = (struct frame){0};
    s->out->surface.mesh.nv = s->out->surface.mesh.nt = 0;
    s->out->step_mm = 0;
}

static void warn(struct scan *s, enum surface_warning k, bool when)
{
    s->found->warnings |= when ? 1U << k : 0;
}

/* The steps of the depths, which count as noise, seen by view (step.h).  To be told before a model is
 * made. */
static void tell_step(struct scan *s, const struct pose *view)
{
    s->found->step_mm = fmax(s->o->step_mm, step_of(s->c->at, s->c->n, view));
    s->out->step_mm = (float)s->found->step_mm;
    warn(s, SURFACE_STEPPED, s->found->step_mm > SURFACE_STEP_MM);
}

/* From the file's unit to mm by the pose. */
static void tell_view(struct surface_found *f, const struct pose *pose)
{
    pose_to_matrix(pose, f->view);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            f->view[4 * i + k] *= f->unit_mm;
}

/* The turn of the face against a scanner whose axes are the agreed ones (side 1) or a camera's (-1: y
 * down, z away).  Yaw and pitch are where the scanner is as the face sees it, so that they do not depend
 * on which way up the scanner stands; the roll is that of the face about the scanner's axis. */
static void turn_of(const double r[9], double side, struct surface_found *f)
{
    const double x = -side * r[2], y = -side * r[5], z = side * r[8];

    f->yaw_deg = series_degrees(x, z);
    f->pitch_deg = series_degrees(y, sqrt(x * x + z * z));
    f->roll_deg = series_degrees(-r[3], side * r[4]);
}

/* Against the side that the face looks to, along z; of points that are all seen from there, as those of a
 * frontal scan are.  A picture may lie on its side or upside down: what is left of its quarter turns is the
 * tilt of the head. */
static void tell_turn(struct scan *s, bool frontal)
{
    const struct pose *pose = &s->view;
    struct surface_found *f = s->found;
    const double side = pose->r[8] > 0 ? 1 : -1;
    double tilt;

    if (side * pose->r[8] < FIND_FACING ||
        !(frontal || sight_single(s->c->at, s->c->n, pose_origin(pose), side)))
        return;
    turn_of(pose->r, side, f);
    tilt = f->roll_deg - 90 * rint(f->roll_deg / 90);
    warn(s, SURFACE_TURNED,
         fabs(f->yaw_deg) > SURFACE_YAW_DEG || fabs(f->pitch_deg) > SURFACE_TILT_DEG ||
             fabs(tilt) > SURFACE_TILT_DEG);
}

/* What the fit shows, where the points are seen by view. */
static void tell_fit(struct scan *s, const struct pose *view)
{
    struct surface_found *f = s->found;

    tell_view(f, view);
    f->faces = f->faces > 0 ? f->faces : 1;
    warn(s, SURFACE_SEVERAL, f->faces > 1);
    warn(s, SURFACE_OCCLUDED, f->occluded > SCAN_OCCLUDED_SOME);
}

/* ---- the gate */

static enum status judge_face(struct scan *s)
{
    s->found->occluded = (double)s->fit.cover / s->shape->cells;
    s->view = pose_scale(&s->fit.pose, s->fit.size);
    return gate_judge(s->shape, &s->fit, s->o->enrolment && !s->o->frame, s->found);
}

/* The share of the face that is seen of the side to which it is turned, 0..1. */
static double far_side(const struct scan *s)
{
    uint32_t on = 0, seen = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (!isnan(s->fit.height[i]) && grid_x(i) * s->found->yaw_deg > 0) {
            on++;
            seen += s->fit.cell[i] != SHAPE_EMPTY;
        }
    return on > 0 ? (double)seen / on : 1;
}

/* Is it one face, not its mirror image, and seen from the front?  The points are in the frontal
 * view. */
static enum status judge_enrolment(struct scan *s)
{
    warn(s, SURFACE_MIRRORED, mirror_told(s->c));
    if (!s->o->enrolment)
        return ST_OK;
    if (s->found->faces > 1)
        return ST_ESEVERAL;
    if ((s->found->warnings >> SURFACE_MIRRORED & 1) != 0)
        return ST_EMIRRORED;
    return fabs(s->found->yaw_deg) > SURFACE_YAW_DEG && far_side(s) < SCAN_FAR_SIDE
               ? ST_EQUALITY
               : ST_OK;
}

/* ---- the face as it was found */

/* c in this many times as large units. */
static void scale(struct cloudpoints *c, double by)
{
    for (size_t i = 0; by != 1 && i < c->n; i++)
        c->at[i] = (struct dvec3){c->at[i].x * by, c->at[i].y * by, c->at[i].z * by};
}

/* pose: of the points' canonical frame, by the fit. */
static enum status scan_build_model(struct scan *s, const struct pose *pose)
{
    enum status st;

    if (!s->o->frame)
        return face_build(s->c->at, s->c->n, s->w, s->out, s->bad);
    st = face_lay(s->c->at, s->c->n, pose, s->w, s->out, s->bad);
    s->out->encoding.residual_mm =
        (float)encode_noise(s->fit.residual_mm, (double)s->out->step_mm);
    s->out->encoding.cells = s->fit.skin;
    place_keep(&s->fit, &s->out->frame);
    return st;
}

/* Is a point where none can be, which says more than that there is no face? */
static bool beyond(const struct scan *s)
{
    const double most = LATTICE_MAX / LATTICE_PER_MM;

    for (size_t i = 0; i < s->c->n; i++) {
        const struct dvec3 p = s->c->at[i];

        if (fabs(p.x) > most || fabs(p.y) > most || fabs(p.z) > most)
            return true;
    }
    return false;
}

/* The model of the points that s->fit explains. */
static enum status build_crop(struct scan *s)
{
    const struct crop_view view = {s->fit.pose, s->fit.height, s->fit.cell};
    const size_t n = s->c->n, most = n > SCAN_FULL ? SCAN_ENOUGH : SCAN_FULL;
    struct crop_count count;
    const enum status judged = judge_face(s);
    struct pose mm;
    enum status st;

    if (judged == ST_ENOTFACE && beyond(s))
        return scan_build_model(s, &still);
    tell_turn(s, false);
    if ((st = crop_face(s->c, &view, most, &count)) != ST_OK)
        return st;
    scale(s->c, s->fit.size);
    tell_fit(s, &s->view);
    s->found->elsewhere = 1 - (double)(count.face + count.other) / (double)n;
    warn(s, SURFACE_BEHIND, s->found->elsewhere > SCAN_ELSEWHERE_SOME);
    warn(s, SURFACE_THINNED, count.kept < count.face);
    st = judge_enrolment(s);
    mm = pose_scale(&still, 1 / s->fit.size);
    if (judged == ST_EQUALITY)
        (void)scan_build_model(
            s, &mm); /* the surface is rated: its points may be too sparse */
    if (judged != ST_OK || st != ST_OK)
        return judged != ST_OK ? judged : st;
    return scan_build_model(s, &mm);
}

/* The points stay as they are, and their model. */
static enum status scan_keep(struct scan *s)
{
    const enum status judged = judge_face(s);
    enum status st;

    tell_turn(s, true);
    tell_fit(s, &still);
    st = judge_enrolment(s);
    return judged != ST_OK ? judged : st;
}

/* ---- the ways from points to a model */

/* The model of the points as they are, and their fit; each is made once. */
static enum status model_of_all(struct scan *s, struct scan_search *k)
{
    if (k->as_is) {
        *s->out = k->model;
    } else {
        k->st_as_is = face_build(s->c->at, s->c->n, s->w, s->out, &k->bad);
        k->model = *s->out;
        k->as_is = true;
    }
    if (s->bad != NULL)
        *s->bad = k->bad;
    return k->st_as_is;
}

static enum status fit_all(struct scan *s, struct scan_search *k)
{
    const struct pose pose = pose_unscaled(&s->out->frame.pose);

    if (!k->fitted)
        k->st_fitted =
            shape_fit(s->shape, s->c->at, s->c->n, &pose, 1, true, &k->fit_as_is);
    k->fitted = true;
    s->fit = k->fit_as_is;
    return k->st_fitted;
}

static enum status build_as_it_is(struct scan *s, struct scan_search *k)
{
    enum status st = model_of_all(s, k), kept;

    /* What was refused only once it had been laid on the mean face has evidence to tell. */
    if (st != ST_OK && (st != ST_ENOTFACE || s->out->frame.mean_id == 0))
        return st;
    if ((kept = fit_all(s, k)) == ST_OK)
        kept = scan_keep(s);
    return kept != ST_OK ? kept : st;
}

/* The unit and the axes are as agreed, or given; a format may have agreed on its own. */
static enum status build_agreed(struct scan *s, struct scan_search *k)
{
    const size_t n = s->c->n;
    enum status st = ST_OK;

    s->found->unit_mm = s->c->unit_mm != 0    ? s->c->unit_mm
                        : s->c->usual_mm != 0 ? s->c->usual_mm
                                              : 1;
    scale(s->c, s->found->unit_mm);
    if (n > SCAN_FULL)
        st = crop_thin(s->c, SCAN_ENOUGH);
    warn(s, SURFACE_THINNED, s->c->n < n);
    if (st != ST_OK)
        return st;
    tell_step(s, NULL);
    return build_as_it_is(s, k);
}

/* The fits from the first of n poses, turned up; *fit becomes one that explains more, and *start where it
 * is from. */
static enum status fit_up(struct scan *s, const struct pose *from, uint32_t n,
                          struct pose *start, struct shape_fit *fit)
{
    static const double up[] = SCAN_UP;
    enum { UP = sizeof up / sizeof *up };
    const struct dvec3 middle = {0, 0, -POSE_LEVER_MM};
    const uint32_t all = (n < SCAN_UP_POSES ? n : SCAN_UP_POSES) * UP;
    struct pose turned[SCAN_UP_POSES * UP];
    struct shape_fit one = {.worth = 0};
    enum status st;

    for (uint32_t i = 0; i < all; i++) {
        turned[i] = from[i / UP];
        pose_tilt(&turned[i], middle, 0, up[i % UP]);
    }
    st = shape_fit(s->shape, s->c->at, s->c->n, turned, all, false, &one);
    if (st != ST_OK || !(one.worth > fit->worth && one.support > SCAN_UP_LEAST))
        return st;
    *start = one.pose;
    *fit = one;
    return ST_OK;
}

/* The fit from the best of n poses, the first of which is plainly a face or not. */
static enum status fit_best(struct scan *s, const struct pose *from, uint32_t n,
                            bool plain, struct shape_fit *fit)
{
    struct pose start = from[0];
    struct shape_fit one;
    enum status st = shape_fit(s->shape, s->c->at, s->c->n, &start, 1, false, fit);

    for (uint32_t i = 1; st == ST_OK && i < n; i++) {
        st = shape_fit(s->shape, s->c->at, s->c->n, &from[i], 1, false, &one);
        if (st != ST_OK || !(one.worth > fit->worth))
            continue;
        start = from[i];
        *fit = one;
    }
    if (st == ST_OK && !plain && fit->support < SCAN_UP_SUPPORT &&
        (fit->cover > SCAN_UP_COVER * s->shape->cells ||
         fit->skin < SCAN_UP_SEEN * s->shape->cells))
        st = fit_up(s, from, n, &start, fit);
    return st == ST_OK ? shape_fit_harder(s->shape, s->c->at, s->c->n, &start, fit) : st;
}

/* Is the face near the place where it lay in another frame?  Then k has it as of a search, and c is
 * in its unit; else c is as before. */
static enum status look_near(struct scan *s, struct scan_search *k)
{
    const struct scan_near *near = s->o->near;
    struct shape_fit rough, close;
    enum status st;

    scale(s->c, near->unit_mm);
    st = shape_fit(s->shape, s->c->at, s->c->n, &near->pose, 1, false, &k->fit);
    if (st == ST_OK && (k->fit.support < SCAN_STILL || k->fit.cover > 0)) {
        st = shape_seek(s->shape, s->c->at, s->c->n, &near->pose, false, &rough);
        if (st == ST_OK)
            st = shape_seek(s->shape, s->c->at, s->c->n, &rough.pose, true, &close);
        if (st == ST_OK)
            st = shape_fit(s->shape, s->c->at, s->c->n, &close.pose, 1, true, &k->fit);
    }
    k->done = st == ST_OK && k->fit.support >= SCAN_NEAR;
    if (k->done)
        k->find = (struct find_result){
            .pose = {{near->unit_mm, k->fit.pose, k->fit.worth}}, .n = 1, .faces = 1};
    else
        scale(s->c, 1 / near->unit_mm);
    return st;
}

/* Nothing is known of unit and axes; c is as it was read.  Leaves it in the unit found. */
static enum status search(struct scan *s, struct scan_search *k)
{
    const struct find_pose *pose = k->find.pose;
    struct pose start[FIND_POSES];
    enum status st;
    uint32_t n = 0;

    if (!k->done && s->o->near != NULL) {
        st = look_near(s, k);
        if (st != ST_OK || k->done)
            return st;
    }
    if (!k->done)
        k->st = find_face(s->c->at, s->c->n, s->c->unit_mm, s->w, s->o->stop, &k->find);
    if (k->st != ST_OK)
        return k->st;
    scale(s->c, pose[0].unit_mm);
    if (k->done)
        return ST_OK;
    for (uint32_t i = 0; i < k->find.n; i++)
        if (pose[i].unit_mm == pose[0].unit_mm)
            start[n++] = pose[i].pose;
    return fit_best(s, start, n, pose[0].worth >= FIND_PLAIN, &k->fit);
}

/* Is the focal length wrong by which a depth image became points? */
static enum status judge_aspect(struct scan *s, struct scan_search *k)
{
    const bool plainly = s->fit.support >= SCAN_ASPECT_SUPPORT && s->fit.cover == 0 &&
                         fabs(s->view.r[8]) >= SCAN_ASPECT_FACING;
    enum status st = ST_OK;

    if (!s->c->pinhole || !plainly)
        return ST_OK;
    if (k->focal_times == 0)
        st = aspect_of(s->shape, s->c->at, s->c->n, &s->fit, &k->focal_times);
    s->found->focal_times = k->focal_times;
    warn(s, SURFACE_FOCAL,
         k->focal_times > SURFACE_FOCAL_MOST || k->focal_times < SURFACE_FOCAL_LEAST);
    return st;
}

/* Where no face is found the points may be too small a part of one, or something is wrong with
 * them as they are. */
static enum status build_unfound(struct scan *s, struct scan_search *k)
{
    const bool many = s->c->n > SCAN_FULL;
    enum status st = ST_OK;

    s->found->unit_mm = s->c->unit_mm != 0 ? s->c->unit_mm : 1;
    scale(s->c, s->found->unit_mm);
    if (many)
        st = crop_thin(s->c, SCAN_ENOUGH);
    if (st == ST_OK)
        st = build_as_it_is(s, k);
    if (st == ST_OK) { /* cropped as what was found is, in that model's memory */
        k->as_is = false;
        s->found->cropped = true;
        return build_crop(s);
    }
    /* No unit was given that could be wrong; of those thinned out nobody knows the place of one any
     * more. */
    return st == ST_ENOTFACE || (st == ST_EUNITS && s->c->unit_mm == 0) ||
                   (many && st == ST_ERANGE)
               ? ST_ENOFACE
               : st;
}

/* Returns true if a unit that was tried is between these. */
static bool was_tried(const struct scan *s, double from_mm, double to_mm)
{
    static const double units[] = FIND_UNITS_MM;

    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        const double mm = s->c->unit_mm != 0 ? s->c->unit_mm : units[i];

        if (mm > from_mm && mm < to_mm)
            return true;
    }
    return false;
}

/* n of the cloud's points into at, by a scale. */
static void sample(const struct scan *s, struct dvec3 *at, size_t n, double by)
{
    for (size_t i = 0; i < n; i++)
        at[i] = vec_along((struct dvec3){0, 0, 0}, by, s->c->at[i * s->c->n / n]);
}

/* Sets k->fits_mm by the scale near one, at which a face was found as fit says, that makes the best face
 * of usual size of it. */
static enum status refine(struct scan *s, struct scan_search *k, struct dvec3 *at,
                          size_t n, double mm, const struct shape_fit *fit)
{
    double best = 0;
    enum status st = ST_OK;

    for (int i = -SCAN_REFINED; i <= SCAN_REFINED && st == ST_OK; i++) {
        const double by = (1 + SCAN_REFINE * i) / fit->size;
        struct pose pose = fit->pose;
        struct shape_fit one;

        for (int axis = 0; axis < 3; axis++)
            pose.t[axis] *= by;
        sample(s, at, n, mm * by);
        st = shape_fit(s->shape, at, n, &pose, 1, true, &one);
        if (st != ST_OK || one.size != 1 || one.worth <= best)
            continue;
        best = one.worth;
        k->fits_mm = mm * by * s->found->unit_mm;
    }
    return st;
}

/* Returns the status of a search for a face in n points by a scale.  Sets k->fits_mm if there plainly is
 * one. */
static enum status try_scale(struct scan *s, struct scan_search *k, struct dvec3 *at,
                             size_t n, double mm)
{
    struct surface_found about = *s->found;
    struct shape_fit fit;
    struct find_result find;
    enum status st;

    sample(s, at, n, mm);
    if ((st = find_once(at, n, s->w, s->o->stop, &find)) == ST_OK)
        st = shape_fit(s->shape, at, n, &find.pose[0].pose, 1, true, &fit);
    if (st != ST_OK)
        return st == ST_ENOFACE ? ST_OK : st;
    about.occluded = (double)fit.cover / s->shape->cells;
    return gate_judge(s->shape, &fit, true, &about) == ST_OK
               ? refine(s, k, at, n, mm, &fit)
               : ST_OK;
}

/* Tries the scales that SCAN_SIDES says, with some of the points. */
static enum status find_scale(struct scan *s, struct scan_search *k)
{
    static const double sides[] = SCAN_SIDES;
    const double extent = find_extent(s->c->at, s->c->n) / s->found->unit_mm;
    size_t n = s->c->n < SCAN_SCALE_POINTS ? s->c->n : SCAN_SCALE_POINTS;
    struct dvec3 *at = mem_array(n, sizeof *at);
    enum status st = at != NULL ? ST_OK : ST_ENOMEM;

    k->scaled = true;
    k->fits_mm = 0;
    if (extent == 0 ||
        was_tried(s, SCAN_USUAL_MIN_MM / extent, SCAN_USUAL_MAX_MM / extent))
        n = 0;
    for (size_t i = 0;
         st == ST_OK && n > 0 && k->fits_mm == 0 && i < sizeof sides / sizeof *sides; i++)
        st = try_scale(s, k, at, n, sides[i] / extent / s->found->unit_mm);
    if (was_tried(s, k->fits_mm / SCAN_SCALE, k->fits_mm * SCAN_SCALE))
        k->fits_mm = 0;
    mem_free(at);
    return st;
}

/* Nothing like a face was found, st: is there one in a unit that nobody gave, or at another scale of a
 * depth image?  The points are in mm by found->unit_mm. */
static enum status try_scales(struct scan *s, struct scan_search *k, enum status st)
{
    enum status tried;

    if ((s->c->unit_mm != 0 && !s->c->pinhole) || s->o->near != NULL)
        return st;
    if (!k->scaled && (tried = find_scale(s, k)) != ST_OK)
        return tried;
    s->found->fits_mm = k->fits_mm;
    return k->fits_mm > 0 ? ST_EUNITS : st;
}

/* Returns true if what was found is no face that could be enrolled. */
static bool is_nothing(const struct scan *s)
{
    struct surface_found ignored = *s->found;

    return gate_judge(s->shape, &s->fit, !s->o->frame, &ignored) == ST_ENOTFACE;
}

static enum status build_found(struct scan *s, struct scan_search *k)
{
    enum status st;

    if (s->c->n < SURFACE_MIN_POINTS)
        return ST_ETOOFEW;
    k->st = search(s, k);
    k->done = true;
    if (k->st == ST_ENOFACE) {
        st = build_unfound(s, k);
        return st == ST_ENOFACE || st == ST_ENOTFACE || st == ST_EUNITS || st == ST_ERANGE
                   ? try_scales(s, k, st)
                   : st;
    }
    if (k->st != ST_OK)
        return k->st;
    if (s->o->stop != NULL && s->o->stop->wanted(s->o->stop->arg))
        return ST_EBUSY;
    s->fit = k->fit;
    s->found->faces = k->find.faces;
    s->found->unit_mm = k->find.pose[0].unit_mm;
    s->view = pose_scale(&s->fit.pose, s->fit.size);
    tell_step(s, &s->view);
    if (is_nothing(s) && (st = try_scales(s, k, ST_OK)) != ST_OK)
        return st;
    if ((st = judge_aspect(s, k)) != ST_OK)
        return st;
    s->found->cropped = true;
    return build_crop(s);
}

enum status scan_build(struct cloudpoints *c, const struct scan_options *o,
                       struct surface_work *w, struct surface_face *out, size_t *bad,
                       struct surface_found *found)
{
    struct scan s = {.c = c, .o = o, .w = w, .out = out, .bad = bad, .found = found};
    struct scan_search own = {.done = false};
    struct scan_search *k = o->search != NULL ? o->search : &own;
    enum status st;

    scan_begin(&s);
    s.shape = &w->shape;
    st = o->axes == SCAN_AXES_SCANNER ? build_agreed(&s, k) : build_found(&s, k);
    found->quality = out->quality;
    if (st == ST_OK)
        found->points_used = c->n;
    else
        out->surface.mesh.nv = out->surface.mesh.nt = 0;
    return st;
}
