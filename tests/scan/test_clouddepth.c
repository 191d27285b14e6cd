/* Depth images: the points of the pixels, what the scale may mean, pixels without a value,
 * and pictures that are no depth images. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <spng.h>

#include "scanfile.h"

static void make(struct scanfile *f, uint32_t width, uint32_t height, uint8_t color,
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

static void test_points(void **state)
{
    const struct clouddepth_camera camera = CAMERA;
    static struct scanfile f;
    struct scanfile_said err;
    struct cloudpoints p;

    (void)state;
    make(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(
            read_by(&f, camera, i == 0 ? CLOUDFORMAT_ANY : CLOUDFORMAT_PNG, &p, &err),
            ST_OK);
        assert_true(p.format == CLOUDFORMAT_PNG && p.unit_mm == 1 && p.normal == NULL);
        assert_true(p.width == 3 && p.height == 2 && p.read == 6 && p.n == 4);
        assert_true(p.index[0] == 0 && p.index[1] == 2 && p.index[2] == 3 &&
                    p.index[3] == 4);
        scanfile_at(p.at[0], -5, -20, -500);
        scanfile_at(p.at[1], 10, -40, -1000);
        scanfile_at(p.at[2], -2.58, -15.48, -258);
        scanfile_at(p.at[3], 0, -3932.1, -65535);
        cloudpoints_free(&p);
    }
}

static void test_scale(void **state)
{
    static const struct {
        double scale, mm; /* of 500 */
    } c[] = {{0, 500},      {1000, 500}, {5000, 100},  {100, 5000}, {1, 500},
             {0.125, 62.5}, {2, 1000},   {0.001, 500}, {0.01, 5000}};
    static struct scanfile f;
    struct scanfile_said err;
    struct cloudpoints p;

    (void)state;
    make(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
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

    assert_int_equal(read_by(f, c, CLOUDFORMAT_ANY, &p, &err), want);
    if (strstr(err.what, words) == NULL)
        fail_msg("no '%s': %s", words, err.what);
}

static void test_refused(void **state)
{
    const struct clouddepth_camera camera = CAMERA, none = CLOUDDEPTH_NO_CAMERA;
    static const unsigned char zeros[64];
    struct clouddepth_camera part = CAMERA;
    static struct scanfile f;

    (void)state;
    make(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    expect(&f, none, ST_EVERSION, "fx, fy, cx and cy");
    expect(&f, (struct clouddepth_camera){0}, ST_EVERSION, "fx, fy, cx and cy");
    part.cy = NAN;
    expect(&f, part, ST_EVERSION, "fx, fy, cx and cy");
    make(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 8, depth, 6);
    expect(&f, camera, ST_EVERSION, "of 8 bits: a depth image has 16 bits, grey");
    make(&f, 2, 1, SPNG_COLOR_TYPE_TRUECOLOR, 16, zeros, 12);
    expect(&f, camera, ST_EVERSION, "of 16 bits, in colour");
    make(&f, 7, 1, SPNG_COLOR_TYPE_GRAYSCALE, 16, zeros,
         14); /* 12 bytes may be unpacked */
    expect(&f, camera, ST_ESIZE, "7 x 1 pixels");
    make(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, zeros, 12);
    expect(&f, camera, ST_ENOTFINITE, "none of the 6 points");
    make(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    f.bytes[f.len - 20]++;
    expect(&f, camera, ST_EINVAL, "damaged");
}

/* Cut off anywhere, but for the end of the last chunk, which has nothing in it. */
static void test_cut(void **state)
{
    const struct clouddepth_camera camera = CAMERA;
    static struct scanfile f;

    (void)state;
    make(&f, 3, 2, SPNG_COLOR_TYPE_GRAYSCALE, 16, depth, sizeof depth);
    for (f.len -= 12 + 4; f.len-- > 8;)
        expect(&f, camera, ST_EINVAL, "damaged");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_scale),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_cut),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
