/* Calibrations: stored, followed by a worker at once, refused when damaged. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "in_force.h"
#include "errinfo.h"
#include "face.h"
#include "forge.h"
#include "model.h"
#include "model_digest.h"
#include "store.h"
#include "tempdb.h"

static struct errinfo e;

static struct store_calibration example(double threshold)
{
    return (struct store_calibration){
        .fmr = 0.001,
        .low = threshold - 1,
        .high = threshold + 1,
        .subjects = 80,
        .impostors = 6320,
        .genuine = 7,
        .table = {.threshold = threshold,
                  .n = 3,
                  .knot = {{-900, 1}, {-800, 0.25}, {threshold, 0.001}}},
    };
}

static void add(struct store *s, struct store_calibration *k)
{
    if (store_calibration_add(s, "test", k, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

static void test_kept(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_calibration a = example(0.6), b = example(0.7), got, *list;
    size_t n;

    (void)state;
    assert_int_equal(store_calibration_get(s, &got, &e), ST_ENOTFOUND);
    assert_int_equal(store_calibration_list(s, &list, &n, &e), ST_OK);
    assert_int_equal(n, 0);
    free(list);
    add(s, &a);
    add(s, &b);
    assert_int_equal(b.version, a.version + 1);
    store_close(s);

    s = tempdb_open(STORE_READ);
    assert_int_equal(store_calibration_get(s, &got, &e), ST_OK);
    assert_memory_equal(&got.table, &b.table, sizeof got.table);
    assert_string_equal(got.actor, "test");
    assert_string_equal(got.engine, store_made_by(s));
    assert_string_equal(got.created, b.created);
    assert_true(got.fmr == b.fmr && got.low == b.low && got.high == b.high);
    assert_true(got.subjects == 80 && got.impostors == 6320 && got.genuine == 7);
    assert_int_equal(store_calibration_list(s, &list, &n, &e), ST_OK);
    assert_int_equal(n, 2);
    assert_true(list[0].table.threshold == 0.6 && list[1].version == b.version);
    free(list);
    assert_int_equal(store_calibration_add(s, "test", &a, &e), ST_EDENIED);
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_OK);
    store_close(s);
    assert_int_equal(
        tempdb_number("SELECT count(*) FROM change_log WHERE kind = 'calibrate'"), 2);
}

static void test_refused(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_calibration k;

    (void)state;
    for (int i = 0; i < 7; i++) {
        k = example(0.6);
        switch (i) {
        case 0:
            k.fmr = 0;
            break;
        case 1:
            k.fmr = (double)NAN;
            break;
        case 2:
            k.low = k.table.threshold + 1;
            break;
        case 3:
            k.high = k.table.threshold - 1;
            break;
        case 4:
            k.table.n = 1;
            break;
        case 5:
            k.table.knot[1].rate = k.table.knot[0].rate;
            break;
        default:
            k.table.knot[0].rate = 0.9;
        }
        assert_int_equal(store_calibration_add(s, "test", &k, &e), ST_EINVAL);
    }
    k = example(0.6);
    assert_int_equal(store_calibration_add(s, "no\nname", &k, &e), ST_EINVAL);
    assert_int_equal(store_calibration_get(s, &k, &e), ST_ENOTFOUND);
    store_close(s);
}

/* Decisions: a comparison of the same two faces, with a threshold to either side. */
static struct face_result compare(void)
{
    struct face_result r;

    assert_int_equal(face_compare(&tempdb_face[0], &tempdb_face[1], (double)NAN, NULL,
                                  tempdb_work, &r),
                     ST_OK);
    return r;
}

static void test_followed(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_calibration k = example(-700), in;
    int64_t version = 0;
    struct face_result r;

    (void)state;
    assert_int_equal(in_force_get(s, &in, &e), ST_OK);
    assert_true(in.shipped && in.version == 0);
    assert_int_equal(in_force_follow(s, tempdb_work, &version, &e), ST_OK);
    assert_int_equal(version, 0);
    r = compare();
    assert_int_equal(r.decision, FACE_NO_MATCH);
    assert_true(r.threshold == model_default.calibration.threshold);

    add(s, &k);
    assert_int_equal(in_force_follow(s, tempdb_work, &version, &e), ST_OK);
    assert_int_equal(version, k.version);
    r = compare();
    assert_int_equal(r.decision, FACE_MATCH);
    assert_true(r.threshold == -700);
    assert_true(r.fmr_at_score == calibration_fmr(&k.table, r.score));

    k.shipped = true; /* back: the row's own numbers do not matter */
    add(s, &k);
    assert_int_equal(in_force_follow(s, tempdb_work, &version, &e), ST_OK);
    assert_int_equal(version, k.version);
    assert_int_equal(compare().decision, FACE_NO_MATCH);
    assert_int_equal(in_force_get(s, &in, &e), ST_OK);
    assert_true(in.shipped && in.version == k.version);
    assert_true(in.table.threshold == model_default.calibration.threshold);

    k.shipped = false; /* of another measure: it says nothing about this one's scores */
    add(s, &k);
    assert_int_equal(forge_sql(tempdb_path,
                               "UPDATE calibrations SET engine = "
                               "'surfaced/0.0.1 measure/0' WHERE calibration_key = "
                               "(SELECT max(calibration_key) FROM calibrations)",
                               &e),
                     ST_OK);
    assert_int_equal(in_force_follow(s, tempdb_work, &version, &e), ST_OK);
    assert_int_equal(version, k.version);
    assert_int_equal(compare().decision, FACE_NO_MATCH);
    assert_int_equal(in_force_get(s, &in, &e), ST_OK);
    assert_true(in.shipped && in.ignored && in.version == k.version);
    assert_string_equal(in.engine, "surfaced/0.0.1 measure/0");
    store_close(s);
}

/* A calibration holds for the model that it was made with; else the model's own
 * decides. */
static void test_other_model(void **state)
{
    struct model *m = malloc(sizeof *m);
    struct store_calibration k = example(0.6), in;
    struct store *s = tempdb_fresh();
    char ours[FACE_ENGINE_MAX + 1];

    (void)state;
    assert_non_null(m);
    *m = model_default;
    m->name[0]++;
    m->calibration.threshold *= 2;
    assert_true(model_digest(m) == model_digest(&model_default)); /* these do not count */
    m->identity.mode[GRID_N / 2][0] += 1;
    assert_true(model_digest(m) != model_digest(&model_default));
    face_engine(NULL, ours);
    assert_string_equal(store_made_by(s), ours);

    add(s, &k);
    assert_int_equal(in_force_get(s, &in, &e), ST_OK);
    assert_true(!in.shipped && !in.ignored);
    store_use_model(s, m);
    assert_string_not_equal(store_made_by(s), ours);
    assert_int_equal(in_force_get(s, &in, &e), ST_OK);
    assert_true(in.shipped && in.ignored);
    assert_true(in.table.threshold == m->calibration.threshold);
    add(s, &k); /* by the new one */
    assert_int_equal(in_force_get(s, &in, &e), ST_OK);
    assert_true(!in.shipped && !in.ignored);
    store_use_model(s, NULL);
    assert_int_equal(in_force_get(s, &in, &e), ST_OK);
    assert_true(in.ignored);
    store_close(s);
    free(m);
}

static void test_damaged(void **state)
{
    static const char *const damage[] = {
        "UPDATE calibrations SET knots = zeroblob(32)",
        "UPDATE calibrations SET knots = substr(knots, 1, 32)",
        "UPDATE calibrations SET threshold = 1e4",
        "UPDATE calibrations SET threshold = 9e999",
        "UPDATE calibrations SET knots = x'00'",
        "UPDATE calibrations SET knots = zeroblob(9)",
        "UPDATE calibrations SET knots = zeroblob(16 * 33)",
        "UPDATE calibrations SET threshold = -1e4",
        "UPDATE calibrations SET fmr = 1",
        "UPDATE calibrations SET low = 0.1",
        "UPDATE calibrations SET impostors = -1",
        "UPDATE calibrations SET engine = CAST(zeroblob(100) AS TEXT)",
        "UPDATE calibrations SET calibration_key = -5",
        "UPDATE calibrations SET calibration_key = 5",
        "UPDATE calibrations SET threshold = threshold + 1",
        "UPDATE calibrations SET shipped = 1",
        "UPDATE calibrations SET actor = 'nobody'",
        "UPDATE calibrations SET mac = zeroblob(32)",
        ("INSERT INTO calibrations SELECT 7, revision, created, actor, engine, shipped, fmr,"
         " 8, -701, 9, subjects, impostors, genuine, knots, mac FROM calibrations"),
    };

    (void)state;
    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        struct store *s = tempdb_fresh();
        struct store_calibration k = example(-700), *list;
        int64_t version = 0;
        size_t n;

        add(s, &k);
        tempdb_sql(damage[i]);
        face_work_decide(tempdb_work, NULL);
        print_message("%s\n", damage[i]);
        assert_int_equal(store_calibration_get(s, &k, &e), ST_ECORRUPT);
        assert_int_equal(in_force_follow(s, tempdb_work, &version, &e), ST_ECORRUPT);
        assert_int_equal(version, 0);
        assert_int_equal(compare().decision, FACE_NO_MATCH); /* as it was before */
        assert_int_equal(store_calibration_list(s, &list, &n, &e), ST_ECORRUPT);
        assert_int_equal(store_verify(s, NULL, NULL, &e), ST_EREFUSED);
        store_close(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kept),     cmocka_unit_test(test_refused),
        cmocka_unit_test(test_followed), cmocka_unit_test(test_other_model),
        cmocka_unit_test(test_damaged),
    };

    return cmocka_run_group_tests(tests, tempdb_begin_faces, tempdb_end_faces);
}
