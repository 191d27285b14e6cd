/* Thinning keeps points of the scan, evenly spread, whatever their order; nearly as many as may
 * be; and all of them where that is enough. */
/* link: -Wl,--wrap=aligned_alloc */
#include "brute.h"
#include "fail_alloc.h"
#include "thin.h"
#include "unit.h"

#define MOST 10000
#define NEAR 2.5
#define ROOM 300000

static struct thin_point pts[ROOM], other[ROOM];
static size_t n;

/* A camera's grid of points over 150 x 190 mm, turned by some degrees. */
static void grid(double step, double degrees)
{
    const double c = cos(degrees / 57.29577951308232),
                 s = sin(degrees / 57.29577951308232);

    n = 0;
    for (double y = -95; y < 95; y += step)
        for (double x = -75; x < 75; x += step, n++)
            pts[n] = (struct thin_point){(float)(c * x - s * y), (float)(s * x + c * y),
                                         (float)(-x * x / 100), (uint32_t)n, 0};
}

static void anywhere(size_t count, struct draw *rng)
{
    for (n = 0; n < count; n++)
        pts[n] = (struct thin_point){(float)draw_uniform(rng, 0, 150),
                                     (float)draw_uniform(rng, 0, 190),
                                     (float)draw_uniform(rng, 0, 1), (uint32_t)n, 0};
}

/* Squares without a point, of those well inside. */
static size_t empty_squares(const struct thin_point *p, size_t count, double step)
{
    static uint8_t seen[256][256];
    size_t empty = 0;

    memset(seen, 0, sizeof seen);
    for (size_t i = 0; i < count; i++)
        seen[(int)((p[i].y + 130) / (float)step)][(int)((p[i].x + 130) / (float)step)] =
            1;
    for (double y = -60; y < 60; y += step) /* well inside */
        for (double x = -40; x < 40; x += step)
            empty += !seen[(int)((y + 130) / step)][(int)((x + 130) / step)];
    return empty;
}

TEST(test_grids)
{
    static const double step[] = {1.6, 1.5, 1.2, 0.9, 0.55, 0.4}, degrees[] = {0, 17, 45};

    for (size_t k = 0; k < 18; k++) {
        size_t kept;

        grid(step[k / 3], degrees[k % 3]);
        kept = n;
        assert_true(n > MOST);
        assert_int_equal(thin_points(pts, &kept, MOST, NEAR), ST_OK);
        assert_in_range(kept, MOST * 8 / 10, MOST);
        /* 10,000 points over 28,500 mm2 are 1.7 mm apart. */
        assert_true(empty_squares(pts, kept, 4) == 0);
        for (size_t i = 1; i < kept; i++)
            assert_true(pts[i - 1].index < pts[i].index);
    }
}

/* Of 30 points a square the mean is five times as near the surface as each of them; what is far
 * from the point kept has no part in it. */
TEST(test_mean)
{
    static const double near[] = {0, NEAR};
    struct draw rng = {brute_seed("mean")};

    for (int k = 0; k < 2; k++) {
        size_t kept, strays = 0;
        double sum = 0;

        anywhere(ROOM, &rng);
        for (size_t i = 0; i < n; i++)
            pts[i].z = i % 200 == 0 ? 9 : pts[i].z - 0.5F;
        kept = n;
        assert_int_equal(thin_points(pts, &kept, MOST, near[k]), ST_OK);
        for (size_t i = 0; i < kept; i++) {
            const double z = (double)pts[i].z + (double)pts[i].off;

            strays += z > 1;
            sum += z > 1 ? 0 : z * z;
        }
        sum = sqrt(sum / (double)kept) / sqrt(1 / 12.0);
        printf("near %g: %.3f of the deviation\n", near[k], sum);
        assert_true(strays < kept / 100);
        assert_true(k == 0 ? sum > 0.95 : sum < 0.25);
    }
}

static int by_index(const void *a, const void *b)
{
    const uint32_t x = ((const struct thin_point *)a)->index;
    const uint32_t y = ((const struct thin_point *)b)->index;

    return (x > y) - (x < y);
}

TEST(test_order)
{
    struct draw rng = {brute_seed("order")};

    for (int k = 0; k < 4; k++) {
        size_t kept, as_many;

        anywhere(40000, &rng);
        if (k % 2 == 0)
            for (size_t i = 0; i < n; i++) /* as many as far from the middle */
                pts[i].x = floorf(pts[i].x * 2) / 2, pts[i].y = floorf(pts[i].y * 2) / 2;
        memcpy(other, pts, n * sizeof *pts);
        brute_shuffle(other, n, sizeof *other, &rng);
        kept = as_many = n;
        assert_int_equal(thin_points(pts, &kept, MOST, NEAR), ST_OK);
        assert_int_equal(thin_points(other, &as_many, MOST, NEAR), ST_OK);
        assert_int_equal(kept, as_many);
        qsort(other, as_many, sizeof *other, by_index);
        for (size_t i = 0; i < kept; i++)
            assert_true(pts[i].off == other[i].off && pts[i].x == other[i].x &&
                        pts[i].y == other[i].y && pts[i].z == other[i].z);
    }
}

/* Few enough points stay as they are; any numbers are safe. */
TEST(test_limits)
{
    struct draw rng = {brute_seed("limits")};
    size_t kept;

    anywhere(MOST, &rng);
    memcpy(other, pts, n * sizeof *pts);
    kept = n;
    fail_alloc_at(1);
    assert_int_equal(thin_points(pts, &kept, MOST, NEAR), ST_OK);
    assert_int_equal(kept, MOST);
    assert_memory_equal(pts, other, n * sizeof *pts);
    anywhere(MOST + 100, &rng);
    for (size_t i = 0; i < n; i++)
        pts[i].x = pts[i].y = 5;
    kept = n;
    fail_alloc_at(0);
    assert_int_equal(thin_points(pts, &kept, MOST, NEAR), ST_OK);
    assert_int_equal(kept, 1);
    anywhere(MOST + 100, &rng);
    for (size_t i = 0; i < n; i += 2) {
        pts[i].x = i % 4 == 0 ? 3e38f : -3e38f;
        pts[i].y *= 1e35f;
    }
    kept = n;
    assert_int_equal(thin_points(pts, &kept, MOST, NEAR), ST_OK);
    assert_in_range(kept, 1000, MOST);
}
