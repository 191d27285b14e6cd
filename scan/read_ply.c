#include "read.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"
#include "errinfo.h"
#include "status.h"

/* The header of a PLY file. */

#define PLY_ELEMENTS   16
#define PLY_PROPERTIES 256

enum ply_head_encoding { PLY_NONE, PLY_ASCII, PLY_LITTLE, PLY_BIG };

enum ply_head_role {                  /* 0 to 5: a vertex's x, y, z, nx, ny, nz */
                     PLY_CORNERS = 6, /* a face's list of vertices */
                     PLY_IGNORED
};

struct ply_head_property {
    unsigned char type;  /* enum cloudvalue, of the value, or of the list's items */
    unsigned char count; /* of a list's length; CLOUDVALUE_NONE: not a list */
    unsigned char role;
};

struct ply_head_element {
    uint64_t rows;
    uint32_t first, n; /* its properties */
    uint32_t stride;   /* bytes a row without its lists' items */
    bool lists, faces;
};

struct ply_head {
    enum ply_head_encoding encoding;
    uint32_t elements, properties;
    uint32_t vertex; /* which element has the vertices */
    bool normals;    /* the vertices have nx, ny and nz */
    bool swap;       /* the data's byte order is not this machine's */
    struct ply_head_element element[PLY_ELEMENTS];
    struct ply_head_property property[PLY_PROPERTIES];
};

static enum cloudvalue type_named(const char *word, size_t len)
{
    static const struct {
        char name[8];
        enum cloudvalue type;
    } names[] = {
        {"char", CLOUDVALUE_I8},    {"int8", CLOUDVALUE_I8},
        {"uchar", CLOUDVALUE_U8},   {"uint8", CLOUDVALUE_U8},
        {"short", CLOUDVALUE_I16},  {"int16", CLOUDVALUE_I16},
        {"ushort", CLOUDVALUE_U16}, {"uint16", CLOUDVALUE_U16},
        {"int", CLOUDVALUE_I32},    {"int32", CLOUDVALUE_I32},
        {"uint", CLOUDVALUE_U32},   {"uint32", CLOUDVALUE_U32},
        {"float", CLOUDVALUE_F32},  {"float32", CLOUDVALUE_F32},
        {"double", CLOUDVALUE_F64}, {"float64", CLOUDVALUE_F64},
    };

    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (cloudtext_is(word, len, names[i].name))
            return names[i].type;
    return CLOUDVALUE_NONE;
}

static enum status read_format(struct cloudtext *t, struct ply_head *h)
{
    const char *word;
    size_t len;

    if (h->encoding != PLY_NONE)
        return cloudtext_fail(t, ST_EINVAL, "a second format line");
    word = cloudtext_word(t, &len);
    if (cloudtext_is(word, len, "ascii"))
        h->encoding = PLY_ASCII;
    else if (cloudtext_is(word, len, "binary_little_endian"))
        h->encoding = PLY_LITTLE;
    else if (cloudtext_is(word, len, "binary_big_endian"))
        h->encoding = PLY_BIG;
    else
        return cloudtext_fail(t, ST_EVERSION, "an unknown PLY format");
    h->swap = cloudvalue_swap(h->encoding == PLY_BIG);
    word = cloudtext_word(t, &len);
    if (!cloudtext_is(word, len, "1.0"))
        return cloudtext_fail(t, ST_EVERSION, "not PLY version 1.0");
    return ST_OK;
}

static enum status read_element(struct cloudtext *t, struct ply_head *h)
{
    struct ply_head_element *e;
    const char *word, *digits;
    size_t len, ndigits;

    if (h->elements == PLY_ELEMENTS)
        return cloudtext_fail(t, ST_EVERSION, "more than %d elements", PLY_ELEMENTS);
    word = cloudtext_word(t, &len);
    digits = cloudtext_word(t, &ndigits);
    if (len == 0 || ndigits == 0)
        return cloudtext_fail(t, ST_EINVAL, "an element needs a name and a count");
    e = &h->element[h->elements];
    memset(e, 0, sizeof *e);
    e->first = h->properties;
    if (!cloudtext_count(digits, ndigits, &e->rows))
        return cloudtext_fail(t, ST_EINVAL, "an element's count is not a number");
    if (cloudtext_is(word, len, "vertex")) {
        if (h->vertex < h->elements)
            return cloudtext_fail(t, ST_EINVAL, "a second vertex element");
        h->vertex = h->elements; /* and no longer "none": there is one element more now */
    } else if (h->vertex == h->elements) {
        h->vertex++;
    }
    e->faces = cloudtext_is(word, len, "face");
    h->elements++;
    return ST_OK;
}

/* What a property of this name is good for. */
static enum ply_head_role role_named(const struct ply_head *h, bool list,
                                     const char *word, size_t len)
{
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz"};
    const bool vertex = h->vertex == h->elements - 1;

    if (list && h->element[h->elements - 1].faces)
        return cloudtext_is(word, len, "vertex_indices") ||
                       cloudtext_is(word, len, "vertex_index")
                   ? PLY_CORNERS
                   : PLY_IGNORED;
    for (int i = 0; vertex && i < 6; i++)
        if ((!list || i < 3) && cloudtext_is(word, len, names[i]))
            return (enum ply_head_role)i;
    return PLY_IGNORED;
}

static enum status read_property(struct cloudtext *t, struct ply_head *h)
{
    struct ply_head_property p = {CLOUDVALUE_NONE, CLOUDVALUE_NONE, PLY_IGNORED};
    struct ply_head_element *e;
    const char *word;
    size_t len;

    if (h->elements == 0)
        return cloudtext_fail(t, ST_EINVAL, "a property before any element");
    if (h->properties == PLY_PROPERTIES)
        return cloudtext_fail(t, ST_EVERSION, "more than %d properties", PLY_PROPERTIES);
    e = &h->element[h->elements - 1];
    word = cloudtext_word(t, &len);
    if (cloudtext_is(word, len, "list")) {
        word = cloudtext_word(t, &len);
        p.count = (unsigned char)type_named(word, len);
        if (p.count == CLOUDVALUE_NONE || p.count >= CLOUDVALUE_F32)
            return cloudtext_fail(t, ST_EINVAL,
                                  "a list's length must be of an integer type");
        word = cloudtext_word(t, &len);
        e->lists = true;
    }
    if ((p.type = (unsigned char)type_named(word, len)) == CLOUDVALUE_NONE)
        return cloudtext_fail(t, ST_EINVAL, "an unknown property type");
    word = cloudtext_word(t, &len);
    if (len == 0)
        return cloudtext_fail(t, ST_EINVAL, "a property without a name");
    p.role = (unsigned char)role_named(h, p.count != CLOUDVALUE_NONE, word, len);
    if (p.role < 3 && p.count != CLOUDVALUE_NONE)
        return cloudtext_fail(t, ST_EINVAL, "the coordinate %c is a list", word[0]);
    for (uint32_t i = e->first; p.role != PLY_IGNORED && i < h->properties; i++)
        if (h->property[i].role == p.role)
            return cloudtext_fail(t, ST_EINVAL, "the property %.*s twice", (int)len,
                                  word);
    h->property[h->properties++] = p;
    e->n++;
    e->stride += cloudvalue_size[p.count != CLOUDVALUE_NONE ? p.count : p.type];
    return ST_OK;
}

/* One line of the header after its first; *last on end_header. */
static enum status read_header_line(struct cloudtext *t, struct ply_head *h, bool *last)
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

/* A bit for each of the first 6 roles that the element's properties have. */
static unsigned roles(const struct ply_head *h, const struct ply_head_element *e)
{
    unsigned bits = 0;

    for (uint32_t i = e->first; i < e->first + e->n; i++)
        if (h->property[i].role < PLY_CORNERS)
            bits |= 1U << h->property[i].role;
    return bits;
}

/* ply_head_read(t, h): t stands at the first byte of the file, then at that of the data.
 * Each coordinate is there, once, and no list.
 * Returns ST_OK; ST_EINVAL; ST_EVERSION also for more than PLY_ELEMENTS elements or
 * PLY_PROPERTIES properties. */
static enum status ply_head_read(struct cloudtext *t, struct ply_head *h)
{
    bool last = false, bare_cr;
    const char *word;
    size_t len;
    enum status st;

    memset(h, 0, sizeof *h);
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
    if (h->encoding == PLY_NONE)
        return cloudtext_fail(t, ST_EINVAL, "no format line in the PLY header");
    if (h->vertex == h->elements)
        return cloudtext_fail(t, ST_EINVAL, "no vertex element in the PLY header");
    if ((roles(h, &h->element[h->vertex]) & 7) != 7)
        return cloudtext_fail(t, ST_EINVAL, "the vertices have no x, y and z");
    h->normals = roles(h, &h->element[h->vertex]) >> 3 == 7;
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

/* A file's data, as it is read. */
struct data {
    struct cloudtext *t;
    struct ply_head h;
    struct cloudlist *list;
    bool text;
    bool stream; /* as text: a row does not have a line of its own */
};

static enum status ends_before(struct data *d)
{
    return cloudtext_fail(d->t, ST_EINVAL, "the data ends before the vertices");
}

/* ---- rows of any kind, text or binary */

/* The next value.  ST_ENOTFOUND: the data ends. */
static enum status read_ply_take(struct data *d, enum cloudvalue type, double *out)
{
    struct cloudtext *t = d->t;

    if (d->stream && !cloudtext_find(t))
        return ST_ENOTFOUND;
    if (d->text)
        return cloudtext_number(t, out);
    if ((size_t)(t->end - t->p) < cloudvalue_size[type])
        return ST_ENOTFOUND;
    *out = cloudvalue_load((const unsigned char *)t->p, type, d->h.swap);
    t->p += cloudvalue_size[type];
    return ST_OK;
}

/* Pass over n values, which may be anything: NaN normals, words. */
static enum status skip(struct data *d, enum cloudvalue type, uint64_t n)
{
    struct cloudtext *t = d->t;

    if (!d->text) {
        if (n > (uint64_t)(t->end - t->p) / cloudvalue_size[type])
            return ST_ENOTFOUND;
        t->p += n * cloudvalue_size[type];
        return ST_OK;
    }
    for (enum status st = ST_OK; n > 0 && st == ST_OK; n--) {
        if (d->stream && !cloudtext_find(t))
            return ST_ENOTFOUND;
        if ((st = cloudtext_pass(t)) != ST_OK)
            return st;
    }
    return ST_OK;
}

/* A face's n corners. */
static enum status take_corners(struct data *d, enum cloudvalue type, uint64_t n)
{
    struct cloudlist_fan fan = {.n = 0};
    enum status st = ST_OK;

    while (fan.n < n && st == ST_OK) {
        double value;

        if ((st = read_ply_take(d, type, &value)) != ST_OK)
            return st;
        if (!(value >= 0 && value <= UINT32_MAX && floor(value) == value))
            return ST_EINVAL;
        st = cloudlist_corner(d->list, &fan, (uint64_t)value);
    }
    return st;
}

static enum status take_list(struct data *d, const struct ply_head_property *q,
                             bool faces)
{
    double n;
    enum status st = read_ply_take(d, q->count, &n);

    if (st != ST_OK)
        return st;
    if (!(n >= 0 && n <= 4294967295.0 && floor(n) == n))
        return cloudtext_fail(d->t, ST_EINVAL, "a list's length is not a count");
    return faces && q->role == PLY_CORNERS ? take_corners(d, q->type, (uint64_t)n)
                                           : skip(d, q->type, (uint64_t)n);
}

/* One row: a vertex into value; a face, with faces, into the list.  ST_ENOTFOUND: the data
 * ends before or in it. */
static enum status read_ply_read_row(struct data *d, const struct ply_head_element *e,
                                     double value[6], bool faces)
{
    struct cloudtext *t = d->t;
    enum status st = ST_OK;

    if (d->text && !cloudtext_find(t))
        return ST_ENOTFOUND;
    for (uint32_t i = e->first; i < e->first + e->n && st == ST_OK; i++) {
        const struct ply_head_property *q = &d->h.property[i];

        if (q->count != CLOUDVALUE_NONE)
            st = take_list(d, q, faces);
        else if (q->role < PLY_CORNERS)
            st = read_ply_take(d, q->type, &value[q->role]);
        else
            st = skip(d, q->type, 1);
    }
    return st != ST_OK || !d->text || d->stream ? st : cloudtext_row_end(t);
}

/* ---- the vertices */

/* Binary rows of one length, which are all there. */
static enum status read_fixed(struct data *d, const struct ply_head_element *e)
{
    const unsigned char *const row = (const unsigned char *)d->t->p;
    struct cloudlist_column column[6] = {{.at = NULL}};
    size_t offset = 0;

    for (uint32_t i = e->first; i < e->first + e->n; i++) {
        const struct ply_head_property *q = &d->h.property[i];

        if (q->role < PLY_CORNERS)
            column[q->role] = (struct cloudlist_column){
                row + offset, e->stride, (enum cloudvalue)q->type, d->h.swap};
        offset += cloudvalue_size[q->type];
    }
    d->t->p += e->rows * e->stride;
    return cloudlist_rows(d->list, column, d->h.normals, e->rows);
}

static enum status read_vertices(struct data *d, const struct ply_head_element *e)
{
    if (!d->text && !e->lists)
        return read_fixed(d, e);
    for (uint64_t i = 0; i < e->rows; i++) {
        double value[6] = {0};
        enum status st = read_ply_read_row(d, e, value, false);

        if (st == ST_ENOTFOUND)
            return cloudtext_cut_off(d->t, e->rows, i);
        if (st != ST_OK || (st = cloudlist_point(d->list, value, d->h.normals)) != ST_OK)
            return st;
    }
    return ST_OK;
}

/* The vertices come next: are there enough bytes for as many as the header says? */
static enum status check_count(struct data *d, const struct ply_head_element *e)
{
    const uint64_t left = (uint64_t)(d->t->end - d->t->p);
    /* As text a value takes a digit and a separator, but for the last one. */
    const uint64_t least = d->text ? 2 * (uint64_t)e->n : e->stride;
    const uint64_t fit = (left + d->text) / least;

    return e->rows > fit ? cloudtext_cut_off(d->t, e->rows, fit) : ST_OK;
}

/* ---- the other elements */

static enum status skip_element(struct data *d, const struct ply_head_element *e)
{
    struct cloudtext *t = d->t;
    double ignored[6];

    if (!d->text && !e->lists) {
        if (e->stride != 0 && e->rows > (uint64_t)(t->end - t->p) / e->stride)
            return ends_before(d);
        t->p += e->rows * e->stride; /* in one step, however many rows of 0 bytes */
        return ST_OK;
    }
    for (uint64_t row = 0; e->n > 0 && row < e->rows; row++) {
        enum status st = read_ply_read_row(d, e, ignored, false);

        if (st == ST_ENOTFOUND)
            return ends_before(d);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Reads the faces for the normals.  They are a help: if they cannot be read, the points are all there is,
 * as in files that end after them.  In a stream they tell whether the vertices were read right. */
static enum status read_faces(struct data *d, const struct ply_head_element *e)
{
    struct errinfo *const report = d->t->e;
    const struct ply_head_element *const last = &d->h.element[d->h.elements - 1];
    double none[6];
    enum status st = ST_OK;

    d->t->e = NULL;
    while (st == ST_OK && ++e <= last && (!e->faces || d->h.normals))
        st = skip_element(d, e);
    for (uint64_t row = 0; st == ST_OK && e <= last && e->n > 0 && row < e->rows; row++)
        st = read_ply_read_row(d, e, none, true);
    while (d->stream && st == ST_OK && ++e <= last)
        st = skip_element(d, e);
    d->t->e = report;
    if (st == ST_ENOMEM)
        return st;
    if (st != ST_OK)
        cloudlist_forget(d->list);
    return d->stream && d->list->faceless ? ST_EINVAL : ST_OK;
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

/* Nearly all programs write each row of text on a line of its own.  Returns false if the first row does
 * not stand so, with the reason. */
static bool has_lines(const struct data *d, struct errinfo *why)
{
    const struct ply_head_element *e = d->h.element;
    struct cloudtext t = *d->t;
    struct data first = {.t = &t, .h = d->h, .text = true};
    double ignored[6];

    t.e = why;
    while (e->rows == 0 || e->n == 0)
        if (++e == &d->h.element[d->h.elements])
            return true;
    return read_ply_read_row(&first, e, ignored, false) != ST_EINVAL;
}

static enum status read_data(struct data *d)
{
    const struct ply_head_element *const vertex = &d->h.element[d->h.vertex];
    const bool last = vertex == &d->h.element[d->h.elements - 1];
    enum status st;

    for (const struct ply_head_element *e = d->h.element; e < vertex; e++)
        if ((st = skip_element(d, e)) != ST_OK)
            return st;
    if ((st = check_count(d, vertex)) != ST_OK ||
        (st = cloudlist_room(d->list, (size_t)vertex->rows)) != ST_OK ||
        (st = read_vertices(d, vertex)) != ST_OK)
        return st;
    if (!last && (d->stream || !d->h.normals))
        st = read_faces(d, vertex);
    return st == ST_OK && (last || d->stream) ? check_end(d->t) : st;
}

bool read_ply_is(const struct cloudtext *t)
{
    return t->end - t->p > 3 && memcmp(t->p, "ply", 3) == 0 &&
           (t->p[3] == '\n' || t->p[3] == '\r' || t->p[3] == ' ');
}

uint64_t read_ply_count(struct cloudtext t)
{
    struct ply_head h;

    return ply_head_read(&t, &h) == ST_OK ? h.element[h.vertex].rows : 0;
}

enum status read_ply_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;
    struct data d = {.t = t, .list = list};
    struct errinfo why;
    enum status st;

    if ((st = ply_head_read(t, &d.h)) != ST_OK)
        return st;
    d.text = d.h.encoding == PLY_ASCII;
    if (!d.text)
        t->line = 0;
    else if ((st = cloudtext_plain(t)) != ST_OK)
        return st;
    d.stream = d.text && !has_lines(&d, &why);
    st = read_data(&d);
    return d.stream && st == ST_EINVAL ? errinfo_set(t->e, st, "%s", why.msg) : st;
}
