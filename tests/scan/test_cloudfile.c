/* Scanner files: every PLY type and byte order, OBJ, and malformed files. */
#include "cloudfile.h"
#include "mem.h"
#include "scanfile.h"
#include "unit.h"

static void expect_points(const struct scanfile *f, enum cloudformat format,
                          const double (*want)[3], size_t n)
{
    struct cloudpoints p;

    scanfile_good(f, format, &p);
    assert_int_equal(p.n, n);
    for (size_t i = 0; i < n; i++)
        scanfile_at(p.at[i], want[i][0], want[i][1], want[i][2]);
    cloudpoints_free(&p);
}

static void expect_text(const char *text, const double (*want)[3], size_t n)
{
    static struct scanfile f;

    f.len = 0;
    scanfile_text(&f, text);
    expect_points(&f, CLOUDFORMAT_ANY, want, n);
}

/* ---- PLY */

#define PLY "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"

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
static void put_value(struct scanfile *b, int encoding, size_t type, double value)
{
    const unsigned size = types[type].size;
    char text[40];

    (void)snprintf(text, sizeof text, "%.17g ", value);
    if (encoding == ASCII)
        scanfile_text(b, text);
    else if (types[type].real)
        scanfile_real(b, value, size, encoding == BIG);
    else
        scanfile_whole(b, (uint64_t)(int64_t)value, size, encoding == BIG);
}

static void end_row(struct scanfile *b, int encoding, const char *eol)
{
    if (encoding == ASCII)
        scanfile_text(b, eol);
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
static void make_ply(struct scanfile *b, int encoding, const size_t axis[3], size_t count,
                     bool list_inside, const char *eol, double (*want)[3], size_t n)
{
    char line[200];

    b->len = 0;
    (void)snprintf(line, sizeof line, "ply%sformat %s 1.0%scomment caf\xC3\xA9 element%s",
                   eol, encodings[encoding], eol, eol);
    scanfile_text(b, line);
    (void)snprintf(line, sizeof line,
                   "element camera 2%sproperty double f%s"
                   "property list %s short k%selement vertex %zu%s",
                   eol, eol, types[count].name, eol, n, eol);
    scanfile_text(b, line);
    (void)snprintf(line, sizeof line, "property float32 nx%sproperty %s y%s", eol,
                   types[axis[1]].name, eol);
    scanfile_text(b, line);
    if (list_inside) {
        (void)snprintf(line, sizeof line, "property list %s double w%s",
                       types[count].name2, eol);
        scanfile_text(b, line);
    }
    (void)snprintf(
        line, sizeof line,
        "property %s x%sproperty uchar red%sobj_info z x%s"
        "property %s z%selement face 1%sproperty list uchar int vertex_indices%s"
        "end_header%s",
        types[axis[0]].name2, eol, eol, eol, types[axis[2]].name, eol, eol, eol, eol);
    scanfile_text(b, line);
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

TEST(test_ply_all_types)
{
    static const char *const eols[] = {"\n", "\r\n", "\r"};
    static struct scanfile b;
    double want[20][3];

    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        for (size_t t = 0; t < NTYPES; t++) {
            for (size_t count = 0; count < 6; count++) {
                const size_t axis[3] = {t, (t + 1) % NTYPES, (t + 5) % NTYPES};

                for (size_t e = 0; e < 3; e++) {
                    for (int list = 0; list < 2; list++) {
                        make_ply(&b, encoding, axis, count, list != 0, eols[e], want, 20);
                        expect_points(&b, CLOUDFORMAT_ANY, (const double(*)[3])want, 20);
                    }
                }
            }
        }
    }
}

/* A line feed as the first byte of data after a header whose lines end in CR or CR LF. */
TEST(test_ply_first_byte)
{
    static const char *const eols[] = {"\n", "\r\n", "\r"};
    static const double want[1][3] = {{10, 13, 10}};
    static struct scanfile b;

    for (size_t e = 0; e < 3; e++) {
        char text[300];

        b.len = 0;
        (void)snprintf(text, sizeof text,
                       "ply%sformat binary_little_endian 1.0%s"
                       "element vertex 1%sproperty char x%sproperty char y%s"
                       "property char z%send_header%s",
                       eols[e], eols[e], eols[e], eols[e], eols[e], eols[e], eols[e]);
        scanfile_text(&b, text);
        scanfile_put(&b, "\n\r\n", 3);
        expect_points(&b, CLOUDFORMAT_PLY, want, 1);
    }
}

/* A file that is truncated before the end of its last vertex is an error; after it, it is
 * not. */
TEST(test_ply_truncated)
{
    static struct scanfile b;
    double want[20][3];

    for (int encoding = LITTLE; encoding <= BIG; encoding++) {
        for (int list = 0; list < 2; list++) {
            const size_t axis[3] = {6, 6, 6};

            make_ply(&b, encoding, axis, 1, list != 0, "\n", want, 20);
            for (int i = 0; i < 1 + 3 * 4; i++, b.len--) /* the face */
                expect_points(&b, CLOUDFORMAT_PLY, (const double(*)[3])want, 20);
            scanfile_cut(&b, CLOUDFORMAT_PLY);
        }
    }
}

TEST(test_ply_bad_text)
{
#define HEAD PLY "element vertex 2\n" XYZ "end_header\n"
    static const struct scanfile_case bad[] = {
        {HEAD "1.000 2 3\n4 5\n", ST_EINVAL, "line 9: the line has too few"},
        {HEAD "1.000000 2 3\n", ST_EINVAL, "line 9: the header promises 2"},
        {HEAD "1 2 3\n4 5 6 7\n", ST_EINVAL, "line 9: the line has more"},
        {HEAD "1 2 3\n4 5 6\n7 8 9\n", ST_EINVAL, "line 10: data is left"},
        {HEAD "1 2 3\n4 5 x\n", ST_EINVAL, "line 9: a number is expected"},
        {HEAD "1 2 3\n4 5 6x\n", ST_EINVAL, "line 9: a number is expected"},
        {HEAD "1 2 3\n4 5 0x10\n", ST_EINVAL, "line 9: a number is expected"},
        {HEAD "1 2 3\n4 nano 6\n", ST_EINVAL, "line 9: a number is expected"},
        {HEAD "1 2 3\n4 1.#\n", ST_EINVAL, "line 9: a number is expected"},
        {HEAD "1 nan 3\n4 5 inf\n", ST_ENOTFINITE, "none of the 2 points"},
        {HEAD "1 2 3\n4 5 \x01 6\n", ST_EINVAL, "line 9: binary data inside text"},
    };
    static struct scanfile b;

    scanfile_refused(bad, sizeof bad / sizeof *bad);
    expect_text(HEAD "1 2 3\n\n  4\t5 6e0", (const double[2][3]){{1, 2, 3}, {4, 5, 6}},
                2);
    scanfile_text(&b, HEAD);
    scanfile_put(&b, "1 2 3\n4 5 6\0\n", 13);
    scanfile_bad(&b, CLOUDFORMAT_ANY, ST_EINVAL, "binary data inside text");
}

/* Rows that are not lines: over several of them, or several on one. */
TEST(test_ply_stream)
{
    static const double want[2][3] = {{1, 2, 3}, {4, 5, 6}};
    static const char *const faces =
        PLY "element vertex 2\n" XYZ "property uchar red\nelement face 1\n"
            "property list uchar int vertex_indices\nelement more 2\nproperty int q\n"
            "end_header\n";
    static const char *const good[] = {
        "1 2 3\n7\n4 5 6\n7\n3 0 1 0\n1\n2\n", "1 2 3 7 4 5 6 7 3 0 1 0 1 2\n",
        "1 2 3 7 4 5 6 7\n3 0 1 0\n1 2", "1\n2\n3\n7\n4\n5\n6\n7\n3\n0\n1\n0\n1\n\n2"};
    static const char *const bad[] = {
        "1 2 3\n4 5 6\n4 0 1 0 1\n1\n2\n", "1 2 3 7 8\n4 5 6 7 8\n3 0 1 0\n1\n2\n",
        "1 2 3\n7\n4 5 6\n7\n3 0 1 0\n1\n", "1 2 3\n7\n4 5 6\n7\n3 0 1 0\n1\n2\n3\n"};
    char text[400];

    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        (void)snprintf(text, sizeof text, "%s%s", faces, good[i]);
        expect_text(text, want, 2);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        (void)snprintf(text, sizeof text, "%s%s", faces, bad[i]);
        scanfile_refused(&(struct scanfile_case){text, ST_EINVAL, "line 13"}, 1);
    }
}

TEST(test_ply_bad_header)
{
    static const char *const bad[] = {
        "ply",
        "ply\n",
        "plywood\n",
        "ply extra\nformat ascii 1.0\n",
        PLY "element vertex 1\n" XYZ,
        "ply\nelement vertex 1\n" XYZ "end_header\n1 2 3\n",
        PLY "element face 1\nproperty float x\nend_header\n1\n",
        PLY "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
        PLY "element vertex -1\n" XYZ "end_header\n1 2 3\n",
        PLY "element vertex 1x\n" XYZ "end_header\n1 2 3\n",
        PLY "element vertex\n" XYZ "end_header\n1 2 3\n",
        PLY "element vertex 1\nproperty float x\n" XYZ "end_header\n1 1 2 3\n",
        PLY
        "element vertex 1\nproperty quad x\nproperty float y\nproperty float z\nend_header\n"
        "1 2 3\n",
        PLY
        "element vertex 1\nproperty list uchar float x\nproperty float y\nproperty float z\nend_header\n"
        "1 1 2 3\n",
        PLY "element vertex 1\nproperty list float float q\n" XYZ "end_header\n0 1 2 3\n",
        PLY "property float x\nelement vertex 1\nend_header\n",
        PLY "format ascii 1.0\nelement vertex 1\n" XYZ "end_header\n1 2 3\n",
        PLY "element vertex 1\nelement vertex 1\n" XYZ "end_header\n1 2 3\n",
        PLY "element vertex 1 2\n" XYZ "end_header\n1 2 3\n",
        PLY "element vertex 1\n" XYZ "hello\nend_header\n1 2 3\n",
        PLY "element vertex 1\n" XYZ "end_header",
        PLY "element a 5\nproperty float q\nelement vertex 1\n" XYZ "end_header\n1\n2\n",
        PLY "element a 1\nproperty list int int q\nelement vertex 1\n" XYZ
            "end_header\n-1\n1 2 3\n",
    };

    static const struct scanfile_case other[] = {
        {"ply\nformat ascii 2.0\n", ST_EVERSION, "line 2: not PLY version 1.0"},
        {"ply\nformat binary_middle_endian 1.0\n", ST_EVERSION, "line 2: an unknown"},
    };

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct scanfile f = {.len = 0};

        scanfile_text(&f, bad[i]);
        scanfile_bad(&f, CLOUDFORMAT_PLY, ST_EINVAL, "");
    }
    scanfile_refused(other, sizeof other / sizeof *other);
}

/* A count (of the vertices or of an element before them) far beyond the data is an error at
 * once, and no memory is allocated for it; so is a count above the caller's limit. */
TEST(test_ply_false_counts)
{
    static const char *const counts[] = {"3", "4294967296", "99999999999999999",
                                         "999999999999999999999999"};
    static struct scanfile b;

    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            for (int before = 0; before < 3; before++) {
                char text[300];

                b.len = 0;
                (void)snprintf(text, sizeof text,
                               "ply\nformat %s 1.0\n%s%s%selement vertex %s\n" XYZ
                               "end_header\n",
                               encodings[encoding], before ? "element a " : "",
                               before ? counts[i] : "",
                               before == 1   ? "\nproperty double q\n"
                               : before == 2 ? "\nproperty list uchar double q\n"
                                             : "",
                               before ? "2" : counts[i]);
                scanfile_text(&b, text);
                if (encoding == ASCII)
                    scanfile_text(&b, "0 0 0\n0 0 0\n");
                else
                    scanfile_put(&b, (const unsigned char[24]){0}, 24);
                if (before && i == 0 && (before == 2 || encoding == ASCII))
                    continue; /* the data may hold three such rows */
                scanfile_bad(&b, CLOUDFORMAT_ANY, ST_EINVAL, "");
            }
        }
    }
}

/* An element without properties takes no data, whatever its count. */
TEST(test_ply_rows_of_nothing)
{
    static const double want[2][3] = {{1, 2, 3}, {4, 5, 6}};
    static const char text[] = PLY "element a 99999999999999999\nelement vertex 2\n" XYZ
                                   "end_header\n1 2 3\n4 5 6\n";

    expect_text(text, want, 2);
}

TEST(test_ply_no_vertices)
{
    struct scanfile f = {.len = 0};

    scanfile_text(&f, "ply\nformat binary_big_endian 1.0\nelement vertex 0\n" XYZ
                      "end_header\n");
    expect_points(&f, CLOUDFORMAT_ANY, NULL, 0);
    f.len--;
    expect_points(&f, CLOUDFORMAT_ANY, NULL, 0);
}

/* Bytes after the last vertex that the header promises. */
TEST(test_ply_left_over)
{
    struct scanfile b = {.len = 0};
    char words[40];

    scanfile_text(&b, "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" XYZ
                      "end_header\n");
    (void)snprintf(words, sizeof words, "byte %zu: data is left", b.len + 36);
    for (size_t k = 0; k < 12; k++)
        put_value(&b, LITTLE, 6, 1);
    scanfile_bad(&b, CLOUDFORMAT_PLY, ST_EINVAL, words);
}

/* ---- points without a value, normals */

static void expect_places(struct cloudpoints *p, size_t read, size_t n,
                          const uint32_t *place)
{
    assert_int_equal(p->read, read);
    assert_int_equal(p->n, n);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(p->index == NULL ? i : p->index[i], place[i]);
        scanfile_at(p->at[i], place[i], 2, 3);
    }
    cloudpoints_free(p);
}

TEST(test_dropped)
{
    static const uint32_t all[] = {0, 1, 2, 3, 4, 5, 6}, odd[] = {1, 3, 6};
    static const char *const texts[] = {
        "nan 2 3\n1 2 3\n2 2 -Infinity\n3 2 3\n1.#QNAN 2 3\n5 1e999 3\n6 2 3\n",
        "NaN,2,3\n1,2,3\n2,+inf,3\n3,2,3\n4,nan(ind),3\n5,-NAN,3\n6,2,3\n",
        "v nan 2 3\nv 1 2 3\nv 2 inf 3\nv 3 2 3\nv 4 2 -nan\nv 5 2 -1.#IND\nv 6 2 3\n",
        "0 0 0\n1 2 3\n0 0 0\n3 2 3\n-0 0 0.0\n0 0 0\n6 2 3\n",
        "{\"points\": [[0,0,0],[1,2,3],[0,0,0],[3,2,3],[0,0,0],[0,0,0],[6,2,3]]}",
        PLY "element vertex 7\n" XYZ
            "end_header\nnan 2 3\n1 2 3\n0 0 0\n3 2 3\n4 inf 3\n0 0 0\n6 2 3\n"};
    struct cloudpoints p;

    scanfile_good_text("0 2 3\n1 2 3\n2 2 3\n", &p);
    assert_null(p.index);
    expect_places(&p, 3, 3, all);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        scanfile_good_text(texts[i], &p);
        expect_places(&p, 7, 3, odd);
    }
    /* One point at the origin is a point. */
    scanfile_good_text("0 0 0\n1 2 3\n", &p);
    assert_int_equal(p.n, 2);
    assert_null(p.index);
    cloudpoints_free(&p);
}

/* More points than the first room, with and without a value, and their normals. */
TEST(test_dropped_many)
{
    const size_t n = 2000;
    char *text = malloc(n * 40 + 1), *at = text;
    struct cloudpoints p;

    assert_non_null(text);
    for (size_t i = 0; i < n; i++)
        at += sprintf(at, "v %zu %s 3\n", i, i % 3 == 1 ? "nan" : "2");
    for (size_t i = 0; i + 3 < n; i++)
        at += sprintf(at, "f %zu %zu %zu\n", i + 1, i + 2, i + 4);
    scanfile_good_text(text, &p);
    assert_int_equal(p.read, n);
    assert_int_equal(p.n, n - (n + 1) / 3);
    for (size_t i = 0; i < p.n; i++) {
        assert_int_equal(p.index[i], i / 2 * 3 + i % 2 * 2);
        scanfile_at(p.at[i], p.index[i], 2, 3);
        scanfile_at(p.normal[i], 0, 0, 0);
    }
    cloudpoints_free(&p);
    free(text);
}

TEST(test_normals)
{
    static const char *const texts[] = {
        "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 9 9 9\nf 1 2 3 4\n",
        "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 9 9 9\nf -5/1/2 -4//2 -3/1\nf 1 3 4\n",
        PLY
        "element vertex 5\n" XYZ
        "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nend_header\n"
        "0 0 0\n2 0 0\n2 3 0\n0 3 0\n9 9 9\n3 0 1 2 7\n3 0 2 3 7\n",
        PLY "element vertex 5\n" XYZ
            "property float nx\nproperty float ny\nproperty float nz\nend_header\n"
            "0 0 0 0 0 12\n2 0 0 0 0 6\n2 3 0 0 0 12\n0 3 0 0 0 6\n9 9 9 nan 0 0\n"};
    static const char *const without[] = {
        "v 0 0 0\nv 2 0 0\nv 2 3 0\nf 1 2 3\nf 1 2 4\n",
        "v 0 0 0\nv 2 0 0\nv 2 3 0\nf 1 2 3\nf 1 2 0\n",
        "v 0 0 0\nv 2 0 0\nv 2 3 0\nf 1 2 3\nf 1 2\n",
        PLY "element vertex 3\n" XYZ
            "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0\n2 0 0\n2 3 0\n3 0 1 2\n3 0 1 3\n"};
    struct cloudpoints p;

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        scanfile_good_text(texts[i], &p);
        assert_non_null(p.normal);
        scanfile_at(p.normal[0], 0, 0, 12);
        scanfile_at(p.normal[1], 0, 0, 6);
        scanfile_at(p.normal[2], 0, 0, 12);
        scanfile_at(p.normal[3], 0, 0, 6);
        scanfile_at(p.normal[4], 0, 0, 0);
        cloudpoints_free(&p);
    }
    /* Faces that cannot be right are no reason to refuse the points. */
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        scanfile_good_text(without[i], &p);
        assert_int_equal(p.n, 3);
        assert_null(p.normal);
        cloudpoints_free(&p);
    }
}

/* ---- the limit of points */

TEST(test_limit)
{
    static const char *const three[] = {
        (PLY "element vertex 3\n" XYZ "end_header\n1 2 3\n1 2 3\n1 2 3\n"),
        "v 1 2 3\nv 1 2 3\nv 1 2 3\n", "1 2 3\n1 2 3\n1 2 3\n"};

    for (size_t i = 0; i < 3; i++) {
        struct cloudfile_options o = {.max_points = 2};
        struct cloudpoints p;

        assert_int_equal(cloudfile_read(three[i], strlen(three[i]), &o, &p, NULL),
                         ST_ELIMIT);
        assert_null(p.at);
        o.max_points = 3;
        assert_int_equal(cloudfile_read(three[i], strlen(three[i]), &o, &p, NULL), ST_OK);
        assert_int_equal(p.n, 3);
        cloudpoints_free(&p);
    }
}

/* ---- OBJ */

TEST(test_obj)
{
    static const double want[4][3] = {
        {1, 2, 3}, {-4.5, 5e-1, 6}, {7, 8, 9}, {10, 11, 12}};
    static const char *const text =
        "\xEF\xBB\xBF# made by a scanner \\\n\nmtllib C:\\a\nv 1 2 3\nvn 0 0 1\n"
        "  v\t-4.5 5e-1 6 1.0\r\nvt 0.5 0.5\nv 7 \\\n8 \\\r\n9 0.1 0.2 0.3\n"
        "f 1//1 2//1 \\\n v 3//1\ng v 1 2 3\nusemtl \\\nv 9 9 9\nv 10 11 12";

    expect_text(text, want, 4);
}

TEST(test_obj_bad)
{
    static const struct scanfile_case bad[] = {
        {"v 1 2\nv 1 2 3\n", ST_EINVAL, "line 1: the line has too few"},
        {"v 1 2 3\nv 1 2 x\n", ST_EINVAL, "line 2: a number is expected"},
        {"v 1 2 3 4 5 6 7 8 9\n", ST_EINVAL, "line 1: more than 8 numbers"},
        {"v 1,2,3\n", ST_EINVAL, "line 1: numbers of an OBJ file"},
        {"v\n", ST_EINVAL, "line 1: the line has too few"},
        {"v", ST_EINVAL, "line 1: the line has too few"},
        {"v 1 2 \\", ST_EINVAL, "line 1: a number is expected"},
        {"v 1 2 3\n\x02\x03\n", ST_EINVAL, "line 2: binary data inside text"},
        {"v 1 2 3\n{\"points\": 1}\n", ST_EINVAL, "line 2: not a line of an OBJ"},
        {"# nothing\nvn 1 2 3\n", ST_EINVAL, "there are no points"},
    };

    scanfile_refused(bad, sizeof bad / sizeof *bad);
}
