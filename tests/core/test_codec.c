/* A face model as bytes and back; damaged bytes are refused. */
#include "pose.h"
#include "brute.h"
#include "codec.h"
#include "delaunay.h"
#include "face.h"
#include "faces.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "model.h"
#include "mst.h"
#include "unit.h"

#define GOLDEN   "tests/golden/face_v4.bin"
#define HEADER   140
#define ENCODING 172 /* with no modes */
#define MODES    6   /* where the number of modes is, */
#define MARK     28  /* where the frame's mark is */
#define FRAME    32  /* and the frame: 12 doubles */

static struct scratch scratch;
static struct ivec3 pts[70000];

static void build(enum brute_shape shape, size_t n, struct draw *r,
                  struct surface_face *f)
{
    n = brute_points(shape, n, r, pts);
    assert_int_equal(delaunay_build(pts, n, &scratch, &f->surface.mesh), ST_OK);
    assert_int_equal(mst_build(&f->surface.mesh, &scratch), ST_OK);
}

static unsigned char *encode(const struct surface_face *f, size_t *len)
{
    unsigned char *buf = malloc(*len = surface_encoded_size(f));

    assert_non_null(buf);
    surface_encode(f, buf);
    return buf;
}

/* Decode from a block that ends where its bytes do, for the address sanitizer. */
static enum status decode(const unsigned char *buf, size_t len, struct surface_face *f)
{
    unsigned char *exact = malloc(len != 0 ? len : 1);
    enum status st;

    assert_non_null(exact);
    memcpy(exact, buf, len);
    st = codec_decode(exact, len, faces_work, f);
    if (st != ST_OK)
        assert_int_equal(f->surface.mesh.nv, 0);
    free(exact);
    return st;
}

static void assert_same(const struct mesh *a, const struct mesh *b)
{
    assert_true(brute_identical(a, b));
    assert_memory_equal(a->parent, b->parent, a->nv * sizeof *a->parent);
}

/* A mesh that never was a face has no frame yet: the first decoding finds one, which from
 * then on is kept. */
static void round_trip(const struct surface_face *f)
{
    struct surface_face g = {0}, h = {0};
    struct pose rigid;
    size_t len;
    unsigned char *buf = encode(f, &len), *odd = malloc(len + 1), *again;

    if (f->surface.mesh.nv >= 100 && f->surface.mesh.nv <= 65535)
        assert_true(len <= 32 * (size_t)f->surface.mesh.nv + ENCODING);
    assert_non_null(odd);
    memcpy(odd + 1, buf, len); /* at an odd address */
    assert_int_equal(codec_decode(odd + 1, len, faces_work, &g), ST_OK);
    assert_same(&f->surface.mesh, &g.surface.mesh);
    rigid = pose_unscaled(&g.frame.pose);
    assert_true(pose_rigid(&rigid) && g.frame.mean_id != 0);
    free(buf);
    buf = encode(&g, &len);
    assert_int_equal(codec_decode(buf, len, faces_work, &h), ST_OK);
    assert_same(&f->surface.mesh, &h.surface.mesh);
    assert_memory_equal(&g.frame.pose, &h.frame.pose, sizeof g.frame.pose);
    assert_int_equal(g.encoding.n, h.encoding.n);
    again = encode(&h, &len);
    assert_memory_equal(buf, again, len);
    free(again);
    free(buf);
    free(odd);
    face_free(&g);
    face_free(&h);
}

TEST(test_round_trip)
{
    /* The last with half-edges, and with points, of two bytes, and the next. */
    static const struct {
        uint32_t n, bytes, less;
    } edge[] = {{10923, 26, 12}, {10924, 30, 16}, {65535, 30, 16}, {65536, 33, 18}};
    struct draw r = {brute_seed("codec")};
    struct surface_face f = {0};

    for (int shape = 0; shape < BRUTE_SHAPES; shape++)
        for (size_t n = 3; n <= 3000; n = n * 2 + 1) {
            build((enum brute_shape)shape, n, &r, &f);
            round_trip(&f);
        }
    for (size_t i = 0; i < sizeof edge / sizeof *edge; i++) {
        const uint32_t n = edge[i].n;

        assert_true(brute_points(BRUTE_RANDOM, n + 100, &r, pts) >= n);
        assert_int_equal(delaunay_build(pts, n, &scratch, &f.surface.mesh), ST_OK);
        assert_int_equal(mst_build(&f.surface.mesh, &scratch), ST_OK);
        round_trip(&f);
        assert_int_equal(surface_encoded_size(&f),
                         HEADER + ENCODING + edge[i].bytes * n - edge[i].less);
    }
    face_free(&f);
}

/* Any other length than the block's own and its head's is refused; the head of no model's face is. */
TEST(test_length)
{
    struct draw r = {brute_seed("bytes")};
    struct surface_face f = {0}, g = {0};
    size_t len;
    unsigned char *buf;

    build(BRUTE_RANDOM, 60, &r, &f);
    buf = encode(&f, &len);
    for (size_t n = 0; n < len; n++)
        assert_int_equal(decode(buf, n, &g),
                         n == surface_encoded_head(buf, len) ? ST_EVERSION : ST_ECORRUPT);
    assert_int_equal(surface_encoded_head(buf, 139), 0);
    buf = realloc(buf, len + 1);
    assert_non_null(buf);
    buf[len] = 0;
    assert_int_equal(decode(buf, len + 1, &g), ST_ECORRUPT);
    assert_int_equal(decode(buf, len, &g), ST_OK);
    free(buf);
    face_free(&f);
    face_free(&g);
}

/* A walk to each vertex ends there: tests/core/test_mesh.c says what mesh_link() refuses. */
static void assert_safe(const struct mesh *m)
{
    struct location *loc = malloc(m->nv * sizeof *loc);

    assert_non_null(loc);
    locate_mesh(m, m, loc);
    for (uint32_t v = 0; v < m->nv; v++)
        assert_int_equal(loc[v].where, LOCATE_VERTEX);
    free(loc);
}

/* Whatever byte is changed: what is accepted is safe to walk on.  The mark is test_frame()'s:
 * with another one the frame is found again, which takes a millisecond. */
TEST(test_checked)
{
    struct draw r = {brute_seed("sealed")};
    struct surface_face f = {0}, g = {0};
    uint32_t accepted = 0, refused = 0;
    size_t len;
    unsigned char *buf;

    for (int shape = 0; shape < BRUTE_SHAPES; shape++) {
        build((enum brute_shape)shape, 40, &r, &f);
        buf = encode(&f, &len);
        assert_int_equal(decode(buf, len, &g), ST_OK); /* which finds its frame */
        free(buf);
        buf = encode(&g, &len);
        for (size_t i = 0; i < len; i++) {
            if (i >= MARK && i < MARK + 4)
                continue;
            for (unsigned change = 1; change < 256; change += 1 + change / 4) {
                buf[i] ^= (unsigned char)change;
                if (decode(buf, len, &g) == ST_OK) {
                    assert_safe(&g.surface.mesh);
                    accepted++;
                } else {
                    refused++;
                }
                buf[i] ^= (unsigned char)change;
            }
        }
        free(buf);
    }
    print_message("%u refused, %u accepted\n", refused, accepted);
    assert_true(refused > 50000 && accepted > 5000);
    face_free(&f);
    face_free(&g);
}

static size_t golden(const char *path, unsigned char buf[1024])
{
    FILE *in = fopen(path, "rb");
    size_t len;

    assert_non_null(in);
    len = fread(buf, 1, 1024, in);
    (void)fclose(in);
    return len;
}

/* A model made by hand: a square with its centre, on a roof. */
TEST(test_golden)
{
    static const struct ivec2 xy[5] = {
        {-50000, -50000}, {0, 0}, {-50000, 50000}, {50000, -50000}, {50000, 50000}};
    static const uint32_t parent[5] = {0, 0, 1, 1, 1};
    static const struct frame frame = {
        {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {1, -2, 0.5}}, 0x04030201, 0, 0, 0, 870, 0.75f};
    static const struct encoding encoding = {.a = {4, 0.5f, 9},
                                             .b = {1.5f, -2},
                                             .residual_mm = 0.75f,
                                             .cells = 3,
                                             .there = {[0] = 0x81, [163] = 0x40},
                                             .n = 2};
    struct surface_face f = {0};
    unsigned char buf[1024], again[1024];
    size_t len = 0;

    len = golden(GOLDEN, buf);
    assert_int_equal(codec_decode(buf, len, faces_work, &f), ST_OK);
    assert_int_equal(f.surface.mesh.nv, 5);
    assert_int_equal(f.surface.mesh.nt, 8);
    assert_int_equal(mesh_real(&f.surface.mesh), 4);
    assert_memory_equal(f.surface.mesh.xy, xy, sizeof xy);
    assert_memory_equal(f.surface.mesh.parent, parent, sizeof parent);
    for (uint32_t v = 0; v < 5; v++)
        assert_int_equal(f.surface.mesh.z[v], v == 1 ? 20000 : -1000);
    assert_true(f.frame.mean_id != 0 &&
                f.frame.mean_id != frame.mean_id); /* found again */
    assert_float_equal(f.step_mm, 2.5f, 0);
    f.frame = frame;
    f.encoding = encoding;
    assert_int_equal(surface_encoded_size(&f), len);
    surface_encode(&f, again);
    assert_memory_equal(buf, again, len);
    buf[4] = 5; /* a version to come */
    assert_int_equal(codec_decode(buf, len, faces_work, &f), ST_EVERSION);
    buf[4] = 2;
    assert_int_equal(codec_decode(buf, len, faces_work, &f), ST_EVERSION);
    face_free(&f);
}

/* ---- the canonical frame */

static void put_double(unsigned char *p, double v)
{
    uint64_t bits;

    memcpy(&bits, &v, sizeof bits);
    for (int i = 0; i < 8; i++)
        p[i] = (unsigned char)(bits >> 8 * i & 0xff);
}

static unsigned char *encoded_face(struct surface_face *f, size_t *len)
{
    faces_scan(3, 1, 2000);
    faces_build(f);
    return encode(f, len);
}

static void check_close(const struct pose *a, const struct pose *b)
{
    for (int i = 0; i < 9; i++)
        assert_true(fabs(a->r[i] - b->r[i]) < 0.01);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(a->t[i] - b->t[i]) < 0.5);
}

/* The frame is kept to the last digit; another mean face's is found again; what is no
 * similarity of a head's size is refused. */
TEST(test_frame)
{
    static const struct {
        size_t at;
        double value;
    } bad[] = {{0, 1.01}, {4, -1}, {8, (double)NAN}, {9, 1e6}, {11, -(double)INFINITY}};
    struct surface_face f = {0}, g = {0};
    size_t len;
    unsigned char *buf = encoded_face(&f, &len), *other = malloc(len);

    assert_non_null(other);
    assert_int_equal(decode(buf, len, &g), ST_OK);
    assert_int_equal(f.frame.mean_id, g.frame.mean_id);
    assert_memory_equal(&f.frame.pose, &g.frame.pose, sizeof f.frame.pose);
    for (size_t i = 0; i < 12; i++) /* a motion, but not this face's: who would know? */
        put_double(buf + FRAME + 8 * i, i == 0 || i == 4 || i == 8 ? 1 : 0);
    assert_int_equal(decode(buf, len, &g), ST_OK);
    assert_true(g.frame.pose.r[0] == 1 && g.frame.pose.t[1] == 0);
    memcpy(other, buf, len);
    other[MARK] ^= 1;
    assert_int_equal(decode(other, len, &g), ST_OK);
    assert_int_equal(f.frame.mean_id, g.frame.mean_id);
    check_close(&f.frame.pose, &g.frame.pose);
    for (double size = 0.25; size < 4.5; size += 0.5) { /* of a head: half to twice */
        for (size_t i = 0; i < 9; i += 4)
            put_double(buf + FRAME + 8 * i, 1 / size);
        assert_int_equal(decode(buf, len, &g),
                         size > 0.5 && size < 2 ? ST_OK : ST_ECORRUPT);
    }
    for (size_t i = 0; i < 9; i += 4)
        put_double(buf + FRAME + 8 * i, 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        memcpy(other, buf, len);
        put_double(other + FRAME + 8 * bad[i].at, bad[i].value);
        assert_int_equal(decode(other, len, &g), ST_ECORRUPT);
    }
    free(buf);
    free(other);
    face_free(&f);
    face_free(&g);
}

/* ---- the encoding */

static void put_bits(unsigned char *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(v >> 8 * i & 0xff);
}

/* Of a face that was built it is what face_build() made, to the last bit; of any other number of
 * modes too, none and the most included. */
TEST(test_encoding)
{
    static const uint32_t modes[] = {0, 1, 7, MODEL_MODES};
    struct draw r = {brute_seed("encoding")};
    struct surface_face f = {0}, g = {0};
    size_t len;
    unsigned char *buf = encoded_face(&f, &len);

    assert_true(f.encoding.n > 0);
    assert_int_equal(decode(buf, len, &g), ST_OK);
    assert_memory_equal(&f.encoding, &g.encoding, sizeof f.encoding);
    free(buf);
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
        memset(&f.encoding, 0, sizeof f.encoding);
        memset(&g.encoding, 0, sizeof g.encoding);
        f.encoding.n = modes[i];
        f.encoding.residual_mm = (float)draw_uniform(&r, 0, 1);
        for (uint32_t k = 0; k < modes[i]; k++)
            f.encoding.b[k] = (float)draw_uniform(&r, -0.5, 0.5);
        for (uint32_t k = 0; k < modes[i] * (modes[i] + 1) / 2; k++)
            f.encoding.a[k] = (float)draw_uniform(&r, -0.5, 0.5);
        for (uint32_t k = 0; k < GRID_N; k += 5, f.encoding.cells++)
            f.encoding.there[k / 8] |= (uint8_t)(1U << k % 8);
        buf = encode(&f, &len);
        assert_int_equal(decode(buf, len, &g), ST_OK);
        assert_memory_equal(&f.encoding, &g.encoding, sizeof f.encoding);
        free(buf);
    }
    face_free(&f);
    face_free(&g);
}

/* An encoding that contradicts itself, or has a number that is none, is refused; so is one of
 * more modes than there are, and one that is cut off. */
TEST(test_bad_encoding)
{
    static const uint32_t none[] = {0x7fc00000, 0x7f800000, 0xff800000, 0xffffffff,
                                    0x7f800001}; /* NAN, infinite, ... */
    static const struct {
        size_t at;
        uint32_t bits;
    } bad[] = {
        {HEADER - 12, 0xbf800000},                           /* a step of -1 */
        {HEADER - 8, 0xbf800000},                            /* -1 cells seen, 1312.03 */
        {HEADER - 8, 0x44a40100},  {HEADER - 4, 0x3f800001}, /* 1 and a bit explained */
        {HEADER, 0xbf800000},                                /* a residual of -1 */
        {HEADER + 4, 0}, /* fewer cells than there are, more */
        {HEADER + 4, GRID_N},
    };
    static const size_t there[] = {HEADER + 8 + 50, HEADER + 8 + GRID_N / 8 - 1};
    struct surface_face f = {0}, g = {0};
    size_t len;
    unsigned char *buf = encoded_face(&f, &len), *other = malloc(len);
    const uint32_t n = f.encoding.n, pairs = n * (n + 1) / 2;
    const uint32_t at[] = {0, 1, n - 1, n, n + pairs / 2, n + pairs - 1};

    assert_non_null(other);
    for (size_t k = 0; k < sizeof none / sizeof *none; k++)
        for (size_t i = 0; i <= sizeof at / sizeof *at; i++) {
            memcpy(other, buf, len);
            put_bits(other + (i == 0 ? HEADER : HEADER + ENCODING + 4 * at[i - 1]),
                     none[k]);
            assert_int_equal(decode(other, len, &g), ST_ECORRUPT);
        }
    for (size_t k = 0; k < sizeof none / sizeof *none; k++)
        for (size_t i = HEADER - 12; i < HEADER; i += 4) {
            memcpy(other, buf, len);
            put_bits(other + i, none[k]);
            assert_int_equal(decode(other, len, &g), ST_ECORRUPT);
        }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        memcpy(other, buf, len);
        put_bits(other + bad[i].at, bad[i].bits);
        assert_int_equal(decode(other, len, &g), ST_ECORRUPT);
    }
    for (size_t i = 0; i < sizeof there / sizeof *there; i++) { /* a cell more or less */
        memcpy(other, buf, len);
        other[there[i]] ^= 16;
        assert_int_equal(decode(other, len, &g), ST_ECORRUPT);
    }
    put_bits(buf + HEADER, 0); /* as little as there may be */
    assert_int_equal(decode(buf, len, &g), ST_OK);
    free(buf);
    free(other);
    face_free(&f);
    face_free(&g);
}

/* The number of modes says how long the block is: more than MODEL_MODES, or one more or less than
 * there are, is refused even where the length of the header agrees. */
TEST(test_modes)
{
    struct surface_face f = {0}, g = {0};
    size_t len;
    unsigned char *buf = encoded_face(&f, &len), *other;
    const uint32_t n = f.encoding.n;

    for (uint32_t modes = 0; modes <= MODEL_MODES + 2; modes++) {
        const size_t was = 4 * n + 2 * n * (n + 1),
                     now = 4 * modes + 2 * modes * (modes + 1);
        const size_t size = len - was + now, head = HEADER + ENCODING;

        for (int fits = 0; fits < 2; fits++) {
            const size_t total = fits ? size : len;

            assert_non_null(other = calloc(total, 1));
            memcpy(other, buf, fits ? head : len);
            if (fits) /* the rest of the face where it belongs then */
                memcpy(other + head + now, buf + head + was, len - head - was);
            other[MODES] = (unsigned char)(modes & 0xff);
            other[MODES + 1] = (unsigned char)(modes >> 8);
            put_bits(other + 8, (uint32_t)total);
            assert_int_equal(decode(other, total, &g),
                             (fits || modes == n) && modes <= MODEL_MODES ? ST_OK
                                                                          : ST_ECORRUPT);
            free(other);
        }
    }
    for (size_t cut = HEADER; cut < HEADER + ENCODING + 4 * n; cut += 37) {
        assert_non_null(other = malloc(len));
        memcpy(other, buf, len);
        put_bits(other + 8, (uint32_t)cut);
        assert_int_equal(decode(other, cut, &g), ST_ECORRUPT);
        free(other);
    }
    free(buf);
    face_free(&f);
    face_free(&g);
}

AFTER_ALL(tear_down)
{
    scratch_free(&scratch);
}
