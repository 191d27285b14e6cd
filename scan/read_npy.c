#include "read.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "clouddepth.h"
#include "cloudfile.h"
#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"

#define NPY_VALUES 16 /* that a point may have; with more it is the row of an image */

#define MAGIC "\x93NUMPY"

struct array {
    enum cloudvalue type; /* CLOUDVALUE_NONE: not said yet */
    bool big, fortran;
    int dims; /* 0: not said yet */
    /* rows, columns, and values of a pixel; and how many values from one to the next */
    uint64_t shape[3], step[3];
};

/* ---- the header */

/* Is this here, behind blanks?  Then it is passed over. */
static bool take(struct cloudtext *t, const char *what)
{
    const size_t len = strlen(what);

    cloudtext_blank(t);
    if ((size_t)(t->end - t->p) < len || memcmp(t->p, what, len) != 0)
        return false;
    t->p += len;
    return true;
}

static enum status read_type(struct cloudtext *t, struct array *a)
{
    static const struct {
        const char *name;
        enum cloudvalue type;
    } types[] = {{"f4'", CLOUDVALUE_F32}, {"f8'", CLOUDVALUE_F64},
                 {"i1'", CLOUDVALUE_I8},  {"u1'", CLOUDVALUE_U8},
                 {"i2'", CLOUDVALUE_I16}, {"u2'", CLOUDVALUE_U16},
                 {"i4'", CLOUDVALUE_I32}, {"u4'", CLOUDVALUE_U32}};

    a->big = take(t, "'>");
    if (a->big || take(t, "'<") || take(t, "'|"))
        for (size_t i = 0; i < sizeof types / sizeof *types; i++)
            if (take(t, types[i].name)) {
                a->type = types[i].type;
                return ST_OK;
            }
    return cloudtext_fail(
        t, ST_EVERSION, "an NPY type that is not read: f4, f8, or i and u of 1, 2 or 4");
}

static enum status read_shape(struct cloudtext *t, struct array *a)
{
    if (!take(t, "("))
        return cloudtext_fail(t, ST_EINVAL, "the shape of the array is expected here");
    for (a->dims = 0; !take(t, ")"); (void)take(t, ",")) {
        const char *word = t->p;

        while (t->p < t->end && *t->p >= '0' && *t->p <= '9')
            t->p++;
        if (a->dims == 3 ||
            !cloudtext_count(word, (size_t)(t->p - word), &a->shape[a->dims++]))
            return cloudtext_fail(t, ST_EVERSION, "a shape has up to three numbers");
    }
    return ST_OK;
}

static enum status read_member(struct cloudtext *t, struct array *a)
{
    if (take(t, "'descr':"))
        return read_type(t, a);
    if (take(t, "'shape':"))
        return read_shape(t, a);
    if (take(t, "'fortran_order':")) {
        a->fortran = take(t, "True");
        if (a->fortran || take(t, "False"))
            return ST_OK;
    }
    return cloudtext_fail(t, ST_EINVAL, "malformed NPY header");
}

/* A Python dictionary, behind its length; t moves to the data. */
static enum status read_header(struct cloudtext *t, struct array *a)
{
    struct cloudtext h = *t;
    size_t size, len;
    enum status st = ST_OK;

    if (!read_npy_is(t))
        return cloudtext_fail(t, ST_EINVAL, "an NPY file begins with \\x93NUMPY");
    size = t->p[6] == 1 ? 10 : 12;
    if (t->p[6] < 1 || t->p[6] > 3)
        return cloudtext_fail(t, ST_EVERSION, "NPY of another version than 1, 2 and 3");
    if ((size_t)(t->end - t->p) < size)
        return cloudtext_fail(t, ST_EINVAL, "the NPY header is cut off");
    len = (size_t)cloudvalue_load((const unsigned char *)t->p + 8,
                                  size == 10 ? CLOUDVALUE_U16 : CLOUDVALUE_U32,
                                  cloudvalue_swap(false));
    if ((size_t)(t->end - t->p) - size < len)
        return cloudtext_fail(t, ST_EINVAL, "the NPY header is cut off");
    h.p += size;
    t->p = h.end = h.p + len;
    if (!take(&h, "{"))
        return cloudtext_fail(&h, ST_EINVAL, "malformed NPY header");
    while (st == ST_OK && !take(&h, "}")) {
        st = read_member(&h, a);
        (void)take(&h, ",");
    }
    if (st == ST_OK && (a->type == CLOUDVALUE_NONE || a->dims == 0))
        return cloudtext_fail(&h, ST_EINVAL, "the NPY header has no type or no shape");
    return st;
}

/* ---- the values */

/* The steps of the array as it is, and that its values are all there is. */
static enum status check_size(struct cloudtext *t, struct array *a)
{
    const uint64_t size = cloudvalue_size[a->type], left = (uint64_t)(t->end - t->p);
    uint64_t n = 1;

    for (int i = 0; i < a->dims; i++) {
        const int k = a->fortran ? i : a->dims - 1 - i;

        a->step[k] = n;
        if (a->shape[k] > 0 && n > left / a->shape[k])
            return cloudtext_fail(t, ST_EINVAL, "the data ends before the array does");
        n *= a->shape[k];
    }
    if (n == 0)
        return cloudtext_fail(t, ST_EINVAL, "there are no points in it");
    if (n * size != left)
        return cloudtext_fail(t, ST_EINVAL, "the array takes %llu bytes, here are %llu",
                              (unsigned long long)(n * size), (unsigned long long)left);
    return ST_OK;
}

static bool is_point(uint64_t values)
{
    return values >= 3 && values <= NPY_VALUES;
}

/* Rows and columns of points, or of values. */
static enum status arrange(struct cloudtext *t, struct array *a)
{
    const struct array was = *a;

    if (a->dims == 2) {
        const bool points = is_point(a->shape[1]), flat = !points && a->shape[0] == 3;

        a->shape[2] = 1;
        if (points || flat) {
            a->shape[0] = was.shape[flat];
            a->step[0] = was.step[flat];
            a->shape[1] = 1;
            a->shape[2] = was.shape[!flat];
            a->step[2] = was.step[!flat];
        }
        if (points || flat || a->shape[1] > NPY_VALUES)
            return ST_OK;
    }
    if (a->dims == 3 && is_point(a->shape[2]))
        return ST_OK;
    return cloudtext_fail(t, ST_EVERSION,
                          "an array of a shape that is not read: (N, 3), (3, N), "
                          "(H, W, 3), or (H, W) of a depth image");
}

static enum status read_values(struct cloudtext *t, const struct array *a,
                               const struct clouddepth_camera *camera,
                               struct cloudlist *list)
{
    const unsigned char *data = (const unsigned char *)t->p;
    const size_t size = cloudvalue_size[a->type];
    const bool swap = cloudvalue_swap(a->big), depth = a->shape[2] == 1;
    struct clouddepth d;
    enum status st = ST_OK;

    if (a->shape[0] > UINT32_MAX || a->shape[1] > UINT32_MAX)
        return cloudtext_fail(t, ST_EINVAL, "the array is too large");
    if (depth) {
        st = clouddepth_begin(&d, camera, (uint32_t)a->shape[1], (uint32_t)a->shape[0],
                              list);
        if (camera->scale == 0 &&
            (a->type == CLOUDVALUE_F32 || a->type == CLOUDVALUE_F64))
            list->out.unit_mm = 0;
    } else if (a->shape[1] > 1) {
        list->out.width = (uint32_t)a->shape[1];
        list->out.height = (uint32_t)a->shape[0];
    }
    for (uint64_t i = 0; i < a->shape[0]; i++)
        for (uint64_t k = 0; k < a->shape[1] && st == ST_OK; k++) {
            const unsigned char *p = data + size * (i * a->step[0] + k * a->step[1]);
            double v[3];

            for (int j = 0; j < (depth ? 1 : 3); j++)
                v[j] = cloudvalue_load(p + size * (size_t)j * a->step[2], a->type, swap);
            st = depth ? clouddepth_add(&d, v[0])
                       : cloudlist_add(list, (struct dvec3){v[0], v[1], v[2]});
        }
    return st;
}

bool read_npy_is(const struct cloudtext *t)
{
    return t->end - t->p >= 8 && memcmp(t->p, MAGIC, sizeof MAGIC - 1) == 0;
}

enum status read_npy_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    struct array a = {.type = CLOUDVALUE_NONE};
    enum status st;

    t->line = 0;
    if ((st = read_header(t, &a)) != ST_OK || (st = check_size(t, &a)) != ST_OK ||
        (st = arrange(t, &a)) != ST_OK)
        return st;
    return read_values(t, &a, &o->camera, list);
}
