/* The digest of a face's points: SHA-256 as db/FORMAT.md says, whatever the points' numbers. */
#include "delaunay.h"
#include "digest.h"
#include "face.h"
#include "mem.h"
#include "unit.h"

#define POINTS 5

static void digest(const struct ivec3 *pts, char hex[65])
{
    struct scratch scratch = {0};
    struct surface_face f = {0};

    assert_int_equal(delaunay_build(pts, POINTS, &scratch, &f.surface.mesh), ST_OK);
    assert_int_equal(digest_face(&f, hex), ST_OK);
    face_free(&f);
    scratch_free(&scratch);
}

/* Every rotation of the points' order gives the digest that another program gave; a point moved
 * by 1 um gives another. */
TEST(test_digest)
{
    struct ivec3 pts[2 * POINTS] = {{-50000, -50000, -1000},
                                    {0, 0, 20000},
                                    {-50000, 50000, -1000},
                                    {50000, -50000, -1000},
                                    {50000, 50000, -1000}};
    char hex[65];

    for (int i = 0; i < POINTS; i++)
        pts[POINTS + i] = pts[i];
    for (int i = 0; i < POINTS; i++) {
        digest(pts + i, hex);
        assert_string_equal(
            hex, "ef674ca9982193727655fe151dd2bbaca52513ce1a012f83e30e4ea818c36d60");
    }
    pts[1].z++;
    digest(pts, hex);
    assert_string_not_equal(
        hex, "ef674ca9982193727655fe151dd2bbaca52513ce1a012f83e30e4ea818c36d60");
}
