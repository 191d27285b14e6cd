/* PCD files: ascii, binary and compressed; fields in any order and of any type; organised
 * clouds; counts and lengths that are not true. */
#include "read.h"
#include "scanfile.h"
#include "unit.h"

enum { ASCII, BINARY, COMPRESSED };
static const char *const encodings[] = {"ascii", "binary", "binary_compressed"};

/* y z normals and x of several types, with fields between them; an organised cloud of 2 x 2 of
 * which one point is NaN and one (0, 0, 0). */
static const double cloud[4][7] = {/* y, rgb, normal x y z, x, z */
                                   {-2, 7, 0, 0, 2, 1.5, 3},
                                   {4, 7, 1, 0, 0, NAN, 6},
                                   {0, 7, 1, 0, 0, 0, 0},
                                   {-8, 7, 0, NAN, 1, 7.25, 9}};
static const unsigned size[7] = {2, 4, 4, 4, 4, 8, 4};

static void put_value(struct scanfile *f, size_t field, double v)
{
    if (field == 0)
        scanfile_whole(f, (uint64_t)(int64_t)v, 2, false);
    else
        scanfile_real(f, v, size[field], false);
}

static void put_header(struct scanfile *f, int encoding, const char *width,
                       const char *points)
{
    char text[600];

    f->len = 0;
    (void)snprintf(text, sizeof text,
                   "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
                   "FIELDS y rgb _ normal_x normal_y normal_z x z\nSIZE 2 4 1 4 4 4 8 4\n"
                   "TYPE I F U F F F F F\nCOUNT 1 1 3 1 1 1 1 1\nWIDTH %s\nHEIGHT 2\n"
                   "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS %s\nDATA %s\n",
                   width, points, encodings[encoding]);
    scanfile_text(f, text);
}

/* As LZF, nothing of it compressed. */
static void put_packed(struct scanfile *f, const struct scanfile *plain,
                       uint32_t size_said)
{
    const size_t runs = (plain->len + 31) / 32;

    scanfile_whole(f, plain->len + runs, 4, false);
    scanfile_whole(f, size_said, 4, false);
    for (size_t at = 0; at < plain->len; at += 32) {
        const size_t n = plain->len - at < 32 ? plain->len - at : 32;

        scanfile_whole(f, n - 1, 1, false);
        scanfile_put(f, plain->bytes + at, n);
    }
}

static void put_data(struct scanfile *f, int encoding)
{
    struct scanfile plain = {.len = 0};

    if (encoding == COMPRESSED) {
        for (size_t k = 0; k < 7; k++) {
            for (size_t i = 0; i < 4; i++)
                put_value(&plain, k, cloud[i][k]);
            for (size_t i = 0; k == 1 && i < 12; i++)
                scanfile_text(&plain, "?"); /* the padding */
        }
        put_packed(f, &plain, (uint32_t)plain.len);
        return;
    }
    for (size_t i = 0; i < 4; i++) {
        for (size_t k = 0; k < 7; k++) {
            char text[40];

            (void)snprintf(text, sizeof text, "%.17g ", cloud[i][k]);
            if (encoding == ASCII)
                scanfile_text(f, text);
            else
                put_value(f, k, cloud[i][k]);
            if (k == 1)
                scanfile_text(f, encoding == ASCII ? "0 0 word " : "???");
        }
        if (encoding == ASCII)
            scanfile_text(f, "\n");
    }
}

static void make(struct scanfile *f, int encoding)
{
    put_header(f, encoding, "2", "4");
    put_data(f, encoding);
}

static void check_cloud(const struct scanfile *f, enum cloudformat format)
{
    struct cloudpoints p;

    scanfile_good(f, format, &p);
    assert_int_equal(p.format, CLOUDFORMAT_PCD);
    assert_int_equal(p.read, 4);
    assert_int_equal(p.n, 2);
    assert_true(p.width == 2 && p.height == 2);
    assert_true(p.index[0] == 0 && p.index[1] == 3);
    scanfile_at(p.at[0], 1.5, -2, 3);
    scanfile_at(p.at[1], 7.25, -8, 9);
    scanfile_at(p.normal[0], 0, 0, 2);
    scanfile_at(p.normal[1], 0, 0, 0);
    cloudpoints_free(&p);
}

TEST(test_all)
{
    static struct scanfile f;

    for (int encoding = ASCII; encoding <= COMPRESSED; encoding++) {
        make(&f, encoding);
        check_cloud(&f, CLOUDFORMAT_ANY);
        check_cloud(&f, CLOUDFORMAT_PCD);
        f.len -= encoding == ASCII ? 2 : 0; /* a blank and a line end, which may miss */
        scanfile_cut(&f, CLOUDFORMAT_PCD);
    }
}

/* An unorganised cloud may have a point at the origin, and neither COUNT nor POINTS. */
TEST(test_short)
{
    struct cloudpoints p;

    scanfile_good_text(
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\n"
        "DATA ascii\n0 0 0\n\n1 2 3",
        &p);
    assert_true(p.n == 2 && p.width == 0 && p.height == 0 && p.normal == NULL);
    scanfile_at(p.at[1], 1, 2, 3);
    cloudpoints_free(&p);
}

TEST(test_hostile)
{
    static const char *const counts[] = {"3", "65536", "4294967295", "4294967296",
                                         "999999999999999999"};
    static struct scanfile f;

    for (int encoding = ASCII; encoding <= COMPRESSED; encoding++) {
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            char points[40];

            put_header(&f, encoding, counts[i], "4");
            put_data(&f, encoding);
            scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "");
            (void)snprintf(points, sizeof points, "%llu",
                           2 * strtoull(counts[i], NULL, 10));
            put_header(&f, encoding, counts[i], points);
            put_data(&f, encoding);
            scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "");
        }
    }
}

/* Lengths of the compressed data that are not true; damage; more than may be unpacked. */
TEST(test_compressed)
{
    struct scanfile f, plain = {.len = 0};

    put_header(&f, COMPRESSED, "2", "4");
    for (int i = 0; i < 4 * 37; i++)
        scanfile_text(&plain, "x");
    put_packed(&f, &plain, (uint32_t)plain.len + 4);
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "not of the points' size");
    put_header(&f, COMPRESSED, "2", "4");
    put_packed(&f, &plain, 4 * 33);
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "damaged");
    put_header(&f, COMPRESSED, "1000000", "2000000");
    scanfile_whole(&f, 4, 4, false);
    scanfile_whole(&f, 2000000ULL * 33, 4, false);
    scanfile_text(&f, "    ");
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_ESIZE, "1048576 bytes when unpacked");
}

TEST(test_lzf)
{
    static const struct {
        size_t len, size;
        bool good;
        unsigned char in[8];
    } c[] = {
        {3, 2, true, {1, 'a', 'b'}},
        {3, 3, false, {1, 'a', 'b'}},            /* too little */
        {3, 1, false, {1, 'a', 'b'}},            /* too much */
        {2, 2, false, {1, 'a'}},                 /* cut off */
        {4, 4, true, {0, 'a', 0x20, 0}},         /* a, three times that */
        {4, 4, false, {0, 'a', 0x20, 1}},        /* from before the beginning */
        {3, 4, false, {0, 'a', 0x20}},           /* without its distance */
        {5, 10, true, {0, 'a', 0xE0, 0, 0}},     /* nine times */
        {5, 265, true, {0, 'a', 0xE0, 255, 0}},  /* the longest */
        {4, 265, false, {0, 'a', 0xE0, 255}},    /* without its distance */
        {3, 265, false, {0, 'a', 0xE0}},         /* without its length */
        {5, 264, false, {0, 'a', 0xE0, 255, 0}}, /* too much */
        {0, 0, true, {0}},
    };

    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        unsigned char out[300] = {0};

        assert_int_equal(read_pcd_unpack(c[i].in, c[i].len, out, c[i].size), c[i].good);
        assert_int_equal(out[c[i].size], 0);
        for (size_t k = 0; c[i].good && c[i].size > 2 && k < c[i].size; k++)
            assert_int_equal(out[k], 'a');
    }
}

TEST(test_bad_header)
{
#define REST "SIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n"
    static const struct scanfile_case bad[] = {
        {"VERSION .7\nFIELDS x y\n" REST, ST_EINVAL, "no x, y and z"},
        {"VERSION .7\nFIELDS x y y\n" REST, ST_EINVAL, "y twice"},
        {"VERSION .7\nFIELDS x y z w\n" REST, ST_EINVAL, "one for each field"},
        {"VERSION .7\nFIELDS x y z\nCOUNT 1 1\n" REST, ST_EINVAL, "one for each field"},
        {"VERSION .7\nFIELDS x y z\nCOUNT 1 1 2\n" REST, ST_EVERSION, "not read"},
        {"VERSION .7\nFIELDS x y z\nPOINTS 2\n" REST, ST_EINVAL, "WIDTH times HEIGHT"},
        {"VERSION .7\nFIELDS x y z\nWIDTH 1\n" REST, ST_EINVAL, "once"},
        {"VERSION .7\nFIELDS x y z\nCOLOR 1\n" REST, ST_EINVAL, "unknown word"},
        {"FIELDS x y z\nSIZE 4 4 9\n", ST_EINVAL, "SIZE"},
        {"FIELDS x y z\nSIZE 4 4 0\n", ST_EINVAL, "SIZE"},
        {"FIELDS x y z\nTYPE F F Q\n", ST_EINVAL, "TYPE"},
        {"FIELDS x y z\nSIZE 2 2 2\nTYPE F F F\nWIDTH 1\nDATA ascii\n1 2 3\n",
         ST_EVERSION, "not read"},
        {"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n", ST_EINVAL,
         "neither WIDTH"},
        {"FIELDS x y z\nDATA xml\n", ST_EVERSION, "DATA is"},
        {"VERSION .7\nFIELDS x y z\n", ST_EINVAL, "does not end"},
        {"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nDATA ascii\n1 2 3 4\n",
         ST_EINVAL, "more numbers"},
        {"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nDATA ascii\n1 2\n", ST_EINVAL,
         "too few numbers"},
    };

    scanfile_refused(bad, sizeof bad / sizeof *bad);
}
