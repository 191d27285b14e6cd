/* A face made of the modes is found again, with its pose; what covers it is told; what is no
 * face has little support. */
#include "brute.h"
#include "shape.h"
#include "shape_map.h"
#include "shape_detail.h"
#include "shape_work.h"
#include "toy.h"
#include "unit.h"

#define POINTS 4000
#define ROOM   40000

static struct surface_model model;
static struct shape_work work;
static struct dvec3 pts[ROOM];
static size_t n;
static float face[GRID_N];          /* heights of a face made of modes */
static double made_of[MODEL_MODES]; /* its coefficients */

/* So many points of the surface h, anywhere on it. */
static void scan(const float *h, size_t count, struct draw *rng)
{
    for (n = 0; n < count;) {
        const double x = draw_uniform(rng, -58, 58), y = draw_uniform(rng, -76, 62);
        const double z = toy_at(h, x, y);

        if (!isnan(z))
            pts[n++] = (struct dvec3){x, y, z};
    }
}

/* A new face, as points in its frame. */
static void make_face(struct draw *rng)
{
    memcpy(face, model.mean, sizeof face);
    for (uint32_t k = 0; k < model.shape.n; k++) {
        made_of[k] = draw_uniform(rng, -1, 1);
        for (uint32_t i = 0; i < GRID_N; i++)
            face[i] += (float)made_of[k] * model.shape.mode[i][k];
    }
    scan(face, POINTS, rng);
}

static void move(const struct pose *p)
{
    for (size_t i = 0; i < n; i++)
        pts[i] = pose_apply(p, pts[i]);
}

static void check(const struct shape_fit *f)
{
    const struct pose rigid = pose_unscaled(&f->pose);
    uint32_t of[4] = {0, 0, 0, 0};

    assert_true(isfinite(f->support) && f->support <= 1 && isfinite(f->likeness));
    assert_true(pose_rigid(&rigid));
    for (uint32_t k = 0; k < MODEL_MODES; k++)
        assert_true(isfinite(f->a[k]) && (k < model.shape.n || f->a[k] == 0.0));
    for (uint32_t i = 0; i < GRID_N; i++) {
        assert_true(isnan(f->height[i]) == isnan(model.mean[i]));
        assert_true(f->cell[i] <= SHAPE_APART);
        assert_true(!isnan(model.mean[i]) || f->cell[i] == SHAPE_EMPTY);
        of[f->cell[i]]++;
    }
    assert_int_equal(f->skin, of[SHAPE_SKIN]);
    assert_int_equal(f->cover, of[SHAPE_COVER]);
    assert_int_equal(f->apart, of[SHAPE_APART]);
}

static void fit(const struct pose *start, bool hard, struct shape_fit *out)
{
    assert_int_equal(shape_fit(&work, pts, n, start, 1, hard, out), ST_OK);
    check(out);
}

/* The farthest that the fitted skin is from the face, mm. */
static double off(const struct shape_fit *f)
{
    double most = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (f->cell[i] == SHAPE_SKIN)
            most = fmax(most, fabs((double)f->height[i] - (double)face[i]));
    return most;
}

static struct pose any_pose(double deg, double mm, struct draw *rng)
{
    struct pose pose;

    toy_pose(draw_uniform(rng, -deg, deg), draw_uniform(rng, -deg, deg),
             draw_uniform(rng, -deg, deg),
             (struct dvec3){mm * draw_uniform(rng, 0, 1), -mm * draw_uniform(rng, 0, 1),
                            mm * draw_uniform(rng, 0, 1)},
             &pose);
    return pose;
}

/* The points lie on the face, where f's pose takes them. */
static void check_pose(const struct shape_fit *f)
{
    for (size_t i = 0; i < n; i += 97) {
        const struct dvec3 q = pose_apply(&f->pose, pts[i]);
        double miss = INFINITY;

        if (grid_cell(q.x, q.y) != GRID_NONE && fabs(q.x) < 61)
            miss = q.z - toy_at(face, q.x, q.y);
        assert_true(isnan(miss) || fabs(miss) < 1.0);
    }
}

TEST(test_recovered)
{
    struct draw rng = {brute_seed("shape")};
    struct shape_fit f, g;

    for (int round = 0; round < 20; round++) {
        const struct pose pose = any_pose(8, 8, &rng), turn = any_pose(90, 90, &rng);
        const struct pose start = pose_after(&turn, &toy_still);

        make_face(&rng);
        fit(&toy_still, false, &g);
        move(&pose);
        move(&turn);
        fit(&start, false, &f);
        check_pose(&f);
        assert_true(f.support > 0.88 && g.support > 0.88);
        assert_true(f.likeness > 2.3 && g.likeness > 2.3);
        assert_true(f.cover == 0 && g.cover == 0 && f.apart == 0 && g.apart == 0);
        assert_true(off(&f) < 0.5 && off(&g) < 0.5);
        for (uint32_t k = 0; k < model.shape.n; k++)
            assert_true(fabs(g.a[k] - made_of[k]) < 0.3);
    }
}

/* The points in the columns and rows of a rectangle become what cover() says: how far before
 * the face they are (mm), or NAN: there are none. */
static void cover(double x0, double x1, double y0, double y1, double mm)
{
    size_t kept = 0;

    for (size_t i = 0; i < n; i++) {
        const bool in = pts[i].x > x0 && pts[i].x < x1 && pts[i].y > y0 && pts[i].y < y1;

        pts[kept] = pts[i];
        pts[kept].z += in && !isnan(mm) ? mm : 0;
        kept += !(in && isnan(mm));
    }
    n = kept;
}

/* The cells within a rectangle, shrunk on all sides by a margin, are told as this; beyond it
 * they are no cover.  But for a few, at the foot of the nose. */
static void check_rectangle(const struct shape_fit *f, const double r[4], double margin,
                            enum shape_cell want)
{
    uint32_t wrong = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double x = grid_x(i), y = grid_y(i);

        if (x > r[0] + margin && x < r[1] - margin && y > r[2] + margin &&
            y < r[3] - margin && !isnan(model.mean[i]))
            wrong += f->cell[i] != want;
    }
    assert_in_range(wrong, 0, 4);
}

static void check_outside(const struct shape_fit *f, const double r[4], double margin)
{
    uint32_t wrong = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double x = grid_x(i), y = grid_y(i);

        if (x < r[0] - margin || x > r[1] + margin || y < r[2] - margin ||
            y > r[3] + margin)
            wrong += f->cell[i] == SHAPE_COVER || f->cell[i] == SHAPE_APART;
    }
    assert_in_range(wrong, 0, 4);
}

/* A slab before the mouth is cover, with a rim of one cell, and nothing else is: the face
 * beneath is found as without it. */
TEST(test_slab)
{
    static const double mouth[4] = {-28, 28, -52, -14};
    struct draw rng = {brute_seed("slab")};
    struct shape_fit f;

    for (int round = 0; round < 10; round++) {
        const struct pose pose = any_pose(5, 5, &rng);

        make_face(&rng);
        cover(mouth[0], mouth[1], mouth[2], mouth[3], 12);
        move(&pose);
        fit(&toy_still, true, &f);
        check_rectangle(&f, mouth, 0, SHAPE_COVER); /* and the rim: */
        check_rectangle(&f, (const double[4]){-28, 28, -57, -9}, 1, SHAPE_COVER);
        check_outside(&f, mouth, 9);
        assert_true(off(&f) < 2.5); /* under the slab it is a guess */
    }
}

/* What hides more than a simple fit can leave out is found from the parts that it leaves. */
TEST(test_hard)
{
    static const double hidden[][4] = {
        {-70, 70, 12, 44}, {-70, 70, -94, 0}, {-70, 0, -94, 94}, {0, 70, -94, 94}};
    struct draw rng = {brute_seed("hard")};
    struct shape_fit f, g;

    for (size_t k = 0; k < sizeof hidden / sizeof *hidden; k++) {
        const double *h = hidden[k];

        make_face(&rng);
        cover(h[0], h[1], h[2], h[3], 9);
        fit(&toy_still, false, &f);
        fit(&toy_still, true, &g);
        assert_true(g.cover >= f.cover && off(&g) < off(&f) + 2);
        assert_true(k > 1 || off(&g) < 1); /* half of a face may lie elsewhere */
    }
}

/* Rims of glasses 7 mm before the face, and no points behind the lenses: these are cover
 * too.  Holes alone are not. */
TEST(test_glasses)
{
    struct draw rng = {brute_seed("glasses")};
    struct shape_fit f;

    for (int round = 0; round < 10; round++) {
        const bool rims = round % 2 == 0;
        double lens[2][4] = {{-46, -14, 20, 44}, {14, 46, 20, 44}};

        make_face(&rng);
        if (rims)
            cover(-50, 50, 16, 48, 7);
        for (int k = 0; k < 2; k++)
            cover(lens[k][0], lens[k][1], lens[k][2], lens[k][3], (double)NAN);
        fit(&toy_still, true, &f);
        for (int k = 0; k < 2; k++)
            check_rectangle(&f, lens[k], 4, rims ? SHAPE_COVER : SHAPE_EMPTY);
        check_outside(&f, (const double[4]){-50, 50, 16, 48}, rims ? 9 : 0);
        assert_true(rims || f.cover == 0);
        assert_true(off(&f) < 1.5);
    }
}

/* Planes, cylinders and eggs are no faces. */
TEST(test_flat)
{
    struct draw rng = {brute_seed("flat")};
    struct shape_fit f;

    for (int what = 0; what < 3; what++) {
        for (n = 0; n < POINTS; n++) {
            const double x = draw_uniform(&rng, -60, 60), y = draw_uniform(&rng, -80, 70);

            pts[n] = (struct dvec3){
                x, y, -25 - (what > 0 ? x * x / 130 : 0) - (what > 1 ? y * y / 220 : 0)};
        }
        fit(&toy_still, true, &f);
        print_message("support %.3f likeness %.2f\n", f.support, f.likeness);
        assert_true(f.support < 0.5 && f.likeness < 1.6);
        fit(&toy_still, false, &f);
        assert_true(f.support < 0.5 && f.likeness < 1.6);
    }
}

/* Few points, or none near the face. */
TEST(test_nothing)
{
    struct shape_fit f;

    for (size_t few = 0; few < 40; few += 13) {
        n = few;
        for (size_t i = 0; i < n; i++)
            pts[i] = (struct dvec3){3.0 * (double)i - 60, 2.0 * (double)i - 50, -20};
        fit(&toy_still, true, &f);
        assert_true(f.support < 0.1);
        fit(&toy_still, false, &f);
        move(&(struct pose){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {4000, 0, 0}});
        fit(&toy_still, true, &f);
        assert_int_equal(f.skin + f.cover + f.apart, 0);
        assert_true(f.support == 0.0);
    }
}

static void check_same(const struct shape_fit *f, const struct shape_fit *g)
{
    assert_memory_equal(&f->pose, &g->pose, sizeof f->pose);
    assert_memory_equal(f->a, g->a, sizeof f->a);
    assert_memory_equal(f->height, g->height, sizeof f->height);
    assert_memory_equal(f->cell, g->cell, sizeof f->cell);
    assert_true(f->support == g->support && f->likeness == g->likeness);
}

static double most_apart(const struct shape_fit *f, const struct shape_fit *g)
{
    double most = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (!isnan(model.mean[i]))
            most = fmax(most, fabs((double)f->height[i] - (double)g->height[i]));
    return most;
}

/* Neither the points' order nor where the scanner stands matters, nor what is far behind; the
 * same call gives the same digits. */
TEST(test_invariant)
{
    struct draw rng = {brute_seed("invariant")};
    static struct shape_fit f, g;
    struct pose pose, start;

    make_face(&rng);
    cover(-28, 28, -52, -14, 12);
    fit(&toy_still, true, &f);
    fit(&toy_still, true, &g);
    check_same(&f, &g);

    brute_shuffle(pts, n, sizeof *pts, &rng);
    fit(&toy_still, true, &g);
    assert_true(most_apart(&f, &g) < 0.01);
    assert_int_equal(f.cover, g.cover);

    for (size_t i = 0; i < 1000; i++)
        pts[n + i] = (struct dvec3){pts[i].x, pts[i].y, pts[i].z - 90};
    n += 1000;
    fit(&toy_still, true, &f);
    check_same(&f, &g);
    n -= 1000;

    toy_pose(70, -30, 130, (struct dvec3){400, -900, 1200}, &pose);
    move(&pose);
    start = pose_after(&pose, &toy_still);
    fit(&start, true, &g);
    assert_true(most_apart(&f, &g) < 0.01);
    assert_true(fabs(f.support - g.support) < 0.01);
}

/* Of several starts that which leads to a face; and many points are as good as few. */
TEST(test_starts)
{
    struct draw rng = {brute_seed("starts")};
    struct pose start[3];
    struct shape_fit f, g;

    make_face(&rng);
    fit(&toy_still, false, &f);
    toy_pose(0, 0, 180, (struct dvec3){0, 0, 0}, &start[0]);
    start[1] = toy_still;
    toy_pose(60, 0, 0, (struct dvec3){0, 0, 0}, &start[2]);
    assert_int_equal(shape_fit(&work, pts, n, start, 3, false, &g), ST_OK);
    check_same(&f, &g);
    scan(face, ROOM, &rng);
    fit(&toy_still, false, &g);
    assert_true(most_apart(&f, &g) < 0.5 && g.support > 0.9 && g.cover == 0);
}

/* shape_map_make() by definition. */
TEST(test_map)
{
    struct draw rng = {brute_seed("map")};
    struct scratch s = {0};
    struct shape_points p;
    float got[GRID_N];

    make_face(&rng);
    for (size_t i = 0; i < n; i++)
        pts[i].z += i % 5 == 0 ? -20 : i % 7 == 0 ? -60 : i % 11 == 0 ? 9 : 0;
    n -= 3; /* no whole number of lanes */
    assert_int_equal(shape_map_points(pts, n, &toy_still, model.mean, &s, &p), ST_OK);
    assert_in_range(p.n, 3 * n / 4, n); /* the farthest behind are left out */
    shape_map_make(&p, &toy_still, model.mean, got);
    for (uint32_t c = 0; c < GRID_N; c++) {
        double first = -SHAPE_BEHIND_MM, sum = 0, count = 0, over[POINTS];
        float zx, zy;

        shape_map_slope(model.mean, c, &zx, &zy);
        for (size_t i = 0; i < n; i++) {
            over[i] = -INFINITY;
            if (grid_cell(pts[i].x, pts[i].y) == c && !isnan(model.mean[c]))
                over[i] = pts[i].z - (double)model.mean[c] -
                          (double)zx * (pts[i].x - grid_x(c)) -
                          (double)zy * (pts[i].y - grid_y(c));
            first = fmax(first, over[i]);
        }
        for (size_t i = 0; i < n; i++)
            if (over[i] > first - SHAPE_LAYER_MM && over[i] > -SHAPE_BEHIND_MM) {
                sum += over[i];
                count++;
            }
        assert_true(isnan(got[c]) == (count == 0));
        assert_true(count == 0 || fabs((double)got[c] - sum / count) < 1e-3);
    }
    scan(face, ROOM, &rng);
    assert_int_equal(shape_map_points(pts, n, &toy_still, model.mean, &s, &p), ST_OK);
    assert_in_range(p.n, SHAPE_POINTS / 2, SHAPE_POINTS);
    scratch_free(&s);
}

/* A cell of the face without points has the mean of those beside it, if there are two: at a corner
 * of the grid too, where the cells at its other side are not beside it. */
TEST(test_fill)
{
    static float level[GRID_N], over[GRID_N];
    const uint32_t corner = 0, left = 5 * GRID_NX, inner = 20 * GRID_NX + 10;
    const float none = (float)NAN;

    for (uint32_t i = 0; i < GRID_N; i++) {
        level[i] = 0.0f;
        over[i] = none;
    }
    over[inner - 1] = 1;
    over[inner + 1] = 2;
    over[inner + GRID_NX] = 6;
    over[corner + 1] = 4;
    over[GRID_NX] = 8;
    over[left - 1] = 3; /* the end of the row below */
    over[left + 1] = 5;
    shape_map_fill(level, over);
    assert_true(over[inner] == 3.0f && over[inner + 1] == 2.0f);
    assert_true(over[corner] == 6.0f && isnan(over[left]));
    assert_true(isnan(over[inner - GRID_NX]) && isnan(over[inner + 2]));
    level[inner] = over[inner] = none;
    shape_map_fill(level, over);
    assert_true(isnan(over[inner])); /* off the face */
}

/* A head of another size is found at the next of the sizes, also where it lies elsewhere; one of the
 * mean's size is not taken for another. */
TEST(test_sizes)
{
    static const double by[] = {0.71, 0.78, 1, 1.16}, want[] = {0.71, 0.77, 1, 1.16};
    struct draw rng = {brute_seed("sizes")};
    struct shape_fit f;

    for (size_t k = 0; k < sizeof by / sizeof *by; k++) {
        const struct pose pose = any_pose(5, 5, &rng);

        make_face(&rng);
        for (size_t i = 0; i < n; i++)
            pts[i] = (struct dvec3){by[k] * pts[i].x, by[k] * pts[i].y, by[k] * pts[i].z};
        move(&pose);
        assert_int_equal(shape_fit(&work, pts, n, &toy_still, 1, true, &f), ST_OK);
        assert_true(fabs(f.size - want[k]) < 1e-9);
        assert_true(f.support > 0.8 && f.cover == 0);
    }
}

/* ---- how much of a face's fine relief a surface has */

static float z[GRID_N]; /* NAN: not seen */

/* All of the mean skin, seen. */
static void see_all(void)
{
    memcpy(z, work.mean, sizeof z);
}

/* Of the surface z. */
static double detail(void)
{
    float over[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++)
        over[i] = z[i] - work.mean[i];
    return shape_detail(work.fine, work.over_rest, over);
}

/* v less the mean of it over the square round cell i, of the cells that `on` says; *all: the
 * square is whole. */
static double above(const double *v, const bool *on, uint32_t i, bool *all)
{
    double sum = 0;
    int count = 0;

    for (int y = -SHAPE_FINE; y <= SHAPE_FINE; y++)
        for (int x = -SHAPE_FINE; x <= SHAPE_FINE; x++) {
            const int at[2] = {(int)(i % GRID_NX) + x, (int)(i / GRID_NX) + y};
            const int k = at[1] * GRID_NX + at[0];

            if (at[0] < 0 || at[1] < 0 || at[0] >= GRID_NX || at[1] >= GRID_NY || !on[k])
                continue;
            sum += v[k];
            count++;
        }
    *all = count == (2 * SHAPE_FINE + 1) * (2 * SHAPE_FINE + 1);
    return v[i] - sum / count;
}

/* By the definition. */
static double reference(void)
{
    static double mean[GRID_N], over[GRID_N];
    static bool skin[GRID_N], seen[GRID_N];
    double sum = 0, all = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        skin[i] = !isnan(work.mean[i]);
        seen[i] = !isnan(z[i]);
        mean[i] = (double)work.mean[i];
        over[i] = (double)z[i] - mean[i];
    }
    for (uint32_t i = 0; i < GRID_N; i++) {
        bool whole, any;
        double m;

        if (!seen[i])
            continue;
        m = above(mean, skin, i, &whole);
        if (!whole)
            continue;
        sum += (double)work.over_rest[i] * m * (m + above(over, seen, i, &any));
        all += (double)work.over_rest[i] * m * m;
    }
    return all > 0 ? sum / all : 0;
}

/* Any heights, seen anywhere. */
TEST(test_detail)
{
    struct draw rng = {brute_seed("detail")};

    for (int k = 0; k < 200; k++) {
        const double share = k == 0 ? 0 : draw_uniform(&rng, 0, 1);

        see_all();
        for (uint32_t i = 0; i < GRID_N; i++)
            z[i] = draw_uniform(&rng, 0, 1) < share
                       ? z[i] + (float)draw_uniform(&rng, -3, 3)
                       : (float)NAN;
        assert_true(fabs(detail() - reference()) < 1e-4);
    }
}

BEFORE_ALL(set_up)
{
    toy_model(&model);
    model.shape.n = 6;
    for (uint32_t i = 0; i < GRID_N; i++)
        for (uint32_t k = 6; k < MODEL_MODES; k++)
            model.shape.mode[i][k] = 0.0f;
    shape_work_prepare(&model, &work);
}
