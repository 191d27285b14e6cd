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

TEST(test_size_of_a_face)
{
    struct facegen_scan s;

    facegen_default(&s);
    for (s.subject = 0; s.subject < 50; s.subject++) {
        struct dvec3 low = {1e9, 1e9, 1e9}, high = {-1e9, -1e9, -1e9};

        assert_int_equal(facegen_sample(&s, a), N);
        for (size_t i = 0; i < N; i++) {
            low.x = fmin(low.x, a[i].x);
            low.y = fmin(low.y, a[i].y);
            low.z = fmin(low.z, a[i].z);
            high.x = fmax(high.x, a[i].x);
            high.y = fmax(high.y, a[i].y);
            high.z = fmax(high.z, a[i].z);
        }
        if (high.x - low.x < 100 || high.x - low.x > 150 || high.y - low.y < 135 ||
            high.y - low.y > 185 || high.z - low.z < 40 || high.z - low.z > 110 ||
            fabs(high.z) > 12)
            fail_msg("subject %d: %.1f x %.1f x %.1f, top %.1f", (int)s.subject,
                     high.x - low.x, high.y - low.y, high.z - low.z, high.z);
    }
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

/* Mean |difference| of two faces over the middle of the face after subtracting the best
 * plane: about what alignment can remove. */
static double unlike(uint64_t p, double smile_p, uint64_t q, double smile_q)
{
    struct facegen_face f, g;
    double m[3][4] = {{0}}, sum = 0;
    int n = 0;

    facegen_face(p, smile_p, &f);
    facegen_face(q, smile_q, &g);
    for (int pass = 0; pass < 2; pass++) {
        for (int x = -45; x <= 45; x += 5) {
            for (int y = -60; y <= 65; y += 5) {
                const double v[3] = {1, x / 50.0, y / 50.0};
                const double d = facegen_height(&f, x, y) - facegen_height(&g, x, y);

                for (int i = 0; pass == 0 && i < 3; i++) {
                    for (int j = 0; j < 3; j++)
                        m[i][j] += v[i] * v[j];
                    m[i][3] += v[i] * d;
                }
                if (pass == 1) {
                    sum += fabs(d - m[0][3] - m[1][3] * v[1] - m[2][3] * v[2]);
                    n++;
                }
            }
        }
        for (int i = 0; pass == 0 && i < 3; i++) { /* Gauss-Jordan */
            for (int j = 3; j >= i; j--)
                m[i][j] /= m[i][i];
            for (int k = 0; k < 3; k++)
                for (int j = 3; k != i && j >= i; j--)
                    m[k][j] -= m[k][i] * m[i][j];
        }
    }
    return sum / n;
}

TEST(test_subjects_differ)
{
    double least = 1e9, most = 0, sum = 0;
    int n = 0;

    for (uint64_t p = 0; p < 40; p++) {
        for (uint64_t q = 0; q < p; q++) {
            const double d = unlike(p, 0, q, 0);

            least = fmin(least, d);
            most = fmax(most, d);
            sum += d;
            n++;
        }
        assert_true(unlike(p, 0, p, 1) > 0.1); /* a smile changes the face */
    }
    print_message("subjects differ by %.2f to %.2f mm, %.2f on average\n", least, most,
                  sum / n);
    assert_true(least > 0.6);
    assert_true(sum / n > 1.2 && sum / n < 3);
}
