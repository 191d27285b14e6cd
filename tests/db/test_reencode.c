/* A template of another engine is re-encoded from its points: with the same bits, however often and
 * by whatever models in between.  What the store makes of it: tests/box/reencode.sh. */
#include "codec.h"
#include "digest.h"
#include "face.h"
#include "facegen.h"
#include "model.h"
#include "model_digest.h"
#include "unit.h"

#define POINTS 1500
#define BYTES  65536 /* more than a model of so many points */

enum { SHIPPED, SHIFTED, HOLDS, ENGINES }; /* the models */

static struct surface_model model[ENGINES];
static struct surface_work *work[ENGINES];

static size_t encode(const struct surface_face *f, unsigned char out[BYTES])
{
    assert_true(surface_encoded_size(f) <= BYTES);
    surface_encode(f, out);
    return surface_encoded_size(f);
}

/* Laying spikes flat again would change the points once more. */
TEST(test_spikes)
{
    static unsigned char first[BYTES], again[BYTES];
    static struct dvec3 pts[POINTS];
    struct facegen_scan s;
    char digest[65], same[65];
    struct surface_face f = {0};
    size_t n;

    facegen_default(&s);
    s.points = POINTS;
    s.spikes = 0.05;
    facegen_pose(&s, 6, 10);
    n = facegen_sample(&s, pts);
    assert_int_equal(face_build(pts, n, work[SHIPPED], &f, NULL), ST_OK);
    assert_int_equal(digest_face(&f, digest), ST_OK);
    assert_int_equal(face_rebuild(&f, work[SHIPPED]), ST_OK);
    n = encode(&f, first);
    for (int i = 1; i <= ENGINES; i++) {
        assert_int_equal(face_rebuild(&f, work[i % ENGINES]), ST_OK);
        assert_int_equal(digest_face(&f, same), ST_OK);
        assert_string_equal(digest, same);
        assert_int_equal(encode(&f, again), n);
        assert_int_equal(memcmp(again, first, n) == 0, i == ENGINES);
    }
    face_free(&f);
}

TEST(test_same_engine)
{
    assert_true(
        surface_same_engine("surfaced/1 measure/2 model/a", "x/2 measure/2 model/a"));
    assert_false(surface_same_engine("surfaced/1 measure/2 model/a",
                                     "surfaced/1 measure/3 model/a"));
    assert_false(surface_same_engine("surfaced/1 measure/2 model/a",
                                     "surfaced/1 measure/2 model/b"));
    assert_false(
        surface_same_engine("surfaced/1 measure/2", "surfaced/1 measure/2 model/a"));
    assert_false(surface_same_engine("old", "old"));
}

/* Another mean face; the same one, and so the same mark, but fitted otherwise. */
BEFORE_ALL(set_up)
{
    for (int i = 0; i < ENGINES; i++) {
        model[i] = model_default;
        for (uint32_t k = 0; k < GRID_N; k++) {
            if (i == SHIFTED)
                model[i].mean[k] += 2;
            if (i == HOLDS && k % 2 == 0)
                model[i].identity.mode[k][0] *= 3;
        }
        assert_non_null(work[i] = surface_work_new(&model[i]));
    }
    assert_int_equal(model_mean_id(&model[HOLDS]), model_mean_id(&model_default));
}

AFTER_ALL(tear_down)
{
    for (int i = 0; i < ENGINES; i++)
        surface_work_free(work[i]);
}
