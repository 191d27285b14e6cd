/* What covers a face, and what is a face's own: above the brows, hair, and masks. */
#include "brute.h"
#include "model.h"
#include "shape.h"
#include "toy.h"
#include "unit.h"

#define POINTS 4000

static struct shape_work work;
static struct dvec3 pts[POINTS];
static struct draw rng;

/* Something on the mean face: what is added to its height, mm. */
typedef double thing(double x, double y);

static void make(thing *on)
{
    for (size_t n = 0; n < POINTS;) {
        const double x = draw_uniform(&rng, -58, 58), y = draw_uniform(&rng, -76, 66);
        const double z = toy_at(work.mean, x, y);

        if (!isnan(z))
            pts[n++] = (struct dvec3){x, y, z + on(x, y) + draw_uniform(&rng, 0, 0.2)};
    }
}

/* As fitted, or fitted hard. */
static struct shape_fit see(thing *on, bool hard)
{
    struct shape_fit f;

    make(on);
    assert_int_equal(shape_fit(&work, pts, POINTS, &toy_still, 1, hard, &f), ST_OK);
    return f;
}

static bool covered(const struct shape_fit *f, double x, double y)
{
    return f->cell[grid_cell(x, y)] == SHAPE_COVER;
}

/* ---- above the brows */

static double cap(double x, double y)
{
    (void)x;
    return y > 46 ? 9 : 0;
}

static double bump(double x, double y)
{
    const double r = hypot(x, y - 48) / 16;

    return r < 1 ? 5 * (1 - r * r) : 0;
}

/* A cap is a cover; a bump in the middle of the forehead is the person's own. */
TEST(test_brows)
{
    struct shape_fit f;

    for (int hard = 0; hard < 2; hard++) {
        f = see(cap, hard);
        assert_true(f.cover > 60);
        f = see(bump, hard);
        assert_true(f.skin > f.cover);
    }
}

/* ---- hair */

static double hair(double x, double y)
{
    return y > 42 ? 1.5 * sin(0.7 * x) * sin(0.6 * y) : 0;
}

static double rough(double x, double y)
{
    return 1.5 * sin(0.7 * x) * sin(0.6 * y);
}

/* What is as rough as hair is hair, unless all of the scan is. */
TEST(test_hair)
{
    struct shape_fit f;

    f = see(hair, false);
    assert_true(f.cover > 60 && covered(&f, 2, 58) && covered(&f, -26, 58));
    assert_true(!covered(&f, 2, 30));
    f = see(rough, false);
    assert_int_equal(f.cover, 0);
}

/* ---- masks */

/* Taut from the nose down to the chin, and from there to both cheeks. */
static double mask(double x, double y)
{
    const double wide = 44, top = 6, low = -62, t = fabs(x) / wide;
    const double nose = toy_at(work.mean, 0, top), chin = toy_at(work.mean, 0, low);
    const double middle =
        y > -2 ? toy_at(work.mean, 0, y) : nose + (y - top) / (low - top) * (chin - nose);
    const double sheet = (1 - t) * fmax(middle, toy_at(work.mean, 0, y)) +
                         t * toy_at(work.mean, wide * (x < 0 ? -1 : 1), y);

    return y < top && y > low && t < 1 ? fmax(sheet + 0.6 - toy_at(work.mean, x, y), 0)
                                       : 0;
}

static double one_cheek(double x, double y)
{
    return x > 0 ? mask(x, y) : 0;
}

static double puff(double x, double y)
{
    const double r = hypot(fabs(x) - 34, y + 26) / 18;

    return r < 1 ? 12 * (1 - r * r) : 0;
}

/* Loose cloth from the cheeks down past the chin. */
static double scarf(double x, double y)
{
    return y < 4 ? 8 + 4 * cos(x / 30) : 0;
}

/* A mask is a cover, and loose cloth down to the rim, and nothing above it; cheeks that are puffed,
 * or a hand on one of them, are none. */
TEST(test_mask)
{
    struct shape_fit f;
    uint32_t below = 0, above = 0;

    for (int hard = 0; hard < 2; hard++) {
        f = see(mask, hard);
        assert_true(f.cover > 50);
    }
    f = see(scarf, true);
    for (uint32_t i = 0; i < GRID_N; i++) {
        below += f.cell[i] == SHAPE_SKIN && grid_y(i) < 0;
        above += f.cell[i] == SHAPE_COVER && grid_y(i) > 16;
    }
    assert_int_equal(below, 0);
    assert_int_equal(above, 0);
    assert_true(f.cover > 300);
    f = see(one_cheek, true);
    assert_true(f.cell[grid_cell(-30, -20)] == SHAPE_SKIN);
    f = see(puff, true);
    assert_true(f.cell[grid_cell(2, -40)] == SHAPE_SKIN);
}

BEFORE_ALL(set_up)
{
    rng = (struct draw){brute_seed("cover")};
    shape_work_prepare(&model_default, &work);
}
