/* The canonical frame: it moves with the face, the mean face's own frame is the identity, and
 * a map of heights in it is the mean face again. */
#include "brute.h"
#include "frame.h"
#include "model_digest.h"
#include "toy.h"
#include "unit.h"

#define POINTS 3000

static struct surface_model model;
static struct frame_mean mean;
static struct align_work work;
static struct surface surface;

static double toy(const void *arg, double x, double y)
{
    (void)arg;
    return toy_height(x, y);
}

/* How far apart two motions carry points of a face, at most, mm. */
static double apart(const struct pose *a, const struct pose *b, const struct dvec3 *pts,
                    size_t n)
{
    double most = 0;

    for (size_t i = 0; i < n; i++) {
        const struct dvec3 p = pose_apply(a, pts[i]);
        const struct dvec3 q = pose_apply(b, pts[i]);

        most = fmax(most, hypot(hypot(p.x - q.x, p.y - q.y), p.z - q.z));
    }
    return most;
}

/* The frame of the toy face, scanned in any pose, is the inverse of that pose. */
TEST(test_toy)
{
    static const struct dvec3 corners[] = {
        {0, 0, 0}, {50, 0, -40}, {-50, 0, -40}, {0, 60, -30}, {0, -60, -30}};
    struct draw rng = {brute_seed("frame")};

    for (int k = 0; k < 5; k++) {
        struct pose pose, both;
        struct frame frame;

        toy_pose(6 * k, -4 * k, 3 * k, (struct dvec3){30 * k, -20 * k, 100 * k}, &pose);
        toy_scan(toy, NULL, 3000, &pose, &rng, &surface);
        assert_int_equal(frame_find(&mean, &surface, &work, &frame), ST_OK);
        both = toy_then(&pose, &frame.pose);
        printf("pose %d: off by %.2f mm, cost %.2f mm, within %.2f\n", k,
               apart(&both, &toy_still, corners, 5), frame.cost_mm, frame.within);
        assert_true(apart(&both, &toy_still, corners, 5) < 1);
        assert_int_equal(frame.mean_id, mean.mean_id);
        assert_true(frame.cost_mm < 0.5 && frame.within > 0.8);
        assert_true(pose_rigid(&frame.pose));
    }
}

TEST(test_mean)
{
    struct surface_model bad = model;
    struct frame_mean m;

    for (uint32_t i = 0; i < GRID_N; i++) {
        assert_true(mean.rigid[i] >= 0.0f && mean.rigid[i] <= 1.0f);
        assert_true((mean.rigid[i] > 0.0f) == (model.change.rest[i] > 0.0f));
        bad.mean[i] = (float)NAN;
    }
    /* nose firmer than mouth */
    assert_true(mean.rigid[grid_cell(2, 20)] > 2 * mean.rigid[grid_cell(2, -42)]);
    assert_int_equal(mean.mean_id, model_mean_id(&model));
    assert_int_equal(frame_mean_make(&bad, &m), ST_EDEGENERATE);
    for (uint32_t i = 3 * GRID_NX; i < 4 * GRID_NX; i++)
        bad.mean[i] = 0.0f; /* all on a line */
    assert_int_equal(frame_mean_make(&bad, &m), ST_EDEGENERATE);
}

BEFORE_ALL(set_up)
{
    toy_model(&model);
    assert_int_equal(frame_mean_make(&model, &mean), ST_OK);
}
