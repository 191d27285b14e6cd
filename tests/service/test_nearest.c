/* link: -Wl,--wrap=store_template_load */
/* Which template of a subject decides, in whatever order they come; those that are gone or of
 * another engine are left out; what fails ends it; every model is given back.  The minimal
 * disparity is of the one that decides. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "clouds.h"
#include "errinfo.h"
#include "measure.h"
#include "minimal.h"
#include "model.h"
#include "nearest.h"
#include "tempdb.h"

#define POINTS 1500

enum { /* of another subject; two of the probe's subject; the middle of that face */
       OTHER,
       SAME,
       AGAIN,
       MIDDLE,
       MODELS
};

static struct face model[MODELS], probe, part; /* part: of a third subject */
static struct face swapped;                    /* the probe, left and right swapped */
static struct store *store;
static enum status
    fails[MODELS]; /* what loading it returns, instead of a model in memory */
static int held, passed_over;
static struct errinfo e;

/* The id of model m is its number. */
static const struct face *find(void *arg, const char *id)
{
    const int m = id[0] - '0';

    assert_ptr_equal(arg, &held);
    if (fails[m] != ST_OK)
        return NULL;
    held++;
    return &model[m];
}

enum status __wrap_store_template_load(struct store *s, const char *id,
                                       struct store_template *t, struct face_work *w,
                                       struct face *f, struct errinfo *err);

enum status __wrap_store_template_load(struct store *s, const char *id,
                                       struct store_template *t, struct face_work *w,
                                       struct face *f, struct errinfo *err)
{
    const int m = id[0] - '0';

    (void)s;
    (void)t;
    (void)w;
    (void)f;
    return errinfo_set(err, fails[m], "model %d", m);
}

static void release(void *arg, const struct face *f)
{
    (void)arg;
    assert_true(f >= model && f < model + MODELS);
    held--;
}

static void pass_over(void *arg, const struct errinfo *err)
{
    (void)arg;
    assert_int_equal(err->code, ST_EVERSION);
    passed_over++;
}

static double clock_ms(void)
{
    static double ms;

    return ms += 1;
}

/* The points of a scan that lie within +-x and +-y of the nose; x to side x, 1 or -1. */
static void make(uint64_t subject, uint64_t scan, double x, double y, double side,
                 struct face *f)
{
    static struct dvec3 pts[2 * POINTS];
    const size_t all = clouds_scan(subject, scan, 2 * POINTS, pts);
    size_t n = 0;

    for (size_t i = 0; i < all; i++)
        if (fabs(pts[i].x) < x && fabs(pts[i].y) < y)
            pts[n++] = (struct dvec3){side * pts[i].x, pts[i].y, pts[i].z};
    assert_int_equal(face_build(pts, n, tempdb_work, f, NULL), ST_OK);
}

static int set_up(void **state)
{
    assert_int_equal(tempdb_begin_faces(state), 0);
    store = tempdb_fresh();
    make(1, 0, 200, 200, 1, &probe);
    make(1, 0, 200, 200, -1, &swapped);
    make(2, 0, 200, 200, 1, &model[OTHER]);
    make(1, 1, 200, 200, 1, &model[SAME]);
    make(1, 2, 200, 200, 1, &model[AGAIN]);
    make(1, 3, 16, 40, 1, &model[MIDDLE]);
    make(5, 4, 22, 60, 1, &part);
    return 0;
}

static int tear_down(void **state)
{
    for (int m = 0; m < MODELS; m++)
        face_free(&model[m]);
    face_free(&probe);
    face_free(&part);
    face_free(&swapped);
    store_close(store);
    return tempdb_end_faces(state);
}

static int reset(void **state)
{
    (void)state;
    memset(fails, 0, sizeof fails);
    passed_over = 0;
    return 0;
}

static struct admission_context context(void)
{
    return (struct admission_context){.store = store,
                                      .work = tempdb_work,
                                      .clock_ms = clock_ms,
                                      .find = find,
                                      .release = release,
                                      .pass_over = pass_over,
                                      .arg = &held};
}

/* ids: the models to compare with, a digit each.  Returns what decided, -1 on failure. */
static int decide(const char *ids, const struct face *p, enum status *st,
                  struct nearest *out)
{
    struct admission_context c = context();
    struct store_template t[MODELS] = {0};
    const size_t n = strlen(ids);
    const struct admission a = {.of = {.t = t, .n = n}};

    for (size_t i = 0; i < n; i++)
        (void)snprintf(t[i].id, sizeof t[i].id, "%c", ids[i]);
    *st = nearest_find(&c, &a, p, out, &e);
    assert_int_equal(held, 0);
    return *st == ST_OK ? ids[out->index] - '0' : -1;
}

static void assert_decides(const char *ids, const struct face *p, int m,
                           enum face_decision decision)
{
    struct nearest out;
    enum status st;

    assert_int_equal(decide(ids, p, &st, &out), m);
    assert_int_equal(out.result.decision, decision);
    assert_int_equal(out.compared, strlen(ids));
    assert_true(out.score_ms >= (double)out.compared);
}

static void test_highest(void **state)
{
    struct nearest out;
    enum status st;

    (void)state;
    assert_decides("0", &probe, OTHER, FACE_NO_MATCH);
    assert_decides("01", &probe, SAME, FACE_MATCH);
    assert_decides("10", &probe, SAME, FACE_MATCH);
    assert_int_equal(decide("1", &probe, &st, &out), SAME);
    const double same = out.result.score;
    assert_int_equal(decide("2", &probe, &st, &out), AGAIN);
    const int higher = same > out.result.score ? SAME : AGAIN;

    assert_decides("012", &probe, higher, FACE_MATCH);
    assert_decides("210", &probe, higher, FACE_MATCH);
}

/* Of n comparisons the best is lowered by ln n, and so are its decision and rate. */
static void test_lowered(void **state)
{
    struct nearest out;
    struct calibration d = model_default.calibration;
    enum status st;

    (void)state;
    assert_int_equal(decide("1", &probe, &st, &out), SAME);
    const struct face_result one = out.result;
    assert_true(out.first_score == one.score);
    assert_int_equal(decide("10", &probe, &st, &out), SAME);
    assert_true(fabs(out.result.score - (one.score - log(2))) < 1e-12);
    assert_true(fabs(out.result.expected - (one.expected - log(2))) < 1e-12);
    assert_true(out.first_score == one.score);
    assert_true(out.result.fmr_at_score >= one.fmr_at_score);
    /* A threshold that one template just reaches, and the best of two does not. */
    d.threshold = one.score;
    face_work_decide(tempdb_work, &d);
    assert_decides("1", &probe, SAME, FACE_MATCH);
    assert_true(decide("10", &probe, &st, &out) >= 0);
    assert_int_not_equal(out.result.decision, FACE_MATCH);
    d.threshold = one.score - log(2) - 1e-9;
    face_work_decide(tempdb_work, &d);
    assert_decides("10", &probe, SAME, FACE_MATCH);
    face_work_decide(tempdb_work, NULL);
}

/* If all comparisons are inconclusive, the highest score is returned. */
static void test_inconclusive(void **state)
{
    struct nearest out;
    double most = -INFINITY;
    enum status st;
    int highest = -1;

    (void)state;
    for (int m = 0; m < MIDDLE; m++) {
        const char id[] = {(char)('0' + m), '\0'};

        assert_int_equal(decide(id, &part, &st, &out), m);
        assert_int_equal(out.result.decision, FACE_INCONCLUSIVE);
        if (out.result.score > most) {
            most = out.result.score;
            highest = m;
        }
    }
    assert_decides("012", &part, highest, FACE_INCONCLUSIVE);
    assert_decides("201", &part, highest, FACE_INCONCLUSIVE);
}

/* A conclusive comparison goes before inconclusive ones of a higher score. */
static void test_conclusive_first(void **state)
{
    struct nearest out;
    enum status st;
    double score;

    (void)state;
    assert_decides("3", &probe, MIDDLE, FACE_INCONCLUSIVE);
    assert_int_equal(decide("3", &probe, &st, &out), MIDDLE);
    score = out.result.score;
    assert_int_equal(decide("03", &probe, &st, &out), OTHER);
    assert_true(out.result.score < score);
    assert_decides("03", &probe, OTHER, FACE_NO_MATCH);
    assert_decides("30", &probe, OTHER, FACE_NO_MATCH);
    assert_decides("301", &probe, SAME, FACE_MATCH);
}

/* A scan with left and right swapped is told from a stranger's: only where it is no match, by
 * one comparison more, and only where its mirror image is one. */
static void test_mirrored(void **state)
{
    struct nearest out;
    enum status st;

    (void)state;
    assert_int_equal(decide("01", &swapped, &st, &out), SAME);
    assert_int_equal(out.result.decision, FACE_NO_MATCH);
    assert_true(out.mirrored);
    assert_int_equal(out.compared, 2);
    assert_int_equal(decide("0", &swapped, &st, &out), OTHER);
    assert_int_equal(out.result.decision, FACE_NO_MATCH);
    assert_false(out.mirrored);
    assert_int_equal(decide("0", &probe, &st, &out), OTHER);
    assert_false(out.mirrored);
    assert_int_equal(decide("1", &probe, &st, &out), SAME);
    assert_false(out.mirrored);
    assert_int_equal(decide("0", &part, &st, &out), OTHER);
    assert_false(out.mirrored);
}

/* Of a stranger, whose mirror image scores about the same, no threshold makes a mirrored scan: it
 * would be as good a sign as a match. */
static void test_hardly_mirrored(void **state)
{
    struct calibration d = model_default.calibration;
    struct face stranger = {0}, image = {0};
    struct nearest out, back;
    enum status st;

    (void)state;
    for (uint64_t k = 3; k < 12; k++) {
        make(k, 0, 200, 200, 1, &stranger);
        make(k, 0, 200, 200, -1, &image);
        assert_int_equal(decide("1", &stranger, &st, &out), SAME);
        assert_int_equal(decide("1", &image, &st, &back), SAME);
        assert_false(out.mirrored || back.mirrored);
        d.threshold = fmax(out.result.score, back.result.score);
        face_work_decide(tempdb_work, &d);
        assert_int_equal(decide("1", &stranger, &st, &out), SAME);
        assert_int_equal(decide("1", &image, &st, &back), SAME);
        face_work_decide(tempdb_work, NULL);
        assert_true((out.result.decision == FACE_MATCH) !=
                    (back.result.decision == FACE_MATCH));
        assert_false(out.mirrored || back.mirrored);
    }
    face_free(&stranger);
    face_free(&image);
}

static void test_left_out(void **state)
{
    struct nearest out;
    enum status st;

    (void)state;
    fails[SAME] = ST_ENOTFOUND;
    assert_int_equal(decide("10", &probe, &st, &out), OTHER);
    assert_int_equal(out.compared, 1);
    assert_int_equal(passed_over, 0);
    fails[SAME] = ST_EVERSION;
    assert_int_equal(decide("01", &probe, &st, &out), OTHER);
    assert_int_equal(passed_over, 1);
    assert_int_equal(decide("1", &probe, &st, &out), -1);
    assert_int_equal(st, ST_EVERSION);
    fails[OTHER] = ST_ENOTFOUND;
    assert_int_equal(decide("0", &probe, &st, &out), -1);
    assert_int_equal(st, ST_ENOTFOUND);
    assert_int_equal(decide("", &probe, &st, &out), -1);
    assert_int_equal(st, ST_ENOTFOUND);
}

static void test_failure(void **state)
{
    struct nearest out;
    enum status st;

    (void)state;
    fails[OTHER] = ST_ECORRUPT;
    assert_int_equal(decide("10", &probe, &st, &out), -1);
    assert_int_equal(st, ST_ECORRUPT);
    assert_string_equal(e.msg, "model 0");
}

/* Of the template that decides, and not above the measure at the alignment's pose. */
static void test_minimal(void **state)
{
    struct admission_context c = context();
    struct store_template t[2] = {{.id = "0"}, {.id = "1"}};
    const struct admission a = {.of = {.t = t, .n = 2}};
    struct measure_work w = {0};
    struct nearest best, again;
    struct minimal m, same;
    struct disparity aligned;

    (void)state;
    assert_int_equal(nearest_find(&c, &a, &probe, &best, &e), ST_OK);
    assert_int_equal(best.index, 1);
    assert_int_equal(nearest_minimal(&c, &a, &probe, &best, false, &m, &e), ST_OK);
    assert_int_equal(held, 0);
    assert_true(m.ms >= 1);
    assert_int_equal(
        face_minimal(&model[SAME], &probe, NULL, tempdb_work, &again.result, &same),
        ST_OK);
    assert_true(m.disparity.plain_mm == same.disparity.plain_mm && same.ms == 0);
    assert_int_equal(measure_at(&model[SAME].surface, &probe.surface,
                                best.result.align.transform, NULL, &w, &aligned),
                     ST_OK);
    assert_true(m.disparity.plain_mm > 0);
    assert_true(m.disparity.plain_mm <= aligned.plain_mm);
    assert_true(m.disparity.area_mm2 >= 0.95 * aligned.area_mm2);
    assert_true(m.disparity.weighted_mm == m.disparity.plain_mm);
    assert_int_equal(nearest_minimal(&c, &a, &probe, &best, true, &m, &e), ST_OK);
    assert_true(m.disparity.plain_mm == same.disparity.plain_mm);
    assert_true(m.disparity.weighted_mm > 0);
    assert_true(m.disparity.weighted_mm != m.disparity.plain_mm);
    fails[SAME] = ST_ECORRUPT;
    assert_int_equal(nearest_minimal(&c, &a, &probe, &best, true, &m, &e), ST_ECORRUPT);
    assert_int_equal(held, 0);
    measure_work_free(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_highest, reset),
        cmocka_unit_test_setup(test_lowered, reset),
        cmocka_unit_test_setup(test_inconclusive, reset),
        cmocka_unit_test_setup(test_conclusive_first, reset),
        cmocka_unit_test_setup(test_mirrored, reset),
        cmocka_unit_test_setup(test_hardly_mirrored, reset),
        cmocka_unit_test_setup(test_left_out, reset),
        cmocka_unit_test_setup(test_failure, reset),
        cmocka_unit_test_setup(test_minimal, reset),
    };

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
