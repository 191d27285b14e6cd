/* NumPy's arrays: points and depth images by their shape; types, byte orders and both orders
 * of the values; headers that are not true. */
#include <math.h>

#include "scanfile.h"
#include "unit.h"

/* The header of a version with this dictionary. */
static void begin(struct scanfile *f, unsigned version, const char *dictionary)
{
    f->len = 0;
    scanfile_text(f, "\x93NUMPY");
    scanfile_whole(f, version, 2, false);
    scanfile_whole(f, strlen(dictionary) + 1, version == 1 ? 2 : 4, false);
    scanfile_text(f, dictionary);
    scanfile_text(f, "\n");
}

static void put(struct scanfile *f, const char *type, double v)
{
    const unsigned size = (unsigned)(type[2] - '0');
    int exponent;

    if (type[1] == 'f' && size == 2) {
        const double fraction = frexp(v, &exponent);

        scanfile_whole(f, (uint64_t)((exponent + 14) * 1024 + (2 * fraction - 1) * 1024),
                       2, type[0] == '>');
    } else if (type[1] == 'f')
        scanfile_real(f, v, size, type[0] == '>');
    else
        scanfile_whole(f, (uint64_t)(int64_t)v, size, type[0] == '>');
}

/* An array of the values 1, 2, 3, ... in C order. */
static void make(struct scanfile *f, const char *type, bool fortran, unsigned rows,
                 unsigned columns, unsigned values)
{
    const unsigned n[3] = {rows, columns, values}, dims = values > 0 ? 3 : 2;
    const unsigned deep = values > 0 ? values : 1;
    char text[200], last[20];

    (void)snprintf(last, sizeof last, dims == 3 ? ", %u" : "%.0u", values);
    (void)snprintf(text, sizeof text,
                   "{'descr': '%s', 'fortran_order': %s, 'shape': (%u, %u%s), }   ", type,
                   fortran ? "True" : "False", rows, columns, last);
    begin(f, 1, text);
    for (unsigned i = 0; i < n[0] * n[1] * deep; i++) {
        const unsigned a = fortran ? i % rows : i / deep / columns,
                       b = fortran ? i / rows % columns : i / deep % columns,
                       c = fortran ? i / rows / columns : i % deep;

        put(f, type, 1.0 + (a * columns + b) * deep + c);
    }
}

static const char *const types[] = {"<f4", ">f4", "<f8", ">f8", "<i2", ">i2", "<u2",
                                    ">u2", "<i4", ">i4", "<u4", ">u4", "|i1", "|u1",
                                    "<f2", ">f2", "<i8", ">i8", "<u8", ">u8"};
#define TYPES (sizeof types / sizeof *types)

static void check(const struct scanfile *f, uint32_t width, uint32_t height)
{
    struct cloudpoints p;

    scanfile_good(f, CLOUDFORMAT_ANY, &p);
    assert_true(p.format == CLOUDFORMAT_NPY && p.unit_mm == 0 && p.normal == NULL);
    assert_true(p.n == 4 && p.read == 4 && p.width == width && p.height == height);
    for (size_t i = 0; i < 4; i++)
        scanfile_at(p.at[i], 1 + 3 * (double)i, 2 + 3 * (double)i, 3 + 3 * (double)i);
    cloudpoints_free(&p);
}

TEST(test_points)
{
    static struct scanfile f;
    struct cloudpoints p;

    for (size_t i = 0; i < 2 * TYPES; i++) {
        make(&f, types[i / 2], i % 2 == 1, 4, 3, 0);
        check(&f, 0, 0);
        scanfile_cut(&f, CLOUDFORMAT_NPY);
        make(&f, types[i / 2], i % 2 == 1, 2, 2, 3);
        check(&f, 2, 2);
        make(&f, types[i / 2], i % 2 == 1, 3, 20, 0); /* of each coordinate a row */
        scanfile_good(&f, CLOUDFORMAT_NPY, &p);
        assert_true(p.n == 20 && p.width == 0);
        scanfile_at(p.at[19], 20, 40, 60);
        cloudpoints_free(&p);
        make(&f, types[i / 2], i % 2 == 1, 2, 16, 0); /* with 13 values behind them */
        scanfile_good(&f, CLOUDFORMAT_ANY, &p);
        assert_true(p.n == 2 && p.width == 0);
        scanfile_at(p.at[1], 17, 18, 19);
        cloudpoints_free(&p);
    }
}

TEST(test_no_value)
{
    static struct scanfile f;
    struct cloudpoints p;

    begin(&f, 3, "{'shape': (2, 2, 3), 'fortran_order': False, 'descr': '<f8'}");
    for (int i = 0; i < 12; i++)
        scanfile_real(&f, i == 4 ? (double)NAN : i < 9 ? i : 0, 8, false);
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_true(p.n == 2 && p.read == 4 && p.index[1] == 2);
    cloudpoints_free(&p);
}

/* Headers as different writers have them, of the points (0, 1, 2), (3, 4, 5), (6, 7, 8), (9, 10, 11). */
TEST(test_writers)
{
    static const char *const headers[] = {
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4L, 3L), }",
        "{'descr':'<f4','fortran_order':False,'shape':(4,3)}",
        "{'descr': '=f4', 'fortran_order': False, 'shape': (1, 4, 3)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 1, 3), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 3, 1), }",
        "{'descr': [('x', '<f4'), ('y', '<f4'), ('z', '<f4')], 'fortran_order': False, 'shape': (4,)}",
        "{'descr': [('x', '<f4'), ('y', '<f4'), ('z', '<f4')], 'fortran_order': False, 'shape': (2L, 2L)}",
        "{'descr': [('X', '<f4'), ('Y', '<f4'), ('Z', '<f4')], 'fortran_order': True, 'shape': (4, 1)}",
        "{'descr': [('xyz', '<f4', (3,))], 'fortran_order': False, 'shape': (4,), }"};
    static struct scanfile f;
    struct cloudpoints p;

    for (unsigned i = 0; i < sizeof headers / sizeof *headers; i++) {
        begin(&f, 1 + i % 3, headers[i]);
        for (int k = 0; k < 12; k++)
            scanfile_real(&f, k, 4, false);
        scanfile_good(&f, CLOUDFORMAT_ANY, &p);
        if (p.n != 4 || p.at[1].x != 3 || p.at[2].y != 7 || p.at[3].z != 11)
            fail_msg("%zu points of %s", p.n, headers[i]);
        cloudpoints_free(&p);
    }
    begin(
        &f, 1,
        "{'descr': [('t', '<M8[ns]'), ('name', '<U2'), ('z', '>f8'), ('', '|V3'), ('x', '<i2'),"
        " ('rgb', '|u1', (1, 3)), ('y', '<f4')], 'fortran_order': False, 'shape': (2,)}");
    for (int i = 0; i < 2; i++) {
        scanfile_put(&f, "0123456701234567", 16);
        scanfile_real(&f, 3 + i, 8, true);
        scanfile_put(&f, "---", 3);
        scanfile_whole(&f, (uint64_t)(1 + i), 2, false);
        scanfile_put(&f, "rgb", 3);
        scanfile_real(&f, 2 + i, 4, false);
    }
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    scanfile_at(p.at[0], 1, 2, 3);
    scanfile_at(p.at[1], 2, 3, 4);
    cloudpoints_free(&p);
    begin(&f, 1, "{'descr': '<f2', 'fortran_order': False, 'shape': (3, 3)}");
    scanfile_put(
        &f, "\x00\x3C\x00\xC0\x01\x00\x00\x7C\x00\x3C\x00\x3C\x01\x7C\x00\x3C\x00\x3C",
        18);
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_int_equal(p.n, 1);
    scanfile_at(p.at[0], 1, -2, ldexp(1, -24));
    cloudpoints_free(&p);
    /* images of x, y and z */
    begin(&f, 1, "{'descr': '<u2', 'fortran_order': False, 'shape': (3, 2, 20)}");
    for (int k = 0; k < 120; k++)
        scanfile_whole(&f, (uint64_t)k, 2, false);
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_true(p.n == 40 && p.width == 20 && p.height == 2);
    scanfile_at(p.at[21], 21, 61, 101);
    cloudpoints_free(&p);
}

static enum status read_by(const struct scanfile *f, double scale, struct cloudpoints *p)
{
    const struct cloudfile_options o = {
        .max_points = 100,
        .max_bytes = 1000,
        .unit_mm = 10,
        .camera = {.fx = 100, .fy = 50, .cx = 1, .cy = 0, .scale = scale}};
    struct scanfile_said err;

    return scanfile_read(f->bytes, f->len, &o, p, &err);
}

/* Of integers a value is a millimetre; of floats it may be anything. */
TEST(test_depth)
{
    static struct scanfile f;
    struct cloudpoints p;

    for (size_t i = 0; i < 2 * TYPES; i++)
        for (int scaled = 0; scaled < 2; scaled++) {
            const char *type = types[i / 2];

            make(&f, type, i % 2 == 1, 2, 20, 0);
            assert_int_equal(read_by(&f, scaled ? 2 : 0, &p), ST_OK);
            assert_true(p.unit_mm == (type[1] == 'f' && !scaled ? 10 : 1));
            assert_true(p.n == 40 && p.width == 20 && p.height == 2);
            if (scaled)
                scanfile_at(p.at[22], 0.46, -0.92, -46);
            else
                scanfile_at(p.at[22], 0.23, -0.46, -23);
            cloudpoints_free(&p);
        }
    begin(&f, 2,
          "{'shape': (2, 17), 'descr': '<i2'}"); /* what is not above 0 is no value */
    for (int i = 0; i < 34; i++)
        scanfile_whole(&f, (uint64_t)(int64_t)(i - 5), 2, false);
    assert_int_equal(read_by(&f, 0, &p), ST_OK);
    assert_true(p.n == 28 && p.read == 34 && p.index[0] == 6);
    cloudpoints_free(&p);
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, "fx, fy, cx and cy");
}

TEST(test_bad)
{
    static const struct scanfile_case bad[] = {
        {"", ST_EINVAL, "byte 10: malformed NPY header"},
        {"{}", ST_EINVAL, "byte 12: the NPY header has no type or no shape"},
        {"{'shape': (4, 3)}", ST_EINVAL, "no type or no shape"},
        {"{'descr': '<f8'}", ST_EINVAL, "no type or no shape"},
        {"{'descr': '<f8', 'shape': ()}", ST_EINVAL, "no type or no shape"},
        {"{'descr': '<f8', 'shape': 12}", ST_EINVAL, "byte 36: the shape of the array"},
        {"{'descr': '<f8', 'shape': (4, x)}", ST_EVERSION, "the shape of the array"},
        {"{'descr': '<f8', 'shape': (4, -3)}", ST_EVERSION, "the shape of the array"},
        {"{'descr': '<f8', 'shape': (4, 3", ST_EVERSION, "the shape of the array"},
        {"{'descr': '<f8', 'shape': (1, 1, 1, 1, 1, 1, 1, 4, 3)}", ST_EVERSION,
         "the shape of the array"},
        {"{'descr': '<f8', 'shape': (12,)}", ST_EVERSION, "(N, 3), (3, N), (H, W, 3)"},
        {"{'descr': '<f8', 'shape': (6, 2)}", ST_EVERSION, "a shape that is not read"},
        {"{'descr': '<f8', 'shape': (2, 3, 2)}", ST_EVERSION, "a shape that is not read"},
        {"{'descr': '<c16', 'shape': (4, 3)}", ST_EVERSION, "an NPY type"},
        {"{'descr': '|O', 'shape': (4, 3)}", ST_EVERSION, "an NPY type"},
        {"{'descr': [('x', '<f4')], 'shape': (4, 3)}", ST_EVERSION, "not x, y and z"},
        {"{'descr': [('x', '<f4'", ST_EVERSION, "a structure of NPY"},
        {"{'descr': [('x', 'f99999')]}", ST_EVERSION, "a structure of NPY"},
        {"{'descr': '<f8', 'fortran_order': 1, 'shape': (4, 3)}", ST_EINVAL,
         "malformed NPY header"},
        {"{'descr': '<f8', 'size': 3, 'shape': (4, 3)}", ST_EINVAL, "byte 27: malformed"},
        {"{'descr': '<f8', 'shape': (4, 3)", ST_EINVAL, "malformed NPY header"},
        {"{'descr': '<f8', 'shape': (5, 3)}", ST_EINVAL, "takes 120 bytes, here are 96"},
        {"{'descr': '<f8', 'shape': (3, 3)}", ST_EINVAL, "takes 72 bytes, here are 96"},
        {"{'descr': '<f4', 'shape': (4, 3)}", ST_EINVAL, "takes 48 bytes, here are 96"},
        {"{'descr': '<f8', 'shape': (0, 3)}", ST_EINVAL, "no points"},
        {"{'descr': '<f8', 'shape': (0, 4000000000, 3)}", ST_EINVAL, ""},
        {"{'descr': '<f8', 'shape': (4000000000, 0, 3)}", ST_EINVAL, ""},
        {"{'descr': '<f8', 'shape': (999999999999999999, 999999999999999999, 3)}",
         ST_EINVAL, "the data ends before the array does"},
    };
    static struct scanfile f;

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        begin(&f, 1, bad[i].text);
        for (int k = 0; k < 12; k++)
            scanfile_real(&f, k, 8, false);
        scanfile_bad(&f, CLOUDFORMAT_ANY, bad[i].st, bad[i].words);
    }
    begin(&f, 4, "{}");
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, "another version than 1, 2 and 3");
    f.len = 0;
    scanfile_text(&f, "NUMPY and nothing");
    scanfile_bad(&f, CLOUDFORMAT_NPY, ST_EINVAL, "an NPY file begins with");
}
