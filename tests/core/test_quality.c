/* The defects of a scan. */
#include "face.h"
#include "quality.h"
#include "unit.h"

static const struct surface_quality good = {0.9, 0.95, 2.2, 0.3};
static const struct frame still = {
    .pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, .mean_id = 1, .support = 0.9};

/* The frame of a face turned so many degrees about axis 0 to 2 (pitch, yaw, roll). */
static struct frame turned(int axis, double degrees)
{
    const double a = degrees * 3.14159265358979323846 / 180;
    const int i = (axis + 1) % 3, k = (axis + 2) % 3;
    struct frame f = still;

    f.pose.r[4 * i] = f.pose.r[4 * k] = cos(a);
    f.pose.r[3 * i + k] = -sin(a);
    f.pose.r[3 * k + i] = sin(a);
    return f;
}

TEST(test_reasons)
{
    const struct {
        struct surface_quality q;
        enum surface_reason r;
    } bad[] = {{{0.9, 0.95, 3.1, 0.3}, SURFACE_SPARSE},
               {{0.9, 0.95, 2.2, 0.7}, SURFACE_NOISY},
               {{0.6, 0.6, 2.2, 0.3}, SURFACE_INCOMPLETE}};
    const struct surface_quality all = {0.1, 0.1, 9, 2};
    struct frame f;

    assert_int_equal(quality_reasons(&good, &still), 0);
    assert_int_equal(quality_reasons(&good, NULL), 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(quality_reasons(&bad[i].q, NULL), 1U << bad[i].r);
    f = turned(1, 45);
    assert_int_equal(quality_reasons(&all, &f), (1U << SURFACE_REASONS) - 1);
}

TEST(test_turned)
{
    static const double limit[3] = {20, 30, 20};

    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            struct frame f = turned(axis, sign * (limit[axis] - 1));

            assert_int_equal(quality_reasons(&good, &f), 0);
            f = turned(axis, sign * (limit[axis] + 1));
            assert_int_equal(quality_reasons(&good, &f), 1U << SURFACE_OBLIQUE);
        }
}
