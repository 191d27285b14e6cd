/* Calibrations: followed by a worker, refused when impossible or damaged. */
#include "face.h"
#include "model.h"
#include "model_digest.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;

static void add(struct store *s, struct store_calibration *k)
{
    must(store_calibration_add(s, "test", k, &e));
}

TEST(test_refused)
{
    struct store *s = tempdb_fresh();
    struct store_calibration k;

    for (int i = 0; i < 7; i++) {
        double *const of[] = {&k.fmr,
                              &k.fmr,
                              &k.low,
                              &k.high,
                              NULL,
                              &k.table.knot[1].rate,
                              &k.table.knot[0].rate};
        static const double bad[] = {0, (double)NAN, 9, -9, 0, 1, 0.9};

        k = tempdb_calibration(0.6);
        if (of[i] != NULL)
            *of[i] = bad[i];
        else
            k.table.n = 1;
        fails(store_calibration_add(s, "test", &k, &e), ST_EINVAL);
    }
    k = tempdb_calibration(0.6);
    fails(store_calibration_add(s, "no\nname", &k, &e), ST_EINVAL);
    fails(store_calibration_get(s, &k, &e), ST_ENOTFOUND);
    store_close(s);
}

/* A worker decides by it, and by nothing where it is damaged; the way back: tests/box/ctl-calibrate.sh. */
TEST(test_followed)
{
    struct store *s = tempdb_fresh();
    struct store_calibration k = tempdb_calibration(-700), in;
    int64_t version = 0;
    struct surface_comparison r;

    must(store_calibration_refresh(s, tempdb_work, &version, &e));
    assert_int_equal(version, 0);
    add(s, &k);
    must(store_calibration_current(s, &in, &e));
    surface_calibration_continue(&k.table, surface_model_calibration(NULL));
    assert_memory_equal(&in.table, &k.table, sizeof in.table);
    assert_string_equal(in.engine, store_made_by(s));
    assert_true(in.fmr == k.fmr && in.low == k.low && in.high == k.high);
    assert_memory_equal(&in.det, &k.det, sizeof in.det);
    assert_true(in.subjects == 80 && in.impostors == 6320 && in.genuine == 7);
    must(store_calibration_refresh(s, tempdb_work, &version, &e));
    for (int damaged = 0; damaged < 2; damaged++) {
        assert_int_equal(version, 1);
        assert_int_equal(
            surface_compare(tempdb_work, &tempdb_face[0], &tempdb_face[1], &r), ST_OK);
        assert_int_equal(r.decision, SURFACE_MATCH);
        assert_true(r.threshold == -700);
        assert_true(r.false_match_rate == surface_calibration_rate(&k.table, r.score));
        tempdb_sql(
            "INSERT INTO calibrations SELECT calibration_key + 1, revision, created, "
            "actor, engine, shipped, fmr, threshold, low, high, subjects, impostors, "
            "genuine, knots, det, mac FROM calibrations ORDER BY 1 DESC LIMIT 1");
        fails(store_calibration_refresh(s, tempdb_work, &version, &e), ST_ECORRUPT);
        fails(store_calibration_add(s, "test", &k, &e), ST_ECORRUPT);
    }
    store_close(s);
}

/* A calibration holds for the model that it was made with; else the model's own
 * decides. */
TEST(test_other_model)
{
    struct surface_model *m = malloc(sizeof *m);
    struct store_calibration k = tempdb_calibration(0.6), in;
    struct store *s = tempdb_fresh();
    char ours[SURFACE_ENGINE_SIZE];

    assert_non_null(m);
    *m = model_default;
    m->name[0]++;
    m->calibration.threshold *= 2;
    assert_true(model_digest(m) == model_digest(&model_default)); /* these do not count */
    m->identity.mode[GRID_N / 2][0] += 1;
    assert_true(model_digest(m) != model_digest(&model_default));
    surface_engine(NULL, ours);
    assert_string_equal(store_made_by(s), ours);

    add(s, &k);
    must(store_calibration_current(s, &in, &e));
    assert_true(!in.shipped && !in.ignored);
    store_use_model(s, m);
    assert_string_not_equal(store_made_by(s), ours);
    must(store_calibration_current(s, &in, &e));
    assert_true(in.shipped && in.ignored);
    assert_true(in.table.threshold == m->calibration.threshold);
    add(s, &k); /* by the new one */
    must(store_calibration_current(s, &in, &e));
    assert_true(!in.shipped && !in.ignored);
    store_use_model(s, NULL);
    must(store_calibration_current(s, &in, &e));
    assert_true(in.ignored);
    store_close(s);
    free(m);
}
