/* The face generator: faces have realistic sizes, scans have no hidden points, the same seeds
 * give the same scan, and different subjects differ more than two scans of one. */
#include "facegen.h"
#include "unit.h"

#define N 3000

static struct dvec3 a[N], b[N];

TEST(test_same_seeds_same_scan)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = 5;
    s.holes = 0.2;
    s.spikes = 0.01;
    s.points = N;
    facegen_pose(&s, 10, 20);
    assert_int_equal(facegen_sample(&s, a), facegen_sample(&s, b));
    assert_memory_equal(a, b, sizeof a);
    s.scan++;
    (void)facegen_sample(&s, b);
    assert_memory_not_equal(a, b, sizeof a);
}

/* Without noise, each point moved back by the pose lies on the face; and points close
 * together in x and y differ little in height: no hidden point was sampled. */
TEST(test_pose_and_visibility)
{
    struct facegen_scan s;
    struct facegen_face face;
    const double rad = acos(-1.0) / 180;

    facegen_default(&s);
    s.subject = 3;
    s.noise = s.warp = 0;
    s.yaw = 25;
    s.tx = 7;
    s.tz = -30;
    facegen_face(3, 0, &face);
    assert_int_equal(facegen_sample(&s, a), N);
    for (size_t i = 0; i < N; i++) {
        const double x = a[i].x - 7, z = a[i].z + 30 + 80;
        const double hx = cos(25 * rad) * x - sin(25 * rad) * z;
        const double hz = sin(25 * rad) * x + cos(25 * rad) * z - 80;

        assert_true(fabs(facegen_height(&face, hx, a[i].y) - hz) < 1e-9);
        for (size_t j = 0; j < i; j++)
            if (fabs(a[i].x - a[j].x) < 0.3 && fabs(a[i].y - a[j].y) < 0.3)
                assert_true(fabs(a[i].z - a[j].z) < 3);
    }
}

TEST(test_holes_and_spikes)
{
    struct facegen_scan s;
    size_t n, off = 0;

    facegen_default(&s);
    s.holes = 0.3;
    n = facegen_sample(&s, a);
    assert_in_range(n, N * 50 / 100, N * 70 / 100);
    s.spikes = 0.02;
    assert_int_equal(facegen_sample(&s, b), n);
    for (size_t i = 0; i < n; i++) {
        assert_true(a[i].x == b[i].x && a[i].y == b[i].y);
        off += fabs(a[i].z - b[i].z) >= 4;
    }
    assert_in_range(off, n * 15 / 1000, n * 20 / 1000 + 1);
    s.yaw = 60;
    s.pitch = 60;
    n = facegen_sample(&s, a);
    assert_true(n == 0 || n <= N);
}
