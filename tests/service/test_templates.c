/* Which template of a subject decides, in whatever order they come; those of another engine are
 * left out; the minimal disparity is of the one that decides.  What is read before: one
 * transaction, and none of it for who is refused; the calibration in force decides. */
#include "clouds.h"
#include "errinfo.h"
#include "measure.h"
#include "minimal.h"
#include "model.h"
#include "tempdb.h"
#include "templates.h"
#include "unit.h"

#define POINTS 1500

enum { /* of another subject; two of the probe's subject; the middle of that face */
       OTHER,
       SAME,
       AGAIN,
       MIDDLE,
       MODELS
};

static struct surface_face model[MODELS], probe, part; /* part: of a third subject */
static struct surface_face swapped; /* the probe, left and right swapped */
static struct store *store;
static struct errinfo e;

static double clock_ms(void)
{
    static double ms;

    return ms += 1;
}

/* The points of a scan that lie within +-x and +-y of the nose; x to side x, 1 or -1. */
static void make(uint64_t subject, uint64_t scan, double x, double y, double side,
                 struct surface_face *f)
{
    static struct dvec3 pts[2 * POINTS];
    const size_t all = clouds_scan(subject, scan, 2 * POINTS, pts);
    size_t n = 0;

    for (size_t i = 0; i < all; i++)
        if (fabs(pts[i].x) < x && fabs(pts[i].y) < y)
            pts[n++] = (struct dvec3){side * pts[i].x, pts[i].y, pts[i].z};
    assert_int_equal(face_build(pts, n, tempdb_work, f, NULL), ST_OK);
}

BEFORE_ALL(set_up)
{
    store = tempdb_fresh();
    make(1, 0, 200, 200, 1, &probe);
    make(1, 0, 200, 200, -1, &swapped);
    make(2, 0, 200, 200, 1, &model[OTHER]);
    make(1, 1, 200, 200, 1, &model[SAME]);
    make(1, 2, 200, 200, 1, &model[AGAIN]);
    make(1, 3, 16, 40, 1, &model[MIDDLE]);
    make(5, 4, 22, 60, 1, &part);
}

AFTER_ALL(tear_down)
{
    for (int m = 0; m < MODELS; m++)
        face_free(&model[m]);
    face_free(&probe);
    face_free(&part);
    face_free(&swapped);
    store_close(store);
}

static struct templates_context context(void)
{
    return (struct templates_context){
        .store = store, .work = tempdb_work, .clock_ms = clock_ms};
}

/* ids: the models to compare with, a digit each; '-': of another engine. */
static struct templates of(struct templates_context *c, const char *ids,
                           struct store_template *rows)
{
    struct templates t = {.context = c, .of = {.t = rows, .n = strlen(ids)}};

    *c = context();
    for (size_t i = 0; i < t.of.n; i++)
        t.face[i] = ids[i] == '-' ? NULL : &model[ids[i] - '0'];
    return t;
}

/* Returns what decided, -1 on failure. */
static int decide(const char *ids, const struct surface_face *p, enum status *st,
                  struct templates_nearest *out)
{
    struct store_template rows[STORE_TEMPLATES_MAX] = {0};
    struct templates_context c;
    struct templates t = of(&c, ids, rows);

    *st = templates_nearest(&t, false, p, out, &e);
    return *st == ST_OK ? ids[out->index] - '0' : -1;
}

static void assert_decides(const char *ids, const struct surface_face *p, int m,
                           enum surface_decision decision)
{
    struct templates_nearest out;
    enum status st;

    assert_int_equal(decide(ids, p, &st, &out), m);
    assert_int_equal(out.result.decision, decision);
    assert_int_equal(out.compared, strlen(ids));
    assert_true(out.score_ms >= (double)out.compared);
}

TEST(test_highest)
{
    struct templates_nearest out;
    enum status st;

    assert_decides("0", &probe, OTHER, SURFACE_NO_MATCH);
    assert_decides("01", &probe, SAME, SURFACE_MATCH);
    assert_decides("10", &probe, SAME, SURFACE_MATCH);
    assert_int_equal(decide("1", &probe, &st, &out), SAME);
    const double same = out.result.score;
    assert_int_equal(decide("2", &probe, &st, &out), AGAIN);
    const int higher = same > out.result.score ? SAME : AGAIN;

    assert_decides("012", &probe, higher, SURFACE_MATCH);
    assert_decides("210", &probe, higher, SURFACE_MATCH);
}

/* Of n comparisons the best is lowered by ln n, and so are its decision and rate. */
TEST(test_lowered)
{
    struct templates_nearest out;
    struct surface_calibration d = model_default.calibration;
    enum status st;

    assert_int_equal(decide("1", &probe, &st, &out), SAME);
    const struct surface_comparison one = out.result;
    assert_true(out.first_score == one.score);
    assert_int_equal(decide("10", &probe, &st, &out), SAME);
    assert_true(fabs(out.result.score - (one.score - log(2))) < 1e-12);
    assert_true(fabs(out.result.expected - (one.expected - log(2))) < 1e-12);
    assert_true(out.first_score == one.score);
    assert_true(out.result.false_match_rate >= one.false_match_rate);
    /* A threshold that one template just reaches, and the best of two does not. */
    d.threshold = one.score;
    (void)surface_work_calibrate(tempdb_work, &d);
    assert_decides("1", &probe, SAME, SURFACE_MATCH);
    assert_true(decide("10", &probe, &st, &out) >= 0);
    assert_int_not_equal(out.result.decision, SURFACE_MATCH);
    d.threshold = one.score - log(2) - 1e-9;
    (void)surface_work_calibrate(tempdb_work, &d);
    assert_decides("10", &probe, SAME, SURFACE_MATCH);
    (void)surface_work_calibrate(tempdb_work, NULL);
}

/* If all comparisons are inconclusive, the highest score is returned. */
TEST(test_inconclusive)
{
    struct templates_nearest out;
    double most = -INFINITY;
    enum status st;
    int highest = -1;

    for (int m = 0; m < MIDDLE; m++) {
        const char id[] = {(char)('0' + m), '\0'};

        assert_int_equal(decide(id, &part, &st, &out), m);
        assert_int_equal(out.result.decision, SURFACE_INCONCLUSIVE);
        if (out.result.score > most) {
            most = out.result.score;
            highest = m;
        }
    }
    assert_decides("012", &part, highest, SURFACE_INCONCLUSIVE);
    assert_decides("201", &part, highest, SURFACE_INCONCLUSIVE);
}

/* A conclusive comparison goes before inconclusive ones of a higher score. */
TEST(test_conclusive_first)
{
    struct templates_nearest out;
    enum status st;
    double score;

    assert_decides("3", &probe, MIDDLE, SURFACE_INCONCLUSIVE);
    assert_int_equal(decide("3", &probe, &st, &out), MIDDLE);
    score = out.result.score;
    assert_int_equal(decide("03", &probe, &st, &out), OTHER);
    assert_true(out.result.score < score);
    assert_decides("03", &probe, OTHER, SURFACE_NO_MATCH);
    assert_decides("30", &probe, OTHER, SURFACE_NO_MATCH);
    assert_decides("301", &probe, SAME, SURFACE_MATCH);
}

/* A scan with left and right swapped is told from a stranger's: only where it is no match, by
 * one comparison more, and only where its mirror image is one. */
TEST(test_mirrored)
{
    struct templates_nearest out;
    enum status st;

    assert_int_equal(decide("01", &swapped, &st, &out), SAME);
    assert_int_equal(out.result.decision, SURFACE_NO_MATCH);
    assert_true(out.mirrored);
    assert_int_equal(out.compared, 2);
    assert_int_equal(decide("0", &swapped, &st, &out), OTHER);
    assert_int_equal(out.result.decision, SURFACE_NO_MATCH);
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
TEST(test_hardly_mirrored)
{
    struct surface_calibration d = model_default.calibration;
    struct surface_face stranger = {0}, image = {0};
    struct templates_nearest out, back;
    enum status st;

    for (uint64_t k = 3; k < 12; k++) {
        make(k, 0, 200, 200, 1, &stranger);
        make(k, 0, 200, 200, -1, &image);
        assert_int_equal(decide("1", &stranger, &st, &out), SAME);
        assert_int_equal(decide("1", &image, &st, &back), SAME);
        assert_false(out.mirrored || back.mirrored);
        d.threshold = fmax(out.result.score, back.result.score);
        (void)surface_work_calibrate(tempdb_work, &d);
        assert_int_equal(decide("1", &stranger, &st, &out), SAME);
        assert_int_equal(decide("1", &image, &st, &back), SAME);
        (void)surface_work_calibrate(tempdb_work, NULL);
        assert_true((out.result.decision == SURFACE_MATCH) !=
                    (back.result.decision == SURFACE_MATCH));
        assert_false(out.mirrored || back.mirrored);
    }
    face_free(&stranger);
    face_free(&image);
}

TEST(test_left_out)
{
    struct templates_nearest out;
    enum status st;

    assert_int_equal(decide("-0", &probe, &st, &out), OTHER);
    assert_int_equal(out.compared, 1);
    assert_int_equal(decide("-", &probe, &st, &out), -1);
    assert_int_equal(st, ST_EVERSION);
    assert_int_equal(decide("", &probe, &st, &out), -1);
    assert_int_equal(st, ST_ENOTFOUND);
}

/* Of the template that decides, and not above the measure at the alignment's pose. */
TEST(test_minimal)
{
    struct store_template rows[2] = {0};
    struct templates_context c;
    struct templates t = of(&c, "01", rows);
    struct measure_work w = {0};
    struct surface_disparity m;
    struct surface_parts parts;
    struct templates_nearest best;
    struct surface_disparity same;
    struct disparity aligned;

    assert_int_equal(templates_nearest(&t, false, &probe, &best, &e), ST_OK);
    assert_int_equal(best.index, 1);
    assert_int_equal(templates_minimal(&t, &probe, &best, &m, NULL, &e), ST_OK);
    assert_true(m.minimal_ms >= 1);
    assert_int_equal(surface_disparity(tempdb_work, &model[SAME], &probe, &same), ST_OK);
    assert_true(m.disparity_mm == same.disparity_mm);
    assert_int_equal(measure_at(&model[SAME].surface, &probe.surface, m.align_transform,
                                NULL, &w, &aligned),
                     ST_OK);
    assert_true(m.disparity_mm > 0);
    assert_true(m.disparity_mm <= aligned.plain_mm);
    assert_true(m.area_mm2 >= 0.95 * aligned.area_mm2);
    assert_true(m.weighted_mm == m.disparity_mm);
    assert_int_equal(templates_minimal(&t, &probe, &best, &m, &parts, &e), ST_OK);
    assert_true(m.disparity_mm == same.disparity_mm);
    assert_true(m.weighted_mm > 0);
    assert_true(m.weighted_mm != m.disparity_mm);
    measure_work_free(&w);
}

/* ---- what is read before */

static struct store_template t[2]; /* of alice */

static void enroll_alice(void)
{
    store_close(store);
    store = tempdb_fresh();
    for (int i = 0; i < 2; i++)
        tempdb_enroll(store, "alice", "", &tempdb_face[i], &t[i]);
}

static enum status read(struct templates_context *c, const char *subject,
                        struct templates *out)
{
    return templates_read(c, &(struct templates_of){.subject = subject}, out, &e);
}

TEST(test_read)
{
    struct templates_context c = context();
    struct templates a;

    enroll_alice();
    c.store = store;
    assert_int_equal(read(&c, "alice", &a), ST_OK);
    assert_int_equal(a.of.n, 2);
    for (size_t i = 0; i < 2; i++) { /* of several what a comparison needs */
        assert_int_equal(a.face[i]->surface.mesh.nv, 0);
        assert_true(a.face[i]->encoding.n > 0);
    }
    templates_free(&a);
    assert_null(a.of.t);
    templates_free(&a);

    const struct templates_of one = {.template_id = t[1].id};

    assert_int_equal(templates_read(&c, &one, &a, &e), ST_OK);
    assert_int_equal(a.of.n, 1);
    assert_string_equal(a.of.subject.id, "alice");
    templates_free(&a);
}

/* No face is read for who is refused. */
TEST(test_refused)
{
    static const bool yes = true;
    const struct store_limits limits = {.failures = 1, .wait_s = 30};
    struct templates_context c = context();
    struct templates a;
    struct templates_of ask = {.subject = "alice", .token = "test", .limits = &limits};

    enroll_alice();
    c.store = store;
    assert_int_equal(read(&c, "nobody", &a), ST_ENOTFOUND);
    assert_int_equal(a.refusal.admit, TEMPLATES_ADMITTED);
    templates_free(&a);
    assert_int_equal(tempdb_record(store, "alice", STORE_RECORD_FAILED, &e), ST_OK);
    assert_int_equal(templates_read(&c, &ask, &a, &e), ST_EDENIED);
    assert_int_equal(a.refusal.why, STORE_WAIT_OWN);
    assert_in_range(a.refusal.wait_ms, 1, 30000);
    assert_int_equal(a.refusal.now.failures, 1);
    assert_null(a.face[0]);
    templates_free(&a);
    assert_int_equal(store_subject_set(store, "test", "alice",
                                       &(struct store_subject_change){.disabled = &yes},
                                       &e),
                     ST_OK);
    assert_int_equal(templates_read(&c, &ask, &a, &e), ST_EDENIED);
    assert_int_equal(a.refusal.admit, TEMPLATES_DISABLED);
    assert_non_null(strstr(e.msg, "alice is disabled"));
    assert_null(a.face[0]);
    templates_free(&a);
}

/* A calibration that comes into force decides the next comparison. */
TEST(test_calibration)
{
    struct store_calibration k = {
        .fmr = 0.5,
        .low = 99,
        .high = 99,
        .table = {.threshold = 99, .n = 2, .knot = {{-100, 1}, {99, 0.5}}}};
    struct templates_context c = context();
    struct templates a;
    struct templates_nearest out;
    const struct {
        bool add, shipped;
        double threshold;
    } step[] = {{false, false, surface_model_calibration(NULL)->threshold},
                {true, false, k.table.threshold},
                {true, true, surface_model_calibration(NULL)->threshold}};

    enroll_alice();
    c.store = store;
    for (size_t i = 0; i < sizeof step / sizeof *step; i++) {
        k.shipped = step[i].shipped;
        if (step[i].add && store_calibration_add(store, "test", &k, &e) != ST_OK)
            fail_msg("%s", e.msg);
        assert_int_equal(read(&c, "alice", &a), ST_OK);
        assert_int_equal(c.calibration, i);
        assert_int_equal(templates_nearest(&a, false, &tempdb_face[1], &out, &e), ST_OK);
        assert_true(out.result.threshold == step[i].threshold);
        templates_free(&a);
    }
}
