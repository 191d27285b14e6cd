/* A sample becomes a template if it matches one of the subject's templates, if it is forced,
 * or if it is the first; but not of a disabled or expired subject. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "clouds.h"
#include "enrolment.h"
#include "errinfo.h"
#include "model.h"
#include "tempdb.h"

#define POINTS 1500

static struct store *store;
#define MODELS 4
static struct face model[MODELS]; /* [models], held */
static int models;
static struct face again; /* another scan of tempdb_face[0]'s person */
static struct face cheek; /* a part of that */
static struct errinfo e;
static const struct face *rival; /* enrolled by release(); NULL: nothing */

static const struct face *keep(void *arg, uint64_t mark, const struct store_template *t,
                               struct face *f)
{
    (void)arg;
    (void)t;
    assert_int_equal(mark, 0);
    assert_true(models < MODELS);
    model[models] = *f;
    return &model[models++];
}

/* Enrols `rival` once: a concurrent enrolment between comparing and storing. */
static void release(void *arg, const struct face *f)
{
    struct store_template t;

    (void)arg;
    (void)f;
    face_free(&model[--models]);
    if (rival != NULL)
        tempdb_enroll(store, "alice", "", rival, &t);
    rival = NULL;
}

static enum status add(const struct face *f, bool force, struct enrolment_outcome *out)
{
    struct admission_context c = {
        .store = store, .work = tempdb_work, .keep = keep, .release = release};
    const struct enrolment x = {
        .actor = "test", .subject = "alice", .label = "", .face = f, .force = force};

    return enrolment_add(&c, &x, out, &e);
}

static int set_up(void **state)
{
    static struct dvec3 pts[POINTS];
    size_t n, part = 0;

    assert_int_equal(tempdb_begin_faces(state), 0);
    n = clouds_scan(1, 1, POINTS, pts);
    assert_int_equal(face_build(pts, n, tempdb_work, &again, NULL), ST_OK);
    for (size_t i = 0; i < n; i++)
        if (pts[i].x > 20)
            pts[part++] = pts[i];
    assert_int_equal(face_build(pts, part, tempdb_work, &cheek, NULL), ST_OK);
    return 0;
}

static int tear_down(void **state)
{
    face_free(&again);
    face_free(&cheek);
    return tempdb_end_faces(state);
}

static int fresh(void **state)
{
    (void)state;
    store = tempdb_fresh();
    return 0;
}

static int closed(void **state)
{
    (void)state;
    store_close(store);
    return 0;
}

static void test_fit(void **state)
{
    struct enrolment_outcome out;

    (void)state;
    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_true(out.created);
    assert_int_equal(out.nearest.compared, 0);
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_true(out.created);
    assert_int_equal(out.nearest.compared, 1);
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_false(out.created);
    assert_int_equal(add(&tempdb_face[1], false, &out), ST_EMISMATCH);
    assert_int_equal(out.nearest.compared, 2);
    assert_int_equal(out.nearest.result.decision, FACE_NO_MATCH);
    assert_non_null(strstr(e.msg, "does not fit"));
    assert_int_equal(add(&tempdb_face[1], true, &out), ST_OK);
    assert_int_equal(out.nearest.compared, 0);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 3);
}

/* A sample that has too little in common with the others to tell. */
static void test_inconclusive(void **state)
{
    struct enrolment_outcome out;

    (void)state;
    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(add(&cheek, false, &out), ST_EMISMATCH);
    assert_int_equal(out.nearest.result.decision, FACE_INCONCLUSIVE);
    assert_non_null(strstr(e.msg, "too little in common"));
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 1);
    assert_int_equal(add(&cheek, true, &out), ST_OK);
    assert_true(out.created);
}

/* Nor does one that hides a part of the face, with a score between the two thresholds. */
static void test_doubt(void **state)
{
    struct decision strict = model_default.decision;
    struct face hidden = again; /* borrows its surface */
    struct enrolment_outcome out;

    (void)state;
    hidden.hidden = 0.4;
    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(add(&hidden, false, &out), ST_OK);
    store_close(store);
    store = tempdb_fresh();
    strict.threshold_mm = 0.8 * out.nearest.result.calibrated_mm;
    face_work_decide(tempdb_work, &strict);
    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(add(&hidden, false, &out), ST_EMISMATCH);
    face_work_decide(tempdb_work, NULL);
    assert_int_equal(out.nearest.result.decision, FACE_INCONCLUSIVE);
    assert_non_null(strstr(e.msg, "a part of the face is hidden"));
}

/* A template that is enrolled between comparing and storing is compared with too. */
static void test_meanwhile(void **state)
{
    struct enrolment_outcome out;

    (void)state;
    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    rival = &tempdb_face[1];
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_null(rival);
    assert_int_equal(out.nearest.compared, 2);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 3);
}

static void test_admitted(void **state)
{
    static const bool yes = true, no = false;
    struct enrolment_outcome out;

    (void)state;
    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(store_subject_set(store, "test", "alice",
                                       &(struct store_subject_change){.disabled = &yes},
                                       &e),
                     ST_OK);
    for (int force = 0; force < 2; force++) {
        assert_int_equal(add(&again, force == 1, &out), ST_EDENIED);
        assert_int_equal(out.admit, ADMIT_DISABLED);
        assert_non_null(strstr(e.msg, "alice is disabled"));
    }
    assert_int_equal(
        store_subject_set(
            store, "test", "alice",
            &(struct store_subject_change){.disabled = &no, .expires = "2020-01-01"}, &e),
        ST_OK);
    assert_int_equal(add(&again, false, &out), ST_EDENIED);
    assert_int_equal(out.admit, ADMIT_EXPIRED);
    assert_non_null(strstr(e.msg, "alice expired at 2020-01-01"));
    assert_int_equal(store_subject_set(store, "test", "alice",
                                       &(struct store_subject_change){.expires = ""}, &e),
                     ST_OK);
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_int_equal(out.admit, ADMIT_YES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_fit, fresh, closed),
        cmocka_unit_test_setup_teardown(test_inconclusive, fresh, closed),
        cmocka_unit_test_setup_teardown(test_doubt, fresh, closed),
        cmocka_unit_test_setup_teardown(test_meanwhile, fresh, closed),
        cmocka_unit_test_setup_teardown(test_admitted, fresh, closed),
    };

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
