#include "read.h"

#include <stdint.h>
#include <string.h>

#include "cloudfile.h"
#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"
#include "mem.h"

#define PCD_FIELDS 64

enum encoding { ASCII, BINARY, COMPRESSED };

struct header {
    struct cloudtext *t;
    unsigned n, sizes, types, counts; /* fields: named, and so on */
    unsigned char size[PCD_FIELDS];
    char type[PCD_FIELDS];
    uint32_t count[PCD_FIELDS]; /* values in the field */
    int field[6];               /* of x, y, z, normal_x, normal_y, normal_z; or -1 */
    uint64_t width, height, points;
    bool has_width, has_height, has_points, has_data;
    enum encoding encoding;
};

/* Where the values of a point are that are wanted. */
struct layout {
    enum cloudvalue type[6]; /* CLOUDVALUE_NONE: there is none */
    uint64_t at[6];          /* bytes from the point's first */
    uint64_t before[6];      /* words from its first, as text */
    uint64_t stride, words;  /* of a point */
    bool normals;
};

/* ---- the header */

static enum status read_fields(struct header *h)
{
    static const char *const names[] = {"x",        "y",        "z",
                                        "normal_x", "normal_y", "normal_z"};
    size_t len;
    const char *word;

    while ((word = cloudtext_word(h->t, &len), len) != 0) {
        if (h->n == PCD_FIELDS)
            return cloudtext_fail(h->t, ST_EVERSION, "more than %d fields", PCD_FIELDS);
        for (int i = 0; i < 6; i++) {
            if (!cloudtext_is(word, len, names[i]))
                continue;
            if (h->field[i] >= 0)
                return cloudtext_fail(h->t, ST_EINVAL, "the field %s twice", names[i]);
            h->field[i] = (int)h->n;
        }
        h->n++;
    }
    return ST_OK;
}

static enum status read_types(struct header *h)
{
    size_t len;
    const char *word;

    while ((word = cloudtext_word(h->t, &len), len) != 0) {
        if (len != 1 || memchr("IUF", *word, 3) == NULL || h->types == PCD_FIELDS)
            return cloudtext_fail(h->t, ST_EINVAL, "a TYPE is I, U or F, for each field");
        h->type[h->types++] = *word;
    }
    return ST_OK;
}

static enum status read_numbers(struct header *h, bool sizes)
{
    unsigned *n = sizes ? &h->sizes : &h->counts;
    size_t len;
    const char *word;
    uint64_t value;

    while ((word = cloudtext_word(h->t, &len), len) != 0) {
        if (!cloudtext_count(word, len, &value) || value == 0 ||
            value > (sizes ? 8 : 65535) || *n == PCD_FIELDS)
            return cloudtext_fail(h->t, ST_EINVAL, "not a %s for each field",
                                  sizes ? "SIZE" : "COUNT");
        if (sizes)
            h->size[*n] = (unsigned char)value;
        else
            h->count[*n] = (uint32_t)value;
        ++*n;
    }
    return ST_OK;
}

static enum status read_one(struct header *h, uint64_t *out, bool *has)
{
    size_t len;
    const char *word = cloudtext_word(h->t, &len);

    if (*has || !cloudtext_count(word, len, out))
        return cloudtext_fail(h->t, ST_EINVAL, "one number is expected here, once");
    *has = true;
    return ST_OK;
}

static enum status read_data(struct header *h)
{
    static const char *const names[] = {"ascii", "binary", "binary_compressed"};
    size_t len;
    const char *word = cloudtext_word(h->t, &len);

    for (int i = 0; i < 3; i++) {
        if (!cloudtext_is(word, len, names[i]))
            continue;
        h->encoding = (enum encoding)i;
        h->has_data = true;
        return ST_OK;
    }
    return cloudtext_fail(h->t, ST_EVERSION,
                          "DATA is ascii, binary or binary_compressed");
}

static enum status read_header_line(struct header *h)
{
    size_t len;
    const char *word = cloudtext_word(h->t, &len);

    if (len == 0 || *word == '#')
        return ST_OK;
    if (cloudtext_is(word, len, "VERSION") || cloudtext_is(word, len, "VIEWPOINT"))
        return ST_OK;
    if (cloudtext_is(word, len, "FIELDS") || cloudtext_is(word, len, "COLUMNS"))
        return read_fields(h);
    if (cloudtext_is(word, len, "SIZE"))
        return read_numbers(h, true);
    if (cloudtext_is(word, len, "TYPE"))
        return read_types(h);
    if (cloudtext_is(word, len, "COUNT"))
        return read_numbers(h, false);
    if (cloudtext_is(word, len, "WIDTH"))
        return read_one(h, &h->width, &h->has_width);
    if (cloudtext_is(word, len, "HEIGHT"))
        return read_one(h, &h->height, &h->has_height);
    if (cloudtext_is(word, len, "POINTS"))
        return read_one(h, &h->points, &h->has_points);
    if (cloudtext_is(word, len, "DATA"))
        return read_data(h);
    h->t->p = word;
    return cloudtext_fail(h->t, ST_EINVAL, "an unknown word in the PCD header");
}

static enum status check_header(struct header *h)
{
    struct cloudtext *t = h->t;

    if (h->field[0] < 0 || h->field[1] < 0 || h->field[2] < 0)
        return cloudtext_fail(t, ST_EINVAL, "the fields have no x, y and z");
    if (h->sizes != h->n || h->types != h->n || (h->counts != 0 && h->counts != h->n))
        return cloudtext_fail(t, ST_EINVAL,
                              "SIZE, TYPE and COUNT have one for each field");
    if (!h->has_width && !h->has_points)
        return cloudtext_fail(t, ST_EINVAL, "neither WIDTH nor POINTS in the PCD header");
    if (!h->has_width)
        h->width = h->points;
    if (!h->has_height)
        h->height = 1;
    if (h->width > UINT32_MAX || h->height > UINT32_MAX)
        return cloudtext_fail(t, ST_EINVAL, "WIDTH and HEIGHT are too large");
    if (h->has_points && h->points != h->width * h->height)
        return cloudtext_fail(t, ST_EINVAL, "POINTS is not WIDTH times HEIGHT");
    h->points = h->width * h->height;
    return ST_OK;
}

static enum status read_pcd_read_header(struct cloudtext *t, struct header *h)
{
    enum status st = ST_OK;

    *h = (struct header){.t = t, .field = {-1, -1, -1, -1, -1, -1}};
    for (unsigned i = 0; i < PCD_FIELDS; i++)
        h->count[i] = 1;
    while (st == ST_OK && !h->has_data) {
        if (h->t->p == h->t->end)
            return cloudtext_fail(h->t, ST_EINVAL, "the PCD header does not end");
        if ((st = read_header_line(h)) == ST_OK)
            cloudtext_skip(h->t);
    }
    return st == ST_OK ? check_header(h) : st;
}

/* ---- the layout */

static enum cloudvalue type_of(char type, unsigned char size)
{
    switch (size) {
    case 1:
        return type == 'I'   ? CLOUDVALUE_I8
               : type == 'U' ? CLOUDVALUE_U8
                             : CLOUDVALUE_NONE;
    case 2:
        return type == 'I'   ? CLOUDVALUE_I16
               : type == 'U' ? CLOUDVALUE_U16
                             : CLOUDVALUE_NONE;
    case 4:
        return type == 'I'   ? CLOUDVALUE_I32
               : type == 'U' ? CLOUDVALUE_U32
                             : CLOUDVALUE_F32;
    default:
        return type == 'F' && size == 8 ? CLOUDVALUE_F64 : CLOUDVALUE_NONE;
    }
}

static enum status lay_out(const struct header *h, struct layout *l)
{
    *l = (struct layout){.normals = true};
    for (unsigned i = 0; i < h->n; i++) {
        for (int k = 0; k < 6; k++) {
            if (h->field[k] != (int)i)
                continue;
            l->type[k] =
                h->count[i] == 1 ? type_of(h->type[i], h->size[i]) : CLOUDVALUE_NONE;
            l->at[k] = l->stride;
            l->before[k] = l->words;
        }
        l->stride += (uint64_t)h->size[i] * h->count[i];
        l->words += h->count[i];
    }
    for (int k = 0; k < 6; k++) {
        if (l->type[k] != CLOUDVALUE_NONE)
            continue;
        if (k < 3)
            return cloudtext_fail(h->t, ST_EVERSION,
                                  "a coordinate is of a type that is not read: F 4 or 8, "
                                  "I or U 1, 2 or 4");
        l->normals = false;
    }
    return ST_OK;
}

/* ---- the points */

/* The points of the data, one behind the other or, by_field, field behind field. */
static enum status read_pcd_read_values(const struct header *h, const struct layout *l,
                                        const unsigned char *data, bool by_field,
                                        struct cloudlist *list)
{
    struct cloudlist_column column[6] = {{.at = NULL}};

    for (int k = 0; k < (l->normals ? 6 : 3); k++)
        column[k] =
            (struct cloudlist_column){data + l->at[k] * (by_field ? h->points : 1),
                                      by_field ? cloudvalue_size[l->type[k]] : l->stride,
                                      l->type[k], cloudvalue_swap(false)};
    return cloudlist_rows(list, column, l->normals, h->points);
}

static enum status read_binary(const struct header *h, const struct layout *l,
                               struct cloudlist *list)
{
    const uint64_t left = (uint64_t)(h->t->end - h->t->p);

    if (h->points > left / l->stride)
        return cloudtext_cut_off(h->t, h->points, left / l->stride);
    return read_pcd_read_values(h, l, (const unsigned char *)h->t->p, false, list);
}

/* LibLZF's format: a control byte below 32 is followed by one literal byte more than it says;
 * another one says in its upper three bits how many bytes to repeat (7: a byte with more of the
 * length follows), in its lower five and the next byte from how far back. */
bool read_pcd_unpack(const unsigned char *in, size_t len, unsigned char *out, size_t size)
{
    size_t from = 0, to = 0;

    while (from < len) {
        const unsigned control = in[from++];
        size_t n = control < 32 ? control + 1 : (control >> 5) + 2, back;

        if (control < 32) {
            if (n > len - from || n > size - to)
                return false;
            memcpy(out + to, in + from, n);
            from += n;
            to += n;
            continue;
        }
        if (control >> 5 == 7) {
            if (from == len)
                return false;
            n += in[from++];
        }
        if (from == len)
            return false;
        back = ((control & 31) << 8) + in[from++] + 1;
        if (back > to || n > size - to)
            return false;
        for (; n > 0; n--, to++) /* the two may overlap */
            out[to] = out[to - back];
    }
    return to == size;
}

/* Two lengths, and the fields one after the other, compressed. */
static enum status read_compressed(const struct header *h, const struct layout *l,
                                   size_t max_bytes, struct cloudlist *list)
{
    const unsigned char *p = (const unsigned char *)h->t->p;
    const uint64_t left = (uint64_t)(h->t->end - h->t->p);
    const bool swap = cloudvalue_swap(false);
    uint64_t packed, size;
    unsigned char *data;
    enum status st;

    if (left < 8)
        return cloudtext_cut_off(h->t, h->points, 0);
    packed = (uint64_t)cloudvalue_load(p, CLOUDVALUE_U32, swap);
    size = (uint64_t)cloudvalue_load(p + 4, CLOUDVALUE_U32, swap);
    if (packed > left - 8)
        return cloudtext_fail(h->t, ST_EINVAL, "the compressed data is cut off");
    if (size % l->stride != 0 || size / l->stride != h->points)
        return cloudtext_fail(h->t, ST_EINVAL,
                              "the compressed data is not of the points' size");
    if (size > max_bytes)
        return cloudtext_fail(h->t, ST_ESIZE, "the limit is %zu bytes when unpacked",
                              max_bytes);
    if ((data = mem_array((size_t)size, 1)) == NULL)
        return cloudtext_fail(h->t, ST_ENOMEM, "no memory to unpack the points");
    st = read_pcd_unpack(p + 8, (size_t)packed, data, (size_t)size)
             ? read_pcd_read_values(h, l, data, true, list)
             : cloudtext_fail(h->t, ST_EINVAL, "the compressed data is damaged");
    mem_free(data);
    return st;
}

static enum status read_pcd_read_row(struct cloudtext *t, const struct layout *l,
                                     double v[6])
{
    enum status st = ST_OK;

    for (uint64_t i = 0; i < l->words && st == ST_OK; i++) {
        int k = 0;

        while (k < 6 && (l->type[k] == CLOUDVALUE_NONE || l->before[k] != i))
            k++;
        st = k < 6 ? cloudtext_number(t, &v[k]) : cloudtext_pass(t);
    }
    return st == ST_OK ? cloudtext_row_end(t) : st;
}

static enum status read_text(const struct header *h, const struct layout *l,
                             struct cloudlist *list)
{
    struct cloudtext *t = h->t;
    enum status st = cloudtext_plain(t);

    for (uint64_t i = 0; i < h->points && st == ST_OK; i++) {
        double v[6] = {0};

        if (!cloudtext_find(t))
            return cloudtext_cut_off(t, h->points, i);
        if ((st = read_pcd_read_row(t, l, v)) == ST_OK)
            st = cloudlist_point(list, v, l->normals);
    }
    return st;
}

bool read_pcd_is(const struct cloudtext *t)
{
    struct cloudtext at = *t;
    size_t len;
    const char *word;

    if (t->end - t->p >= 6 && memcmp(t->p, "# .PCD", 6) == 0)
        return true;
    word = cloudtext_word(&at, &len);
    return cloudtext_is(word, len, "VERSION") || cloudtext_is(word, len, "FIELDS");
}

uint64_t read_pcd_count(struct cloudtext t)
{
    struct header h;

    return read_pcd_read_header(&t, &h) == ST_OK ? h.points : 0;
}

enum status read_pcd_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    struct header h;
    struct layout l;
    enum status st;

    if ((st = read_pcd_read_header(t, &h)) != ST_OK || (st = lay_out(&h, &l)) != ST_OK)
        return st;
    if (h.encoding != ASCII)
        t->line = 0;
    if (h.height > 1) {
        list->out.width = (uint32_t)h.width;
        list->out.height = (uint32_t)h.height;
    }
    switch (h.encoding) {
    case BINARY:
        return read_binary(&h, &l, list);
    case COMPRESSED:
        return read_compressed(&h, &l, o->max_bytes, list);
    default:
        return read_text(&h, &l, list);
    }
}
