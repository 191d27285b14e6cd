/* link: -Wl,--wrap=store_admit -Wl,--wrap=store_template_decode -Wl,--wrap=store_template_load */
/* What is read before a comparison: one transaction, whatever is in memory and whatever is not;
 * who is refused costs no model; models beyond the first are read when they are used; every
 * model is given back; the calibration in force decides. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "admission.h"
#include "clouds.h"
#include "errinfo.h"
#include "model.h"
#include "nearest.h"
#include "tempdb.h"

#define TEMPLATES (ADMISSION_MODELS + 2)

static struct store *store;
static struct store_template t[TEMPLATES];
static struct errinfo e;
static unsigned reads, decoded, loaded, passed_over, readings;
static const char *foreign; /* a template's id: decoding it is ST_EVERSION */
static enum status broken;  /* what decoding any other is */

enum status __real_store_admit(struct store *s, const struct store_admit *what,
                               struct store_admission *out, struct errinfo *why);
enum status __wrap_store_admit(struct store *s, const struct store_admit *what,
                               struct store_admission *out, struct errinfo *why);
enum status __real_store_template_decode(const struct store *s,
                                         const struct store_template *one,
                                         const void *model, size_t len,
                                         struct face_work *w, struct face *f,
                                         struct errinfo *why);
enum status __wrap_store_template_decode(const struct store *s,
                                         const struct store_template *one,
                                         const void *model, size_t len,
                                         struct face_work *w, struct face *f,
                                         struct errinfo *why);

enum status __real_store_template_load(struct store *s, const char *id,
                                       struct store_template *one, struct face_work *w,
                                       struct face *f, struct errinfo *why);
enum status __wrap_store_template_load(struct store *s, const char *id,
                                       struct store_template *one, struct face_work *w,
                                       struct face *f, struct errinfo *why);

enum status __wrap_store_template_load(struct store *s, const char *id,
                                       struct store_template *one, struct face_work *w,
                                       struct face *f, struct errinfo *why)
{
    loaded++;
    return __real_store_template_load(s, id, one, w, f, why);
}

enum status __wrap_store_admit(struct store *s, const struct store_admit *what,
                               struct store_admission *out, struct errinfo *why)
{
    reads++;
    return __real_store_admit(s, what, out, why);
}

enum status __wrap_store_template_decode(const struct store *s,
                                         const struct store_template *one,
                                         const void *model, size_t len,
                                         struct face_work *w, struct face *f,
                                         struct errinfo *why)
{
    const enum status st = __real_store_template_decode(s, one, model, len, w, f, why);

    decoded++;
    assert_int_equal(st, ST_OK);
    if (foreign != NULL && strcmp(foreign, one->id) == 0)
        return errinfo_set(why, ST_EVERSION, "foreign");
    return broken != ST_OK ? errinfo_set(why, broken, "broken") : ST_OK;
}

/* ---- a memory of one model */

static struct {
    char id[STORE_ID_LEN + 1]; /* "": there is none */
    struct face face;
    int held;
    uint64_t mark;
} kept;

static const struct face *find(void *arg, const char *id)
{
    assert_ptr_equal(arg, &kept);
    if (strcmp(kept.id, id) != 0)
        return NULL;
    kept.held++;
    return &kept.face;
}

static uint64_t mark(void *arg)
{
    assert_ptr_equal(arg, &kept);
    assert_int_equal(reads,
                     0); /* before the transaction: nothing deleted in it is missed */
    return ++kept.mark;
}

static const struct face *keep(void *arg, uint64_t since,
                               const struct store_template *one, struct face *f)
{
    assert_ptr_equal(arg, &kept);
    assert_int_equal(since, kept.mark);
    assert_string_equal(kept.id, "");
    memcpy(kept.id, one->id, sizeof kept.id);
    kept.face = *f;
    kept.held++;
    return &kept.face;
}

static void release(void *arg, const struct face *f)
{
    assert_ptr_equal(arg, &kept);
    assert_ptr_equal(f, &kept.face);
    kept.held--;
}

static void pass_over(void *arg, const struct errinfo *why)
{
    (void)arg;
    assert_string_equal(why->msg, "foreign");
    passed_over++;
}

/* Without a memory. */
static struct admission_context context(void)
{
    return (struct admission_context){
        .store = store, .work = tempdb_work, .pass_over = pass_over};
}

static enum status admitted(void *arg, const struct store_admission *a,
                            struct errinfo *why)
{
    assert_int_equal(readings, 0);
    assert_true(a->n > 0);
    return arg != NULL ? errinfo_set(why, ST_EHELD, "no") : ST_OK;
}

static void reading(void *arg)
{
    (void)arg;
    assert_int_equal(decoded, 0);
    readings++;
}

static enum status read(struct admission_context *c, const char *subject, void *arg,
                        struct admission *out)
{
    const struct admission_request ask = {
        .subject = subject, .admitted = admitted, .reading = reading, .arg = arg};

    reads = decoded = loaded = passed_over = readings = 0;
    return admission_read(c, &ask, out, &e);
}

/* ---- the tests */

static int fresh(void **state)
{
    (void)state;
    store = tempdb_fresh();
    tempdb_enroll(store, "alice", "", &tempdb_face[0], &t[0]);
    foreign = NULL;
    broken = ST_OK;
    return 0;
}

static int closed(void **state)
{
    (void)state;
    store_close(store);
    return 0;
}

static void test_read(void **state)
{
    struct admission_context c = context();
    struct admission a;
    const struct face *f;

    (void)state;
    tempdb_enroll(store, "alice", "", &tempdb_face[1], &t[1]);
    assert_int_equal(read(&c, "alice", NULL, &a), ST_OK);
    assert_int_equal(a.of.n, 2);
    assert_int_equal(readings, 1);
    assert_int_equal(decoded, 2);
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(admission_hold(&c, &a, i, &f, &e), ST_OK);
        assert_int_equal(f->surface.mesh.nv, t[i].points);
        admission_release(&c, &a, i, f);
    }
    assert_int_equal(decoded, 2);
    assert_int_equal(reads, 1);
    admission_free(&c, &a);
    assert_null(a.of.t);
    admission_free(&c, &a);

    const struct admission_request one = {.template_id = t[1].id};

    assert_int_equal(admission_read(&c, &one, &a, &e), ST_OK);
    assert_int_equal(a.of.n, 1);
    assert_string_equal(a.of.subject.id, "alice");
    admission_free(&c, &a);
}

static void test_memory(void **state)
{
    struct admission_context c = context();
    struct admission a;
    const struct face *f;

    (void)state;
    c.find = find;
    c.mark = mark;
    c.keep = keep;
    c.release = release;
    c.arg = &kept;
    for (unsigned loads = 1; loads <= 2; loads++) {
        assert_int_equal(read(&c, "alice", NULL, &a), ST_OK);
        assert_int_equal(reads, 1);
        assert_int_equal(decoded, loads == 1);
        assert_int_equal(readings, loads == 1); /* else nothing is waited for */
        assert_int_equal(kept.held, 1);
        assert_int_equal(admission_hold(&c, &a, 0, &f, &e), ST_OK);
        assert_ptr_equal(f, &kept.face);
        admission_release(&c, &a, 0, f);
        assert_int_equal(kept.held, 1);
        admission_free(&c, &a);
        assert_int_equal(kept.held, 0);
    }
    face_free(&kept.face);
    memset(&kept, 0, sizeof kept);
}

/* Nothing is read for who is refused. */
static void test_refused(void **state)
{
    static const bool yes = true;
    struct admission_context c = context();
    struct admission a;

    (void)state;
    assert_int_equal(read(&c, "nobody", NULL, &a), ST_ENOTFOUND);
    assert_int_equal(a.admit, ADMIT_YES);
    assert_int_equal(read(&c, "alice", &c, &a), ST_EHELD);
    assert_int_equal(decoded + readings, 0);
    assert_int_equal(store_subject_set(store, "test", "alice",
                                       &(struct store_subject_change){.disabled = &yes},
                                       &e),
                     ST_OK);
    assert_int_equal(read(&c, "alice", NULL, &a), ST_EDENIED);
    assert_int_equal(a.admit, ADMIT_DISABLED);
    assert_non_null(strstr(e.msg, "alice is disabled"));
    assert_int_equal(reads, 1);
    assert_int_equal(decoded + readings, 0);
}

static void test_foreign(void **state)
{
    struct admission_context c = context();
    struct admission a;
    struct nearest out;

    (void)state;
    tempdb_enroll(store, "alice", "", &tempdb_face[1], &t[1]);
    foreign = t[0].id;
    assert_int_equal(read(&c, "alice", NULL, &a), ST_OK);
    assert_int_equal(nearest_find(&c, &a, &tempdb_face[0], &out, &e), ST_OK);
    assert_int_equal(out.compared, 1);
    assert_int_equal(out.index, 1);
    assert_int_equal(passed_over, 1);
    assert_int_equal(decoded, 2);
    assert_int_equal(loaded, 0); /* none of them again */
    admission_free(&c, &a);

    foreign = NULL;
    broken = ST_ECORRUPT; /* nothing is left of what was read before */
    assert_int_equal(read(&c, "alice", NULL, &a), ST_ECORRUPT);
    assert_int_equal(a.of.n, 0);
    assert_null(a.model[0].face);
}

/* The last ones are loaded when they are compared, and deleted ones of them are left out. */
static void test_many(void **state)
{
    static struct dvec3 pts[600];
    struct admission_context c = context();
    struct admission a;
    struct nearest out;

    (void)state;
    for (unsigned i = 1; i < TEMPLATES; i++) {
        struct face f = {0};

        assert_int_equal(
            face_build(pts, clouds_scan(1, i, 600, pts), tempdb_work, &f, NULL), ST_OK);
        tempdb_enroll(store, "alice", "", &f, &t[i]);
        face_free(&f);
    }
    assert_int_equal(read(&c, "alice", NULL, &a), ST_OK);
    assert_int_equal(a.of.n, TEMPLATES);
    assert_int_equal(decoded, ADMISSION_MODELS);
    assert_int_equal(nearest_find(&c, &a, &tempdb_face[0], &out, &e), ST_OK);
    assert_int_equal(out.compared, TEMPLATES);
    assert_int_equal(loaded, TEMPLATES - ADMISSION_MODELS);
    assert_int_equal(store_template_delete(store, "test", t[TEMPLATES - 1].id, &e),
                     ST_OK);
    assert_int_equal(nearest_find(&c, &a, &tempdb_face[0], &out, &e), ST_OK);
    assert_int_equal(out.compared, TEMPLATES - 1);
    admission_free(&c, &a);
}

/* A calibration that comes into force decides the next comparison. */
static void test_calibration(void **state)
{
    struct store_calibration k = {
        .fmr = 0.5,
        .low = 99,
        .high = 99,
        .table = {.threshold = 99, .n = 2, .knot = {{-100, 1}, {99, 0.5}}}};
    struct admission_context c = context();
    struct admission a;
    struct nearest out;
    const struct {
        bool add, shipped;
        double threshold;
    } step[] = {{false, false, store_model(store)->calibration.threshold},
                {true, false, k.table.threshold},
                {true, true, store_model(store)->calibration.threshold}};

    (void)state;
    for (size_t i = 0; i < sizeof step / sizeof *step; i++) {
        k.shipped = step[i].shipped;
        if (step[i].add && store_calibration_add(store, "test", &k, &e) != ST_OK)
            fail_msg("%s", e.msg);
        assert_int_equal(read(&c, "alice", NULL, &a), ST_OK);
        assert_int_equal(reads, 1);
        assert_int_equal(c.calibration, i);
        assert_int_equal(nearest_find(&c, &a, &tempdb_face[1], &out, &e), ST_OK);
        assert_true(out.result.threshold == step[i].threshold);
        admission_free(&c, &a);
    }
    assert_int_equal(admission_calibrate(&c, &e), ST_OK);
    assert_int_equal(c.calibration, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_read, fresh, closed),
        cmocka_unit_test_setup_teardown(test_memory, fresh, closed),
        cmocka_unit_test_setup_teardown(test_refused, fresh, closed),
        cmocka_unit_test_setup_teardown(test_foreign, fresh, closed),
        cmocka_unit_test_setup_teardown(test_many, fresh, closed),
        cmocka_unit_test_setup_teardown(test_calibration, fresh, closed),
    };

    return cmocka_run_group_tests(tests, tempdb_begin_faces, tempdb_end_faces);
}
