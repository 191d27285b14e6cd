/* What a verification reads and writes, in one transaction each. */
/* link: -Wl,--wrap=sql_begin */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "expect.h"
#include "model.h"
#include "sql.h"
#include "tempdb.h"

static struct errinfo e;
static unsigned reads, writes;

enum status __real_sql_begin(struct sql *d, enum sql_begin how, struct sql_txn **t,
                             struct errinfo *why);
enum status __wrap_sql_begin(struct sql *d, enum sql_begin how, struct sql_txn **t,
                             struct errinfo *why);

enum status __wrap_sql_begin(struct sql *d, enum sql_begin how, struct sql_txn **t,
                             struct errinfo *why)
{
    reads += how == SQL_READ;
    writes += how != SQL_READ;
    return __real_sql_begin(d, how, t, why);
}

static void assert_transactions(unsigned read, unsigned written)
{
    assert_int_equal(reads, read);
    assert_int_equal(writes, written);
    reads = writes = 0;
}

/* The caller: which models it wants, and which it was given. */
struct caller {
    const struct store *store;
    unsigned listed, used;
    const char *has; /* a template that is in its cache */
    bool end;        /* when all is listed */
    enum status fail;
    char got[4][STORE_ID_LEN + 1];
};

static enum status listed(void *arg, const struct store_admission *a, struct errinfo *why)
{
    struct caller *c = arg;

    assert_true(a->n > 0);
    assert_int_equal(c->used, 0); /* before any model is read */
    c->listed++;
    return c->end ? errinfo_set(why, ST_EHELD, "no more") : ST_OK;
}

static bool wanted(void *arg, const struct store_template *t)
{
    const struct caller *c = arg;

    return c->has == NULL || strcmp(c->has, t->id) != 0;
}

static enum status use(void *arg, const struct store_template *t, const void *model,
                       size_t len, struct errinfo *why)
{
    struct caller *c = arg;
    struct face f = {0};

    assert_int_equal(store_template_decode(c->store, t, model, len, tempdb_work, &f, why),
                     ST_OK);
    assert_int_equal(f.surface.mesh.nv, t->points);
    face_free(&f);
    memcpy(c->got[c->used++], t->id, sizeof t->id);
    return c->fail != ST_OK ? errinfo_set(why, c->fail, "not this one") : ST_OK;
}

static struct store_template t[3]; /* two of alice, one of bob */

static struct store *make(void)
{
    struct store *s = tempdb_fresh();

    tempdb_enroll(s, "alice", "left", &tempdb_face[0], &t[0]);
    tempdb_enroll(s, "alice", "right", &tempdb_face[1], &t[1]);
    tempdb_enroll(s, "bob", "", &tempdb_face[2], &t[2]);
    reads = writes = 0;
    return s;
}

static void test_admit(void **state)
{
    struct store *s = make();
    struct caller c = {.store = s};
    struct store_admit what = {
        .subject = "alice", .listed = listed, .wanted = wanted, .use = use, .arg = &c};
    struct store_admission a;

    (void)state;
    must(store_admit(s, &what, &a, &e));
    assert_transactions(1, 0);
    assert_string_equal(a.subject.id, "alice");
    assert_int_equal(a.subject.templates, 2);
    assert_false(a.subject.expired || a.subject.disabled);
    assert_string_equal(a.attempts.subject, "alice");
    assert_int_equal(a.attempts.failures, 0);
    assert_int_equal(a.calibration, 0);
    assert_int_equal(a.n, 2);
    assert_memory_equal(&a.t[0], &t[0], sizeof t[0]);
    assert_memory_equal(&a.t[1], &t[1], sizeof t[1]);
    assert_int_equal(c.listed, 1);
    assert_int_equal(c.used, 2);
    assert_string_equal(c.got[0], t[0].id);
    assert_string_equal(c.got[1], t[1].id);
    free(a.t);

    c = (struct caller){.store = s, .has = t[0].id};
    must(store_admit(s, &what, &a, &e));
    assert_int_equal(c.used, 1);
    assert_string_equal(c.got[0], t[1].id);
    free(a.t);

    /* One template, and its subject. */
    c = (struct caller){.store = s};
    what.subject = NULL;
    what.template_id = t[2].id;
    must(store_admit(s, &what, &a, &e));
    assert_string_equal(a.subject.id, "bob");
    assert_int_equal(a.n, 1);
    assert_memory_equal(&a.t[0], &t[2], sizeof t[2]);
    assert_int_equal(c.used, 1);
    free(a.t);

    /* Without callbacks: the lists alone. */
    what = (struct store_admit){.subject = "bob"};
    must(store_admit(s, &what, &a, &e));
    assert_int_equal(a.n, 1);
    free(a.t);
    store_close(s);
}

/* A callback's status ends the read, and nothing is left to be freed. */
static void test_ended(void **state)
{
    struct store *s = make();
    struct caller c = {.store = s, .end = true};
    struct store_admit what = {
        .subject = "alice", .listed = listed, .wanted = wanted, .use = use, .arg = &c};
    struct store_admission a;

    (void)state;
    fails(store_admit(s, &what, &a, &e), ST_EHELD);
    assert_string_equal(e.msg, "no more");
    assert_null(a.t);
    assert_int_equal(c.used, 0);
    c = (struct caller){.store = s, .fail = ST_EVERSION};
    fails(store_admit(s, &what, &a, &e), ST_EVERSION);
    assert_null(a.t);
    assert_int_equal(c.used, 1);
    what.subject = "nobody";
    fails(store_admit(s, &what, &a, &e), ST_ENOTFOUND);
    what.subject = "no body";
    fails(store_admit(s, &what, &a, &e), ST_EINVAL);
    what.subject = NULL;
    what.template_id = "00000000000000000000000000000000";
    fails(store_admit(s, &what, &a, &e), ST_ENOTFOUND);
    must(tempdb_erase(s, "test", "bob", &e));
    what.template_id = t[2].id;
    fails(store_admit(s, &what, &a, &e), ST_ENOTFOUND);
    store_close(s);
}

static void test_state(void **state)
{
    struct store *s = make();
    struct store_admit what = {.subject = "alice", .token = "test"};
    struct store_admission a;
    struct store_calibration k = {
        .fmr = 0.001, .low = -1e3, .high = 1e3, .table = store_model(s)->calibration};

    (void)state;
    tempdb_expire(s, "alice");
    must(tempdb_settle(s, "alice", STORE_SETTLE_FAILED, &e));
    must(store_calibration_add(s, "test", &k, &e));
    reads = writes = 0;
    must(store_admit(s, &what, &a, &e));
    assert_transactions(1, 0);
    assert_true(a.subject.expired);
    assert_int_equal(a.attempts.failures, 1);
    assert_in_range(a.attempts.age_ms, 0, 60000);
    assert_int_equal(a.calibration, 1);
    assert_int_equal(a.k.version, 1);
    assert_true(a.k.fmr == k.fmr);
    free(a.t);
    /* A caller that has this calibration does not get it again. */
    what.calibration = 1;
    must(store_admit(s, &what, &a, &e));
    assert_int_equal(a.calibration, 1);
    assert_int_equal(a.k.version, 0);
    free(a.t);
    /* The clock was set back: the last failure is now, for good. */
    tempdb_sql("UPDATE attempts SET at_ms = at_ms + 1000000000");
    reads = writes = 0;
    must(store_admit(s, &what, &a, &e));
    assert_transactions(1, 1);
    assert_int_equal(a.attempts.age_ms, 0);
    free(a.t);
    must(store_admit(s, &what, &a, &e));
    assert_transactions(1, 0);
    free(a.t);
    /* Also where the caller ends the reading: its lock-out would never end. */
    tempdb_sql("UPDATE attempts SET at_ms = at_ms + 1000000000");
    what.listed = listed;
    what.arg = &(struct caller){.end = true};
    fails(store_admit(s, &what, &a, &e), ST_EHELD);
    assert_string_equal(e.msg, "no more");
    assert_null(a.t);
    assert_transactions(1, 1);
    fails(store_admit(s, &what, &a, &e), ST_EHELD);
    assert_transactions(1, 0);
    what.listed = NULL;
    /* By a damaged calibration nobody may decide. */
    tempdb_sql("UPDATE calibrations SET threshold = threshold + 1");
    what.calibration = 0;
    fails(store_admit(s, &what, &a, &e), ST_ECORRUPT);
    store_close(s);
}

static bool few(void *arg, const struct store_attempts *now)
{
    unsigned *failures = arg;

    *failures = now->failures;
    return now->failures < 2;
}

static struct store_audit_entry last_event(struct store *s)
{
    static const enum log_name accesses = LOG_ACCESSES;
    const struct store_audit_filter last = {
        .log = &accesses, .wanted = {.newest = true, .limit = 1}, .names = true};
    struct store_audit_entry *list, one;
    size_t n;

    must(store_audit_list(s, &last, &list, &n, &e));
    assert_int_equal(n, 1);
    one = list[0];
    free(list);
    return one;
}

static void test_settle(void **state)
{
    struct store *s = make();
    struct store_subject alice;
    unsigned failures = 9;
    struct store_settle what = {.subject = &alice,
                                .as = STORE_SETTLE_FAILED,
                                .actor = "test",
                                .kind = "verify",
                                .template_id = t[0].id,
                                .outcome = "no_match",
                                .may = few,
                                .arg = &failures};
    struct store_settled out;
    uint64_t seq;

    (void)state;
    tempdb_sql("UPDATE subjects SET seen = '2020-01-01T00:00:00.000Z'");
    must(store_subject_get(s, "alice", &alice, &e));
    reads = writes = 0;
    for (unsigned i = 0; i < 2; i++) {
        must(store_settle(s, &what, &out, &e));
        assert_transactions(0, 1);
        assert_true(out.may);
        assert_int_equal(failures, i);
    }
    assert_string_equal(last_event(s).entry.outcome, "no_match");
    assert_string_equal(last_event(s).subject, "alice");
    assert_string_equal(last_event(s).entry.actor, "test");
    seq = last_event(s).entry.seq;
    assert_int_equal(tempdb_count("subjects WHERE seen > '2026'"), 1);
    /* No more: and nothing is written. */
    must(store_settle(s, &what, &out, &e));
    assert_false(out.may);
    assert_int_equal(last_event(s).entry.seq, seq);
    assert_int_equal(tempdb_attempts(s, "alice").failures, 2);
    what.may = NULL;
    what.as = STORE_SETTLE_UNCOUNTED;
    must(store_settle(s, &what, &out, &e));
    assert_int_equal(tempdb_attempts(s, "alice").failures, 2);
    assert_int_equal(last_event(s).entry.seq, seq + 1);
    what.as = STORE_SETTLE_PASSED;
    what.outcome = "match";
    must(store_settle(s, &what, &out, &e));
    assert_int_equal(tempdb_attempts(s, "alice").failures, 0);
    assert_string_equal(last_event(s).entry.outcome, "match");
    must(store_verify(s, NULL, NULL, &e));
    /* A subject that was seen just now is not written again. */
    must(store_subject_get(s, "alice", &alice, &e));
    tempdb_sql("UPDATE subjects SET seen = '2020-01-01T00:00:00.000Z'");
    must(store_settle(s, &what, &out, &e));
    assert_int_equal(tempdb_count("subjects WHERE seen > '2026'"), 0);
    store_close(s);
}

/* Without an entry in the access log nothing is counted, and nothing is answered. */
static void test_no_event(void **state)
{
    struct store *s = make();
    struct store_subject bob;
    struct store_settle what = {.subject = &bob,
                                .as = STORE_SETTLE_FAILED,
                                .actor = "test",
                                .kind = "verify",
                                .template_id = "",
                                .outcome = "no_match"};
    struct store_settled out;

    (void)state;
    must(store_subject_get(s, "bob", &bob, &e));
    must(store_settle(s, &what, &out, &e));
    tempdb_sql("UPDATE access_log SET mac = zeroblob(32)");
    fails(store_settle(s, &what, &out, &e), ST_ECORRUPT);
    assert_int_equal(tempdb_attempts(s, "bob").failures, 1);
    tempdb_sql("DELETE FROM access_log");
    must(tempdb_erase(s, "test", "bob", &e));
    fails(store_settle(s, &what, &out, &e), ST_ENOTFOUND);
    store_close(s);
}

static char digest[2][65]; /* of points as they were read */

/* A match by a probe: is it a new scan? */
static bool replayed(struct store *s, const char *who, const char *read, const char *used)
{
    struct store_subject one;
    struct store_probe probe = {.read = read};
    struct store_settled out = {.may = false};
    const struct store_settle what = {.subject = &one,
                                      .as = STORE_SETTLE_PASSED,
                                      .actor = "test",
                                      .kind = "verify",
                                      .template_id = "",
                                      .outcome = "match",
                                      .probe = &probe};
    uint32_t before;

    (void)snprintf(probe.used, sizeof probe.used, "%s", used);
    must(store_subject_get(s, who, &one, &e));
    before = tempdb_attempts(s, who).failures;
    must(store_settle(s, &what, &out, &e));
    assert_true(out.may);
    assert_string_equal(last_event(s).entry.outcome, out.replayed ? "replayed" : "match");
    assert_int_equal(tempdb_attempts(s, who).failures, out.replayed ? before + 1 : 0);
    return out.replayed;
}

static void test_replayed(void **state)
{
    struct store *s = make();
    struct store_template carol;
    bool created;

    (void)state;
    for (int i = 0; i < 2; i++)
        memset(digest[i], 'a' + i, 64);
    must(store_enroll(
        s,
        &(struct store_enroll){
            .actor = "test",
            .subject = "carol",
            .label = "",
            .sample = &(struct store_sample){.face = &tempdb_face[2], .read = digest[0]},
            .n = 1},
        &carol, &created, &e));
    /* The cloud of a template, as it was used and as it was read; of this subject alone. */
    assert_true(replayed(s, "alice", digest[1], t[0].digest));
    assert_true(replayed(s, "alice", digest[1], t[1].digest));
    assert_false(replayed(s, "alice", digest[1], t[2].digest));
    assert_true(replayed(s, "carol", digest[0], ""));
    assert_false(replayed(s, "bob", digest[0], ""));
    /* A probe is not remembered. */
    assert_false(replayed(s, "alice", digest[1], ""));
    assert_false(replayed(s, "alice", digest[1], ""));
    /* It ends with the template, and with the subject. */
    must(store_template_delete(s, "test", carol.id, &e));
    assert_false(replayed(s, "carol", digest[0], carol.digest));
    must(store_verify(s, NULL, NULL, &e));
    must(tempdb_erase(s, "test", "alice", &e));
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t[0]);
    assert_true(replayed(s, "alice", digest[1], t[0].digest));
    assert_false(replayed(s, "alice", digest[1], t[1].digest));
    store_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_admit),    cmocka_unit_test(test_ended),
        cmocka_unit_test(test_state),    cmocka_unit_test(test_settle),
        cmocka_unit_test(test_no_event), cmocka_unit_test(test_replayed),
    };

    return cmocka_run_group_tests(tests, tempdb_begin_faces, tempdb_end_faces);
}
