#include "align.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "align_field.h"
#include "align_grid.h"
#include "pose.h"
#include "solve.h"
#include "cells.h"
#include "fit.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "surface.h"

/* Points of the probe that decide between starts, that bring the best of them home, and that
 * leave out what does not fit; at most twice as many.  A step shorter than MM is the last of
 * its stage, and there are STAGE_STEPS at most.  Time grows with the points; one start is
 * enough for 90 % of probes turned by up to 25 degrees, and none of 340 ended beyond 1.5
 * degrees. */
#define ALIGN_COARSE_POINTS 150
#define ALIGN_COARSE_MM     1.0
#define ALIGN_MIDDLE_POINTS 400
#define ALIGN_MIDDLE_MM     0.3
#define ALIGN_TUKEY_POINTS  1000
#define ALIGN_TUKEY_STEP_MM 0.1
#define ALIGN_STAGE_STEPS   8

/* Other starts are tilted by turns whose half angles have these tangents: 14 degrees from
 * the principal axes, 17 from the pose as scanned, which knows less.  By hand. */
#define ALIGN_TILT_AXES  0.12
#define ALIGN_TILT_AS_IS 0.15

/* A coarse pose needs no rival when it has GOOD_WITHIN of the points over the template and
 * costs less than GOOD_MM, or more when two or three starts led there (SAME_MM apart at
 * most).  A quarter of all scans tried all starts before agreement counted. */
#define ALIGN_GOOD_WITHIN 0.75
#define ALIGN_GOOD_MM     1.0
#define ALIGN_GOOD_2_MM   2.0
#define ALIGN_GOOD_3_MM   3.0
#define ALIGN_SAME_MM     5.0

/* Else the second best is followed too, if it costs less than this times the best. */
#define ALIGN_RIVAL 1.4

/* The last step, which separates motion from change: over this many points, at most twice as
 * many (with half as many the median rotation error grows by 5 %, and a second step does not
 * make it less), and the prior on the motion (1 / mm^2), which is next to none.  By hand. */
#define ALIGN_LAST_POINTS 3000
#define ALIGN_LAST_TIE    1e-4

/* Triangles that the area of the probe is taken from, at most twice as many: to 2 %. */
#define ALIGN_AREA_TRIANGLES 2500

/* Points of the face that its frame is found by, at most twice as many. */
#define FRAME_POINTS 1200

/* Reweighted steps onto a surface that does not fit are too short: each is three fifths of
 * the one before.  Stretched by this they end after 25 sums instead of 31. */
#define FRAME_STRETCH 1.5

/* What a coarse pose may cost to need no rival, by the number of starts that led there; more
 * starts than AGREED say no more. */
static const double good_mm[] = {0, ALIGN_GOOD_MM, ALIGN_GOOD_2_MM, ALIGN_GOOD_3_MM};
#define AGREED 3

/* A search in progress. */
struct align_searching {
    struct align_field field;
    struct align_point *pts;
    uint32_t n;
    struct dvec3 centre;
    double stretch; /* of steps */
    const struct align_how *how;
    struct align_result *out;
};

/* A pose with what it costs. */
struct candidate {
    struct pose pose;
    double cost, within;
};

/* stride_for(n, points): the stride that takes `points` of n points, or up to twice as many:
 * a power of two, so that the points of one stage are among those of the next. */
static uint32_t stride_for(uint32_t n, uint32_t points)
{
    uint32_t stride = 1;

    while (n / (2 * stride) >= points)
        stride *= 2;
    return stride;
}

/* step(s, sum, pose): one Gauss-Newton step.  Returns its length in mm (rotations at
 * POSE_LEVER_MM), or 0 where the normal equations are singular. */
static double align_step(const struct align_searching *s, const struct solve_sum *sum,
                         struct pose *pose)
{
    double x[6], turn, shift, scale = s->stretch;

    if (!solve_equations(&sum->normal, SOLVE_DAMPING, x))
        return 0.0;
    turn = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    shift = sqrt(x[3] * x[3] + x[4] * x[4] + x[5] * x[5]);
    if (turn * scale > SOLVE_MAX_TURN_RAD)
        scale = SOLVE_MAX_TURN_RAD / turn;
    if (shift * scale > SOLVE_MAX_SHIFT_MM)
        scale = SOLVE_MAX_SHIFT_MM / shift;
    for (int i = 0; i < 6; i++)
        x[i] *= scale;
    pose_move(pose, s->centre, x);
    return scale * (turn * POSE_LEVER_MM + shift);
}

/* descend(s, stride, loss, limit, enough, c): at most limit steps from c->pose, until one
 * is shorter than enough (mm).  *c becomes the cheapest pose met; with Tukey's loss, where
 * no other pose is compared with it, the one after a short step, which is not summed again.
 * Returns true if a short step ended it. */
static bool descend(struct align_searching *s, uint32_t stride, enum solve_loss loss,
                    int limit, double enough, struct candidate *c)
{
    struct pose pose = c->pose;
    bool ended = false;

    c->cost = INFINITY;
    for (int i = 0; i <= limit; i++) {
        struct solve_sum sum;

        if (s->how->grid != NULL)
            align_grid_sum(s->how->grid, s->pts, s->n, stride, &pose, s->centre, loss,
                           &sum);
        else
            align_field_sum(&s->field, s->pts, s->n, stride, &pose, s->centre, loss,
                            &sum);
        s->out->evaluations++;
        if (sum.cost < c->cost)
            *c = (struct candidate){pose, sum.cost, sum.within};
        if (ended || i == limit)
            break;
        ended = align_step(s, &sum, &pose) < enough;
        if (ended && loss == SOLVE_LOSS_TUKEY) {
            c->pose = pose;
            break;
        }
    }
    return ended;
}

/* load(probe, step, pts): each step-th vertex as a point that has not been located and stands
 * for no area.  Returns how many there are. */
static uint32_t align_load(const struct surface *probe, uint32_t step,
                           struct align_point *pts)
{
    const struct mesh *m = &probe->mesh;
    uint32_t n = 0;

    for (uint32_t v = 0; v < m->nv; v += step)
        pts[n++] = (struct align_point){lattice_to_mm(m->xy[v], m->z[v]), 0.0f,
                                        ALIGN_FIELD_NONE};
    return n;
}

/* Does a measured triangle have the vertex? */
static bool measured(const struct surface *s, uint32_t vertex)
{
    const uint32_t first = s->mesh.out[vertex];
    uint32_t h = first;

    while (s->bridge[h / 3]) /* (Ghosts bridge.) */
        if ((h = mesh_turn(&s->mesh, h)) == first)
            return false;
    return true;
}

/* share(probe, step, pts): the points that align_load() made stand for equal shares of the surface,
 * but for those of no measured triangle.  Shares by the area of the triangles round each
 * vertex would depend on the side that the probe was scanned from, and so would the pose.
 * The surface's area is taken from ALIGN_AREA_TRIANGLES of its triangles. */
static void align_share(const struct surface *probe, uint32_t step,
                        struct align_point *pts)
{
    const struct mesh *m = &probe->mesh;
    const uint32_t each = stride_for(m->nt, ALIGN_AREA_TRIANGLES);
    uint32_t seen = 0;
    double twice = 0, area;

    for (uint32_t t = 0; t < m->nt; t += each) {
        const uint32_t *v = &m->org[3 * t];
        struct dvec3 a, n;

        if (probe->bridge[t])
            continue;
        a = lattice_to_mm(m->xy[v[0]], m->z[v[0]]);
        n = vec_cross(vec_sub(lattice_to_mm(m->xy[v[1]], m->z[v[1]]), a),
                      vec_sub(lattice_to_mm(m->xy[v[2]], m->z[v[2]]), a));
        twice += sqrt(vec_dot(n, n));
    }
    for (uint32_t v = 0, i = 0; v < m->nv; v += step, i++) {
        pts[i].area = measured(probe, v) ? 1.0f : 0.0f;
        seen += pts[i].area > 0.0f;
    }
    area = 0.5 * twice * each / (seen > 0 ? seen : 1);
    for (uint32_t v = 0, i = 0; v < m->nv; v += step, i++)
        pts[i].area *= (float)area;
}

/* between(to, from, by_nose, pose): the pose that moves the axes `from` onto `to`, centre to
 * centre or nose to nose. */
static void between(const struct pose_axes *to, const struct pose_axes *from,
                    bool by_nose, struct pose *pose)
{
    const struct dvec3 *a = to->axis, *b = from->axis;
    const struct dvec3 p = by_nose ? from->nose : from->centre;
    const struct dvec3 q = by_nose ? to->nose : to->centre;
    struct dvec3 moved;

    for (int i = 0; i < 9; i++)
        pose->r[i] = 0.0;
    for (int k = 0; k < 3; k++) {
        const double to_k[3] = {a[k].x, a[k].y, a[k].z};
        const double from_k[3] = {b[k].x, b[k].y, b[k].z};

        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                pose->r[3 * i + j] += to_k[i] * from_k[j];
    }
    memset(pose->t, 0, sizeof pose->t);
    moved = pose_apply(pose, p);
    pose->t[0] = q.x - moved.x;
    pose->t[1] = q.y - moved.y;
    pose->t[2] = q.z - moved.z;
}

/* A start: the probe's axes moved onto the template's, or the probe as it was scanned; the
 * centres or the noses in one place; then tilted (tangents of the half angles). */
struct start {
    bool as_is, by_nose;
    double yaw, pitch;
};

#define AXES  ALIGN_TILT_AXES
#define AS_IS ALIGN_TILT_AS_IS
static const struct start starts[] = {
    {false, true, 0.0, 0.0},    {false, false, 0.0, 0.0},  {true, true, 0.0, 0.0},
    {true, false, 0.0, 0.0},    {false, true, AXES, 0.0},  {false, true, -AXES, 0.0},
    {false, true, 0.0, AXES},   {false, true, 0.0, -AXES}, {true, false, AS_IS, 0.0},
    {true, false, -AS_IS, 0.0}, {true, false, 0.0, AS_IS}, {true, false, 0.0, -AS_IS},
};

static void start_pose(const struct start *st, const struct pose_axes *tmpl,
                       const struct pose_axes *probe, struct pose *pose)
{
    static const struct dvec3 scanner[3] = {
        {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    struct pose_axes a = *tmpl, b = *probe;
    struct dvec3 back = st->by_nose ? tmpl->nose : tmpl->centre;

    if (st->as_is) {
        memcpy(a.axis, scanner, sizeof scanner);
        memcpy(b.axis, scanner, sizeof scanner);
    }
    between(&a, &b, st->by_nose, pose);
    back.z -= POSE_LEVER_MM;
    pose_tilt(pose, back, st->yaw, st->pitch);
}

/* same(s, a, b): do both poses put the surface in the same place?  Three points of the
 * template are moved by the inverse of a and then by b. */
static bool align_same(const struct align_searching *s, const struct pose *a,
                       const struct pose *b)
{
    static const double offset[3][3] = {
        {50, 0, POSE_LEVER_MM}, {-50, 0, POSE_LEVER_MM}, {0, 70, POSE_LEVER_MM}};

    for (int i = 0; i < 3; i++) {
        const struct dvec3 q = {s->centre.x + offset[i][0] - a->t[0],
                                s->centre.y + offset[i][1] - a->t[1],
                                s->centre.z + offset[i][2] - a->t[2]};
        const double *r = a->r;
        const struct dvec3 p = {r[0] * q.x + r[3] * q.y + r[6] * q.z,
                                r[1] * q.x + r[4] * q.y + r[7] * q.z,
                                r[2] * q.x + r[5] * q.y + r[8] * q.z};
        const struct dvec3 m = pose_apply(b, p);
        const double dx = m.x - a->t[0] - q.x, dy = m.y - a->t[1] - q.y;
        const double dz = m.z - a->t[2] - q.z;

        if (dx * dx + dy * dy + dz * dz > ALIGN_SAME_MM * ALIGN_SAME_MM)
            return false;
    }
    return true;
}

/* What was cropped lies in the frame already, and a part of a face, whose axes and nose mislead,
 * may come there from no other start: the pose is taken that is cheaper by far. */
static void try_as_it_lies(struct align_searching *s, uint32_t stride,
                           struct candidate best[2])
{
    struct candidate c = {.pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}};

    (void)descend(s, stride, SOLVE_LOSS_L1, ALIGN_STAGE_STEPS, ALIGN_COARSE_MM, &c);
    s->out->starts++;
    if (c.cost * ALIGN_RIVAL < best[0].cost) {
        best[1] = best[0];
        best[0] = c;
    }
}

/* choose(s, tmpl, probe, best): descend from the starts over few points until one is
 * clearly good.  best[0] and best[1] become the two cheapest poses in different places. */
static void align_choose(struct align_searching *s, const struct surface *tmpl,
                         const struct surface *probe, struct candidate best[2])
{
    const uint32_t stride = stride_for(s->n, ALIGN_COARSE_POINTS);
    const struct pose *given = s->how->start;
    const struct pose_axes *to = s->how->axes;
    struct pose_axes made, from; /* when they are needed */
    uint32_t agreed = 0;         /* starts that led to best[0] */
    bool framed = false;

    best[0].cost = best[1].cost = INFINITY;
    for (size_t i = given != NULL ? 0 : 1; i <= sizeof starts / sizeof *starts; i++) {
        struct candidate c;
        bool again;

        if (i > 0 && !framed) {
            if (to == NULL) {
                pose_find_axes(tmpl, &made);
                to = &made;
            }
            pose_find_axes(probe, &from);
            framed = true;
        }
        if (i == 0)
            c.pose = *given;
        else
            start_pose(&starts[i - 1], to, &from, &c.pose);
        (void)descend(s, stride, SOLVE_LOSS_L1, ALIGN_STAGE_STEPS, ALIGN_COARSE_MM, &c);
        s->out->starts++;
        again = best[0].cost < INFINITY && align_same(s, &best[0].pose, &c.pose);
        agreed = again ? agreed + (agreed < AGREED) : c.cost < best[0].cost ? 1 : agreed;
        if (c.cost < best[0].cost) {
            if (!again)
                best[1] = best[0];
            best[0] = c;
        } else if (!again && c.cost < best[1].cost) {
            best[1] = c;
        }
        if (best[0].within > ALIGN_GOOD_WITHIN && best[0].cost < good_mm[agreed])
            break;
    }
    if (s->how->grid != NULL && best[0].cost >= ALIGN_GOOD_MM)
        try_as_it_lies(s, stride, best);
}

/* settle(s, w, pose): the last step, which separates motion from change. */
static enum status align_settle(struct align_searching *s, struct align_work *w,
                                struct pose *pose)
{
    const struct pose *frame = &s->how->u->frame;
    const double *r = frame->r;
    const double back[3] = {-frame->t[0], -frame->t[1], -POSE_LEVER_MM - frame->t[2]};
    const struct dvec3 lever = {r[0] * back[0] + r[3] * back[1] + r[6] * back[2],
                                r[1] * back[0] + r[4] * back[1] + r[7] * back[2],
                                r[2] * back[0] + r[5] * back[1] + r[8] * back[2]};
    struct cells cells;
    struct fit fit;
    double x[6], *d = fit.deviation;
    enum status st;

    cells_sample(&s->field, s->pts, s->n, pose, frame, &cells);
    st = fit_solve(s->how->motion, &cells, ALIGN_LAST_TIE, 1, &w->fit, &fit);
    if (st != ST_OK)
        return st;
    s->out->evaluations++;
    for (int k = 0; k < 6; k++) { /* from the frame to the template */
        const int b = k < 3 ? 0 : 3;

        x[k] = r[k - b] * fit.x[b] + r[k - b + 3] * fit.x[b + 1] +
               r[k - b + 6] * fit.x[b + 2];
    }
    pose_move(pose, lever, x);
    s->out->turn_deg = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * VEC_DEGREES;
    s->out->shift_mm = sqrt(d[3] * d[3] + d[4] * d[4] + d[5] * d[5]);
    return ST_OK;
}

void align_work_free(struct align_work *w)
{
    scratch_free(&w->field);
    scratch_free(&w->fit);
}

void align_work_wipe(struct align_work *w, size_t keep)
{
    scratch_wipe(&w->field, keep);
    scratch_wipe(&w->fit, keep);
}

enum status align_search(const struct surface *tmpl, const struct surface *probe,
                         const struct align_how *how, struct align_work *w,
                         struct align_result *out)
{
    const uint32_t step =
        stride_for(probe->mesh.nv, tmpl == NULL ? FRAME_POINTS : ALIGN_LAST_POINTS);
    struct align_searching search = {.stretch = 1.0, .how = how, .out = out};
    struct candidate best[2];
    enum status st = ST_OK;
    bool rival;

    search.pts =
        scratch_need(&w->field, (probe->mesh.nv / step + 1) * sizeof *search.pts);
    if (search.pts == NULL)
        return ST_ENOMEM;
    memset(out, 0, sizeof *out);
    out->turn_deg = out->shift_mm = INFINITY;
    search.n = align_load(probe, step, search.pts);
    if (tmpl == NULL) {
        search.stretch = FRAME_STRETCH;
    } else {
        align_field_make(tmpl, how->u, &search.field);
        align_share(probe, step, search.pts);
    }
    search.centre = how->axes != NULL ? how->axes->centre : pose_centre(&tmpl->mesh);
    search.centre.z -= POSE_LEVER_MM;

    align_choose(&search, tmpl, probe, best);
    rival = best[0].cost >= ALIGN_GOOD_MM && best[1].cost < ALIGN_RIVAL * best[0].cost;
    (void)descend(&search, stride_for(search.n, ALIGN_MIDDLE_POINTS), SOLVE_LOSS_L1,
                  ALIGN_STAGE_STEPS, ALIGN_MIDDLE_MM, &best[0]);
    if (rival)
        (void)descend(&search, stride_for(search.n, ALIGN_MIDDLE_POINTS), SOLVE_LOSS_L1,
                      ALIGN_STAGE_STEPS, ALIGN_MIDDLE_MM, &best[1]);
    if (rival && best[1].cost < best[0].cost) {
        const struct candidate swap = best[0];

        best[0] = best[1];
        best[1] = swap;
    }
    out->cost_mm = best[0].cost;
    out->rival_mm = best[1].cost;
    out->within = best[0].within;
    out->stop =
        descend(&search, stride_for(search.n, ALIGN_TUKEY_POINTS), SOLVE_LOSS_TUKEY,
                ALIGN_STAGE_STEPS, ALIGN_TUKEY_STEP_MM, &best[0])
            ? ALIGN_CONVERGED
            : ALIGN_STEPS;
    if (best[0].within < ALIGN_APART_WITHIN)
        out->stop = ALIGN_APART;
    else if (how->u != NULL && how->motion != NULL && how->motion->b->n > 0)
        st = align_settle(&search, w, &best[0].pose);
    pose_to_matrix(&best[0].pose, out->transform);
    return st;
}

const char *align_stop_name(enum align_stop stop)
{
    return stop == ALIGN_CONVERGED ? "converged"
           : stop == ALIGN_STEPS   ? "steps"
                                   : "apart";
}
