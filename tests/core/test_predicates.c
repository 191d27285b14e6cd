/* The predicates compared with determinants computed another way (four rows, not translated,
 * in 128-bit integers), on all small quadruples and on the largest; and the rule for cocircular
 * points. */
#include "brute.h"
#include "lattice.h"
#include "predicates.h"
#include "unit.h"

typedef predicates_i128 wide;

static wide det3(wide a, wide b, wide c, wide d, wide e, wide f, wide g, wide h, wide i)
{
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
}

static int sign(wide v)
{
    return (v > 0) - (v < 0);
}

static wide slow_orient(struct ivec2 a, struct ivec2 b, struct ivec2 c)
{
    return det3(a.x, a.y, 1, b.x, b.y, 1, c.x, c.y, 1);
}

/* The determinant of the rows x, y, lift, 1 of four points, by the lifts' cofactors. */
static wide lifted(const struct ivec2 p[4], const wide lift[4])
{
    wide sum = 0;

    for (int i = 0; i < 4; i++) {
        const struct ivec2 a = p[i == 0], b = p[i <= 1 ? 2 : 1], c = p[i == 3 ? 2 : 3];
        const wide cofactor = slow_orient(a, b, c);

        sum += (i % 2 == 0 ? 1 : -1) * lift[i] * cofactor;
    }
    return sum;
}

static wide slow_incircle(struct ivec2 a, struct ivec2 b, struct ivec2 c, struct ivec2 d)
{
    const struct ivec2 p[4] = {a, b, c, d};
    wide lift[4];

    for (int i = 0; i < 4; i++)
        lift[i] = (wide)p[i].x * p[i].x + (wide)p[i].y * p[i].y;
    return lifted(p, lift);
}

/* The tie rule by its definition: the lift of the lexicographically first point is lowered. */
static bool slow_tie(struct ivec2 a, struct ivec2 b, struct ivec2 c, struct ivec2 d)
{
    const struct ivec2 p[4] = {a, b, c, d};
    wide lift[4] = {0, 0, 0, 0};
    int first = 0;

    for (int i = 1; i < 4; i++)
        first = lex_less(p[i], p[first]) ? i : first;
    lift[first] = -1;
    return lifted(p, lift) > 0;
}

static void check_orient(struct ivec2 a, struct ivec2 b, struct ivec2 c)
{
    const int want = sign(slow_orient(a, b, c));

    assert_int_equal(sign(orient2d(a, b, c)), want);
    assert_int_equal(sign(orient2d(b, c, a)), want);
    assert_int_equal(sign(orient2d(c, a, b)), want);
    assert_int_equal(sign(orient2d(b, a, c)), -want);
    assert_int_equal(sign(orient2d(a, c, b)), -want);
    assert_int_equal(sign(orient2d(c, b, a)), -want);
}

static bool same(struct ivec2 a, struct ivec2 b)
{
    return a.x == b.x && a.y == b.y;
}

/* abc in any orientation; three points on a line are not checked. */
static void check_incircle(struct ivec2 a, struct ivec2 b, struct ivec2 c, struct ivec2 d)
{
    const wide det = slow_incircle(a, b, c, d), turn = slow_orient(a, b, c);
    bool want;

    assert_true(incircle_det(a, b, c, d) == det);
    assert_true(incircle_det(b, c, a, d) == det);
    assert_true(incircle_det(c, a, b, d) == det);
    assert_true(incircle_det(b, a, c, d) == -det);
    assert_true(incircle_det(a, c, b, d) == -det);
    assert_true(incircle_det(c, b, a, d) == -det);
    if (turn == 0)
        return;
    if (turn < 0) {
        const struct ivec2 t = b;

        b = c;
        c = t;
    }
    if (same(d, a) || same(d, b) || same(d, c))
        want = false;
    else
        want = det != 0 ? (turn > 0 ? det : -det) > 0 : slow_tie(a, b, c, d);
    assert_int_equal(incircle(a, b, c, d), want);
    assert_int_equal(incircle(b, c, a, d), want);
    assert_int_equal(incircle(c, a, b, d), want);
}

/* The largest possible determinants: points at and near the corners of the lattice. */
TEST(test_extremes)
{
    static const int32_t at[] = {-LATTICE_MAX,    1 - LATTICE_MAX, -1, 0, 1,
                                 LATTICE_MAX - 1, LATTICE_MAX};
    struct draw r = {brute_seed("extremes")};

    for (int k = 0; k < 200000; k++) {
        struct ivec2 p[4];

        for (int i = 0; i < 4; i++)
            p[i] = (struct ivec2){at[draw_next(&r) % 7], at[draw_next(&r) % 7]};
        check_orient(p[0], p[1], p[2]);
        check_incircle(p[0], p[1], p[2], p[3]);
    }
    for (int k = 0; k < 200000; k++) {
        struct ivec2 p[4];

        for (int i = 0; i < 4; i++)
            p[i] = (struct ivec2){brute_int(&r, -LATTICE_MAX, LATTICE_MAX),
                                  brute_int(&r, -LATTICE_MAX, LATTICE_MAX)};
        check_orient(p[0], p[1], p[2]);
        check_incircle(p[0], p[1], p[2], p[3]);
    }
}

/* All small quadruples: every degenerate case of four points. */
TEST(test_exhaustive_small)
{
    for (uint32_t k = 0; k < 1u << 16; k++) {
        struct ivec2 p[4];

        for (uint32_t i = 0; i < 4; i++)
            p[i] = (struct ivec2){(int32_t)(k >> 4 * i & 3),
                                  (int32_t)(k >> (4 * i + 2) & 3)};
        check_incircle(p[0], p[1], p[2], p[3]);
    }
}
