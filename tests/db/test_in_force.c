/* Calibrations: stored, followed by a worker at once, refused when damaged. */
#include "expect.h"
#include "in_force.h"
#include "face.h"
#include "forge.h"
#include "model.h"
#include "model_digest.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

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
    must(store_calibration_add(s, "test", k, &e));
}

TEST(test_kept)
{
    struct store *s = tempdb_fresh();
    struct store_calibration a = example(0.6), b = example(0.7), got, *list;
    size_t n;

    fails(store_calibration_get(s, &got, &e), ST_ENOTFOUND);
    must(store_calibration_list(s, &list, &n, &e));
    assert_int_equal(n, 0);
    free(list);
    add(s, &a);
    add(s, &b);
    assert_int_equal(b.version, a.version + 1);
    store_close(s);

    s = tempdb_open(STORE_READ);
    must(store_calibration_get(s, &got, &e));
    assert_memory_equal(&got.table, &b.table, sizeof got.table);
    assert_string_equal(got.actor, "test");
    assert_string_equal(got.engine, store_made_by(s));
    assert_string_equal(got.created, b.created);
    assert_true(got.fmr == b.fmr && got.low == b.low && got.high == b.high);
    assert_true(got.subjects == 80 && got.impostors == 6320 && got.genuine == 7);
    must(store_calibration_list(s, &list, &n, &e));
    assert_int_equal(n, 2);
    assert_true(list[0].table.threshold == 0.6 && list[1].version == b.version);
    free(list);
    fails(store_calibration_add(s, "test", &a, &e), ST_EDENIED);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'calibrate'"), 2);
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

        k = example(0.6);
        if (of[i] != NULL)
            *of[i] = bad[i];
        else
            k.table.n = 1;
        fails(store_calibration_add(s, "test", &k, &e), ST_EINVAL);
    }
    k = example(0.6);
    fails(store_calibration_add(s, "no\nname", &k, &e), ST_EINVAL);
    fails(store_calibration_get(s, &k, &e), ST_ENOTFOUND);
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

TEST(test_followed)
{
    struct store *s = tempdb_fresh();
    struct store_calibration k = example(-700), in;
    int64_t version = 0;
    struct face_result r;

    must(in_force_get(s, &in, &e));
    assert_true(in.shipped && in.version == 0);
    must(in_force_follow(s, tempdb_work, &version, &e));
    assert_int_equal(version, 0);
    r = compare();
    assert_int_equal(r.decision, SURFACE_NO_MATCH);
    assert_true(r.threshold == model_default.calibration.threshold);

    add(s, &k);
    must(in_force_follow(s, tempdb_work, &version, &e));
    assert_int_equal(version, k.version);
    r = compare();
    assert_int_equal(r.decision, SURFACE_MATCH);
    assert_true(r.threshold == -700);
    assert_true(r.fmr_at_score == surface_calibration_rate(&k.table, r.score));

    k.shipped = true; /* back: the row's own numbers do not matter */
    add(s, &k);
    must(in_force_follow(s, tempdb_work, &version, &e));
    assert_int_equal(version, k.version);
    assert_int_equal(compare().decision, SURFACE_NO_MATCH);
    must(in_force_get(s, &in, &e));
    assert_true(in.shipped && in.version == k.version);
    assert_true(in.table.threshold == model_default.calibration.threshold);

    k.shipped = false; /* of another measure: it says nothing about this one's scores */
    add(s, &k);
    must(forge_sql(tempdb_path,
                   "UPDATE calibrations SET engine = "
                   "'surfaced/0.0.1 measure/0' WHERE calibration_key = "
                   "(SELECT max(calibration_key) FROM calibrations)",
                   &e));
    must(in_force_follow(s, tempdb_work, &version, &e));
    assert_int_equal(version, k.version);
    assert_int_equal(compare().decision, SURFACE_NO_MATCH);
    must(in_force_get(s, &in, &e));
    assert_true(in.shipped && in.ignored && in.version == k.version);
    assert_string_equal(in.engine, "surfaced/0.0.1 measure/0");

    k.table.threshold = k.low = -700; /* a damaged one changes nothing */
    add(s, &k);
    tempdb_sql("UPDATE calibrations SET threshold = threshold + 1");
    fails(in_force_follow(s, tempdb_work, &version, &e), ST_ECORRUPT);
    assert_int_equal(version, k.version - 1);
    assert_int_equal(compare().decision, SURFACE_NO_MATCH);
    store_close(s);
}

/* A calibration holds for the model that it was made with; else the model's own
 * decides. */
TEST(test_other_model)
{
    struct surface_model *m = malloc(sizeof *m);
    struct store_calibration k = example(0.6), in;
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
    must(in_force_get(s, &in, &e));
    assert_true(!in.shipped && !in.ignored);
    store_use_model(s, m);
    assert_string_not_equal(store_made_by(s), ours);
    must(in_force_get(s, &in, &e));
    assert_true(in.shipped && in.ignored);
    assert_true(in.table.threshold == m->calibration.threshold);
    add(s, &k); /* by the new one */
    must(in_force_get(s, &in, &e));
    assert_true(!in.shipped && !in.ignored);
    store_use_model(s, NULL);
    must(in_force_get(s, &in, &e));
    assert_true(in.ignored);
    store_close(s);
    free(m);
}

BEFORE_ALL(begin)
{
    assert_int_equal(tempdb_begin_faces(NULL), 0);
}

AFTER_ALL(end)
{
    assert_int_equal(tempdb_end_faces(NULL), 0);
}
