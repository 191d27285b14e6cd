/* Rendered heads: a depth camera's pixels, covers before the face, hidden layers.  test_find.c finds
 * the face of each kind in its unit and at its pose. */
#include "draw.h"
#include "face.h"
#include "headscan.h"
#include "headview.h"
#include "unit.h"

static struct head made;

BEFORE_ALL(make)
{
    head_make_up(3, &made);
}

/* A camera's grid: each pixel on its ray, the head before the wall, and no value somewhere;
 * depths are steps that grow with the distance. */
TEST(test_depth_camera)
{
    struct headscan_options o;
    double nearest = INFINITY, farthest = 0;
    size_t n = 0, near = 0;
    struct headscan s;

    assert_true(headscan_kind("depth", 3, false, &o));
    headscan_render(&made, &o, &s);
    assert_int_equal(s.width * s.height, 640 * 480);
    assert_int_equal(s.n, 640 * 480);
    for (size_t i = 0; i < s.n; i++) {
        const struct dvec3 p = s.at[i];
        const double z = p.z * o.unit_mm, step = 600 * 50 * 16 / z;

        if (isnan(z))
            continue;
        n++;
        assert_true(fabs(p.x / p.z - ((double)(i % 640) - 319.5) / 600) < 1e-9);
        assert_true(fabs(p.y / p.z - ((double)(i / 640) - 239.5) / 600) < 1e-9);
        assert_true(fabs(step - nearbyint(step)) < 1e-6);
        near += z < o.distance + 60;
        nearest = fmin(nearest, z);
        farthest = fmax(farthest, z);
    }
    assert_true(n < s.n && n > s.n * 9 / 10);
    assert_true(nearest > o.distance - 60 && farthest > o.distance + 300);
    assert_true(near > 5000);
    headscan_free(&s);
}

static size_t skin_seen(const struct headview *v)
{
    size_t n = 0;

    for (size_t i = 0; i < v->head->n; i++)
        n += v->seen[i] && v->head->part[i] == HEAD_SKIN;
    return n;
}

/* What covers a face lies before it, and what it hides is not seen: of the head's own front
 * less is left than without it. */
TEST(test_covers)
{
    static const struct {
        double x, y; /* a place that it covers */
    } at[HEADCOVERS] = {[HEADCOVER_GLASSES] = {33, 14}, [HEADCOVER_MASK] = {0, -30},
                        [HEADCOVER_SCARF] = {0, -60},   [HEADCOVER_HAND] = {40, -40},
                        [HEADCOVER_FRINGE] = {0, 72},   [HEADCOVER_BEARD] = {0, -60},
                        [HEADCOVER_CAP] = {0, 70}};
    struct headview bare, v;

    headview_make(&made, false, &bare);
    for (int kind = 1; kind < HEADCOVERS; kind++) {
        size_t covered = 0;

        for (uint64_t seed = 0; seed < 4; seed++) {
            struct head h = head_copy(&made);
            double z, skin;

            headcover_add(&h, (enum headcover)kind, seed, false);
            assert_true(h.n > made.n + 500);
            headview_make(&h, false, &v);
            assert_true(skin_seen(&v) + 100 < skin_seen(&bare));
            for (int side = -1; side <= 1; side += 2)
                for (double y = at[kind].y - 8; y <= at[kind].y + 8; y += 2) {
                    if (headview_at(&bare, side * at[kind].x, y, &skin) == HEAD_SKIN &&
                        headview_at(&v, side * at[kind].x, y, &z) == HEAD_COVER) {
                        covered++;
                        assert_true(z > skin - 1);
                    }
                }
            headview_free(&v);
            head_free(&h);
        }
        if (covered < 8)
            fail_msg("cover %d: %zu places covered", kind, covered);
    }
    headview_free(&bare);
}

/* Points at random on a slope, each off it by some tenths of a mm, and as many 4 mm behind it. */
static void make_layers(double slope, struct head *h)
{
    struct draw r = draw_stream(9, 0, 0);

    *h = (struct head){.spacing = 1.8};
    for (int i = 0; i < 16000; i++) {
        const double x = draw_uniform(&r, -80, 80), y = draw_uniform(&r, -80, 80);
        const double z = slope * x + (i % 2 ? 0 : -4);

        head_add(h, (struct dvec3){x, y, z + 0.1 * draw_normal(&r)}, HEAD_SKIN);
    }
}

/* Of two layers the front one is seen whole, on slopes too, and an eighth of the other one at
 * most; the surface passes through the points, and is not smoothed. */
TEST(test_layers)
{
    for (int steep = 0; steep <= 2; steep++) {
        size_t front = 0, back = 0, all = 0;
        double off = 0, z, rough = 0;
        struct headview v;
        struct head h;

        make_layers(0.5 * steep, &h);
        headview_make(&h, false, &v);
        for (size_t i = 0; i < h.n; i++) {
            const struct dvec3 p = h.at[i];

            if (fabs(p.x) > 70 || fabs(p.y) > 70)
                continue;
            *(i % 2 ? &front : &back) += v.seen[i];
            all += i % 2;
            if (v.seen[i] && i % 2 && headview_at(&v, p.x, p.y, &z) == HEAD_SKIN) {
                off = fmax(off, fabs(z - p.z));
                rough += pow(z - 0.5 * steep * p.x, 2);
            }
        }
        print_message("%zu %zu %zu\n", front, back, all);
        assert_true(front > all * 99 / 100 && back < all / 8);
        assert_true(off < 0.01 && rough > 0.009 * (double)front);
        headview_free(&v);
        head_free(&h);
    }
}
