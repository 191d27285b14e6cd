/* Depth images in PNG, PGM and without a header: the points of the pixels, what the scale may
 * mean, pixels without a value, and pictures that are no depth images. */
#include <spng.h>

#include "scanfile.h"
#include "unit.h"

static void make_png(struct scanfile *f, uint32_t width, uint32_t height, uint8_t color,
                     uint8_t bits, const void *pixels, size_t len)
{
    struct spng_ihdr h = {
        .width = width, .height = height, .color_type = color, .bit_depth = bits};
    spng_ctx *png = spng_ctx_new(SPNG_CTX_ENCODER);
    int code;
    size_t n;
    void *bytes;

    assert_non_null(png);
    (void)spng_set_option(png, SPNG_ENCODE_TO_BUFFER, 1);
    assert_int_equal(spng_set_ihdr(png, &h), 0);
    assert_int_equal(
        spng_encode_image(png, pixels, len, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE), 0);
    bytes = spng_get_png_buffer(png, &n, &code);
    assert_non_null(bytes);
    f->len = 0;
    scanfile_put(f, bytes, n);
    free(bytes);
    spng_ctx_free(png);
}

static const uint16_t depth[2][3] = {{500, 0, 1000}, {0x0102, 65535, 0}};
#define CAMERA                                                                           \
    {                                                                                    \
        .fx = 100, .fy = 50, .cx = 1, .cy = -2                                           \
    }

static enum status read_by(const struct scanfile *f, struct clouddepth_camera c,
                           enum cloudformat format, struct cloudpoints *p,
                           struct scanfile_said *err)
{
    const struct cloudfile_options o = {.format = format,
                                        .max_points = 10,
                                        .max_bytes = 12,
                                        .unit_mm = 1000,
                                        .camera = c};

    return scanfile_read(f->bytes, f->len, &o, p, err);
}

/* The same image in each format. */
static enum cloudformat make(struct scanfile *f, int as)
{
    const uint16_t *d = depth[0];
    char text[100];

    f->len = 0;
    switch (as) {
    case 0:
        make_png(f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
        return CLOUDFORMAT_PNG;
    case 1:
        scanfile_text(f, "P5\n# by hand\n3 2\n# and more\n65535\n");
        for (int i = 0; i < 6; i++)
            scanfile_whole(f, d[i], 2, true);
        return CLOUDFORMAT_PGM;
    case 2:
        (void)snprintf(text, sizeof text,
                       "P2 3 2 65535\r\n%u %u %u # a row\r\n\r\n %u\t%u %u", d[0], d[1],
                       d[2], d[3], d[4], d[5]);
        scanfile_text(f, text);
        return CLOUDFORMAT_PGM;
    default:
        for (int i = 0; i < 6; i++)
            scanfile_whole(f, d[i], 2, false);
        return CLOUDFORMAT_RAW;
    }
}

TEST(test_points)
{
    static struct scanfile f;
    struct scanfile_said err;
    struct cloudpoints p;

    for (int i = 0; i < 8; i++) {
        const enum cloudformat format = make(&f, i / 2);
        struct clouddepth_camera camera = CAMERA;

        if (format == CLOUDFORMAT_RAW) {
            camera.width = 3;
            camera.height = 2;
        }
        assert_int_equal(
            read_by(&f, camera, i % 2 == 0 ? CLOUDFORMAT_ANY : format, &p, &err), ST_OK);
        assert_true(p.format == format && p.unit_mm == 1 && p.normal == NULL);
        assert_true(p.width == 3 && p.height == 2 && p.read == 6 && p.n == 3);
        assert_true(p.index[0] == 0 && p.index[1] == 2 && p.index[2] == 3);
        scanfile_at(p.at[0], -5, -20, -500);
        scanfile_at(p.at[1], 10, -40, -1000);
        scanfile_at(p.at[2], -2.58, -15.48, -258);
        cloudpoints_free(&p);
    }
}

/* The numbers of a depth image 8 x 4 that stand for no value: all but 500 to 530. */
TEST(test_no_value)
{
    static const uint16_t marks[] = {0, 65535, 9999, 65000, 10000, 32001};
    static const double floats[] = {9999, 1e10, 3.4e38, 1000, 65.535};
    struct clouddepth_camera camera = CAMERA;
    static struct scanfile f;
    struct cloudpoints p;

    camera.width = 8;
    camera.height = 4;
    for (size_t m = 0; m < sizeof marks / sizeof *marks; m++) {
        const struct cloudfile_options o = {
            .max_points = 100, .max_bytes = 1000, .camera = camera};
        struct scanfile_said err;

        f.len = 0;
        for (unsigned i = 0; i < 32; i++)
            scanfile_whole(&f,
                           i % 5 == 1 ? marks[m]
                           : i == 30  ? 9500
                                      : 500 + i,
                           2, false);
        assert_int_equal(scanfile_read(f.bytes, f.len, &o, &p, &err), ST_OK);
        assert_true(p.read == 32 && p.n == 24 && p.index[1] == 2);
        cloudpoints_free(&p);
    }
    for (size_t m = 0; m < sizeof floats / sizeof *floats; m++) {
        char text[200];

        /* an organised cloud in an unknown unit, with and without values for x and y */
        f.len = 0;
        scanfile_text(
            &f,
            "# .PCD\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 8\nHEIGHT 4\nDATA ascii\n");
        for (unsigned i = 0; i < 32; i++) {
            const double z = i % 5 == 1   ? floats[m]
                             : i % 7 == 1 ? -2 * floats[m]
                                          : 0.5 + 0.01 * i;

            (void)snprintf(text, sizeof text, "%.17g %.17g %.17g\n",
                           m % 2 == 0 ? 0.1 * i : z, 0.01 * i, z);
            scanfile_text(&f, text);
        }
        scanfile_good(&f, CLOUDFORMAT_ANY, &p);
        if (p.n != 21)
            fail_msg("%zu points with %g", p.n, floats[m]);
        cloudpoints_free(&p);
    }
    /* What is far is not without a value, if it is no more than that; nor is a unit that is wrong. */
    for (unsigned k = 0; k < 2; k++) {
        const struct cloudfile_options o = {
            .max_points = 100, .max_bytes = 1000, .camera = camera};
        struct scanfile_said err;

        f.len = 0;
        for (unsigned i = 0; i < 32; i++)
            scanfile_whole(&f, (k == 0 ? 500 : 9000) + 31 * i, 2, false);
        assert_int_equal(scanfile_read(f.bytes, f.len, &o, &p, &err), ST_OK);
        assert_int_equal(p.n, 32);
        cloudpoints_free(&p);
    }
}

TEST(test_scale)
{
    static const struct {
        double scale, mm; /* of 500 */
    } c[] = {{0, 500},      {1000, 500}, {5000, 100},  {100, 5000}, {1, 500},
             {0.125, 62.5}, {2, 1000},   {0.001, 500}, {0.01, 5000}};
    static struct scanfile f;
    struct scanfile_said err;
    struct cloudpoints p;

    make_png(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        struct clouddepth_camera camera = CAMERA;

        camera.scale = c[i].scale;
        assert_int_equal(read_by(&f, camera, CLOUDFORMAT_ANY, &p, &err), ST_OK);
        assert_true(fabs(p.at[0].z + c[i].mm) < 1e-9);
        cloudpoints_free(&p);
    }
}

static void expect(const struct scanfile *f, struct clouddepth_camera c, enum status want,
                   const char *words)
{
    struct scanfile_said err;
    struct cloudpoints p;

    const enum status st = read_by(f, c, CLOUDFORMAT_ANY, &p, &err);

    if (st != want || strstr(err.msg, words) == NULL)
        fail_msg("status %d, not %d with '%s': %s", st, want, words, err.msg);
}

TEST(test_refused)
{
    const struct clouddepth_camera camera = CAMERA, none = CLOUDDEPTH_NO_CAMERA;
    static const unsigned char zeros[64];
    struct clouddepth_camera part = CAMERA;
    static struct scanfile f;

    make_png(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    expect(&f, none, ST_EVERSION, "fx, fy, cx and cy");
    expect(&f, (struct clouddepth_camera){0}, ST_EVERSION, "fx, fy, cx and cy");
    part.cy = NAN;
    expect(&f, part, ST_EVERSION, "fx, fy, cx and cy");
    make_png(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 8, depth, 6);
    expect(&f, camera, ST_EVERSION, "of 8 bits: a depth image has 16 bits, grey");
    make_png(&f, 2, 1, SPNG_COLOR_TYPE_TRUECOLOR, 16, zeros, 12);
    expect(&f, camera, ST_EVERSION, "of 16 bits, in colour");
    make_png(&f, 7, 1, SPNG_COLOR_TYPE_GRAYSCALE, 16, zeros,
             14); /* 12 bytes may be unpacked */
    expect(&f, camera, ST_ESIZE, "7 x 1 pixels");
    make_png(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, zeros, 12);
    expect(&f, camera, ST_ENOTFINITE, "none of the 6 points");
    make_png(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    f.bytes[f.len - 20]++;
    expect(&f, camera, ST_EINVAL, "damaged");
}

/* Cut off anywhere, but for the end of the last chunk, which has nothing in it. */
TEST(test_cut)
{
    const struct clouddepth_camera camera = CAMERA;
    static struct scanfile f;

    make_png(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    for (f.len -= 12 + 4; f.len-- > 8;)
        expect(&f, camera, ST_EINVAL, "damaged");
}

TEST(test_pgm)
{
    struct scanfile_said err;
    struct cloudpoints p;
    static const struct scanfile_case bad[] = {
        {"P5\n2 2\n255\n\1\2\3\4", ST_EVERSION, "of 8 bits: a depth image has 16"},
        {"P2\n2 2\n255\n1 2 3 4\n", ST_EVERSION, "of 8 bits: a depth image has 16"},
        {"P2\n2 2\n65536\n1 2 3 4\n", ST_EINVAL, "line 3: a number from 0 to 65535"},
        {"P2\n2 -2\n65535\n1 2 3 4\n", ST_EINVAL, "line 2: a number from 0 to 65535"},
        {"P2\n2 2\n999\n1 2\n3 1000\n", ST_EINVAL, "line 5: a number from 0 to 999"},
        {"P2\n2 2\n999\n1 2\n3 4 5\n", ST_EINVAL, "line 5: more pixels than the"},
        {"P2\n2 2\n999\n1 2\n3\n", ST_EINVAL, "line 6: a number from 0 to 999"},
        {"P2\n2 2\n999\n1 2.5 3 4\n", ST_EINVAL, "line 4: a number"},
        {"P2\n0 2\n999\n", ST_EINVAL, "no points"},
        {"P2\n65535 65535\n999\n1", ST_EINVAL, "line 4: a number"},
        {"P5\n65535 65535\n999\n1", ST_EINVAL,
         "65535 x 65535 pixels of 16 bits take 8589672450 bytes, from here on the file has 1"},
        {"P5 2 1 999\n\1\2\3\4\5", ST_EINVAL, "byte 11: 2 x 1 pixels of 16 bits"},
        {"P5 ", ST_EINVAL, "line 1: a number from 0 to 65535"},
        {"P2\n2 2\n999\n0 0\n0 0\n", ST_ENOTFINITE, "none of the 4 points"},
    };
    const struct clouddepth_camera camera = CAMERA, none = CLOUDDEPTH_NO_CAMERA;
    static struct scanfile f;

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        f.len = 0;
        scanfile_text(&f, bad[i].text);
        expect(&f, camera, bad[i].st, bad[i].words);
    }
    for (int as = 1; as < 3; as++) {
        (void)make(&f, as);
        expect(&f, none, ST_EVERSION, "fx, fy, cx and cy");
        for (f.len -= as == 2 ? 3 : 0; f.len-- > 0;) /* the last number may be shorter */
            assert_int_not_equal(read_by(&f, camera, CLOUDFORMAT_PGM, &p, &err), ST_OK);
    }
}

/* Nothing in such a file says what it is, so it may look like anything. */
TEST(test_raw)
{
    struct clouddepth_camera camera = CAMERA;
    static struct scanfile f;
    struct scanfile_said err;
    struct cloudpoints p;

    camera.width = 2;
    camera.height = 3;
    f.len = 0;
    scanfile_text(&f, "<?xml is not");
    assert_int_equal(read_by(&f, camera, CLOUDFORMAT_ANY, &p, &err), ST_OK);
    assert_true(p.format == CLOUDFORMAT_RAW && p.n == 6 && p.width == 2);
    assert_true(p.at[0].z == -('<' + 256 * '?'));
    cloudpoints_free(&p);
    while (f.len-- > 0)
        expect(&f, camera, ST_EINVAL,
               f.len > 0 ? "2 x 3 pixels of 16 bits take 12 bytes" : "no points");
    (void)make(&f, 0);
    expect(&f, camera, ST_EINVAL, "this is PNG, not RAW as declared");
    assert_int_equal(read_by(&f, camera, CLOUDFORMAT_PNG, &p, &err), ST_OK);
    cloudpoints_free(&p);
    (void)make(&f, 3);
    camera.fx = NAN;
    expect(&f, camera, ST_EVERSION, "fx, fy, cx and cy");
}

static void check_weight(const struct scanfile *f, enum cloudformat format, size_t want)
{
    unsigned char *exact = malloc(f->len); /* a byte beyond it is an error */

    assert_non_null(exact);
    memcpy(exact, f->bytes, f->len);
    assert_int_equal(cloudfile_weight(exact, f->len, format), want);
    free(exact);
}

/* What counts are the points and pixels that a header says, however few bytes they take; and the
 * bytes where those are more. */
TEST(test_weight)
{
    static const uint16_t none[100][200];
    static const char *const head[] = {
        "P5 200 100 65535\n", "P2\n#\n200 100\n65535\n",
        "ply\nformat ascii 1.0\nelement vertex 20000\nproperty char x\nproperty char y\n"
        "property char z\nend_header\n",
        "\xEF\xBB\xBF# .PCD\nFIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH 200\n"
        "HEIGHT 100\nDATA binary_compressed\n"};
    const size_t want = 200 * 100 * (size_t)CLOUDFILE_POINT_WEIGHT;
    static struct scanfile f;

    make_png(&f, 200, 100, SPNG_COLOR_TYPE_GRAYSCALE, 16, none, sizeof none);
    assert_true(f.len < 200);
    check_weight(&f, CLOUDFORMAT_ANY, want);
    check_weight(&f, CLOUDFORMAT_PNG, want);
    check_weight(&f, CLOUDFORMAT_PLY, f.len); /* it is not read as one */
    for (f.len = 23; f.len > 0; f.len--)
        check_weight(&f, CLOUDFORMAT_ANY, f.len);
    for (size_t i = 0; i < sizeof head / sizeof *head; i++) {
        f.len = 0;
        scanfile_text(&f, head[i]);
        check_weight(&f, CLOUDFORMAT_ANY, want);
    }
    f.len = 0;
    scanfile_text(&f, "WIDTH 4000000000\nHEIGHT 4000000000\nFIELDS x y z\nSIZE 1 1 1\n"
                      "TYPE U U U\nDATA ascii\n");
    check_weight(&f, CLOUDFORMAT_PCD, SIZE_MAX);
    check_weight(&f, CLOUDFORMAT_ANY, f.len);
    f.len = 0;
    scanfile_text(&f, "\x93NUMPY\x01");
    scanfile_whole(&f, 0, 1, false);
    scanfile_whole(&f, 59, 2, false);
    scanfile_text(&f, "{'descr': '|u1', 'fortran_order': False, 'shape': (50, 20)}");
    for (int i = 0; i < 1000; i++)
        scanfile_whole(&f, 0, 1, false);
    check_weight(&f, CLOUDFORMAT_ANY, 1000 * CLOUDFILE_POINT_WEIGHT);
    f.len = 100;
    memset(f.bytes, 0, f.len);
    check_weight(&f, CLOUDFORMAT_ANY, 100);
    check_weight(&f, CLOUDFORMAT_RAW, 50 * CLOUDFILE_POINT_WEIGHT);
    memcpy(f.bytes, "\x1F\x8B", 2);
    check_weight(&f, CLOUDFORMAT_ANY, SIZE_MAX);
}
