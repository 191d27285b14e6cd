#include "find.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "face.h"
#include "face_work.h"
#include "find_view.h"
#include "mem.h"
#include "select.h"
#include "shape.h"

/* The fit score of eyes that are as the mean face's. */
#define FIND_WORTH_EYES 200.0

/* The fit score of a face within 45 degrees (1 + 2 cos) of upright before a scanner; of a probable face,
 * so that other units are not tried; and of a rough fit that is refined at once. */
#define FIND_UPRIGHT       560.0
#define FIND_UPRIGHT_TRACE 2.4142
#define FIND_LIKELY        350.0
#define FIND_SURE          400.0

/* mm: the longest side of a head with shoulders, and of a room, without one point in STRAY_IN at
 * either end, or one in STRAYS_IN if that finds no face.  The smallest crops are 130 mm, of a child of
 * five 90, busts 500. */
#define FIND_HEAD_MIN_MM 80
#define FIND_ROOM_MIN_MM 900
#define FIND_ROOM_MAX_MM 6000
#define FIND_STRAY_IN    100
#define FIND_STRAYS_IN   10

/* Numbers of starts that are fitted roughly (SEEKS), and of rough fits that are refined (FITS): along a
 * scanner's axes, without a definite face MORE of them; from the OTHER sides, and the LAST of these. */
#define FIND_SEEKS        12
#define FIND_FITS         4
#define FIND_SEEKS_MORE   16
#define FIND_FITS_MORE    6
#define FIND_SEEKS_OTHERS 30
#define FIND_FITS_OTHERS  6
#define FIND_SEEKS_LAST   16
#define FIND_FITS_LAST    4

/* The budget of a search, in noses, of some 4 us each (find_view_all()), and one more for PER points
 * each.  A fit costs FIT and one for FAR cubes.  A head that may be small has the budget SMALL, and
 * the rest of the points' share. */
#define FIND_SPENT       4600
#define FIND_SPENT_SMALL 1120
#define FIND_SPENT_ONCE  300
#define FIND_SPENT_PER   12
#define FIND_SPENT_FIT   25
#define FIND_SPENT_FAR   1000

/* A child's head, upright before a scanner, is searched for as if it were SMALL times as large; its fit
 * score must be higher by SMALL_COST. */
#define FIND_SMALL      1.25
#define FIND_SMALL_COST 80.0

/* Without a definite face, poses with this share of the best fit score are reported too. */
#define FIND_RIVAL 0.75

/* mm: the place of the nose in a face that was fitted upside down. */
#define FIND_WAY_UP_MM 56.0

/* Poses are the same within MM and 10 degrees (1 + 2 cos).  The nose of another face is OTHER_MM
 * away, and its start costs less than COST. */
#define FIND_SAME_MM    10.0
#define FIND_SAME_TRACE 2.9696
#define FIND_OTHER_MM   120.0
#define FIND_OTHER_COST 18.0

#define SAMPLE 2048
#define FOUND  16

struct extent {
    struct dvec3 middle; /* in the points' unit */
    double size;
};

static double coordinate(struct dvec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* Measures a sample of the points, without every share-th point at either end of each axis. */
static void measure_extent(const struct dvec3 *pts, size_t n, size_t share,
                           struct extent *out)
{
    const size_t m = n < SAMPLE ? n : SAMPLE;
    double v[SAMPLE], middle[3];

    *out = (struct extent){0};
    if (m == 0)
        return;
    for (int axis = 0; axis < 3; axis++) {
        double size;

        for (size_t i = 0; i < m; i++)
            v[i] = coordinate(pts[i * n / m], axis);
        size = select_kth(v, m, m - 1 - m / share) - select_kth(v, m, m / share);
        out->size = size > out->size ? size : out->size;
        middle[axis] = select_kth(v, m, m / 2);
    }
    out->middle = (struct dvec3){middle[0], middle[1], middle[2]};
}

struct found {
    struct find_pose pose;
    struct dvec3 nose; /* the tip, mm, in the points' axes */
};

/* By falling worth, no two the same. */
struct find_list {
    struct found at[FOUND];
    uint32_t n;
};

/* One call of find_face(). */
struct finder {
    const struct dvec3 *pts;
    size_t n;
    double unit_mm; /* 0: to be found */
    double size;    /* factor of the points; 1, or FIND_SMALL */
    struct shape_work *shape;
    const struct surface_stop *stop; /* NULL: none */
    struct extent extent;
    struct find_view_face face;
    struct find_starts starts;
    struct find_list rough, best;
};

/* Returns true if the caller cancels, or the budget is spent. */
static bool stopped(const struct finder *f)
{
    return f->starts.left <= 0 || (f->stop != NULL && f->stop->wanted(f->stop->arg));
}

static bool found(const struct finder *f, double worth)
{
    return f->best.n > 0 && f->best.at[0].pose.worth >= worth;
}

/* ---- poses */

static bool near(struct dvec3 a, struct dvec3 b, double mm)
{
    const struct dvec3 way = vec_sub(a, b);

    return vec_dot(way, way) < mm * mm;
}

/* Returns true if both are less than FIND_SAME_MM and FIND_SAME_TRACE apart. */
static bool find_is_same(const struct found *a, const struct found *b)
{
    const struct pose d = pose_after(&a->pose.pose, &b->pose.pose);

    return a->pose.unit_mm == b->pose.unit_mm && near(a->nose, b->nose, FIND_SAME_MM) &&
           d.r[0] + d.r[4] + d.r[8] > FIND_SAME_TRACE;
}

/* Returns the index of the pose that is the same; l->n: none. */
static uint32_t place_of(const struct find_list *l, const struct found *one)
{
    uint32_t i = 0;

    while (i < l->n && !find_is_same(&l->at[i], one))
        i++;
    return i;
}

static void find_take(struct find_list *l, const struct found *one)
{
    uint32_t i = place_of(l, one);

    if (i < l->n && one->pose.worth <= l->at[i].pose.worth)
        return;
    if (i == l->n && i < FOUND)
        l->n++;
    else if (i == l->n && one->pose.worth <= l->at[--i].pose.worth)
        return;
    for (; i > 0 && one->pose.worth > l->at[i - 1].pose.worth; i--)
        l->at[i] = l->at[i - 1];
    l->at[i] = *one;
}

/* Returns true if a definite face is there, or has another unit. */
static bool taken(const struct finder *f, const struct found *one)
{
    const struct found *best = f->best.at;

    for (uint32_t i = 0; i < f->best.n && best[i].pose.worth >= FIND_PLAIN; i++)
        if (best[i].pose.unit_mm != one->pose.unit_mm ||
            near(best[i].nose, one->nose, FIND_OTHER_MM))
            return true;
    return false;
}

/* A pose of points as one of the same points, each less by so much. */
static struct pose less(const struct pose *pose, double by, struct dvec3 way)
{
    struct pose out = *pose;

    for (int i = 0; i < 3; i++)
        out.t[i] += by * (out.r[3 * i] * way.x + out.r[3 * i + 1] * way.y +
                          out.r[3 * i + 2] * way.z);
    return out;
}

/* A pose of g's cubes, of a head that seems f->size as large as it is, as one of the points in mm,
 * and back. */
static struct found found_at(const struct finder *f, const struct find_grid *g,
                             double unit_mm, const struct pose *pose, double worth)
{
    struct pose p = less(pose, -1, g->corner);

    for (int i = 0; i < 3; i++)
        p.t[i] /= f->size;
    return (struct found){{unit_mm, p, worth}, pose_origin(&p)};
}

static struct pose in_grid(const struct finder *f, const struct find_grid *g,
                           const struct pose *pose)
{
    struct pose p = *pose;

    for (int i = 0; i < 3; i++)
        p.t[i] *= f->size;
    return less(&p, 1, g->corner);
}

/* What a face shows that other things, and a face the wrong way up, hardly do. */
static double worth_of(const struct shape_fit *fit)
{
    return fit->worth + FIND_WORTH_EYES * fmax(fit->eyes, 0);
}

static enum status fit_roughly(struct finder *f, const struct find_grid *g,
                               double unit_mm, const struct pose *start,
                               struct found *out)
{
    struct shape_fit fit;
    const enum status st = shape_seek(f->shape, g->at, g->n, start, false, &fit);

    f->starts.left -= FIND_SPENT_FIT + g->n / FIND_SPENT_FAR;
    *out = found_at(f, g, unit_mm, &fit.pose, fit.worth);
    return st;
}

static enum status fit_closely(struct finder *f, const struct find_grid *g,
                               const struct found *rough)
{
    const struct pose start = in_grid(f, g, &rough->pose.pose);
    struct shape_fit fit;
    const enum status st = shape_seek(f->shape, g->at, g->n, &start, true, &fit);

    f->starts.left -= FIND_SPENT_FIT + g->n / FIND_SPENT_FAR;
    if (st == ST_OK) {
        const struct found one =
            found_at(f, g, rough->pose.unit_mm, &fit.pose,
                     worth_of(&fit) - (f->size == 1 ? 0 : FIND_SMALL_COST));

        find_take(&f->best, &one);
    }
    return st;
}

/* Fits `left` starts roughly, from start `from` on, and refines the `most` best fits.  Once a face is
 * definite, only starts elsewhere that are probably another face. */
static enum status seek(struct finder *f, const struct find_grid *g, double unit_mm,
                        uint32_t from, uint32_t left, uint32_t most)
{
    enum status st = ST_OK;

    f->rough.n = 0;
    for (uint32_t k = from; k < f->starts.n && left > 0 && st == ST_OK && !stopped(f);
         k++) {
        const struct find_start *start = &f->starts.start[k];
        struct found one = found_at(f, g, unit_mm, &start->pose, 0);

        if (taken(f, &one) || (found(f, FIND_PLAIN) && start->cost > FIND_OTHER_COST))
            continue;
        left--;
        st = fit_roughly(f, g, unit_mm, &start->pose, &one);
        if (st == ST_OK && one.pose.worth >= FIND_SURE)
            st = fit_closely(f, g, &one);
        else {
            one.pose.worth /= (double)start->odds;
            find_take(&f->rough, &one);
        }
    }
    for (uint32_t k = 0; k < f->rough.n && k < most && st == ST_OK && !stopped(f); k++)
        if (!taken(f, &f->rough.at[k]))
            st = fit_closely(f, g, &f->rough.at[k]);
    return st;
}

/* Refines the best pose again, and turned upside down: a face upside down resembles one, whose nose is
 * between its brows. */
static enum status turn_over(struct finder *f, const struct find_grid *g, double unit_mm)
{
    struct pose over = f->best.at[0].pose.pose;
    struct found one;
    enum status st;

    if (f->best.n == 0 || found(f, FIND_PLAIN) || stopped(f))
        return ST_OK;
    for (int k = 0; k < 6; k++)
        over.r[k] = -over.r[k];
    over.t[0] = -over.t[0];
    over.t[1] = FIND_WAY_UP_MM - over.t[1];
    over = in_grid(f, g, &over);
    one = f->best.at[0];
    if ((st = fit_closely(f, g, &one)) == ST_OK &&
        (st = fit_roughly(f, g, unit_mm, &over, &one)) == ST_OK)
        st = fit_closely(f, g, &one);
    return st;
}

/* ---- sides and units */

/* Returns true if there is a face that is upright before a scanner, of agreed axes or a camera's, as most
 * are.  It may show less of itself. */
static bool upright(const struct finder *f)
{
    const double *r = f->best.at[0].pose.pose.r;

    return found(f, FIND_UPRIGHT) && r[0] + fabs(r[4] + r[8]) > FIND_UPRIGHT_TRACE;
}

/* Along the agreed axes or a camera's; or from all other sides: to the faces, edges and corners
 * of a cube. */
static void find_look(struct finder *f, const struct find_grid *g, bool others,
                      struct find_view_room *r)
{
    f->starts.n = 0;
    for (int k = 0; k < 27 && !stopped(f); k++) {
        const struct dvec3 axis = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};

        if (k != 13 && (axis.x != 0 || axis.y != 0) == others)
            find_view_all(&f->face, g, axis, r, &f->starts);
    }
}

/* Returns true if there is a face, so that nothing else is tried. */
static bool sure(const struct finder *f)
{
    return found(f, FIND_PLAIN) || upright(f);
}

/* Among the starts of other sides that of a noisy face may be far behind; a head that may be small is not
 * looked for so long. */
static enum status seek_others(struct finder *f, const struct find_grid *g,
                               double unit_mm)
{
    enum status st = seek(f, g, unit_mm, 0, FIND_SEEKS_OTHERS, FIND_FITS_OTHERS);

    if (st == ST_OK)
        st = turn_over(f, g, unit_mm);
    if (st == ST_OK && f->size == 1 && !sure(f))
        st = seek(f, g, unit_mm, FIND_SEEKS_OTHERS, FIND_SEEKS_LAST, FIND_FITS_LAST);
    return st;
}

static enum status search_grid(struct finder *f, const struct find_grid *g,
                               double unit_mm)
{
    struct find_view_room r;
    enum status st = find_view_open(g, &r);

    if (st != ST_OK)
        return st;
    find_look(f, g, false, &r);
    st = seek(f, g, unit_mm, 0, FIND_SEEKS, FIND_FITS);
    if (st == ST_OK && f->size == 1 && !sure(f))
        st = seek(f, g, unit_mm, FIND_SEEKS, FIND_SEEKS_MORE, FIND_FITS_MORE);
    if (st == ST_OK)
        st = turn_over(f, g, unit_mm);
    if (st == ST_OK && !sure(f)) {
        find_look(f, g, true, &r);
        st = seek_others(f, g, unit_mm);
    }
    find_view_close(&r);
    return st;
}

static enum status search(struct finder *f, double unit_mm)
{
    const struct dvec3 m = f->extent.middle;
    struct find_grid g;
    const double mm = unit_mm * f->size;
    enum status st = find_grid_make(f->pts, f->n, mm,
                                    (struct dvec3){m.x * mm, m.y * mm, m.z * mm}, &g);

    if (st == ST_OK)
        st = search_grid(f, &g, unit_mm);
    find_grid_free(&g);
    return st;
}

/* Returns true if other units need not be tried: there is a probable face, or, of a head that may not be
 * of the usual size, a definite one. */
static bool enough(const struct finder *f)
{
    return f->size == 1 ? found(f, FIND_LIKELY) : sure(f);
}

/* By each unit that makes the cloud as large as that, until there is enough. */
static enum status search_units(struct finder *f, double from_mm, double to_mm)
{
    static const double units[] = FIND_UNITS_MM;
    const size_t n = f->unit_mm > 0 ? 1 : sizeof units / sizeof *units;
    enum status st = ST_OK;

    for (size_t i = 0; i < n && st == ST_OK && !enough(f) && !stopped(f); i++) {
        const double mm = f->unit_mm > 0 ? f->unit_mm : units[i];

        if (f->extent.size * mm >= from_mm && f->extent.size * mm < to_mm)
            st = search(f, mm);
    }
    return st;
}

/* As large as a head, then as a room. */
static enum status search_extent(struct finder *f)
{
    const enum status st = search_units(f, FIND_HEAD_MIN_MM, FIND_ROOM_MIN_MM);

    return st == ST_OK ? search_units(f, FIND_ROOM_MIN_MM, FIND_ROOM_MAX_MM) : st;
}

/* Returns the rest of the budget, up to the share of the points. */
static int64_t spare(const struct finder *f)
{
    const int64_t most = (int64_t)(f->n / FIND_SPENT_PER);

    return f->starts.left < 0 ? 0 : f->starts.left < most ? f->starts.left : most;
}

/* Searches the points as they are; once more if many are strays; and as if a child's head were larger. */
static enum status search_all(struct finder *f)
{
    static const size_t strays[] = {FIND_STRAY_IN, FIND_STRAYS_IN};
    enum status st = ST_OK;

    for (int i = 0; i < 2 && st == ST_OK; i++) {
        struct extent extent;

        measure_extent(f->pts, f->n, strays[i], &extent);
        if (i > 0 && !(extent.size < f->extent.size / 2))
            break;
        f->extent = extent;
        st = search_extent(f);
    }
    if (st == ST_OK && !sure(f)) {
        f->size = FIND_SMALL;
        f->unit_mm = found(f, FIND_LIKELY) ? f->best.at[0].pose.unit_mm : f->unit_mm;
        f->starts.left = spare(f) + FIND_SPENT_SMALL;
        st = search_extent(f);
    }
    if (f->stop != NULL && f->stop->wanted(f->stop->arg))
        return ST_EBUSY;
    return st;
}

/* ---- what is reported */

/* Returns true if best[i] is a definite face, and another one than those before it. */
static bool another(const struct finder *f, uint32_t i)
{
    for (uint32_t k = 0; k < i; k++)
        if (near(f->best.at[i].nose, f->best.at[k].nose, FIND_OTHER_MM))
            return false;
    return f->best.at[i].pose.worth >= FIND_PLAIN;
}

/* How near the nose is to a scanner with the agreed axes (side 1) or a camera's (-1: y down
 * and z away), if the face is turned to it; else false. */
static bool nearness(const struct found *f, double side, double *near)
{
    *near = side * f->nose.z;
    return side * f->pose.pose.r[8] >= FIND_FACING;
}

/* Returns true if a is nearer than b, and both look at one scanner. */
static bool nearer(const struct found *a, const struct found *b)
{
    double near_a, near_b;

    for (int side = 1; side >= -1; side -= 2)
        if (nearness(a, side, &near_a) && nearness(b, side, &near_b))
            return near_a > near_b;
    return false;
}

/* Of several plain faces the nearest; else the best poses, of one unit. */
static void find_choose(const struct finder *f, struct find_result *out)
{
    uint32_t first = 0;

    out->faces = 1;
    for (uint32_t i = 1; i < f->best.n; i++) {
        if (!another(f, i))
            continue;
        out->faces++;
        first = nearer(&f->best.at[i], &f->best.at[first]) ? i : first;
    }
    out->pose[out->n++] = f->best.at[first].pose;
    if (found(f, FIND_PLAIN))
        return;
    for (uint32_t i = 1; i < f->best.n && out->n < FIND_POSES; i++)
        if (f->best.at[i].pose.unit_mm == out->pose[0].unit_mm &&
            f->best.at[i].pose.worth >= FIND_RIVAL * out->pose[0].worth)
            out->pose[out->n++] = f->best.at[i].pose;
}

double find_extent(const struct dvec3 *pts, size_t n)
{
    struct extent extent;

    measure_extent(pts, n, FIND_STRAY_IN, &extent);
    return extent.size;
}

/* Searches the points, in mm, as they are. */
static enum status search_once(struct finder *f)
{
    measure_extent(f->pts, f->n, FIND_STRAY_IN, &f->extent);
    return search(f, 1);
}

static enum status find_run(const struct dvec3 *pts, size_t n, double unit_mm,
                            int64_t spend, enum status (*how)(struct finder *f),
                            struct surface_work *w, const struct surface_stop *stop,
                            struct find_result *out)
{
    struct finder *f;
    enum status st;

    memset(out, 0, sizeof *out);
    if (n == 0)
        return ST_ENOFACE;
    if ((f = mem_array(1, sizeof *f)) == NULL)
        return ST_ENOMEM;
    f->pts = pts;
    f->n = n;
    f->unit_mm = unit_mm;
    f->size = 1;
    f->shape = &w->shape;
    f->stop = stop;
    f->starts.left = spend;
    f->best.n = 0;
    find_view_prepare(&w->mean, &f->face);
    st = how(f);
    if (st == ST_OK && f->best.n == 0)
        st = ST_ENOFACE;
    if (st == ST_OK)
        find_choose(f, out);
    mem_free(f);
    return st;
}

enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      struct surface_work *w, const struct surface_stop *stop,
                      struct find_result *out)
{
    return find_run(pts, n, unit_mm, FIND_SPENT + (int64_t)(n / FIND_SPENT_PER),
                    search_all, w, stop, out);
}

enum status find_once(const struct dvec3 *pts, size_t n, struct surface_work *w,
                      const struct surface_stop *stop, struct find_result *out)
{
    return find_run(pts, n, 1, FIND_SPENT_ONCE, search_once, w, stop, out);
}
