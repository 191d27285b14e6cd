/* Points of one side of a ball are told from points all round, with and without a wall. */
#include "sight.h"
#include "unit.h"

#define ACROSS 120

static struct dvec3 pts[4 * ACROSS * ACROSS];
static size_t n;

/* A ball of 80 mm about (5, -7, 0), its front towards side; and its back. */
static void take(double side, bool back)
{
    n = 0;
    for (int i = 0; i < ACROSS; i++)
        for (int j = 0; j < ACROSS; j++) {
            const double x = 160.0 * i / ACROSS - 80, y = 160.0 * j / ACROSS - 80;
            const double z2 = 80 * 80 - x * x - y * y;

            if (z2 < 0)
                continue;
            pts[n++] = (struct dvec3){x + 5, y - 7, side * sqrt(z2)};
            if (back)
                pts[n++] = (struct dvec3){x + 5, y - 7, -side * sqrt(z2)};
        }
}

/* What a scanner sees of a wall: not what the ball hides. */
static void add_wall(double side)
{
    for (int i = 0; i < ACROSS; i++)
        for (int j = 0; j < ACROSS; j++) {
            const double x = 4.0 * i - 240, y = 4.0 * j - 240;

            if (x * x + y * y > 80 * 80)
                pts[n++] = (struct dvec3){x + 5, y - 7, -300 * side};
        }
}

TEST(test_ball)
{
    for (double side = -1; side <= 1; side += 2) {
        const struct dvec3 nose = {5, -7, 80 * side};

        take(side, false);
        assert_true(sight_single(pts, n, nose, side));
        add_wall(side);
        assert_true(sight_single(pts, n, nose, side));
        take(side, true);
        assert_false(sight_single(pts, n, nose, side));
        assert_false(sight_single(pts, n, nose, -side));
    }
}

TEST(test_nothing)
{
    take(1, true);
    assert_false(sight_single(pts, n, (struct dvec3){1e6, 0, 0}, 1));
    assert_false(sight_single(pts, 0, (struct dvec3){0, 0, 0}, 1));
}
