/* Pairs: heads of one person are compared at one size, whatever each scan was taken for. */
/* link: -Wl,--wrap=aligned_alloc */
#include "pair.h"

#include "face.h"
#include "faces.h"
#include "fail_alloc.h"
#include "place.h"
#include "pose.h"
#include "unit.h"
#include "face_work.h"

static void make(uint64_t subject, uint64_t number, double size, struct surface_face *f)
{
    faces_scan(subject, number, FACES_POINTS);
    for (size_t i = 0; i < faces_n; i++)
        faces_pts[i] = vec_along((struct dvec3){0, 0, 0}, size, faces_pts[i]);
    faces_build(f);
}

static double score(const struct surface_face *a, const struct surface_face *b)
{
    struct surface_comparison ab, ba;

    assert_int_equal(surface_compare(faces_work, a, b, &ab), ST_OK);
    assert_int_equal(surface_compare(faces_work, b, a, &ba), ST_OK);
    assert_true(fabs(ab.score - ba.score) < 1e-6);
    return ab.score;
}

/* A head alone (surface_decode()) gives the same score; with two sizes the surfaces are needed. */
TEST(test_heads)
{
    struct surface_face a = {0}, b = {0}, *head = NULL;
    struct surface_comparison whole, c;
    unsigned char *bytes;
    size_t n;

    make(3, 0, 1, &a);
    make(3, 1, 1, &b);
    bytes = malloc(n = surface_encoded_size(&a));
    assert_non_null(bytes);
    surface_encode(&a, bytes);
    n = surface_encoded_head(bytes, n);
    assert_true(n > 20000 && n < 22000);
    assert_int_equal(surface_decode(faces_work, bytes, n, &head), SURFACE_OK);
    assert_int_equal(surface_face_points(head, NULL), 0);
    assert_int_equal(surface_compare(faces_work, &a, &b, &whole), SURFACE_OK);
    assert_int_equal(surface_compare(faces_work, head, &b, &c), SURFACE_OK);
    assert_memory_equal(&c, &whole, sizeof c);
    faces_mistake(&b, 0.9);
    assert_int_equal(surface_compare(faces_work, head, &b, &c), SURFACE_EINVAL);
    assert_int_equal(surface_compare(faces_work, &b, head, &c), SURFACE_EINVAL);
    surface_face_free(head);
    free(bytes);
    face_free(&a);
    face_free(&b);
}

/* Whichever size one of two scans was mistaken for, the score is nearly what it is without: not that
 * of a stranger. */
TEST(test_one_size)
{
    static const double wrong[] = {0.8, 0.9, 0.96, 1.05, 1.145, 1.3};
    struct surface_face a = {0}, b = {0}, other = {0};

    for (uint64_t k = 0; k < 6; k++) {
        const double size = k % 2 == 0 ? 1 : 0.8;

        make(k, 0, size, &a);
        make(k + 100, 0, size, &other);
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
            double right;

            make(k, 1, size, &b);
            right = score(&a, &b);
            faces_mistake(&b, place_size(&b.frame.pose) * wrong[i]);
            assert_true(right > 8);
            assert_true(score(&a, &b) > right / 2);
            assert_true(score(&other, &b) < 8);
        }
    }
    face_free(&a);
    face_free(&b);
    face_free(&other);
}

/* What is shown is of what was compared: the parts add up to the score, and the minimal disparity
 * starts from the common frame. */
TEST(test_all_of_one_pair)
{
    struct surface_face a = {0}, b = {0};
    struct surface_parts parts;
    struct surface_disparity d, want;
    double sum = 0;

    make(3, 0, 1, &a);
    make(3, 1, 1, &b);
    assert_int_equal(surface_disparity(faces_work, &a, &b, &want), ST_OK);
    faces_mistake(&b, 1.2);
    assert_int_equal(surface_parts(faces_work, &a, &b, &parts), ST_OK);
    for (int i = 0; i < SURFACE_REGIONS; i++)
        sum += parts.region[i];
    assert_true(fabs(sum - score(&a, &b)) < 1e-3);
    assert_true(fabs(parts.scale - 1) < 1e-9);
    assert_int_equal(surface_disparity(faces_work, &a, &b, &d), ST_OK);
    assert_true(fabs(d.disparity_mm - want.disparity_mm) < 0.01 * want.disparity_mm);
    face_free(&a);
    face_free(&b);
}

/* The mirror image of a scan taken for another size is compared at the common one too. */
TEST(test_mirrored)
{
    struct surface_face a = {0}, b = {0};
    struct surface_comparison right, mistaken;

    make(4, 0, 1, &a);
    make(4, 1, 1, &b);
    assert_int_equal(surface_compare_mirrored(faces_work, &a, &b, &right), ST_OK);
    faces_mistake(&b, 0.85);
    assert_int_equal(surface_compare_mirrored(faces_work, &a, &b, &mistaken), ST_OK);
    assert_true(fabs(right.score - mistaken.score) < 8);
    face_free(&a);
    face_free(&b);
}

/* A frame that is off by a few mm makes a stranger of a scan; the surfaces say otherwise.  Of another
 * person they do not. */
TEST(test_doubt)
{
    const struct dvec3 nose = {0, 0, 0};
    const double off[] = {0.12, -0.1, 0.06, 3, 9, -2};
    struct surface_face a = {0}, b = {0}, other = {0};
    struct surface_comparison r, again;
    struct surface_parts parts;
    struct shape_fit fit;
    double sum = 0;

    make(6, 0, 1, &a);
    make(6, 0, 1, &b);
    make(7, 0, 1, &other);
    pose_move(&b.frame.pose, nose, off);
    fit.pose = b.frame.pose;
    fit.residual_mm = 0.5;
    assert_int_equal(place_encode(&b, &fit, faces_work, &b.encoding), ST_OK);
    assert_int_equal(surface_compare(faces_work, &a, &b, &r), ST_OK);
    assert_true(r.score < SURFACE_DOUBT && r.decision == SURFACE_NO_MATCH);
    again = r;
    assert_int_equal(surface_compare_again(faces_work, &a, &b, &again), ST_OK);
    assert_true(again.score > 20 && again.decision == SURFACE_MATCH);
    assert_true(again.threshold == r.threshold);
    assert_true(again.false_match_rate < r.false_match_rate);
    assert_int_equal(surface_parts(faces_work, &a, &b, &parts), ST_OK);
    for (int i = 0; i < SURFACE_REGIONS; i++)
        sum += parts.region[i];
    assert_true(fabs(sum - again.score) < 1e-3);

    assert_int_equal(surface_compare(faces_work, &a, &other, &r), ST_OK);
    assert_true(r.score < SURFACE_DOUBT);
    again = r;
    assert_int_equal(surface_compare_again(faces_work, &a, &other, &again), ST_OK);
    assert_memory_equal(&r, &again, sizeof r);
    face_free(&a);
    face_free(&b);
    face_free(&other);
}

static struct surface_face failing[2];

static enum status compare(void *arg)
{
    struct surface_comparison r;
    struct surface_work *w = surface_work_new(NULL);
    enum status st = ST_ENOMEM;

    (void)arg;
    if (w != NULL)
        st = status_from(surface_compare(w, &failing[0], &failing[1], &r));
    surface_work_free(w);
    return st;
}

/* Each allocation fails. */
TEST(test_allocations)
{
    make(5, 0, 1, &failing[0]);
    make(5, 1, 1, &failing[1]);
    faces_mistake(&failing[1], 1.1);
    assert_true(fail_alloc_walk(compare, NULL) > 1);
    face_free(&failing[0]);
    face_free(&failing[1]);
}
