#include "cloudply.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "cloudlist.h"
#include "cloudplyhead.h"
#include "cloudtext.h"
#include "lattice.h"
#include "mesh.h"

/* A file's data, as it is read. */
struct data {
    struct cloudtext *t;
    struct cloudplyhead h;
    struct cloudlist *list;
    bool text;
};

static enum status cut_off(struct data *d, uint64_t row)
{
    return cloudtext_fail(
        d->t, ST_EINVAL,
        "the header promises %llu vertices, the data ends in number %llu",
        (unsigned long long)d->h.element[d->h.vertex].rows, (unsigned long long)row + 1);
}

static enum status ends_before(struct data *d)
{
    return cloudtext_fail(d->t, ST_EINVAL, "the data ends before the vertices");
}

static enum status too_few(struct data *d)
{
    return cloudtext_fail(d->t, ST_EINVAL, "the line has too few numbers");
}

/* ---- rows of any kind, text or binary */

/* The next value.  ST_ENOTFOUND: the data ends. */
static enum status take(struct data *d, enum cloudvalue type, double *out)
{
    struct cloudtext *t = d->t;

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
    for (; n > 0; n--) {
        size_t len;

        (void)cloudtext_word(t, &len);
        if (len == 0)
            return too_few(d);
    }
    return ST_OK;
}

/* A face's n corners, as a fan of triangles. */
static enum status take_corners(struct data *d, enum cloudvalue type, uint64_t n)
{
    uint64_t corner[3];
    enum status st = ST_OK;

    for (uint64_t i = 0; i < n && st == ST_OK; i++) {
        double value;

        if ((st = take(d, type, &value)) != ST_OK)
            return st;
        if (!(value >= 0 && value <= UINT32_MAX && floor(value) == value))
            return ST_EINVAL;
        corner[i < 3 ? i : 2] = (uint64_t)value;
        if (i >= 2) {
            st = cloudlist_face(d->list, corner);
            corner[1] = corner[2];
        }
    }
    return st;
}

static enum status take_list(struct data *d, const struct cloudplyhead_property *q,
                             bool faces)
{
    double n;
    enum status st = take(d, q->count, &n);

    if (st != ST_OK)
        return st;
    if (!(n >= 0 && n <= 4294967295.0 && floor(n) == n))
        return cloudtext_fail(d->t, ST_EINVAL, "a list's length is not a count");
    return faces && q->role == CLOUDPLYHEAD_CORNERS
               ? take_corners(d, q->type, (uint64_t)n)
               : skip(d, q->type, (uint64_t)n);
}

/* One row: a vertex into value; a face, with faces, into the list.  ST_ENOTFOUND: the data
 * ends before or in it. */
static enum status read_row(struct data *d, const struct cloudplyhead_element *e,
                            double value[6], bool faces)
{
    struct cloudtext *t = d->t;
    enum status st = ST_OK;

    if (d->text) { /* on a line of its own; blank lines before it are skipped */
        for (cloudtext_blank(t); cloudtext_eol(t) && t->p < t->end; cloudtext_blank(t))
            cloudtext_newline(t);
        if (t->p == t->end)
            return ST_ENOTFOUND;
    }
    for (uint32_t i = e->first; i < e->first + e->n && st == ST_OK; i++) {
        const struct cloudplyhead_property *q = &d->h.property[i];

        if (q->count != CLOUDVALUE_NONE)
            st = take_list(d, q, faces);
        else if (q->role < CLOUDPLYHEAD_CORNERS)
            st = take(d, q->type, &value[q->role]);
        else
            st = skip(d, q->type, 1);
    }
    if (st != ST_OK || !d->text)
        return st;
    cloudtext_blank(t);
    return cloudtext_eol(t)
               ? ST_OK
               : cloudtext_fail(t, ST_EINVAL,
                                "the line has more numbers than the header says");
}

/* ---- the vertices */

static enum status add(struct data *d, const double value[6])
{
    enum status st = cloudlist_add(d->list, (struct dvec3){value[0], value[1], value[2]});

    if (st == ST_OK && d->h.normals)
        st = cloudlist_normal(d->list, (struct dvec3){value[3], value[4], value[5]});
    return st;
}

/* Binary rows of one length, which are all there. */
static enum status read_fixed(struct data *d, const struct cloudplyhead_element *e)
{
    const unsigned char *row = (const unsigned char *)d->t->p;
    size_t at[6] = {0}, offset = 0;
    enum cloudvalue type[6] = {CLOUDVALUE_NONE};
    const int most = d->h.normals ? 6 : 3;
    enum status st = ST_OK;

    for (uint32_t i = e->first; i < e->first + e->n; i++) {
        const struct cloudplyhead_property *q = &d->h.property[i];

        if (q->role < CLOUDPLYHEAD_CORNERS) {
            at[q->role] = offset;
            type[q->role] = q->type;
        }
        offset += cloudvalue_size[q->type];
    }
    for (uint64_t k = 0; k < e->rows && st == ST_OK; k++, row += e->stride) {
        double value[6];

        for (int i = 0; i < most; i++)
            value[i] = cloudvalue_load(row + at[i], type[i], d->h.swap);
        st = add(d, value);
    }
    d->t->p = (const char *)row;
    return st;
}

static enum status read_vertices(struct data *d, const struct cloudplyhead_element *e)
{
    if (!d->text && !e->lists)
        return read_fixed(d, e);
    for (uint64_t i = 0; i < e->rows; i++) {
        double value[6] = {0};
        enum status st = read_row(d, e, value, false);

        if (st == ST_ENOTFOUND)
            return cut_off(d, i);
        if (st != ST_OK || (st = add(d, value)) != ST_OK)
            return st;
    }
    return ST_OK;
}

/* The vertices come next: are there enough bytes for as many as the header says? */
static enum status check_count(struct data *d, const struct cloudplyhead_element *e)
{
    const uint64_t left = (uint64_t)(d->t->end - d->t->p);
    /* As text a value takes a digit and a separator, but for the last one. */
    const uint64_t least = d->text ? 2 * (uint64_t)e->n : e->stride;
    const uint64_t fit = (left + d->text) / least;

    return e->rows > fit ? cut_off(d, fit) : ST_OK;
}

/* ---- the other elements */

static enum status skip_element(struct data *d, const struct cloudplyhead_element *e)
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
        enum status st = read_row(d, e, ignored, false);

        if (st == ST_ENOTFOUND)
            return ends_before(d);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* The normals by the faces.  They are a help: where they cannot be read the points are all
 * there is, as in files that end after them. */
static enum status read_faces(struct data *d, const struct cloudplyhead_element *e)
{
    struct errinfo *const told = d->t->e;
    const struct cloudplyhead_element *const last = &d->h.element[d->h.elements - 1];
    double none[6];
    enum status st = ST_OK;

    d->t->e = NULL;
    while (st == ST_OK && ++e <= last && !e->faces)
        st = skip_element(d, e);
    for (uint64_t row = 0; st == ST_OK && e <= last && e->n > 0 && row < e->rows; row++)
        st = read_row(d, e, none, true);
    d->t->e = told;
    if (st == ST_OK || st == ST_ENOMEM)
        return st;
    cloudlist_forget(d->list);
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

enum status cloudply_parse(struct cloudtext *t, struct cloudlist *list)
{
    struct data d = {.t = t, .list = list};
    const struct cloudplyhead_element *vertex;
    enum status st;

    if ((st = cloudplyhead_read(t, &d.h)) != ST_OK)
        return st;
    vertex = &d.h.element[d.h.vertex];
    d.text = d.h.encoding == CLOUDPLYHEAD_ASCII;
    if (!d.text)
        t->line = 0;
    else if ((st = cloudtext_plain(t)) != ST_OK)
        return st;
    for (const struct cloudplyhead_element *e = d.h.element; e < vertex; e++)
        if ((st = skip_element(&d, e)) != ST_OK)
            return st;
    if ((st = check_count(&d, vertex)) != ST_OK ||
        (st = cloudlist_room(list, (size_t)vertex->rows)) != ST_OK ||
        (st = read_vertices(&d, vertex)) != ST_OK)
        return st;
    if (vertex == &d.h.element[d.h.elements - 1])
        return check_end(t);
    return d.h.normals ? ST_OK : read_faces(&d, vertex);
}

void cloudply_write(FILE *to, const struct mesh *m)
{
    (void)fprintf(
        to,
        "ply\nformat ascii 1.0\ncomment mm\nelement vertex %u\n"
        "property float x\nproperty float y\nproperty float z\n"
        "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
        m->nv, mesh_real(m));
    for (uint32_t v = 0; v < m->nv; v++)
        (void)fprintf(to, "%.3f %.3f %.3f\n", m->xy[v].x / LATTICE_PER_MM,
                      m->xy[v].y / LATTICE_PER_MM, m->z[v] / LATTICE_PER_MM);
    for (uint32_t t = 0; t < m->nt; t++)
        if (!mesh_is_ghost(m, t))
            (void)fprintf(to, "3 %u %u %u\n", m->org[3 * t], m->org[3 * t + 1],
                          m->org[3 * t + 2]);
}
