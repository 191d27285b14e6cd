/* The rendered kinds are what they say: unit, axes, counts, what covers what. */
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

static struct headscan_options kind(const char *name, uint64_t seed)
{
    struct headscan_options o = {.seed = 0};

    for (unsigned k = 0; k < HEADSCAN_KINDS; k++)
        if (strcmp(headscan_name(k), name) == 0) {
            headscan_kind(k, seed, false, &o);
            return o;
        }
    fail_msg("there is no kind %s", name);
    return o;
}

static void render(const struct headscan_options *o, struct headscan *s)
{
    headscan_render(&made, &made, o, s);
}

/* Extents of what has a value, and how many that is. */
static size_t extent(const struct headscan *s, struct dvec3 *low, struct dvec3 *high)
{
    size_t n = 0;

    *low = (struct dvec3){INFINITY, INFINITY, INFINITY};
    *high = (struct dvec3){-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < s->n; i++) {
        const struct dvec3 p = s->at[i];

        if (isnan(p.x))
            continue;
        n++;
        *low = (struct dvec3){fmin(low->x, p.x), fmin(low->y, p.y), fmin(low->z, p.z)};
        *high =
            (struct dvec3){fmax(high->x, p.x), fmax(high->y, p.y), fmax(high->z, p.z)};
    }
    return n;
}

TEST(test_same_seed_same_scan)
{
    struct headscan_options o = kind("glasses", 7);
    struct headscan a, b;

    render(&o, &a);
    render(&o, &b);
    assert_int_equal(a.n, 20000);
    assert_int_equal(b.n, a.n);
    assert_memory_equal(a.at, b.at, a.n * sizeof *a.at);
    headscan_free(&b);
    o.seed = 8;
    render(&o, &b);
    assert_memory_not_equal(a.at, b.at, a.n * sizeof *a.at);
    headscan_free(&a);
    headscan_free(&b);
}

/* Metres, y down, z away, and the shoulders are wider than the head. */
TEST(test_bust)
{
    const struct headscan_options o = kind("bust", 1);
    struct dvec3 low, high;
    struct headscan s;
    double nose = INFINITY, above = 0;

    render(&o, &s);
    assert_int_equal(extent(&s, &low, &high), 30000);
    assert_true(high.x - low.x > 0.35 && high.x - low.x < 0.5);
    assert_true(high.y - low.y > 0.4 && high.y - low.y < 0.6);
    assert_true(low.z > o.distance / 1000 - 0.06 && high.z < o.distance / 1000 + 0.35);
    for (size_t i = 0; i < s.n; i++)
        nose = fmin(nose, s.at[i].z);
    for (size_t i = 0; i < s.n; i++) /* above the nose, y smaller, lies the skull */
        above += s.at[i].z < nose + 0.1 && s.at[i].y < -0.08;
    assert_true(above > 100);
    headscan_free(&s);
}

/* The same points in any axes and unit: distances are kept. */
TEST(test_axes_and_units)
{
    struct headscan_options o = kind("head", 2);
    struct headscan a, b;

    render(&o, &a);
    for (int axes = 0; axes < HEADSCAN_AXES; axes++) {
        o.axes = (enum headscan_axes)axes;
        o.unit_mm = 25.4;
        render(&o, &b);
        assert_int_equal(b.n, a.n);
        for (size_t i = 1; i < a.n; i += 97) {
            const struct dvec3 p = vec_sub(a.at[i], a.at[i - 1]);
            const struct dvec3 q = vec_sub(b.at[i], b.at[i - 1]);

            assert_true(fabs(sqrt(vec_dot(p, p)) - 25.4 * sqrt(vec_dot(q, q))) < 1e-6);
        }
        headscan_free(&b);
    }
    o = kind("head", 2);
    o.mirrored = true;
    render(&o, &b);
    for (size_t i = 0; i < a.n; i += 97)
        assert_true(b.at[i].x == -a.at[i].x && b.at[i].z == a.at[i].z);
    headscan_free(&a);
    headscan_free(&b);
}

/* A camera's grid: each pixel on its ray, the head before the wall, and no value somewhere;
 * depths are steps that grow with the distance. */
TEST(test_depth_camera)
{
    const struct headscan_options o = kind("depth", 3);
    size_t n, near = 0;
    struct dvec3 low, high;
    struct headscan s;

    render(&o, &s);
    n = extent(&s, &low, &high);
    assert_int_equal(s.width * s.height, 640 * 480);
    assert_int_equal(s.n, 640 * 480);
    assert_true(n < s.n && n > s.n * 9 / 10);
    for (size_t i = 0; i < s.n; i++) {
        const struct dvec3 p = s.at[i];
        const double z = p.z * o.unit_mm, step = 600 * 50 * 16 / z;

        if (isnan(z))
            continue;
        assert_true(fabs(p.x / p.z - ((double)(i % 640) - 319.5) / 600) < 1e-9);
        assert_true(fabs(p.y / p.z - ((double)(i / 640) - 239.5) / 600) < 1e-9);
        assert_true(fabs(step - nearbyint(step)) < 1e-6);
        near += z < o.distance + 60;
    }
    assert_true(low.z * o.unit_mm > o.distance - 60);
    assert_true(high.z * o.unit_mm > o.distance + 300);
    assert_true(near > 5000);
    headscan_free(&s);
}

TEST(test_grid_half_behind_two)
{
    struct headscan_options o = kind("grid", 4);
    struct dvec3 low, high;
    struct headscan s;

    render(&o, &s);
    for (size_t i = 0; i < s.n; i++)
        assert_true(fmod(fabs(s.at[i].x) + 1e-6, 1) < 2e-6 &&
                    fabs(10 * s.at[i].z - nearbyint(10 * s.at[i].z)) < 1e-6);
    headscan_free(&s);
    for (uint64_t seed = 0; seed < 20; seed++) {
        o = kind("half", seed);
        assert_true(fabs(o.yaw) >= 35 && fabs(o.yaw) <= 55);
    }
    o = kind("behind", 4);
    render(&o, &s);
    assert_int_equal(s.n, 22222);
    headscan_free(&s);
    o = kind("two", 4);
    render(&o, &s);
    (void)extent(&s, &low, &high);
    assert_true(high.x - low.x > 330);
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
