#include "cloudply.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "cloudtext.h"
#include "mem.h"
#include "vec.h"

enum type { T_NONE, T_I8, T_U8, T_I16, T_U16, T_I32, T_U32, T_F32, T_F64 };
enum encoding { E_NONE, E_ASCII, E_LITTLE, E_BIG };

static const unsigned char type_size[] = {
    [T_NONE] = 0, [T_I8] = 1,  [T_U8] = 1,  [T_I16] = 2, [T_U16] = 2,
    [T_I32] = 4,  [T_U32] = 4, [T_F32] = 4, [T_F64] = 8};

struct property {
    unsigned char type;  /* enum type of the value, or of the list's items */
    unsigned char count; /* enum type of a list's length; T_NONE: not a list */
    signed char axis;    /* 0, 1, 2 for a vertex's x, y, z; else -1 */
};

struct element {
    uint64_t rows;
    uint32_t first, n; /* its properties */
    uint32_t stride;   /* bytes a row without its lists' items */
    bool lists;
};

struct header {
    enum encoding encoding;
    uint32_t elements, properties;
    uint32_t vertex; /* which element; == elements: none yet */
    bool swap;       /* the data's byte order is not this machine's */
    struct element element[CLOUDPLY_ELEMENTS];
    struct property property[CLOUDPLY_PROPERTIES];
};

/* ---- the header */

static enum type type_named(const char *word, size_t len)
{
    static const struct {
        char name[8];
        enum type type;
    } names[] = {
        {"char", T_I8},   {"int8", T_I8},     {"uchar", T_U8},   {"uint8", T_U8},
        {"short", T_I16}, {"int16", T_I16},   {"ushort", T_U16}, {"uint16", T_U16},
        {"int", T_I32},   {"int32", T_I32},   {"uint", T_U32},   {"uint32", T_U32},
        {"float", T_F32}, {"float32", T_F32}, {"double", T_F64}, {"float64", T_F64},
    };

    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (cloudtext_is(word, len, names[i].name))
            return names[i].type;
    return T_NONE;
}

static enum status read_format(struct cloudtext *t, struct header *h)
{
    static const uint16_t probe = 1;
    const bool little = *(const unsigned char *)&probe == 1;
    const char *word;
    size_t len;

    if (h->encoding != E_NONE)
        return cloudtext_fail(t, ST_EINVAL, "a second format line");
    word = cloudtext_word(t, &len);
    if (cloudtext_is(word, len, "ascii"))
        h->encoding = E_ASCII;
    else if (cloudtext_is(word, len, "binary_little_endian"))
        h->encoding = E_LITTLE;
    else if (cloudtext_is(word, len, "binary_big_endian"))
        h->encoding = E_BIG;
    else
        return cloudtext_fail(t, ST_EVERSION, "an unknown PLY format");
    h->swap = (h->encoding == E_BIG) == little;
    word = cloudtext_word(t, &len);
    if (!cloudtext_is(word, len, "1.0"))
        return cloudtext_fail(t, ST_EVERSION, "not PLY version 1.0");
    return ST_OK;
}

static enum status read_element(struct cloudtext *t, struct header *h)
{
    struct element *e;
    const char *word, *digits;
    size_t len, ndigits;

    if (h->elements == CLOUDPLY_ELEMENTS)
        return cloudtext_fail(t, ST_EVERSION, "more than %d elements", CLOUDPLY_ELEMENTS);
    word = cloudtext_word(t, &len);
    digits = cloudtext_word(t, &ndigits);
    if (len == 0 || ndigits == 0)
        return cloudtext_fail(t, ST_EINVAL, "an element needs a name and a count");
    e = &h->element[h->elements];
    memset(e, 0, sizeof *e);
    e->first = h->properties;
    for (size_t i = 0; i < ndigits; i++) {
        if (digits[i] < '0' || digits[i] > '9' || i == 18)
            return cloudtext_fail(t, ST_EINVAL, "an element's count is not a number");
        e->rows = 10 * e->rows + (uint64_t)(digits[i] - '0');
    }
    if (cloudtext_is(word, len, "vertex")) {
        if (h->vertex < h->elements)
            return cloudtext_fail(t, ST_EINVAL, "a second vertex element");
        h->vertex = h->elements; /* and no longer "none": there is one element more now */
    } else if (h->vertex == h->elements) {
        h->vertex++;
    }
    h->elements++;
    return ST_OK;
}

static enum status read_property(struct cloudtext *t, struct header *h)
{
    struct property p = {T_NONE, T_NONE, -1};
    struct element *e;
    const char *word;
    size_t len;

    if (h->elements == 0)
        return cloudtext_fail(t, ST_EINVAL, "a property before any element");
    if (h->properties == CLOUDPLY_PROPERTIES)
        return cloudtext_fail(t, ST_EVERSION, "more than %d properties",
                              CLOUDPLY_PROPERTIES);
    e = &h->element[h->elements - 1];
    word = cloudtext_word(t, &len);
    if (cloudtext_is(word, len, "list")) {
        word = cloudtext_word(t, &len);
        p.count = (unsigned char)type_named(word, len);
        if (p.count == T_NONE || p.count >= T_F32)
            return cloudtext_fail(t, ST_EINVAL,
                                  "a list's length must be of an integer type");
        word = cloudtext_word(t, &len);
        e->lists = true;
    }
    if ((p.type = (unsigned char)type_named(word, len)) == T_NONE)
        return cloudtext_fail(t, ST_EINVAL, "an unknown property type");
    word = cloudtext_word(t, &len);
    if (len == 0)
        return cloudtext_fail(t, ST_EINVAL, "a property without a name");
    if (h->vertex == h->elements - 1 && len == 1 && word[0] >= 'x' && word[0] <= 'z') {
        p.axis = (signed char)(word[0] - 'x');
        if (p.count != T_NONE)
            return cloudtext_fail(t, ST_EINVAL, "the coordinate %c is a list", word[0]);
        for (uint32_t i = e->first; i < h->properties; i++)
            if (h->property[i].axis == p.axis)
                return cloudtext_fail(t, ST_EINVAL, "the coordinate %c twice", word[0]);
    }
    h->property[h->properties++] = p;
    e->n++;
    e->stride += type_size[p.count != T_NONE ? p.count : p.type];
    return ST_OK;
}

/* One line of the header after its first; *last on end_header. */
static enum status read_header_line(struct cloudtext *t, struct header *h, bool *last)
{
    enum status st = ST_OK;
    const char *word;
    size_t len;

    word = cloudtext_word(t, &len);
    if (cloudtext_is(word, len, "comment") || cloudtext_is(word, len, "obj_info")) {
        while (!cloudtext_eol(t))
            t->p++;
        return ST_OK;
    }
    if (cloudtext_is(word, len, "end_header"))
        *last = true;
    else if (cloudtext_is(word, len, "format"))
        st = read_format(t, h);
    else if (cloudtext_is(word, len, "element"))
        st = read_element(t, h);
    else if (cloudtext_is(word, len, "property"))
        st = read_property(t, h);
    else if (len != 0)
        return cloudtext_fail(t, ST_EINVAL, "an unknown word in the PLY header");
    if (st != ST_OK)
        return st;
    cloudtext_blank(t);
    if (!cloudtext_eol(t))
        return cloudtext_fail(t, ST_EINVAL, "more on a header line than belongs there");
    return ST_OK;
}

static enum status read_header(struct cloudtext *t, struct header *h)
{
    unsigned axes = 0;
    bool last = false, bare_cr;
    const char *word;
    size_t len;
    enum status st;

    h->encoding = E_NONE;
    h->elements = h->properties = h->vertex = 0;
    h->swap = false;
    word = cloudtext_word(t, &len);
    cloudtext_blank(t);
    if (!cloudtext_is(word, len, "ply") || !cloudtext_eol(t))
        return cloudtext_fail(t, ST_EINVAL, "a PLY file begins with the word ply");
    bare_cr = t->end - t->p > 1 && t->p[0] == '\r' && t->p[1] != '\n';
    while (!last) {
        cloudtext_newline(t);
        if (t->p == t->end)
            return cloudtext_fail(t, ST_EINVAL, "the PLY header does not end");
        if ((st = read_header_line(t, h, &last)) != ST_OK)
            return st;
    }
    if (h->encoding == E_NONE)
        return cloudtext_fail(t, ST_EINVAL, "no format line in the PLY header");
    if (h->vertex == h->elements)
        return cloudtext_fail(t, ST_EINVAL, "no vertex element in the PLY header");
    for (uint32_t i = 0; i < h->element[h->vertex].n; i++) {
        int axis = h->property[h->element[h->vertex].first + i].axis;

        if (axis >= 0)
            axes |= 1U << axis;
    }
    if (axes != 7)
        return cloudtext_fail(t, ST_EINVAL, "the vertices have no x, y and z");
    if (t->p == t->end)
        return h->element[h->vertex].rows == 0
                   ? ST_OK
                   : cloudtext_fail(t, ST_EINVAL, "the file ends with its header");
    /* Where lines end in CR alone, a line feed next is the first byte of the data. */
    if (bare_cr)
        t->p++;
    else
        cloudtext_newline(t);
    return ST_OK;
}

/* ---- binary data */

static double load(const unsigned char *p, enum type type, bool swap)
{
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
    float f32;
    double f64;

    switch (type_size[type]) {
    case 1:
        return type == T_I8 ? (double)(int8_t)*p : (double)*p;
    case 2:
        memcpy(&u16, p, sizeof u16);
        u16 = swap ? __builtin_bswap16(u16) : u16;
        return type == T_I16 ? (double)(int16_t)u16 : (double)u16;
    case 4:
        memcpy(&u32, p, sizeof u32);
        u32 = swap ? __builtin_bswap32(u32) : u32;
        memcpy(&f32, &u32, sizeof f32);
        return type == T_F32   ? (double)f32
               : type == T_I32 ? (double)(int32_t)u32
                               : (double)u32;
    default:
        memcpy(&u64, p, sizeof u64);
        u64 = swap ? __builtin_bswap64(u64) : u64;
        memcpy(&f64, &u64, sizeof f64);
        return f64;
    }
}

/* Read one row; the coordinates go to xyz, unless that is NULL.  False: the row is cut
 * off, or a list has a negative length. */
static bool read_row(struct cloudtext *t, const struct header *h, const struct element *e,
                     double *xyz)
{
    const unsigned char *p = (const unsigned char *)t->p;
    const unsigned char *end = (const unsigned char *)t->end;

    for (uint32_t i = e->first; i < e->first + e->n; i++) {
        const struct property *q = &h->property[i];
        const enum type type = q->count != T_NONE ? q->count : q->type;
        double value;

        if ((size_t)(end - p) < type_size[type])
            return false;
        value = load(p, type, h->swap);
        p += type_size[type];
        if (q->count != T_NONE) {
            if (value < 0 || (uint64_t)value > (uint64_t)(end - p) / type_size[q->type])
                return false;
            p += (size_t)value * type_size[q->type];
        } else if (q->axis >= 0 && xyz != NULL) {
            xyz[q->axis] = value;
        }
    }
    t->p = (const char *)p;
    return true;
}

/* Rows of one length: read column by column. */
static void read_columns(const unsigned char *rows, const struct header *h, size_t n,
                         struct dvec3 *out)
{
    const struct element *e = &h->element[h->vertex];
    const size_t stride = e->stride;
    size_t offset = 0;

    for (uint32_t i = e->first; i < e->first + e->n; i++) {
        const struct property *q = &h->property[i];
        const unsigned char *p = rows + offset;

        offset += type_size[q->type];
        if (q->axis < 0)
            continue;
        for (size_t k = 0; k < n; k++, p += stride) {
            double value = load(p, q->type, h->swap);

            if (q->axis == 0)
                out[k].x = value;
            else if (q->axis == 1)
                out[k].y = value;
            else
                out[k].z = value;
        }
    }
}

static enum status cut_off(struct cloudtext *t, const struct header *h, uint64_t row)
{
    return cloudtext_fail(
        t, ST_EINVAL, "the header promises %llu vertices, the data ends in number %llu",
        (unsigned long long)h->element[h->vertex].rows, (unsigned long long)row + 1);
}

static enum status skip_element(struct cloudtext *t, const struct header *h,
                                const struct element *e)
{
    if (!e->lists) {
        if (e->stride != 0 && e->rows > (uint64_t)(t->end - t->p) / e->stride)
            return cloudtext_fail(t, ST_EINVAL, "the data ends before the vertices");
        t->p += e->rows * e->stride; /* in one step, however many rows of 0 bytes */
        return ST_OK;
    }
    for (uint64_t row = 0; row < e->rows; row++)
        if (!read_row(t, h, e, NULL))
            return cloudtext_fail(t, ST_EINVAL, "the data ends before the vertices");
    return ST_OK;
}

static enum status read_binary(struct cloudtext *t, const struct header *h, size_t n,
                               struct dvec3 *out)
{
    const struct element *e = &h->element[h->vertex];
    const char *rows = t->p;

    if (!e->lists) {
        read_columns((const unsigned char *)t->p, h, n, out);
        t->p += n * e->stride;
    } else {
        for (size_t i = 0; i < n; i++) {
            double xyz[3] = {0, 0, 0};

            if (!read_row(t, h, e, xyz))
                return cut_off(t, h, i);
            out[i] = (struct dvec3){xyz[0], xyz[1], xyz[2]};
        }
    }
    for (size_t i = 0; i < n; i++) {
        if (isfinite(out[i].x) && isfinite(out[i].y) && isfinite(out[i].z))
            continue;
        if (!e->lists)
            t->p = rows + i * e->stride;
        return cloudtext_fail(t, ST_ENOTFINITE, "vertex %zu is not three finite numbers",
                              i);
    }
    return ST_OK;
}

/* ---- text data */

/* One row, on a line of its own; blank lines before it are skipped. */
static enum status read_text_row(struct cloudtext *t, const struct header *h,
                                 const struct element *e, double *xyz)
{
    double value, items;
    enum status st;

    for (cloudtext_blank(t); cloudtext_eol(t) && t->p < t->end; cloudtext_blank(t))
        cloudtext_newline(t);
    if (t->p == t->end)
        return ST_ENOTFOUND;
    for (uint32_t i = e->first; i < e->first + e->n; i++) {
        const struct property *q = &h->property[i];

        /* What is not a coordinate may be anything, NaN normals too. */
        if (q->axis < 0 && q->count == T_NONE) {
            size_t len;

            (void)cloudtext_word(t, &len);
            if (len == 0)
                return cloudtext_fail(t, ST_EINVAL, "the line has too few numbers");
            continue;
        }
        if ((st = cloudtext_number(t, &value)) != ST_OK)
            return st;
        if (q->axis >= 0) {
            xyz[q->axis] = value;
            continue;
        }
        if (!(value >= 0 && value <= 4294967295.0 && floor(value) == value))
            return cloudtext_fail(t, ST_EINVAL, "a list's length is not a count");
        for (items = 0; items < value; items++) {
            size_t len;

            (void)cloudtext_word(t, &len);
            if (len == 0)
                return cloudtext_fail(t, ST_EINVAL, "the line has too few numbers");
        }
    }
    cloudtext_blank(t);
    if (!cloudtext_eol(t))
        return cloudtext_fail(t, ST_EINVAL,
                              "the line has more numbers than the header says");
    return ST_OK;
}

static enum status read_text(struct cloudtext *t, const struct header *h,
                             const struct element *e, size_t n, struct dvec3 *out)
{
    if (e->n == 0)
        return ST_OK; /* rows of nothing take no lines */
    for (size_t i = 0; i < n; i++) {
        double xyz[3] = {0, 0, 0};
        enum status st = read_text_row(t, h, e, xyz);

        if (st == ST_ENOTFOUND)
            return out != NULL ? cut_off(t, h, i)
                               : cloudtext_fail(t, ST_EINVAL,
                                                "the data ends before the "
                                                "vertices");
        if (st != ST_OK)
            return st;
        if (out != NULL)
            out[i] = (struct dvec3){xyz[0], xyz[1], xyz[2]};
    }
    return ST_OK;
}

/* ---- all of it */

/* t->p is at the vertices: are there enough bytes for as many as the header says? */
static enum status check_count(struct cloudtext *t, const struct header *h,
                               size_t max_points)
{
    const struct element *e = &h->element[h->vertex];
    const uint64_t left = (uint64_t)(t->end - t->p);
    /* As text a value takes a digit and a separator, but for the last one. */
    const uint64_t least = h->encoding == E_ASCII ? 2 * (uint64_t)e->n : e->stride;
    const uint64_t fit = (left + (h->encoding == E_ASCII)) / least;

    if (e->rows > fit)
        return cut_off(t, h, fit);
    if (e->rows > max_points)
        return cloudtext_fail(t, ST_ELIMIT, "%llu points, over the limit of %zu",
                              (unsigned long long)e->rows, max_points);
    return ST_OK;
}

/* Nothing but line ends may follow the last element. */
static enum status check_end(struct cloudtext *t)
{
    for (cloudtext_blank(t); t->p < t->end; cloudtext_blank(t)) {
        if (!cloudtext_eol(t))
            return cloudtext_fail(
                t, ST_EINVAL,
                "data is left after the last vertex that the header promises");
        cloudtext_newline(t);
    }
    return ST_OK;
}

bool cloudply_is(const struct cloudtext *t)
{
    return t->end - t->p > 3 && memcmp(t->p, "ply", 3) == 0 &&
           (t->p[3] == '\n' || t->p[3] == '\r' || t->p[3] == ' ');
}

enum status cloudply_parse(struct cloudtext *t, size_t max_points, struct dvec3 **out,
                           size_t *n)
{
    struct header h;
    const struct element *e;
    struct dvec3 *points = NULL;
    bool text;
    enum status st;

    if ((st = read_header(t, &h)) != ST_OK)
        return st;
    e = &h.element[h.vertex];
    text = h.encoding == E_ASCII;
    if (!text)
        t->line = 0;
    else if ((st = cloudtext_plain(t)) != ST_OK)
        return st;
    for (const struct element *before = h.element; before < e; before++) {
        st = text ? read_text(t, &h, before, before->rows, NULL)
                  : skip_element(t, &h, before);
        if (st != ST_OK)
            return st;
    }
    if ((st = check_count(t, &h, max_points)) != ST_OK)
        return st;
    if ((points = mem_array((size_t)e->rows, sizeof *points)) == NULL)
        return ST_ENOMEM;
    st = text ? read_text(t, &h, e, (size_t)e->rows, points)
              : read_binary(t, &h, (size_t)e->rows, points);
    if (st == ST_OK && e == &h.element[h.elements - 1])
        st = check_end(t);
    if (st != ST_OK) {
        mem_free(points);
        return st;
    }
    *out = points;
    *n = (size_t)e->rows;
    return ST_OK;
}
