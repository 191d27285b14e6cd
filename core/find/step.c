#include "step.h"

#include <math.h>
#include <stdbool.h>

#include "select.h"

/* mm: the middle of a face, whose depths are looked at, in the canonical frame. */
#define STEP_SIDE_MM   50.0
#define STEP_BEFORE_MM 15.0
#define STEP_BEHIND_MM 60.0

/* The depths that are looked at, at most; and the fewest. */
#define STEP_DEPTHS 4096
#define STEP_LEAST  100

/* Depths are in steps if the gap between them is so many times as large as it would be if all were
 * evenly spread.  At random depths it would be twice as large on average. */
#define STEP_HEAP 6.0

/* Share of the range over which gaps are averaged, the smallest first: larger ones are of depths that
 * hardly a point has. */
#define STEP_SHARE 0.8

static double coordinate(struct dvec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

static bool on_face(const struct pose *view, struct dvec3 p)
{
    struct dvec3 q;

    if (view == NULL)
        return true;
    q = pose_apply(view, p);
    return fabs(q.x) < STEP_SIDE_MM && fabs(q.y) < STEP_SIDE_MM && q.z < STEP_BEFORE_MM &&
           q.z > -STEP_BEHIND_MM;
}

/* The axis nearest to a direction. */
static int axis_of(const double r[3])
{
    const int side = fabs(r[0]) > fabs(r[1]) ? 0 : 1;

    return fabs(r[2]) >= fabs(r[side]) ? 2 : side;
}

/* The depths of every k-th point on the face, sorted; how many. */
static size_t step_take(const struct dvec3 *pts, size_t n, const struct pose *view,
                        double depth[STEP_DEPTHS])
{
    const int axis = view != NULL ? axis_of(&view->r[6]) : 2;
    size_t on = 0, every, m = 0;

    for (size_t i = 0; i < n; i++)
        on += on_face(view, pts[i]);
    every = on / STEP_DEPTHS + 1;
    on = 0;
    for (size_t i = 0; i < n; i++)
        if (on_face(view, pts[i]) && on++ % every == 0)
            depth[m++] = coordinate(pts[i], axis);
    select_sort(depth, m);
    return m;
}

double step_of(const struct dvec3 *pts, size_t n, const struct pose *view)
{
    double depth[STEP_DEPTHS], gap[STEP_DEPTHS], range, sum = 0, length = 0;
    size_t m = step_take(pts, n, view, depth), first, last;

    if (m < STEP_LEAST)
        return 0;
    first = m / 20;
    last = m - 1 - first;
    range = depth[last] - depth[first];
    m = last - first;
    for (size_t i = 0; i < m; i++)
        gap[i] = depth[first + i + 1] - depth[first + i];
    select_sort(gap, m);
    for (size_t i = 0; i < m && length < STEP_SHARE * range; i++) {
        sum += gap[i] * gap[i];
        length += gap[i];
    }
    return sum > STEP_HEAP * range / (double)m * length ? sum / length : 0;
}
