#include "cloudlist.h"

#include <math.h>
#include <string.h>

#include "errinfo.h"
#include "mem.h"

#define FIRST_ROOM 1024
#define MARKS      4 /* numbers that stand for no value, in one file */

static enum status cloudlist_no_memory(const struct cloudlist *l)
{
    return errinfo_set(l->e, ST_ENOMEM, "no memory for the points");
}

/* *array with room for `room`, of n elements; where it is NULL it remains so. */
static bool enlarge(void **array, size_t n, size_t room, size_t size)
{
    void *larger;

    if (*array == NULL)
        return true;
    if ((larger = mem_array(room, size)) == NULL)
        return false;
    memcpy(larger, *array, n * size);
    mem_free(*array);
    *array = larger;
    return true;
}

static enum status cloudlist_grow(struct cloudlist *l)
{
    struct cloudpoints *out = &l->out;
    const size_t twice = 2 * l->room, room = twice < l->max ? twice : l->max;
    void *at = out->at, *normal = out->normal, *index = out->index;
    bool done;

    if (l->room == l->max)
        return errinfo_set(l->e, ST_ELIMIT, "more points than the limit of %zu", l->max);
    done = enlarge(&at, out->n, room, sizeof *out->at) &&
           enlarge(&normal, out->n, room, sizeof *out->normal) &&
           enlarge(&index, out->n, room, sizeof *out->index);
    out->at = at;
    out->normal = normal;
    out->index = index;
    if (!done)
        return cloudlist_no_memory(l);
    if (normal != NULL)
        memset(out->normal + out->n, 0, (room - out->n) * sizeof *out->normal);
    l->room = room;
    return ST_OK;
}

enum status cloudlist_room(struct cloudlist *l, size_t n)
{
    l->room = n < l->max ? n : l->max;
    if (l->room == 0)
        l->room = 1; /* so that it can be doubled */
    l->out.at = mem_array(l->room, sizeof *l->out.at);
    return l->out.at != NULL ? ST_OK : cloudlist_no_memory(l);
}

/* The point read last is not kept: from now on places differ from indices. */
static enum status cloudlist_drop(struct cloudlist *l)
{
    struct cloudpoints *out = &l->out;

    l->kept = false;
    if (out->index != NULL)
        return ST_OK;
    if ((out->index = mem_array(l->room, sizeof *out->index)) == NULL)
        return cloudlist_no_memory(l);
    for (size_t i = 0; i < out->n; i++)
        out->index[i] = (uint32_t)i;
    return ST_OK;
}

enum status cloudlist_add(struct cloudlist *l, struct dvec3 p)
{
    struct cloudpoints *out = &l->out;
    const bool zero = p.x == 0 && p.y == 0 && p.z == 0;
    enum status st;

    if (out->at == NULL && (st = cloudlist_room(l, FIRST_ROOM)) != ST_OK)
        return st;
    if (out->read == UINT32_MAX)
        return errinfo_set(l->e, ST_ELIMIT, "more points than can be counted");
    out->read++;
    l->zeros += zero;
    if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z) || (zero && l->zeros > 1))
        return cloudlist_drop(l);
    if (out->n == l->room && (st = cloudlist_grow(l)) != ST_OK)
        return st;
    if (zero)
        l->zero = out->n;
    if (out->index != NULL)
        out->index[out->n] = (uint32_t)(out->read - 1);
    out->at[out->n++] = p;
    l->kept = true;
    return ST_OK;
}

static enum status need_normals(struct cloudlist *l)
{
    struct cloudpoints *out = &l->out;

    if (out->normal != NULL || out->at == NULL)
        return ST_OK;
    if ((out->normal = mem_array(l->room, sizeof *out->normal)) == NULL)
        return cloudlist_no_memory(l);
    memset(out->normal, 0, l->room * sizeof *out->normal);
    return ST_OK;
}

enum status cloudlist_point(struct cloudlist *l, const double v[6], bool normals)
{
    enum status st = cloudlist_add(l, (struct dvec3){v[0], v[1], v[2]});

    if (st == ST_OK && normals)
        st = need_normals(l);
    if (st == ST_OK && normals && l->kept && isfinite(v[3]) && isfinite(v[4]) &&
        isfinite(v[5]))
        l->out.normal[l->out.n - 1] = (struct dvec3){v[3], v[4], v[5]};
    return st;
}

enum status cloudlist_rows(struct cloudlist *l, const struct cloudlist_column c[6],
                           bool normals, uint64_t n)
{
    const int values = normals ? 6 : 3;
    enum status st = ST_OK;

    for (uint64_t i = 0; i < n && st == ST_OK; i++) {
        double v[6];

        for (int k = 0; k < values; k++)
            v[k] = cloudvalue_load(c[k].at + i * c[k].step, c[k].type, c[k].swap);
        st = cloudlist_point(l, v, normals);
    }
    return st;
}

/* Where the point of a place is in out; out->n: it was dropped. */
static size_t cloudlist_find(const struct cloudpoints *out, uint64_t place)
{
    size_t low = 0, high = out->n;

    if (out->index == NULL)
        return (size_t)place;
    while (low < high) {
        const size_t mid = low + (high - low) / 2;

        if (out->index[mid] < place)
            low = mid + 1;
        else
            high = mid;
    }
    return low < out->n && out->index[low] == place ? low : out->n;
}

enum status cloudlist_face(struct cloudlist *l, const uint64_t corner[3])
{
    struct cloudpoints *out = &l->out;
    struct dvec3 normal;
    size_t at[3];
    enum status st;

    if (l->faceless)
        return ST_OK;
    for (int i = 0; i < 3; i++) {
        if (corner[i] >= out->read) {
            cloudlist_forget(l);
            return ST_OK;
        }
        if ((at[i] = cloudlist_find(out, corner[i])) == out->n)
            return ST_OK;
    }
    if ((st = need_normals(l)) != ST_OK)
        return st;
    normal = vec_cross(vec_sub(out->at[at[1]], out->at[at[0]]),
                       vec_sub(out->at[at[2]], out->at[at[0]]));
    for (int i = 0; i < 3; i++)
        out->normal[at[i]] = vec_along(out->normal[at[i]], 1, normal);
    return ST_OK;
}

enum status cloudlist_corner(struct cloudlist *l, struct cloudlist_fan *f, uint64_t k)
{
    uint64_t *const c = f->corner;
    enum status st;

    c[f->n < 2 ? f->n : 2] = k;
    if (++f->n < 3)
        return ST_OK;
    st = cloudlist_face(l, f->clockwise ? (const uint64_t[3]){c[0], c[2], c[1]} : c);
    c[1] = c[2];
    return st;
}

void cloudlist_forget(struct cloudlist *l)
{
    l->faceless = true;
    mem_free(l->out.normal);
    l->out.normal = NULL;
}

/* Take the first point at (0, 0, 0) out. */
static enum status drop_zero(struct cloudlist *l)
{
    struct cloudpoints *out = &l->out;
    const size_t i = l->zero, after = out->n - i - 1;
    enum status st = cloudlist_drop(l);

    if (st != ST_OK)
        return st;
    memmove(out->at + i, out->at + i + 1, after * sizeof *out->at);
    memmove(out->index + i, out->index + i + 1, after * sizeof *out->index);
    if (out->normal != NULL)
        memmove(out->normal + i, out->normal + i + 1, after * sizeof *out->normal);
    out->n--;
    return ST_OK;
}

static double distance(const struct cloudpoints *out, size_t i, int axis)
{
    const struct dvec3 p = out->at[i];

    return fabs(axis == 0 ? p.x : axis == 1 ? p.y : p.z);
}

/* The points that are as far from the origin as least, along an axis, have no value. */
static enum status drop_far(struct cloudlist *l, int axis, double least)
{
    struct cloudpoints *out = &l->out;
    enum status st = cloudlist_drop(l);
    size_t n = 0;

    for (size_t i = 0; st == ST_OK && i < out->n; i++) {
        if (distance(out, i, axis) >= least)
            continue;
        out->at[n] = out->at[i];
        out->index[n] = out->index[i];
        if (out->normal != NULL)
            out->normal[n] = out->normal[i];
        n++;
    }
    out->n = st == ST_OK ? n : out->n;
    return st;
}

/* The largest distance along an axis that is less than below, and how many points have it. */
static double farthest(const struct cloudpoints *out, int axis, double below, size_t *n)
{
    double most = 0;

    *n = 0;
    for (size_t i = 0; i < out->n; i++) {
        const double d = distance(out, i, axis);

        if (d >= below || d < most)
            continue;
        *n = d > most ? 1 : *n + 1;
        most = d;
    }
    return most;
}

/* How many points are as far as least along an axis. */
static size_t count_far(const struct cloudpoints *out, int axis, double least)
{
    size_t n = 0;

    for (size_t i = 0; i < out->n; i++)
        n += distance(out, i, axis) >= least;
    return n;
}

/* What programs write for "no value" beside 0 and NaN: one number for several points, twice as far as
 * all others (9999, 65.535, the end of a renderer's view); or anything beyond the range of cameras,
 * unless nearly all is, so that the unit is not what it is said to be. */
static enum status drop_marks(struct cloudlist *l)
{
    struct cloudpoints *out = &l->out;
    enum status st = ST_OK;

    for (int axis = 0; axis < 3; axis++) {
        const double range =
            out->unit_mm > 0 ? CLOUDLIST_RANGE_MM / out->unit_mm : (double)INFINITY;
        const size_t beyond = count_far(out, axis, range);

        if (beyond > 0 && beyond < out->n / 10 * 9)
            st = drop_far(l, axis, range);
        for (int i = 0; st == ST_OK && i < MARKS; i++) {
            size_t n, others;
            const double most = farthest(out, axis, (double)INFINITY, &n);
            const double next = farthest(out, axis, most, &others);

            if (n < 2 || next == 0 || most < 2 * next)
                break;
            st = drop_far(l, axis, most);
        }
        if (st != ST_OK)
            return st;
    }
    return st;
}

enum status cloudlist_finish(struct cloudlist *l)
{
    const bool organised = l->out.height > 1;
    enum status st = ST_OK;

    if (l->zeros > 1 || (l->zeros == 1 && organised))
        st = drop_zero(l);
    if (st == ST_OK && organised)
        st = drop_marks(l);
    if (st == ST_OK && l->out.n == 0 && l->out.read > 0)
        return errinfo_set(l->e, ST_ENOTFINITE,
                           "none of the %zu points has a value: each is NaN, infinite or "
                           "(0, 0, 0)",
                           l->out.read);
    return st;
}
