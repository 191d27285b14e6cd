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

#define DIMS 8

struct read_npy_value {
    enum cloudvalue type; /* CLOUDVALUE_NONE: not said yet */
    bool big;
    size_t at; /* bytes from the item's first */
};

struct array {
    struct read_npy_value value
        [3]; /* x, y and z of a structured item; else the first is that of each item */
    bool fields; /* the items are structured */
    size_t size; /* bytes of an item */
    bool fortran;
    int dims; /* 0: not said yet */
    /* rows, columns, and values of a pixel; and how many items from one to the next */
    uint64_t shape[DIMS], step[DIMS];
};

/* ---- the header */

/* Is this here, behind blanks?  Then it is passed over. */
static bool read_npy_take(struct cloudtext *t, const char *what)
{
    const size_t len = strlen(what);

    cloudtext_blank(t);
    if ((size_t)(t->end - t->p) < len || memcmp(t->p, what, len) != 0)
        return false;
    t->p += len;
    return true;
}

/* Takes the digits that are here.  Returns false if there are none, or more than 18. */
static bool take_digits(struct cloudtext *t, uint64_t *out)
{
    const char *word = t->p;

    while (t->p < t->end && *t->p >= '0' && *t->p <= '9')
        t->p++;
    return cloudtext_count(word, (size_t)(t->p - word), out);
}

/* "'<f4'": a type, and its size in bytes.  Of types that have no numbers the size alone. */
static bool take_type(struct cloudtext *t, struct read_npy_value *v, uint64_t *size)
{
    static const struct {
        char kind, size;
        enum cloudvalue type;
    } types[] = {
        {'f', 2, CLOUDVALUE_F16}, {'f', 4, CLOUDVALUE_F32}, {'f', 8, CLOUDVALUE_F64},
        {'i', 1, CLOUDVALUE_I8},  {'u', 1, CLOUDVALUE_U8},  {'i', 2, CLOUDVALUE_I16},
        {'u', 2, CLOUDVALUE_U16}, {'i', 4, CLOUDVALUE_I32}, {'u', 4, CLOUDVALUE_U32},
        {'i', 8, CLOUDVALUE_I64}, {'u', 8, CLOUDVALUE_U64}};
    char kind;

    if (!read_npy_take(t, "'") || t->end - t->p < 3)
        return false;
    v->big = *t->p == '>';
    t->p += memchr("<>|=", *t->p, 4) != NULL;
    kind = *t->p++;
    if (kind == 'O' || !take_digits(t, size) || *size > 65535)
        return false;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].kind == kind && (uint64_t)types[i].size == *size)
            v->type = types[i].type;
    if (kind == 'U')
        *size *= 4;
    while (t->p < t->end && *t->p != '\'') /* the unit of a time */
        t->p++;
    return read_npy_take(t, "'");
}

/* "('x', '<f4')" or "('rgb', '|u1', (3,))": takes the field if it is x, y or z, or xyz of three. */
static bool take_field(struct cloudtext *t, struct array *a)
{
    struct read_npy_value v = {.type = CLOUDVALUE_NONE, .at = a->size};
    uint64_t size, n, items = 1;
    const char *name;
    bool of_three = false;
    size_t len;

    if (!read_npy_take(t, "(") || !read_npy_take(t, "'"))
        return false;
    for (name = t->p; t->p < t->end && *t->p != '\''; t->p++)
        ;
    len = (size_t)(t->p - name);
    if (!read_npy_take(t, "'") || !read_npy_take(t, ",") || !take_type(t, &v, &size))
        return false;
    if (read_npy_take(t, ",") && read_npy_take(t, "(")) {
        while (!read_npy_take(t, ")")) {
            if (!take_digits(t, &n) || n > 65535)
                return false;
            of_three = items == 1 && n == 3;
            items = items * n < 65535 ? items * n : 65535;
            (void)read_npy_take(t, "L");
            (void)read_npy_take(t, ",");
        }
    }
    for (size_t k = 0; k < 3; k++) {
        const bool is = cloudtext_like(name, len, (const char *[]){"x", "y", "z"}[k]);

        if (is || (of_three && cloudtext_like(name, len, "xyz"))) {
            a->value[k] = v;
            a->value[k].at += is ? 0 : k * (size_t)size;
        }
    }
    a->size += (size_t)(size * items);
    return read_npy_take(t, ")") && a->size < 65536;
}

static enum status read_type(struct cloudtext *t, struct array *a)
{
    uint64_t size;

    a->fields = read_npy_take(t, "[");
    if (!a->fields) {
        if (take_type(t, &a->value[0], &size) && a->value[0].type != CLOUDVALUE_NONE) {
            a->size = (size_t)size;
            return ST_OK;
        }
        return cloudtext_fail(t, ST_EVERSION,
                              "an NPY type that is not read: send floats or integers");
    }
    for (a->size = 0; !read_npy_take(t, "]"); (void)read_npy_take(t, ","))
        if (!take_field(t, a))
            return cloudtext_fail(
                t, ST_EVERSION,
                "a structure of NPY that is not read: send x, y and z as floats");
    for (size_t k = 0; k < 3; k++)
        if (a->value[k].type == CLOUDVALUE_NONE)
            return cloudtext_fail(
                t, ST_EVERSION,
                "the fields of the NPY array are not x, y and z of numbers");
    return ST_OK;
}

static enum status read_shape(struct cloudtext *t, struct array *a)
{
    if (!read_npy_take(t, "("))
        return cloudtext_fail(t, ST_EINVAL, "the shape of the array is expected here");
    for (a->dims = 0; !read_npy_take(t, ")"); (void)read_npy_take(t, ",")) {
        if (a->dims == DIMS || !take_digits(t, &a->shape[a->dims++]))
            return cloudtext_fail(t, ST_EVERSION, "the shape of the array is not read");
        (void)read_npy_take(t, "L"); /* Python 2 */
    }
    return ST_OK;
}

static enum status read_member(struct cloudtext *t, struct array *a)
{
    if (read_npy_take(t, "'descr':"))
        return read_type(t, a);
    if (read_npy_take(t, "'shape':"))
        return read_shape(t, a);
    if (read_npy_take(t, "'fortran_order':")) {
        a->fortran = read_npy_take(t, "True");
        if (a->fortran || read_npy_take(t, "False"))
            return ST_OK;
    }
    return cloudtext_fail(t, ST_EINVAL, "malformed NPY header");
}

/* A Python dictionary, behind its length; t moves to the data. */
static enum status read_npy_read_header(struct cloudtext *t, struct array *a)
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
    if (!read_npy_take(&h, "{"))
        return cloudtext_fail(&h, ST_EINVAL, "malformed NPY header");
    while (st == ST_OK && !read_npy_take(&h, "}")) {
        st = read_member(&h, a);
        (void)read_npy_take(&h, ",");
    }
    if (st == ST_OK && (a->size == 0 || a->dims == 0))
        return cloudtext_fail(&h, ST_EINVAL, "the NPY header has no type or no shape");
    return st;
}

/* ---- the values */

/* The steps of the array as it is, and that its values are all there is. */
static enum status check_size(struct cloudtext *t, struct array *a)
{
    const uint64_t size = a->size, left = (uint64_t)(t->end - t->p);
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

/* Takes the dimensions of length 1 away that are not needed. */
static void squeeze(struct array *a)
{
    for (int k = 0; k < a->dims && a->dims > 2;) {
        if (a->shape[k] != 1) {
            k++;
            continue;
        }
        a->dims--;
        memmove(a->shape + k, a->shape + k + 1, (size_t)(a->dims - k) * sizeof *a->shape);
        memmove(a->step + k, a->step + k + 1, (size_t)(a->dims - k) * sizeof *a->step);
    }
}

/* Rows and columns of points, or of values. */
static enum status arrange(struct cloudtext *t, struct array *a)
{
    struct array was;

    squeeze(a);
    was = *a;
    if (a->fields && a->dims <= 2) {
        if (a->dims == 1)
            a->shape[1] = 1;
        return ST_OK;
    }
    if (a->dims == 3 && a->shape[0] == 3 &&
        !is_point(a->shape[2])) { /* x, y and z are images */
        for (int k = 0; k < 3; k++) {
            a->shape[k] = was.shape[(k + 1) % 3];
            a->step[k] = was.step[(k + 1) % 3];
        }
        return ST_OK;
    }
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
                          "(H, W, 3), (3, H, W), or (H, W) of a depth image");
}

static enum status read_npy_read_values(struct cloudtext *t, const struct array *a,
                                        const struct clouddepth_camera *camera,
                                        struct cloudlist *list)
{
    const unsigned char *data = (const unsigned char *)t->p;
    const bool depth = !a->fields && a->shape[2] == 1;
    struct read_npy_value value[3];
    struct clouddepth d;
    enum status st = ST_OK;

    if (a->shape[0] > UINT32_MAX || a->shape[1] > UINT32_MAX)
        return cloudtext_fail(t, ST_EINVAL, "the array is too large");
    for (size_t k = 0; k < 3; k++) {
        value[k] = a->value[a->fields ? k : 0];
        value[k].at += a->fields || depth ? 0 : k * a->size * (size_t)a->step[2];
    }
    if (depth) {
        st = clouddepth_begin(&d, camera, (uint32_t)a->shape[1], (uint32_t)a->shape[0],
                              list);
        if (camera->scale == 0 && a->value[0].type >= CLOUDVALUE_F32 &&
            a->value[0].type <= CLOUDVALUE_F16)
            list->out.unit_mm = 0;
    } else if (a->shape[1] > 1) {
        list->out.width = (uint32_t)a->shape[1];
        list->out.height = (uint32_t)a->shape[0];
    }
    for (uint64_t i = 0; i < a->shape[0]; i++)
        for (uint64_t k = 0; k < a->shape[1] && st == ST_OK; k++) {
            const unsigned char *p = data + a->size * (i * a->step[0] + k * a->step[1]);
            double v[3];

            for (int j = 0; j < (depth ? 1 : 3); j++)
                v[j] = cloudvalue_load(p + value[j].at, value[j].type,
                                       cloudvalue_swap(value[j].big));
            st = depth ? clouddepth_add(&d, v[0])
                       : cloudlist_add(list, (struct dvec3){v[0], v[1], v[2]});
        }
    return st;
}

bool read_npy_is(const struct cloudtext *t)
{
    return t->end - t->p >= 8 && memcmp(t->p, MAGIC, sizeof MAGIC - 1) == 0;
}

/* The array's rows and columns; t moves to its values. */
static enum status read_array(struct cloudtext *t, struct array *a)
{
    enum status st;

    t->line = 0;
    if ((st = read_npy_read_header(t, a)) == ST_OK && (st = check_size(t, a)) == ST_OK)
        st = arrange(t, a);
    return st;
}

uint64_t read_npy_count(struct cloudtext t)
{
    struct array a = {.dims = 0};

    return read_array(&t, &a) == ST_OK ? a.shape[0] * a.shape[1] : 0;
}

enum status read_npy_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    struct array a = {.dims = 0};
    const enum status st = read_array(t, &a);

    return st == ST_OK ? read_npy_read_values(t, &a, &o->camera, list) : st;
}
