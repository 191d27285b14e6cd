#include "codec.h"

#include <string.h>

#include "face.h"
#include "face_work.h"
#include "lattice.h"
#include "mesh.h"
#include "mesh_link.h"

/* The layout: db/FORMAT.md. */
#define MAGIC   "SURF"
#define VERSION 4
#define NARROW  65535 /* the largest number that fits 2 bytes */

enum {
    AT_MAGIC = 0,
    AT_VERSION = 4,
    AT_MODES = 6, /* of the encoding */
    AT_LENGTH = 8,
    AT_POINTS = 16,
    AT_TRIANGLES = 20,
    AT_SCALE = 24,
    AT_MARK = 28,
    AT_FRAME = 32, /* 9 + 3 doubles: rotation and shift, scanner -> canonical frame */
    AT_STEP = 128,
    AT_SEEN = 132, /* and what is explained of it */
    HEADER = 140,
    THERE = GRID_N / 8
};

/* ---- little-endian numbers at any address: what there are many of, without a loop */

static void put16(unsigned char *p, uint32_t v)
{
    p[0] = (unsigned char)(v & 0xff);
    p[1] = (unsigned char)(v >> 8 & 0xff);
}

static void put24(unsigned char *p, uint32_t v)
{
    put16(p, v & 0xffff);
    p[2] = (unsigned char)(v >> 16 & 0xff);
}

static void put32(unsigned char *p, uint32_t v)
{
    put16(p, v & 0xffff);
    put16(p + 2, v >> 16);
}

static void put64(unsigned char *p, uint64_t v)
{
    put32(p, (uint32_t)(v & 0xffffffff));
    put32(p + 4, (uint32_t)(v >> 32));
}

static uint32_t get16(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

static uint32_t get24(const unsigned char *p)
{
    return get16(p) | (uint32_t)p[2] << 16;
}

static uint32_t get32(const unsigned char *p)
{
    return get16(p) | get16(p + 2) << 16;
}

static uint64_t get64(const unsigned char *p)
{
    return (uint64_t)get32(p) | (uint64_t)get32(p + 4) << 32;
}

/* Bytes of a number that is at most `most`: below 6 SURFACE_MAX_POINTS, so 3 are enough. */
static size_t width(uint32_t most)
{
    return most <= NARROW ? 2 : 3;
}

static void put_index(unsigned char *p, uint32_t v, size_t bytes)
{
    if (bytes == 2)
        put16(p, v);
    else
        put24(p, v);
}

/* n numbers to v[0], v[stride], ...; returns what follows them. */
static const unsigned char *get_indices(const unsigned char *p, uint32_t *v, size_t n,
                                        size_t stride, size_t bytes)
{
    if (bytes == 2)
        for (size_t i = 0; i < n; i++)
            v[stride * i] = get16(p + 2 * i);
    else
        for (size_t i = 0; i < n; i++)
            v[stride * i] = get24(p + 3 * i);
    return p + n * bytes;
}

/* Two's complement in 32 bits to int32_t, without relying on how a conversion overflows. */
static int32_t to_signed(uint32_t v)
{
    int32_t s;

    memcpy(&s, &v, sizeof s);
    return s;
}

/* ---- models */

/* A model's numbers of vertices and of half-edges have these bytes each. */
static size_t vertex_width(uint32_t nv)
{
    return width(nv); /* the ghost's is nv */
}

static size_t half_width(uint32_t nv)
{
    return width(6 * nv - 7); /* 2 nv - 2 triangles */
}

/* Of an encoding with this many modes. */
static size_t encoding_size(size_t modes)
{
    return 8 + THERE + 4 * modes + 2 * modes * (modes + 1);
}

static size_t size_of(uint32_t nv, uint32_t modes)
{
    const size_t n = nv, nt = 2 * n - 2;

    return HEADER + encoding_size(modes) + 12 * n + 2 * nt * half_width(nv) +
           (nt + n) * vertex_width(nv);
}

size_t surface_encoded_size(const struct surface_face *f)
{
    return size_of(f->surface.mesh.nv, f->encoding.n);
}

size_t surface_encoded_head(const void *bytes, size_t length)
{
    const unsigned char *p = bytes;
    const size_t head = length < HEADER ? 0 : HEADER + encoding_size(get16(p + AT_MODES));

    return head <= length ? head : 0;
}

static void put_frame(unsigned char *p, const struct pose *a)
{
    for (size_t i = 0; i < 12; i++) {
        uint64_t bits;

        memcpy(&bits, i < 9 ? &a->r[i] : &a->t[i - 9], sizeof bits);
        put64(p + 8 * i, bits);
    }
}

/* False: no similarity, beyond the lattice, or of no head's size. */
static bool get_frame(const unsigned char *p, struct pose *a)
{
    const double *r = a->r;
    struct pose rigid;
    double scale;

    for (size_t i = 0; i < 12; i++) {
        const uint64_t bits = get64(p + 8 * i);

        memcpy(i < 9 ? &a->r[i] : &a->t[i - 9], &bits, sizeof bits);
    }
    scale = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    rigid = pose_unscaled(a);
    return scale > 0.25 && scale < 4 && pose_rigid(&rigid);
}

static unsigned char *put_float(unsigned char *p, float v)
{
    uint32_t bits;

    memcpy(&bits, &v, sizeof bits);
    put32(p, bits);
    return p + 4;
}

/* False: not finite. */
static bool get_floats(const unsigned char *p, float *v, size_t n)
{
    bool finite = true;

    for (size_t i = 0; i < n; i++) {
        const uint32_t bits = get32(p + 4 * i);

        memcpy(&v[i], &bits, sizeof bits);
        finite &= (bits & 0x7f800000) != 0x7f800000;
    }
    return finite;
}

/* False: no fit sees or explains so much. */
static bool get_fit(const unsigned char *p, struct frame *out)
{
    return get_floats(p, &out->seen, 1) && get_floats(p + 4, &out->explained, 1) &&
           out->seen >= 0.0f && out->seen <= (float)GRID_N && out->explained <= 1.0f;
}

static unsigned char *put_encoding(unsigned char *p, const struct encoding *e)
{
    p = put_float(p, e->residual_mm);
    put32(p, e->cells);
    memcpy(p + 4, e->there, THERE);
    p += 4 + THERE;
    for (uint32_t i = 0; i < e->n; i++)
        p = put_float(p, e->b[i]);
    for (uint32_t i = 0; i < e->n * (e->n + 1) / 2; i++)
        p = put_float(p, e->a[i]);
    return p;
}

/* False: no encoding. */
static bool get_encoding(const unsigned char *p, uint32_t modes, struct encoding *e)
{
    uint32_t cells = 0;
    bool good;

    e->n = modes;
    good = get_floats(p, &e->residual_mm, 1) && e->residual_mm >= 0.0f;
    e->cells = get32(p + 4);
    memcpy(e->there, p + 8, THERE);
    for (size_t i = 0; i < THERE; i++)
        cells += (uint32_t)__builtin_popcount(e->there[i]);
    p += 8 + THERE;
    good &= cells == e->cells && get_floats(p, e->b, modes);
    return good && get_floats(p + 4 * modes, e->a, modes * (modes + 1) / 2);
}

void surface_encode(const struct surface_face *f, void *bytes)
{
    unsigned char *buf = bytes;
    const struct mesh *m = &f->surface.mesh;
    const size_t half = half_width(m->nv), vertex = vertex_width(m->nv);
    unsigned char *p = buf + HEADER;

    memcpy(buf + AT_MAGIC, MAGIC, 4);
    put16(buf + AT_VERSION, VERSION);
    put16(buf + AT_MODES, f->encoding.n);
    put64(buf + AT_LENGTH, surface_encoded_size(f));
    put32(buf + AT_POINTS, m->nv);
    put32(buf + AT_TRIANGLES, m->nt);
    put32(buf + AT_SCALE, (uint32_t)LATTICE_PER_MM);
    put32(buf + AT_MARK, f->frame.mean_id);
    put_frame(buf + AT_FRAME, &f->frame.pose);
    (void)put_float(buf + AT_STEP, f->step_mm);
    (void)put_float(put_float(buf + AT_SEEN, f->frame.seen), f->frame.explained);
    p = put_encoding(p, &f->encoding);
    for (uint32_t v = 0; v < m->nv; v++, p += 8) {
        put32(p, (uint32_t)m->xy[v].x);
        put32(p + 4, (uint32_t)m->xy[v].y);
    }
    for (uint32_t v = 0; v < m->nv; v++, p += 4)
        put32(p, (uint32_t)m->z[v]);
    for (uint32_t t = 0; t < m->nt; t++, p += half)
        put_index(p, m->org[3 * t + 2] == m->nv ? m->org[3 * t] : m->twin[3 * t], half);
    for (uint32_t t = 0; t < m->nt; t++, p += vertex)
        put_index(p, m->org[3 * t + 2], vertex);
    for (uint32_t h = 0; h < 3 * m->nt; h++)
        if (mesh_listed(m, h)) {
            put_index(p, h, half);
            put_index(p + half, m->twin[h], half);
            p += 2 * half;
        }
    for (uint32_t v = 0; v < m->nv; v++, p += vertex)
        put_index(p, m->parent[v], vertex);
}

/* Of the whole block, or of its head alone. */
static enum status check_header(const unsigned char *p, size_t len)
{
    uint32_t nv, modes;

    if (len < HEADER || memcmp(p + AT_MAGIC, MAGIC, 4) != 0)
        return ST_ECORRUPT;
    if (get16(p + AT_VERSION) != VERSION)
        return ST_EVERSION;
    nv = get32(p + AT_POINTS);
    modes = get16(p + AT_MODES);
    return get64(p + AT_LENGTH) == size_of(nv, modes) && nv >= 3 &&
                   nv <= SURFACE_MAX_POINTS && modes <= MODEL_MODES &&
                   (size_of(nv, modes) == len || HEADER + encoding_size(modes) == len) &&
                   get32(p + AT_TRIANGLES) == 2 * nv - 2 &&
                   get32(p + AT_SCALE) == (uint32_t)LATTICE_PER_MM
               ? ST_OK
               : ST_ECORRUPT;
}

/* The mesh of nv points behind the head, unchecked. */
static enum status get_mesh(const unsigned char *p, uint32_t nv, struct mesh *m)
{
    const enum status st = mesh_reserve(m, nv);

    if (st != ST_OK)
        return st;
    m->nv = nv;
    m->nt = 2 * nv - 2;
    for (uint32_t v = 0; v < nv; v++, p += 8) {
        m->xy[v].x = to_signed(get32(p));
        m->xy[v].y = to_signed(get32(p + 4));
    }
    for (uint32_t v = 0; v < nv; v++, p += 4)
        m->z[v] = to_signed(get32(p));
    p = get_indices(p, m->twin, m->nt, 3, half_width(nv));
    p = get_indices(p, m->org + 2, m->nt, 3, vertex_width(nv));
    for (uint32_t t = 0; t < m->nt && m->org[3 * t + 2] == nv; t++)
        m->org[3 * t] = m->twin[3 * t]; /* a ghost has no gate */
    p = get_indices(p, m->org + 1, m->nt, 3, half_width(nv));
    (void)get_indices(p, m->parent, nv, 1, vertex_width(nv));
    return ST_OK;
}

enum status codec_decode(const void *buf, size_t len, struct surface_work *w,
                         struct surface_face *out)
{
    const unsigned char *p = buf;
    enum status st;
    uint32_t modes;
    size_t head;
    bool good;

    out->surface.mesh.nv = out->surface.mesh.nt = 0;
    if ((st = check_header(p, len)) != ST_OK)
        return st;
    modes = get16(p + AT_MODES);
    head = HEADER + encoding_size(modes);
    out->frame = (struct frame){.mean_id = get32(p + AT_MARK)};
    good = get_frame(p + AT_FRAME, &out->frame.pose) || out->frame.mean_id == 0;
    good &= get_floats(p + AT_STEP, &out->step_mm, 1) && out->step_mm >= 0.0f;
    good &= get_fit(p + AT_SEEN, &out->frame);
    if (!good || !get_encoding(p + HEADER, modes, &out->encoding))
        return ST_ECORRUPT;
    memset(&out->quality, 0, sizeof out->quality);
    if (len == head)
        return out->frame.mean_id == w->mean.mean_id ? ST_OK : ST_EVERSION;
    st = get_mesh(p + head, get32(p + AT_POINTS), &out->surface.mesh);
    return st == ST_OK ? face_adopt(out, w) : st;
}

enum surface_status surface_decode(struct surface_work *work, const void *bytes,
                                   size_t length, struct surface_face **out)
{
    struct surface_face *f = face_renew(out);

    return face_finish(f == NULL ? ST_ENOMEM : codec_decode(bytes, length, work, f), f,
                       out);
}
