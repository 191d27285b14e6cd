/* Scanner files: every PLY type and byte order, OBJ, XYZ, and malformed files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "cloudfile.h"
#include "mem.h"

#define LIMIT 100000

struct buffer {
    unsigned char bytes[65536];
    size_t len;
};

static void put(struct buffer *b, const void *bytes, size_t len)
{
    assert_true(b->len + len <= sizeof b->bytes);
    memcpy(b->bytes + b->len, bytes, len);
    b->len += len;
}

static void put_text(struct buffer *b, const char *text)
{
    put(b, text, strlen(text));
}

/* Parse a copy of exactly len bytes, so that the sanitizer sees a read too far. */
static enum status parse(const void *bytes, size_t len, enum cloudfile_format format,
                         struct dvec3 **out, size_t *n, struct clouderror *err)
{
    void *copy = malloc(len != 0 ? len : 1);
    enum status st;

    assert_non_null(copy);
    if (len != 0)
        memcpy(copy, bytes, len);
    memset(err, 0, sizeof *err);
    st = cloudfile_parse(copy, len, format, LIMIT, out, n, err);
    free(copy);
    if (st != ST_OK) {
        assert_null(*out);
        assert_true(*n == 0);
        assert_true(err->what[0] != 0);
        assert_true(err->where <= len);
    } else {
        assert_non_null(*out);
    }
    return st;
}

static void expect_points(const void *bytes, size_t len, enum cloudfile_format format,
                          const double (*want)[3], size_t nwant)
{
    struct clouderror err;
    struct dvec3 *pts;
    size_t n;
    enum status st = parse(bytes, len, format, &pts, &n, &err);

    if (st != ST_OK)
        fail_msg("line %u: %s", err.line, err.what);
    assert_int_equal(n, nwant);
    for (size_t i = 0; i < n; i++) {
        assert_true(pts[i].x == want[i][0]);
        assert_true(pts[i].y == want[i][1]);
        assert_true(pts[i].z == want[i][2]);
    }
    mem_free(pts);
}

static void expect_error(const char *text, enum cloudfile_format format, enum status want,
                         uint32_t line)
{
    struct clouderror err;
    struct dvec3 *pts;
    size_t n;
    enum status st = parse(text, strlen(text), format, &pts, &n, &err);

    if (st != want || (line != 0 && err.line != line))
        fail_msg("status %d, line %u (%s) for: %.80s", st, err.line, err.what, text);
    mem_free(pts);
}

/* ---- PLY */

static const struct {
    const char *name, *name2;
    unsigned size;
    bool real;
} types[] = {{"char", "int8", 1, false},    {"uchar", "uint8", 1, false},
             {"short", "int16", 2, false},  {"ushort", "uint16", 2, false},
             {"int", "int32", 4, false},    {"uint", "uint32", 4, false},
             {"float", "float32", 4, true}, {"double", "float64", 8, true}};
#define NTYPES (sizeof types / sizeof *types)

enum { ASCII, LITTLE, BIG };
static const char *const encodings[] = {"ascii", "binary_little_endian",
                                        "binary_big_endian"};

/* One value as encoded; integers are two's complement of the type's size. */
static void put_value(struct buffer *b, int encoding, size_t type, double value)
{
    unsigned char bytes[8];
    uint64_t bits;
    float f = (float)value;
    uint32_t fbits;

    if (encoding == ASCII) {
        char text[40];

        (void)snprintf(text, sizeof text, "%.17g ", value);
        put_text(b, text);
        return;
    }
    memcpy(&bits, &value, sizeof bits);
    memcpy(&fbits, &f, sizeof fbits);
    if (!types[type].real)
        bits = (uint64_t)(int64_t)value;
    else if (types[type].size == 4)
        bits = fbits;
    for (unsigned i = 0; i < types[type].size; i++) {
        unsigned at = encoding == LITTLE ? i : types[type].size - 1 - i;

        bytes[at] = (unsigned char)(bits >> (8 * i));
    }
    put(b, bytes, types[type].size);
}

static void end_row(struct buffer *b, int encoding, const char *eol)
{
    if (encoding == ASCII)
        put_text(b, eol);
}

/* Values that distinguish the types: negative and fractional ones where the type has them. */
static double sample(size_t type, size_t i)
{
    if (types[type].real)
        return (double)i * 0.25 - 100.125;
    if (type % 2 == 0)
        return (double)(i % 100) - 50;
    return (double)(200 + i % 50);
}

/* x, y and z of three types, with lists and other properties between them, and elements
 * before and after the vertices. */
static void make_ply(struct buffer *b, int encoding, const size_t axis[3], size_t count,
                     bool list_inside, const char *eol, double (*want)[3], size_t n)
{
    char line[200];

    b->len = 0;
    (void)snprintf(line, sizeof line, "ply%sformat %s 1.0%scomment caf\xC3\xA9 element%s",
                   eol, encodings[encoding], eol, eol);
    put_text(b, line);
    (void)snprintf(line, sizeof line,
                   "element camera 2%sproperty double f%s"
                   "property list %s short k%selement vertex %zu%s",
                   eol, eol, types[count].name, eol, n, eol);
    put_text(b, line);
    (void)snprintf(line, sizeof line, "property float32 nx%sproperty %s y%s", eol,
                   types[axis[1]].name, eol);
    put_text(b, line);
    if (list_inside) {
        (void)snprintf(line, sizeof line, "property list %s double w%s",
                       types[count].name2, eol);
        put_text(b, line);
    }
    (void)snprintf(
        line, sizeof line,
        "property %s x%sproperty uchar red%sobj_info z x%s"
        "property %s z%selement face 1%sproperty list uchar int vertex_indices%s"
        "end_header%s",
        types[axis[0]].name2, eol, eol, eol, types[axis[2]].name, eol, eol, eol, eol);
    put_text(b, line);
    for (size_t i = 0; i < 2; i++) {
        put_value(b, encoding, 7, 1.5);
        put_value(b, encoding, count, (double)i * 3);
        for (size_t k = 0; k < 3 * i; k++)
            put_value(b, encoding, 2, -7);
        end_row(b, encoding, eol);
    }
    for (size_t i = 0; i < n; i++) {
        put_value(b, encoding, 6, NAN); /* a bad normal does not matter */
        put_value(b, encoding, axis[1], want[i][1] = sample(axis[1], i + 1));
        if (list_inside) {
            put_value(b, encoding, count, (double)(i % 3));
            for (size_t k = 0; k < i % 3; k++)
                put_value(b, encoding, 7, 1e300);
        }
        put_value(b, encoding, axis[0], want[i][0] = sample(axis[0], i));
        put_value(b, encoding, 1, 255);
        put_value(b, encoding, axis[2], want[i][2] = sample(axis[2], i + 2));
        end_row(b, encoding, eol);
    }
    put_value(b, encoding, 1, 3);
    for (int k = 0; k < 3; k++)
        put_value(b, encoding, 4, k);
    end_row(b, encoding, eol);
}

static void test_ply_all_types(void **state)
{
    static const char *const eols[] = {"\n", "\r\n", "\r"};
    static struct buffer b;
    double want[20][3];

    (void)state;
    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        for (size_t t = 0; t < NTYPES; t++) {
            for (size_t count = 0; count < 6; count++) {
                const size_t axis[3] = {t, (t + 1) % NTYPES, (t + 5) % NTYPES};

                for (size_t e = 0; e < 3; e++) {
                    for (int list = 0; list < 2; list++) {
                        make_ply(&b, encoding, axis, count, list != 0, eols[e], want, 20);
                        expect_points(b.bytes, b.len, CLOUDFILE_ANY,
                                      (const double(*)[3])want, 20);
                    }
                }
            }
        }
    }
}

/* A line feed as the first byte of data after a header whose lines end in CR or CR LF. */
static void test_ply_first_byte(void **state)
{
    static const char *const eols[] = {"\n", "\r\n", "\r"};
    static const double want[1][3] = {{10, 13, 10}};
    static struct buffer b;

    (void)state;
    for (size_t e = 0; e < 3; e++) {
        char text[300];

        b.len = 0;
        (void)snprintf(text, sizeof text,
                       "ply%sformat binary_little_endian 1.0%s"
                       "element vertex 1%sproperty char x%sproperty char y%s"
                       "property char z%send_header%s",
                       eols[e], eols[e], eols[e], eols[e], eols[e], eols[e], eols[e]);
        put_text(&b, text);
        put(&b, "\n\r\n", 3);
        expect_points(b.bytes, b.len, CLOUDFILE_PLY, want, 1);
    }
}

/* A file that is truncated before the end of its last vertex is an error; after it, it is
 * not. */
static void test_ply_truncated(void **state)
{
    static struct buffer b;
    double want[20][3];

    (void)state;
    for (int encoding = LITTLE; encoding <= BIG; encoding++) {
        for (int list = 0; list < 2; list++) {
            const size_t axis[3] = {6, 6, 6};
            size_t after;

            make_ply(&b, encoding, axis, 1, list != 0, "\n", want, 20);
            after = 1 + 3 * 4; /* the face */
            for (size_t len = 0; len < b.len; len++) {
                struct clouderror err;
                struct dvec3 *pts;
                size_t n;
                enum status st = parse(b.bytes, len, CLOUDFILE_PLY, &pts, &n, &err);

                assert_int_equal(st == ST_OK, len >= b.len - after);
                mem_free(pts);
            }
        }
    }
}

static const char head[] = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                           "property float y\nproperty float z\nend_header\n";

static void expect_ply_body(const char *body, enum status want, uint32_t line)
{
    static struct buffer b;

    b.len = 0;
    put_text(&b, head);
    put(&b, body, strlen(body) + 1);
    expect_error((const char *)b.bytes, CLOUDFILE_ANY, want, line);
}

static void test_ply_bad_text(void **state)
{
    static struct buffer b;
    struct clouderror err;
    struct dvec3 *pts;
    size_t n;

    (void)state;
    expect_ply_body("1 2 3\n4 5 6\n", ST_OK, 0);
    expect_ply_body("1 2 3\n\n  4\t5 6e0", ST_OK, 0);
    expect_ply_body("1.000 2 3\n4 5\n", ST_EINVAL, 9);
    expect_ply_body("1.000000 2 3\n", ST_EINVAL, 9);
    expect_ply_body("1 2 3\n4 5 6 7\n", ST_EINVAL, 9);
    expect_ply_body("1 2 3\n4 5 6\n7 8 9\n", ST_EINVAL, 10);
    expect_ply_body("1 2 3\n4 5 x\n", ST_EINVAL, 9);
    expect_ply_body("1 2 3\n4 5 6x\n", ST_EINVAL, 9);
    expect_ply_body("1 2 3\n4 5 0x10\n", ST_EINVAL, 9);
    expect_ply_body("1 nan 3\n4 5 6\n", ST_ENOTFINITE, 8);
    expect_ply_body("1 2 3\n4 -Infinity 6\n", ST_ENOTFINITE, 9);
    expect_ply_body("1 2 3\n4 1.#QNAN 6\n", ST_ENOTFINITE, 9);
    expect_ply_body("1 2 3\n4 1e999 6\n", ST_ENOTFINITE, 9);
    expect_ply_body("1 2 3\n4 5 \x01 6\n", ST_EINVAL, 9);
    b.len = 0;
    put_text(&b, head);
    put(&b, "1 2 3\n4 5 6\0\n", 13);
    assert_int_equal(parse(b.bytes, b.len, CLOUDFILE_ANY, &pts, &n, &err), ST_EINVAL);
    assert_string_equal(err.what, "binary data inside text");
}

static void test_ply_bad_header(void **state)
{
    static const char *const bad[] = {
        "ply",
        "ply\n",
        "plywood\n",
        "ply extra\nformat ascii 1.0\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\n",
        "ply\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement face 1\nproperty float x\nend_header\n1\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "end_header\n1 2\n",
        "ply\nformat ascii 1.0\nelement vertex -1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1x\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\n"
        "property float y\nproperty float z\nend_header\n1 1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nproperty float y\n"
        "property float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar float x\n"
        "property float y\nproperty float z\nend_header\n1 1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float float q\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n0 1 2 3\n",
        "ply\nformat ascii 1.0\nproperty float x\nelement vertex 1\nend_header\n",
        "ply\nformat ascii 1.0\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
        "property float y\nproperty float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 1\nproperty float x\n"
        "property float y\nproperty float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1 2\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nhello\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header",
        "ply\nformat ascii 1.0\nelement a 5\nproperty float q\nelement vertex 1\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n1\n2\n",
        "ply\nformat ascii 1.0\nelement a 1\nproperty list int int q\nelement vertex 1\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n-1\n1 2 3\n",
    };

    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_error(bad[i], CLOUDFILE_PLY, ST_EINVAL, 0);
    expect_error("ply\nformat ascii 2.0\n", CLOUDFILE_PLY, ST_EVERSION, 2);
    expect_error("ply\nformat binary_middle_endian 1.0\n", CLOUDFILE_PLY, ST_EVERSION, 2);
    expect_error("solid x\n", CLOUDFILE_PLY, ST_EINVAL, 1);
}

/* A count (of the vertices or of an element before them) far beyond the data is an error at
 * once, and no memory is allocated for it; so is a count above the caller's limit. */
static void test_ply_false_counts(void **state)
{
    static const char *const counts[] = {"3", "4294967296", "99999999999999999",
                                         "999999999999999999999999"};
    static struct buffer b;

    (void)state;
    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            for (int before = 0; before < 3; before++) {
                struct clouderror err;
                struct dvec3 *pts;
                char text[300];
                size_t n;

                b.len = 0;
                (void)snprintf(text, sizeof text,
                               "ply\nformat %s 1.0\n%s%s%selement vertex %s\n"
                               "property float x\nproperty float y\nproperty float z\n"
                               "end_header\n",
                               encodings[encoding], before ? "element a " : "",
                               before ? counts[i] : "",
                               before == 1   ? "\nproperty double q\n"
                               : before == 2 ? "\nproperty list uchar double q\n"
                                             : "",
                               before ? "2" : counts[i]);
                put_text(&b, text);
                if (encoding == ASCII)
                    put_text(&b, "0 0 0\n0 0 0\n");
                else
                    put(&b, (const unsigned char[24]){0}, 24);
                if (before && i == 0 && (before == 2 || encoding == ASCII))
                    continue; /* the data may hold three such rows */
                assert_int_equal(parse(b.bytes, b.len, CLOUDFILE_ANY, &pts, &n, &err),
                                 ST_EINVAL);
            }
        }
    }
}

/* An element without properties takes no data, whatever its count. */
static void test_ply_rows_of_nothing(void **state)
{
    static const double want[2][3] = {{1, 2, 3}, {4, 5, 6}};
    static const char text[] = "ply\nformat ascii 1.0\nelement a 99999999999999999\n"
                               "element vertex 2\nproperty float x\nproperty float y\n"
                               "property float z\nend_header\n1 2 3\n4 5 6\n";

    (void)state;
    expect_points(text, strlen(text), CLOUDFILE_ANY, want, 2);
}

static void test_ply_no_vertices(void **state)
{
    static const char text[] = "ply\nformat binary_big_endian 1.0\nelement vertex 0\n"
                               "property float x\nproperty float y\nproperty float z\n"
                               "end_header\n";

    (void)state;
    expect_points(text, strlen(text), CLOUDFILE_ANY, NULL, 0);
    expect_points(text, strlen(text) - 1, CLOUDFILE_ANY, NULL, 0);
}

static void test_ply_binary_not_finite(void **state)
{
    static struct buffer b;
    const float bad[] = {NAN, INFINITY, -INFINITY};

    (void)state;
    for (size_t i = 0; i < 3; i++) {
        struct clouderror err;
        struct dvec3 *pts;
        size_t n;

        b.len = 0;
        put_text(&b,
                 "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
                 "property float x\nproperty float y\nproperty float z\nend_header\n");
        for (size_t k = 0; k < 9; k++)
            put_value(&b, LITTLE, 6, k == 3 + i ? (double)bad[i] : 1);
        assert_int_equal(parse(b.bytes, b.len, CLOUDFILE_PLY, &pts, &n, &err),
                         ST_ENOTFINITE);
        assert_string_equal(err.what, "vertex 1 is not three finite numbers");
        assert_int_equal(err.line, 0);
        assert_int_equal(err.where, b.len - 24);
        /* bytes after the last vertex that the header promises */
        b.len -= 36;
        for (size_t k = 0; k < 12; k++)
            put_value(&b, LITTLE, 6, 1);
        assert_int_equal(parse(b.bytes, b.len, CLOUDFILE_PLY, &pts, &n, &err), ST_EINVAL);
    }
}

static void test_limit(void **state)
{
    static const char *const three[] = {
        ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n1 2 3\n1 2 3\n1 2 3\n"),
        "v 1 2 3\nv 1 2 3\nv 1 2 3\n", "1 2 3\n1 2 3\n1 2 3\n"};

    (void)state;
    for (size_t i = 0; i < 3; i++) {
        struct dvec3 *pts;
        size_t n;

        assert_int_equal(
            cloudfile_parse(three[i], strlen(three[i]), CLOUDFILE_ANY, 2, &pts, &n, NULL),
            ST_ELIMIT);
        assert_null(pts);
        assert_int_equal(
            cloudfile_parse(three[i], strlen(three[i]), CLOUDFILE_ANY, 3, &pts, &n, NULL),
            ST_OK);
        assert_int_equal(n, 3);
        mem_free(pts);
    }
}

/* ---- OBJ */

static void test_obj(void **state)
{
    static const double want[4][3] = {
        {1, 2, 3}, {-4.5, 5e-1, 6}, {7, 8, 9}, {10, 11, 12}};
    static const char text[] =
        "\xEF\xBB\xBF# made by a scanner \\\n\nmtllib C:\\a\nv 1 2 3\nvn 0 0 1\n"
        "  v\t-4.5 5e-1 6 1.0\r\nvt 0.5 0.5\nv 7 \\\n8 \\\r\n9 0.1 0.2 0.3\n"
        "f 1//1 2//1 \\\n v 3//1\ng v 1 2 3\nusemtl \\\nv 9 9 9\nv 10 11 12";

    (void)state;
    expect_points(text, strlen(text), CLOUDFILE_OBJ, want, 4);
    expect_points(text, strlen(text), CLOUDFILE_ANY, want, 4);
}

static void test_obj_bad(void **state)
{
    (void)state;
    expect_error("v 1 2\nv 1 2 3\n", CLOUDFILE_ANY, ST_EINVAL, 1);
    expect_error("v 1 2 3\nv 1 2 x\n", CLOUDFILE_OBJ, ST_EINVAL, 2);
    expect_error("v 1 2 3\nv 1 nan 3\n", CLOUDFILE_OBJ, ST_ENOTFINITE, 2);
    expect_error("v 1 2 3 4 5 6 7 8 9\n", CLOUDFILE_OBJ, ST_EINVAL, 1);
    expect_error("v 1,2,3\n", CLOUDFILE_OBJ, ST_EINVAL, 1);
    expect_error("v\n", CLOUDFILE_OBJ, ST_EINVAL, 1);
    expect_error("v", CLOUDFILE_OBJ, ST_EINVAL, 1);
    expect_error("v 1 2 \\", CLOUDFILE_OBJ, ST_EINVAL, 1);
    expect_error("v 1 2 3\n\x02\x03\n", CLOUDFILE_OBJ, ST_EINVAL, 2);
    expect_error("v 1 2 3\n{\"points\": 1}\n", CLOUDFILE_OBJ, ST_EINVAL, 2);
    expect_error("# nothing\nvn 1 2 3\n", CLOUDFILE_ANY, ST_EINVAL, 0);
    expect_error("", CLOUDFILE_OBJ, ST_EINVAL, 1);
}

/* ---- XYZ */

static void test_xyz(void **state)
{
    static const double want[3][3] = {{1, 2, 3}, {-4, 5.5, 6}, {7, 8, 9}};
    static const char *const texts[] = {
        "1 2 3\n-4 5.5 6\n7 8 9",
        "1,2,3\r\n-4, 5.5, 6\r\n7 ,8 ,9\r\n",
        "1;2;3\n-4 ; 5.5 ; 6\n7;8;9;\n",
        "x y z\n1 2 3 255 0 0\n-4\t5.5\t6\n7 8 9 skin\n",
        "# a comment\n// X Y Z\n\"X\",\"Y\",\"Z\"\n1,2,3\n\n-4,5.5,6,#\n#\n7,8,9\n",
        ("\xEF\xBB\xBF"
         "1 2 3\r-4 5.5 6\r7 8 9\r"),
    };

    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        expect_points(texts[i], strlen(texts[i]), CLOUDFILE_XYZ, want, 3);
        expect_points(texts[i], strlen(texts[i]), CLOUDFILE_ANY, want, 3);
    }
}

static void test_xyz_bad(void **state)
{
    (void)state;
    expect_error("1 2\n", CLOUDFILE_ANY, ST_EINVAL, 1);
    expect_error("1 2 3\n4 5\n", CLOUDFILE_XYZ, ST_EINVAL, 2);
    expect_error("1 2 3\nx y z\n", CLOUDFILE_XYZ, ST_EINVAL, 2);
    expect_error("1,5 2,5 3,5\n", CLOUDFILE_ANY, ST_EINVAL, 1);
    expect_error("1,5;2,5;3,5\n", CLOUDFILE_ANY, ST_EINVAL, 1);
    expect_error("1,,2,3\n", CLOUDFILE_XYZ, ST_EINVAL, 1);
    expect_error("nan 2 3\n1 2 3\n", CLOUDFILE_XYZ, ST_ENOTFINITE, 1);
    expect_error("1 inf 3\n", CLOUDFILE_ANY, ST_ENOTFINITE, 1);
    expect_error("1 2 3\n1 2 \"3\"\n", CLOUDFILE_XYZ, ST_EINVAL, 2);
    expect_error("hello world\n", CLOUDFILE_ANY, ST_EINVAL, 0);
    expect_error("{\"points\": [[1,2,3]]}", CLOUDFILE_ANY, ST_EINVAL, 1);
    expect_error("\x89PNG\r\n\x1a\n", CLOUDFILE_ANY, ST_EINVAL, 1);
    expect_error("", CLOUDFILE_ANY, ST_EINVAL, 1);
    expect_error("\n\n# only\n", CLOUDFILE_ANY, ST_EINVAL, 0);
    expect_error("1 2 3\n4 5 6 \x7f\n", CLOUDFILE_ANY, ST_EINVAL, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ply_all_types),
        cmocka_unit_test(test_ply_first_byte),
        cmocka_unit_test(test_ply_truncated),
        cmocka_unit_test(test_ply_bad_text),
        cmocka_unit_test(test_ply_bad_header),
        cmocka_unit_test(test_ply_false_counts),
        cmocka_unit_test(test_ply_rows_of_nothing),
        cmocka_unit_test(test_ply_no_vertices),
        cmocka_unit_test(test_ply_binary_not_finite),
        cmocka_unit_test(test_limit),
        cmocka_unit_test(test_obj),
        cmocka_unit_test(test_obj_bad),
        cmocka_unit_test(test_xyz),
        cmocka_unit_test(test_xyz_bad),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
