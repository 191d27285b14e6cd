#include "scan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloudpoints.h"
#include "crop.h"
#include "face.h"
#include "find.h"
#include "mem.h"
#include "mirror.h"
#include "scan_search.h"
#include "shape.h"
#include "sight.h"
#include "sparse.h"
#include "tuning.h"
#include "vec.h"

#define SCAN_GLB_MM 1000 /* glTF is in metres */

static const struct align_pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

/* One call. */
struct scan {
    struct cloudpoints *c;
    const struct scan_options *o;
    struct face_work *w;
    struct shape_work *shape; /* w's */
    struct face *out;
    size_t *bad;
    struct scan_found *found;
    struct shape_fit fit; /* the latest */
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

static void begin(struct scan *s)
{
    *s->found = (struct scan_found){.format = s->c->format,
                                    .points_read = s->c->read,
                                    .points_dropped = s->c->read - s->c->n,
                                    .unit_found = s->c->unit_mm == 0,
                                    .gate = {.size = 1},
                                    .yaw_deg = (double)NAN,
                                    .pitch_deg = (double)NAN,
                                    .roll_deg = (double)NAN};
    measure_extent(s->c, s->found->extent);
    s->out->quality = (struct quality){0};
    s->out->frame = (struct frame){0};
    s->out->surface.mesh.nv = s->out->surface.mesh.nt = 0;
}

static void warn(struct scan *s, enum scan_warning k, bool when)
{
    s->found->warnings |= when ? 1U << k : 0;
}

/* From the file's unit to mm by the pose. */
static void tell_view(struct scan_found *f, const struct align_pose *pose)
{
    align_pose_to_matrix(pose, f->view);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            f->view[4 * i + k] *= f->unit_mm;
}

/* The turn of the face against a scanner with these axes: x as in the image, y and z by the
 * sign of `side`; how far, as the trace of the rotation. */
static double turn_of(const double r[9], double side, struct scan_found *f)
{
    const double x = r[6], y = side * r[7], z = side * r[8];

    f->yaw_deg = atan2(x, z) * VEC_DEGREES;
    f->pitch_deg = atan2(y, sqrt(x * x + z * z)) * VEC_DEGREES;
    f->roll_deg = atan2(-r[3], side * r[4]) * VEC_DEGREES;
    return r[0] + side * (r[4] + r[8]);
}

/* Against the agreed axes, or a camera's: y down and z away; of points that are all seen from
 * there, as those of a frontal scan are. */
static void tell_turn(struct scan *s, bool frontal)
{
    const struct align_pose *pose = &s->fit.pose;
    struct scan_found *f = s->found;
    const double camera = turn_of(pose->r, -1, f);
    struct scan_found seen = *f;
    const double agreed = turn_of(pose->r, 1, &seen);
    const struct dvec3 nose = align_pose_origin(pose);

    if (agreed > camera)
        *f = seen;
    if (fmax(agreed, camera) < SCAN_AXES_TRACE ||
        !(frontal || sight_single(s->c->at, s->c->n, nose, agreed > camera ? 1 : -1)))
        f->yaw_deg = f->pitch_deg = f->roll_deg = (double)NAN;
    warn(s, SCAN_TURNED,
         fabs(f->yaw_deg) > QUALITY_TURNED_YAW_DEG ||
             fabs(f->pitch_deg) > QUALITY_TURNED_OTHER_DEG ||
             fabs(f->roll_deg) > QUALITY_TURNED_OTHER_DEG);
}

/* What the fit tells, where the points are seen by view. */
static void tell_fit(struct scan *s, const struct align_pose *view)
{
    struct scan_found *f = s->found;

    tell_view(f, view);
    f->faces = f->faces > 0 ? f->faces : 1;
    warn(s, SCAN_SEVERAL, f->faces > 1);
    warn(s, SCAN_OCCLUDED, f->occluded > SCAN_OCCLUDED_SOME);
}

/* ---- the gate */

/* The points are those that were fitted to. */
static enum status judge_face(struct scan *s, const struct dvec3 *pts, size_t n)
{
    const struct gate_scan g = {s->shape, &s->fit, pts, n, s->o->enrolment};

    s->found->occluded = (double)s->fit.cover / g.shape->cells;
    return gate_judge(&g, &s->found->gate);
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
    warn(s, SCAN_MIRRORED, mirror_told(s->c));
    if (!s->o->enrolment)
        return ST_OK;
    if (s->found->faces > 1)
        return ST_ESEVERAL;
    if ((s->found->warnings >> SCAN_MIRRORED & 1) != 0)
        return ST_EMIRRORED;
    return fabs(s->found->yaw_deg) > QUALITY_TURNED_YAW_DEG && far_side(s) < SCAN_FAR_SIDE
               ? ST_EQUALITY
               : ST_OK;
}

/* ---- points that are frontal already */

/* c in this many times as large units. */
static void scale(struct cloudpoints *c, double by)
{
    for (size_t i = 0; by != 1 && i < c->n; i++)
        c->at[i] = (struct dvec3){c->at[i].x * by, c->at[i].y * by, c->at[i].z * by};
}

/* The unit by which the points are as large as a face alone; mm if there is none. */
static double likely_unit(const struct cloudpoints *c, const double extent[3])
{
    static const double mm[] = {1, 1000, 10, 25.4};
    const double side = fmax(extent[0], fmax(extent[1], extent[2]));

    if (c->unit_mm != 0)
        return c->unit_mm;
    for (size_t i = 0; i < sizeof mm / sizeof *mm; i++)
        if (side * mm[i] >= SCAN_SIDE_MIN_MM && side * mm[i] <= SCAN_SIDE_MAX_MM)
            return mm[i];
    return 1;
}

/* What the shape of a face explains of n points, at a pose that is nearly right. */
static enum status fit(struct scan *s, const struct dvec3 *pts, size_t n,
                       const struct align_pose *pose)
{
    enum status st = shape_judge(s->shape, pts, n, pose, &s->fit);
    const uint32_t sure = s->fit.sure;
    const bool hard = sure > SCAN_PLAIN_STRAYS;

    if (st != ST_OK ||
        (s->fit.support >= SCAN_SURE && s->fit.cover == 0 && !hard && !s->o->enrolment))
        return st;
    if ((st = shape_fit(s->shape, pts, n, pose, 1, hard, &s->fit)) == ST_OK && !hard)
        s->fit.sure = sure; /* a fit may also raise what it was not asked for */
    return st;
}

/* Where no search follows, what was refused only once it had been laid on the mean face has
 * evidence to tell. */
static bool placed(const struct scan *s, enum status built)
{
    return built == ST_ENOTFACE && s->o->axes == SCAN_AXES_SCANNER &&
           s->out->frame.mean_id != 0;
}

/* The model of points that are frontal, and what the shape of a face explains of them.  Few
 * points leave cells between them, of which their surface tells. */
static enum status build(struct scan *s, const struct dvec3 *pts, size_t n)
{
    const struct align_pose *pose = &s->out->frame.pose;
    const enum status built = face_build(pts, n, s->w, s->out, s->bad);
    struct dvec3 *more;
    enum status st;

    if (built != ST_OK && !placed(s, built))
        return built;
    if (built != ST_OK || s->out->quality.density_mm <= QUALITY_SPARSE_MM) {
        st = fit(s, pts, n, pose);
        return st != ST_OK ? st : built;
    }
    if ((st = sparse_points(&s->out->surface, &more, &n)) == ST_OK)
        st = fit(s, more, n, pose);
    mem_free(more);
    return st;
}

/* Is it plainly one uncovered face seen from the front, without much else?  Beyond a head's
 * width there may be another person's. */
static bool plain(const struct scan *s)
{
    const struct surface *f = &s->out->surface;
    const double wide = s->found->extent[0] * s->found->unit_mm;

    return wide <= SCAN_PLAIN_WIDE_MM && s->fit.support >= SCAN_PLAIN &&
           s->fit.cover <= SCAN_PLAIN_COVER && s->fit.sure <= SCAN_PLAIN_SURE &&
           f->spikes <= SCAN_PLAIN_SPIKES * f->mesh.nv;
}

/* What little seems covered is the face's own shape. */
static void uncover(struct shape_fit *f)
{
    for (uint32_t i = 0; i < GRID_N; i++)
        f->cell[i] = f->cell[i] == SHAPE_COVER ? SHAPE_SKIN : f->cell[i];
    f->skin += f->cover;
    f->cover = 0;
}

/* The model of the points that s->fit explains. */
static enum status build_crop(struct scan *s)
{
    const struct crop_view view = {s->fit.pose, s->fit.height, s->fit.cell};
    const size_t n = s->c->n, most = n > SCAN_FULL ? SCAN_ENOUGH : SCAN_FULL;
    struct crop_count count;
    const enum status judged = judge_face(s, s->c->at, n);
    enum status st;

    tell_turn(s, false);
    st = crop_face(s->c, &view, most, &count);
    if (st != ST_OK || judged == ST_ENOMEM)
        return st != ST_OK ? st : judged;
    tell_fit(s, &s->fit.pose);
    s->found->elsewhere = 1 - (double)(count.face + count.other) / (double)n;
    warn(s, SCAN_BEHIND, s->found->elsewhere > SCAN_ELSEWHERE_SOME);
    warn(s, SCAN_THINNED, count.kept < count.face);
    st = judge_enrolment(s);
    if (judged != ST_OK || st != ST_OK)
        return judged != ST_OK ? judged : st;
    return face_build(s->c->at, s->c->n, s->w, s->out, s->bad);
}

/* The points stay as they are, and their model. */
static enum status keep(struct scan *s)
{
    const enum status judged = judge_face(s, s->c->at, s->c->n);
    enum status st;

    tell_turn(s, true);
    tell_fit(s, &still);
    st = judge_enrolment(s);
    return judged != ST_OK ? judged : st;
}

/* ---- the ways from points to a model */

/* The unit and the axes are as agreed, or given; a format may have agreed on its own. */
static enum status build_agreed(struct scan *s)
{
    const size_t n = s->c->n;
    enum status st = ST_OK;

    s->found->unit_mm = s->c->unit_mm != 0                ? s->c->unit_mm
                        : s->c->format == CLOUDFORMAT_GLB ? SCAN_GLB_MM
                                                          : 1;
    scale(s->c, s->found->unit_mm);
    if (n > SCAN_FULL)
        st = crop_thin(s->c, SCAN_ENOUGH);
    warn(s, SCAN_THINNED, s->c->n < n);
    if (st != ST_OK)
        return st;
    st = build(s, s->c->at, s->c->n);
    if (st == ST_OK || placed(s, st)) {
        const enum status kept = keep(s);

        st = kept != ST_OK ? kept : st;
    }
    return st;
}

static uint64_t mix(uint64_t h, double v)
{
    uint64_t bits;

    memcpy(&bits, &v, sizeof bits);
    h = (h ^ bits) * UINT64_C(0xBF58476D1CE4E5B9); /* of splitmix64 */
    return h ^ (h >> 32);
}

/* Some SCAN_LOOK of more points, drawn by their coordinates: the same ones in any order. */
static size_t draw(const struct cloudpoints *c, struct dvec3 few[2 * SCAN_LOOK])
{
    const uint64_t most = UINT64_MAX / c->n * SCAN_LOOK;
    size_t n = 0;

    for (size_t i = 0; i < c->n && n < 2 * SCAN_LOOK; i++) {
        const struct dvec3 p = c->at[i];

        few[n] = p;
        n += mix(mix(mix(0, p.x), p.y), p.z) < most;
    }
    return n;
}

/* Are the points in mm plainly a face as they are?  Of many, few are looked at first. */
static enum status look(struct scan *s, bool *is)
{
    struct dvec3 *few = NULL;
    enum status st;

    if (s->c->n <= SCAN_FULL)
        st = build(s, s->c->at, s->c->n);
    else if ((few = mem_array(2 * SCAN_LOOK, sizeof *few)) == NULL)
        st = ST_ENOMEM;
    else if ((st = build(s, few, draw(s->c, few))) == ST_ERANGE)
        st = ST_ENOFACE; /* nobody knows its place any more */
    *is = st == ST_OK && plain(s);
    if (*is && few != NULL) {
        st = fit(s, s->c->at, s->c->n, &s->out->frame.pose);
        *is = st == ST_OK && plain(s);
    }
    mem_free(few);
    if (*is)
        uncover(&s->fit);
    return st;
}

/* Nothing is known of unit and axes; c is as it was read.  Leaves it in the unit found. */
static enum status search(struct scan *s, struct scan_search *k)
{
    const struct find_pose *pose = k->find.pose;
    struct align_pose start[FIND_POSES];
    uint32_t n = 0;

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
    return shape_fit(s->shape, s->c->at, s->c->n, start, n, true, &k->fit);
}

static enum status build_searched(struct scan *s)
{
    struct scan_search own = {.done = false};
    struct scan_search *k = s->o->search != NULL ? s->o->search : &own;

    k->st = search(s, k);
    k->done = true;
    if (k->st != ST_OK)
        return k->st;
    if (s->o->stop != NULL && atomic_load_explicit(s->o->stop, memory_order_relaxed))
        return ST_EBUSY;
    s->fit = k->fit;
    s->found->found = true;
    s->found->faces = k->find.faces;
    s->found->unit_mm = k->find.pose[0].unit_mm;
    s->out->quality = (struct quality){0}; /* was that of all points */
    return build_crop(s);
}

static enum status build_found(struct scan *s)
{
    const double unit = likely_unit(s->c, s->found->extent);
    struct quality quality;
    enum status st, searched;
    bool is;

    if (s->c->n < FACE_MIN_POINTS)
        return ST_ETOOFEW;
    s->found->unit_mm = unit;
    scale(s->c, unit);
    st = look(s, &is);
    if (is)
        return s->c->n <= SCAN_FULL ? keep(s) : build_crop(s);
    if (st == ST_ENOMEM || st == ST_ENOTFINITE)
        return st; /* of metres taken for mm the points coincide: that ends nothing */
    scale(s->c, 1 / unit);
    s->found->unit_mm = s->c->unit_mm;
    quality = s->out->quality;
    searched = build_searched(s);
    /* What is wrong with the points as they are may be the nearer reason. */
    if ((searched == ST_ENOFACE && st != ST_OK) ||
        (searched == ST_ENOTFACE && (st == ST_EQUALITY || st == ST_ERANGE))) {
        s->out->quality = quality;
        return st;
    }
    return searched;
}

enum status scan_build(struct cloudpoints *c, const struct scan_options *o,
                       struct face_work *w, struct face *out, size_t *bad,
                       struct scan_found *found)
{
    struct scan s = {.c = c, .o = o, .w = w, .out = out, .bad = bad, .found = found};
    enum status st;

    begin(&s);
    s.shape = face_work_shape(w);
    st = o->axes == SCAN_AXES_SCANNER ? build_agreed(&s) : build_found(&s);
    mem_free(c->normal); /* they have told what they could */
    c->normal = NULL;
    if (st == ST_OK)
        found->points_used = c->n;
    else
        out->surface.mesh.nv = out->surface.mesh.nt = 0;
    return st;
}

const char *scan_warning_name(enum scan_warning k)
{
    static const char *const name[SCAN_WARNINGS] = {
        [SCAN_SEVERAL] = "several_faces",   [SCAN_MIRRORED] = "mirrored",
        [SCAN_BEHIND] = "points_elsewhere", [SCAN_TURNED] = "turned",
        [SCAN_OCCLUDED] = "occluded",       [SCAN_THINNED] = "thinned"};

    return name[k];
}
