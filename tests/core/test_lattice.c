/* Millimetres to lattice units: rounding, range, and the index of the first bad point. */
#include "lattice.h"
#include "unit.h"

static int32_t rounded(double mm, double scale)
{
    const struct dvec3 p = {mm, 0, 0};
    struct ivec3 u = {INT32_MIN, 1, 1};

    assert_int_equal(lattice_from_mm(&p, 1, scale, &u, NULL), ST_OK);
    assert_true(u.y == 0 && u.z == 0);
    return u.x;
}

static enum status refused(double mm)
{
    const struct dvec3 p = {mm, 0, 0};
    struct ivec3 u;

    return lattice_from_mm(&p, 1, LATTICE_PER_MM, &u, NULL);
}

TEST(test_nearest)
{
    assert_int_equal(rounded(0, LATTICE_PER_MM), 0);
    assert_int_equal(rounded(-0.0, LATTICE_PER_MM), 0);
    assert_int_equal(rounded(1, LATTICE_PER_MM), 1000);
    assert_int_equal(rounded(-12.3456, LATTICE_PER_MM), -12346);
    assert_int_equal(rounded(0.00049, LATTICE_PER_MM), 0);
    assert_int_equal(rounded(0.00051, LATTICE_PER_MM), 1);
    assert_int_equal(rounded(0x1p-1074, LATTICE_PER_MM), 0);
    assert_int_equal(rounded(3, 0.5), 2);
}

TEST(test_ties_to_even)
{
    static const double at[] = {0.5, 1.5, 2.5, 3.5, 1000000.5, 1000001.5};
    static const int32_t want[] = {0, 2, 2, 4, 1000000, 1000002};

    for (int i = 0; i < 6; i++) {
        assert_int_equal(rounded(at[i], 1), want[i]);
        assert_int_equal(rounded(-at[i], 1), -want[i]);
    }
}

TEST(test_range)
{
    const double edge = LATTICE_MAX / LATTICE_PER_MM;

    assert_int_equal(rounded(edge, LATTICE_PER_MM), LATTICE_MAX);
    assert_int_equal(rounded(-edge, LATTICE_PER_MM), -LATTICE_MAX);
    assert_int_equal(rounded(nextafter(edge, 0), LATTICE_PER_MM), LATTICE_MAX);
    assert_int_equal(refused(edge + 0.001), ST_ERANGE);
    assert_int_equal(refused(-edge - 0.001), ST_ERANGE);
    assert_int_equal(refused(1e12), ST_ERANGE);
    assert_int_equal(refused(1e308), ST_ERANGE); /* infinite in lattice units */
    assert_int_equal(refused(-1e308), ST_ERANGE);
}

/* Whichever coordinate of whichever point is bad, the point's index is returned. */
TEST(test_offender)
{
    static const double wrong[] = {(double)NAN, (double)INFINITY, 16778, -16778};
    static const enum status want[] = {ST_ENOTFINITE, ST_ENOTFINITE, ST_ERANGE,
                                       ST_ERANGE};

    for (size_t k = 0; k < 4; k++)
        for (size_t i = 0; i < 5; i++)
            for (int axis = 0; axis < 3; axis++) {
                struct dvec3 pts[5] = {
                    {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}, {5, 5, 5}};
                struct ivec3 out[5];
                size_t bad = 99;

                *(axis == 0 ? &pts[i].x : axis == 1 ? &pts[i].y : &pts[i].z) = wrong[k];
                assert_int_equal(lattice_from_mm(pts, 5, LATTICE_PER_MM, out, &bad),
                                 want[k]);
                assert_int_equal(bad, i);
                assert_int_equal(lattice_from_mm(pts, 5, LATTICE_PER_MM, out, NULL),
                                 want[k]);
            }
}
