/* The crop keeps the face that is seen from the front: of two layers the first, nothing that
 * covers it or lies elsewhere, and the same points whatever their order. */
#include "brute.h"
#include "cloudpoints.h"
#include "crop.h"
#include "grid.h"
#include "mem.h"
#include "mirror.h"
#include "model.h"
#include "shape.h"
#include "toy.h"
#include "unit.h"

#define POINTS 12000
#define ROOM   60000

static struct draw rng;
static uint8_t cell[GRID_N];
static struct crop_view view;
static struct pose pose; /* of the scan: canonical frame -> points */
static struct dvec3 pts[ROOM];
static size_t n;

BEFORE_EACH(set_up)
{
    rng.x = brute_seed("crop");
    memset(cell, SHAPE_EMPTY, sizeof cell);
    for (uint32_t i = 0; i < GRID_N; i++)
        if (!isnan(model_default.mean[i]))
            cell[i] = SHAPE_SKIN;
    toy_pose(140, 30, 70, (struct dvec3){300, -50, 900}, &pose);
    view.pose = pose_after(&pose, &toy_still);
    view.height = model_default.mean;
    view.cell = cell;
    n = 0;
}

/* So many points of the face, by so much before it, with noise. */
static void add_face(size_t count, double before, double noise)
{
    for (size_t k = 0; k < count;) {
        const double x = draw_uniform(&rng, -60, 60), y = draw_uniform(&rng, -88, 66);
        const double z = toy_at(model_default.mean, x, y);

        if (isnan(z))
            continue;
        pts[n++] = pose_apply(
            &pose, (struct dvec3){x, y, z + before + noise * draw_normal(&rng)});
        k++;
    }
}

/* In a box of the canonical frame. */
static void add_box(size_t count, struct dvec3 lo, struct dvec3 hi)
{
    for (size_t k = 0; k < count; k++)
        pts[n++] = pose_apply(&pose, (struct dvec3){draw_uniform(&rng, lo.x, hi.x),
                                                    draw_uniform(&rng, lo.y, hi.y),
                                                    draw_uniform(&rng, lo.z, hi.z)});
}

static void take(struct cloudpoints *c)
{
    *c = (struct cloudpoints){.at = mem_array(n, sizeof *c->at), .n = n, .read = n};
    assert_non_null(c->at);
    memcpy(c->at, pts, n * sizeof *pts);
}

/* Of the points kept those with places in [from, to). */
static size_t kept(const struct cloudpoints *c, size_t from, size_t to)
{
    size_t k = 0;

    for (size_t i = 0; i < c->n; i++)
        k += c->index[i] >= from && c->index[i] < to;
    return k;
}

/* Points that stand for others are moved along z. */
static void assert_place(struct dvec3 p, struct dvec3 from, bool thinned)
{
    assert_true(p.x == from.x && p.y == from.y);
    assert_true(thinned ? fabs(p.z - from.z) <= CROP_MEAN_MM : p.z == from.z);
}

static void crop(struct cloudpoints *c, size_t most, struct crop_count *count)
{
    take(c);
    assert_int_equal(crop_face(c, &view, most, count), ST_OK);
    assert_int_equal(count->kept, c->n);
    for (size_t i = 0; i < c->n; i++) { /* in the frame, and ascending */
        const struct dvec3 q = pose_apply(&view.pose, pts[c->index[i]]);

        assert_place(c->at[i], q, count->kept < count->face);
        assert_true(i == 0 || c->index[i] > c->index[i - 1]);
    }
}

TEST(test_elsewhere)
{
    struct crop_count count;
    struct cloudpoints c;

    add_face(POINTS, 0, 0.2);
    add_box(3000, (struct dvec3){-60, -90, -220}, (struct dvec3){60, 70, -150});
    add_box(3000, (struct dvec3){-250, -300, -150}, (struct dvec3){250, -130, 0});
    add_box(3000, (struct dvec3){-900, -900, -800}, (struct dvec3){900, 900, -790});
    add_box(500, (struct dvec3){-60, -90, 30}, (struct dvec3){60, 70, 300});
    crop(&c, ROOM, &count);
    assert_true((double)kept(&c, 0, POINTS) > 0.99 * POINTS);
    assert_int_equal(kept(&c, POINTS, n), 0);
    assert_true(count.face == c.n && count.other == 0);
    cloudpoints_free(&c);
}

/* The second layer goes where it is 3 mm behind the first; what is noisy has none. */
TEST(test_layers)
{
    static const double behind[] = {3, 5, 7.5};
    struct crop_count count;
    struct cloudpoints c;

    for (size_t k = 0; k < sizeof behind / sizeof *behind; k++) {
        n = 0;
        add_face(POINTS, 0, 0.15);
        add_face(POINTS, -behind[k], 0.15);
        crop(&c, ROOM, &count);
        assert_true((double)kept(&c, 0, POINTS) > 0.98 * POINTS);
        printf("%g mm: %.3f of the first, %.3f of the second\n", behind[k],
               (double)kept(&c, 0, POINTS) / POINTS,
               (double)kept(&c, POINTS, n) / POINTS);
        assert_true((double)kept(&c, POINTS, n) < 0.1 * POINTS);
        cloudpoints_free(&c);
    }
    n = 0;
    add_face(POINTS, 0, 0.9);
    crop(&c, ROOM, &count);
    printf("noise: %.3f\n", (double)kept(&c, 0, POINTS) / POINTS);
    assert_true((double)kept(&c, 0, POINTS) > 0.97 * POINTS);
    cloudpoints_free(&c);
}

/* Is a point where something covers the face? */
static bool covered(struct dvec3 p)
{
    return p.x < 0 && p.y < -18;
}

/* What covers the face is left out with all that lies under it; strays beside it stay. */
TEST(test_cover)
{
    struct crop_count count;
    struct cloudpoints c;
    size_t cover = 0, strays = 0, left = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (cell[i] == SHAPE_SKIN && grid_y(i) < -18)
            cell[i] = grid_x(i) < 0 ? SHAPE_COVER : SHAPE_APART;
    add_face(POINTS, 0, 0.15);
    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = pose_apply(&view.pose, pts[i]);

        strays += p.x >= 0 && p.y < -18;
    }
    add_face(POINTS, 12, 0.15);
    for (size_t i = 0; i < n; i++)
        cover += covered(pose_apply(&view.pose, pts[i]));
    crop(&c, ROOM, &count);
    for (size_t i = 0; i < c.n; i++) {
        assert_false(covered(c.at[i]));
        left += c.at[i].x >= 0 && c.at[i].y < -18;
    }
    assert_true((double)left > 0.9 * (double)strays);
    assert_true((double)count.other > 0.98 * (double)cover);
    assert_true(count.other <= cover);
    assert_int_equal(count.face, count.kept);
    cloudpoints_free(&c);
}

static int by_place(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct dvec3));
}

TEST(test_order)
{
    struct crop_count count;
    struct cloudpoints a, b;

    add_face(POINTS, 0, 0.2);
    add_face(POINTS, -4, 0.2);
    add_box(3000, (struct dvec3){-60, -90, -220}, (struct dvec3){60, 70, 20});
    crop(&a, 8000, &count);
    assert_in_range(a.n, 7000, 8000);
    brute_shuffle(pts, n, sizeof *pts, &rng);
    crop(&b, 8000, &count);
    assert_int_equal(a.n, b.n);
    qsort(a.at, a.n, sizeof *a.at, by_place);
    qsort(b.at, b.n, sizeof *b.at, by_place);
    assert_memory_equal(a.at, b.at, a.n * sizeof *a.at);
    cloudpoints_free(&a);
    cloudpoints_free(&b);
}

/* What many points measure alike is measured the better: of 10 points each the noise is a
 * third, on steep places too. */
TEST(test_noise)
{
    static const size_t most[] = {ROOM, 5000};
    double rms[2];

    add_face(50000, 0, 0.5);
    for (int k = 0; k < 2; k++) {
        struct crop_count count;
        struct cloudpoints c;
        double sum = 0;

        crop(&c, most[k], &count);
        for (size_t i = 0; i < c.n; i++)
            sum += pow(c.at[i].z - toy_at(model_default.mean, c.at[i].x, c.at[i].y), 2);
        rms[k] = sqrt(sum / (double)c.n);
        cloudpoints_free(&c);
    }
    printf("noise %.3f mm, of means %.3f\n", rms[0], rms[1]);
    assert_true(rms[0] > 0.45 && rms[1] < 0.4 * rms[0]);
}

/* Places and normals go with the points. */
TEST(test_members)
{
    struct crop_count count;
    struct cloudpoints c;

    add_face(POINTS, 0, 0.15);
    take(&c);
    c.index = mem_array(n, sizeof *c.index);
    c.normal = mem_array(n, sizeof *c.normal);
    assert_true(c.index != NULL && c.normal != NULL);
    for (size_t i = 0; i < n; i++) {
        c.index[i] = (uint32_t)(3 * i + 1);
        c.normal[i] = (struct dvec3){pose.r[2], pose.r[5], pose.r[8]}; /* the frame's z */
    }
    c.read = 4 * n;
    assert_int_equal(crop_face(&c, &view, 5000, &count), ST_OK);
    assert_in_range(c.n, 4500, 5000);
    for (size_t i = 0; i < c.n; i++) {
        const struct dvec3 q = pose_apply(&view.pose, pts[(c.index[i] - 1) / 3]);

        assert_place(c.at[i], q, true);
        assert_true(fabs(c.normal[i].z - 1) < 1e-9 && fabs(c.normal[i].x) < 1e-9);
    }
    cloudpoints_free(&c);
}

/* No points at all, and none on the face. */
TEST(test_none)
{
    struct crop_count count;
    struct cloudpoints c;

    crop(&c, 100, &count);
    assert_int_equal(c.n, 0);
    cloudpoints_free(&c);
    add_box(500, (struct dvec3){200, 0, 0}, (struct dvec3){300, 1, 1});
    crop(&c, 100, &count);
    assert_int_equal(c.n, 0);
    cloudpoints_free(&c);
}

/* ---- a mirror image */

/* The face as c, seen from the front; side: -1 mirrors it. */
static void seen(struct cloudpoints *c, double side)
{
    take(c);
    c->normal = mem_array(n, sizeof *c->normal);
    assert_non_null(c->normal);
    for (size_t i = 0; i < n; i++) {
        c->at[i] = pose_apply(&view.pose, pts[i]);
        c->normal[i] = (struct dvec3){0.1, 0.3, side * 0.9};
    }
}

TEST(test_normals)
{
    struct cloudpoints c;

    add_face(1000, 0, 0.15);
    seen(&c, 1);
    assert_false(mirror_told(&c));
    for (size_t i = 0; i < n; i++)
        c.normal[i].z *= -1;
    assert_true(mirror_told(&c));
    for (size_t i = 0; i < n; i += 5) /* not all agree */
        c.normal[i].z *= -1;
    assert_false(mirror_told(&c));
    memset(c.normal, 0, n * sizeof *c.normal);
    assert_false(mirror_told(&c));
    mem_free(c.normal);
    c.normal = NULL;
    assert_false(mirror_told(&c));
    cloudpoints_free(&c);
}

/* An image of so many columns, x = ax column + bx row, y = ay column + by row. */
static bool told(double ax, double bx, double ay, double by, bool shuffled)
{
    struct cloudpoints c;
    bool mirrored;

    n = 0;
    for (uint32_t i = 0; i < 40 * 50; i++) {
        const double u = shuffled ? draw_uniform(&rng, 0, 40) : i % 40;
        const double v = shuffled ? draw_uniform(&rng, 0, 50) : i / 40;

        pts[n++] = (struct dvec3){ax * u + bx * v, ay * u + by * v, -0.02 * u * u};
    }
    take(&c);
    c.width = 40;
    c.height = 50;
    mirrored = mirror_told(&c);
    cloudpoints_free(&c);
    return mirrored;
}

TEST(test_pixels)
{
    assert_false(told(2, 0.2, -0.1, -2, false));
    assert_false(told(0.1, 2, 2, 0.3, false)); /* the camera on its side */
    assert_false(told(-2, 0, 0, 2, false));    /* upside down */
    assert_true(told(-2, 0.2, -0.1, -2, false));
    assert_true(told(2, 0, 0, 2, false));
    assert_true(told(0.1, -2, 2, 0.3, false));
    assert_false(told(-2, 0, 0, -2, true)); /* the order is no image's */
}
