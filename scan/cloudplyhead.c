#include "cloudplyhead.h"

#include <string.h>

#include "cloudtext.h"

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

static enum status read_format(struct cloudtext *t, struct cloudplyhead *h)
{
    const char *word;
    size_t len;

    if (h->encoding != CLOUDPLYHEAD_NONE)
        return cloudtext_fail(t, ST_EINVAL, "a second format line");
    word = cloudtext_word(t, &len);
    if (cloudtext_is(word, len, "ascii"))
        h->encoding = CLOUDPLYHEAD_ASCII;
    else if (cloudtext_is(word, len, "binary_little_endian"))
        h->encoding = CLOUDPLYHEAD_LITTLE;
    else if (cloudtext_is(word, len, "binary_big_endian"))
        h->encoding = CLOUDPLYHEAD_BIG;
    else
        return cloudtext_fail(t, ST_EVERSION, "an unknown PLY format");
    h->swap = cloudvalue_swap(h->encoding == CLOUDPLYHEAD_BIG);
    word = cloudtext_word(t, &len);
    if (!cloudtext_is(word, len, "1.0"))
        return cloudtext_fail(t, ST_EVERSION, "not PLY version 1.0");
    return ST_OK;
}

static enum status read_element(struct cloudtext *t, struct cloudplyhead *h)
{
    struct cloudplyhead_element *e;
    const char *word, *digits;
    size_t len, ndigits;

    if (h->elements == CLOUDPLYHEAD_ELEMENTS)
        return cloudtext_fail(t, ST_EVERSION, "more than %d elements",
                              CLOUDPLYHEAD_ELEMENTS);
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
static enum cloudplyhead_role role_named(const struct cloudplyhead *h, bool list,
                                         const char *word, size_t len)
{
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz"};
    const bool vertex = h->vertex == h->elements - 1;

    if (list && h->element[h->elements - 1].faces)
        return cloudtext_is(word, len, "vertex_indices") ||
                       cloudtext_is(word, len, "vertex_index")
                   ? CLOUDPLYHEAD_CORNERS
                   : CLOUDPLYHEAD_IGNORED;
    for (int i = 0; vertex && i < 6; i++)
        if ((!list || i < 3) && cloudtext_is(word, len, names[i]))
            return (enum cloudplyhead_role)i;
    return CLOUDPLYHEAD_IGNORED;
}

static enum status read_property(struct cloudtext *t, struct cloudplyhead *h)
{
    struct cloudplyhead_property p = {CLOUDVALUE_NONE, CLOUDVALUE_NONE,
                                      CLOUDPLYHEAD_IGNORED};
    struct cloudplyhead_element *e;
    const char *word;
    size_t len;

    if (h->elements == 0)
        return cloudtext_fail(t, ST_EINVAL, "a property before any element");
    if (h->properties == CLOUDPLYHEAD_PROPERTIES)
        return cloudtext_fail(t, ST_EVERSION, "more than %d properties",
                              CLOUDPLYHEAD_PROPERTIES);
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
    for (uint32_t i = e->first; p.role != CLOUDPLYHEAD_IGNORED && i < h->properties; i++)
        if (h->property[i].role == p.role)
            return cloudtext_fail(t, ST_EINVAL, "the property %.*s twice", (int)len,
                                  word);
    h->property[h->properties++] = p;
    e->n++;
    e->stride += cloudvalue_size[p.count != CLOUDVALUE_NONE ? p.count : p.type];
    return ST_OK;
}

/* One line of the header after its first; *last on end_header. */
static enum status read_header_line(struct cloudtext *t, struct cloudplyhead *h,
                                    bool *last)
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
static unsigned roles(const struct cloudplyhead *h, const struct cloudplyhead_element *e)
{
    unsigned bits = 0;

    for (uint32_t i = e->first; i < e->first + e->n; i++)
        if (h->property[i].role < CLOUDPLYHEAD_CORNERS)
            bits |= 1U << h->property[i].role;
    return bits;
}

enum status cloudplyhead_read(struct cloudtext *t, struct cloudplyhead *h)
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
    if (h->encoding == CLOUDPLYHEAD_NONE)
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
