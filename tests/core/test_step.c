/* Depths in steps are told from continuous ones, from a regular grid and from rounding. */
#include "clouds.h"
#include "pose.h"
#include "step.h"
#include "toy.h"
#include "unit.h"

#define ROOM 20000

static struct dvec3 pts[ROOM];
static size_t n;

static void sample(uint64_t subject, uint32_t points)
{
    n = clouds_scan(subject, 0, points, pts);
    assert_true(n > points / 2);
}

static void round_to(double step, double off)
{
    for (size_t i = 0; i < n; i++)
        pts[i].z = step * rint((pts[i].z - off) / step) + off;
}

static void assert_step(double want, double within, const struct pose *view)
{
    const double step = step_of(pts, n, view);

    if (!(fabs(step - want) <= within))
        fail_msg("a step of %.4f mm, wanted %.4f", step, want);
}

TEST(test_continuous)
{
    for (uint32_t points = 150; points < ROOM; points *= 5) {
        sample(1, points);
        assert_step(0, 0, &toy_still);
        assert_step(0, 0, NULL);
    }
}

/* Whatever the step, where the first depth is, and how many points there are. */
TEST(test_steps)
{
    static const double step[] = {0.1, 1, 2, 4, 6};

    for (size_t k = 0; k < sizeof step / sizeof *step; k++) {
        sample(2 + k, k == 0 ? 15000 : 1500);
        round_to(step[k], 0.3);
        assert_step(step[k], 1e-9, &toy_still);
        assert_step(step[k], 1e-9, NULL);
    }
}

/* A sensor's steps grow with the square of the distance; and a filter, or a rounding of its own, moves
 * each depth a little. */
TEST(test_disparity)
{
    const double far = 900, constant = far * far / 2.5;

    sample(3, 5000);
    for (size_t i = 0; i < n; i++) {
        const double to = constant / rint(constant / (far - pts[i].z));

        pts[i].z = far - to + 0.01 * (double)(i % 20);
    }
    assert_step(2.3, 0.3, &toy_still);
}

/* x and y on a grid, as of an image that was computed anew, say nothing of the depth. */
TEST(test_grid)
{
    sample(4, 15000);
    for (size_t i = 0; i < n; i++) {
        pts[i].x = rint(pts[i].x);
        pts[i].y = rint(pts[i].y);
    }
    assert_step(0, 0, &toy_still);
}

/* The axis that the face looks along, whichever that is. */
TEST(test_axes)
{
    const struct pose from_x = {{0, 1, 0, 0, 0, 1, 1, 0, 0}, {0, 0, 0}};
    const struct pose from_y = {{1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0, 0}};

    sample(5, 4000);
    round_to(2, 0);
    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){pts[i].z, pts[i].x, pts[i].y};
    assert_step(2, 1e-9, &from_x);
    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){pts[i].y, pts[i].x, -pts[i].z};
    assert_step(2, 1e-9, &from_y);
}

/* Too few points, one depth, and points elsewhere. */
TEST(test_nothing)
{
    const struct pose away = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {500, 0, 0}};

    sample(6, 4000);
    round_to(2, 0);
    assert_step(0, 0, &away);
    n = 99;
    assert_step(0, 0, NULL);
    n = 0;
    assert_step(0, 0, NULL);
    sample(6, 4000);
    round_to(1000, 0);
    assert_step(0, 0, NULL);
}
