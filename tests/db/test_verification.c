/* What a verification reads and writes, in one transaction each.  What is no new scan:
 * tests/box/http-replay.sh. */
/* link: -Wl,--wrap=sql_begin */
#include <math.h>

#include "errinfo.h"
#include "sql.h"
#include "tempdb.h"
#include "unit.h"

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

static enum status read(struct store *s, const struct store_snapshot_of *what,
                        struct store_snapshot *out)
{
    return store_snapshot_end(out, store_snapshot_begin(s, what, out, &e), &e);
}

TEST(test_snapshot)
{
    struct store *s = make();
    struct store_snapshot_of what = {.subject = "alice"};
    struct store_snapshot a;

    must(store_snapshot_begin(s, &what, &a, &e));
    assert_string_equal(a.subject.id, "alice");
    assert_int_equal(a.subject.templates, 2);
    assert_false(a.subject.expired || a.subject.disabled);
    assert_string_equal(a.attempts.subject, "alice");
    assert_int_equal(a.attempts.failures, 0);
    assert_int_equal(a.calibration, 0);
    assert_int_equal(a.n, 2);
    for (size_t i = 0; i < 2; i++) {
        struct surface_face *f = NULL;

        assert_memory_equal(&a.t[i], &t[i], sizeof t[i]);
        must(store_snapshot_face(&a, i, tempdb_work, &f, &e));
        assert_true(f->surface.mesh.nv == 0 && f->encoding.n > 0); /* the head */
        surface_face_free(f);
    }
    must(store_snapshot_end(&a, ST_OK, &e));
    assert_transactions(1, 0);
    store_snapshot_free(&a);

    /* One template, and its subject. */
    what = (struct store_snapshot_of){.template_id = t[2].id};
    assert_int_equal(read(s, &what, &a), ST_OK);
    assert_string_equal(a.subject.id, "bob");
    assert_int_equal(a.n, 1);
    assert_memory_equal(&a.t[0], &t[2], sizeof t[2]);
    store_snapshot_free(&a);

    /* None. */
    what = (struct store_snapshot_of){.subject = "nobody"};
    fails(read(s, &what, &a), ST_ENOTFOUND);
    store_snapshot_free(&a);
    must(tempdb_erase(s, "test", "bob", &e));
    what = (struct store_snapshot_of){.template_id = t[2].id};
    assert_int_equal(read(s, &what, &a), ST_ENOTFOUND);
    store_snapshot_free(&a);
    store_close(s);
}

TEST(test_state)
{
    struct store *s = make();
    struct store_snapshot_of what = {.subject = "alice", .token = "test"};
    struct store_snapshot a;
    struct store_calibration k = tempdb_calibration(1);

    tempdb_expire(s, "alice");
    must(tempdb_record(s, "alice", STORE_RECORD_FAILED, &e));
    must(store_calibration_add(s, "test", &k, &e));
    reads = writes = 0;
    assert_int_equal(read(s, &what, &a), ST_OK);
    assert_transactions(1, 0);
    assert_true(a.subject.expired);
    assert_int_equal(a.attempts.failures, 1);
    assert_in_range(a.attempts.age_ms, 0, 60000);
    assert_int_equal(a.calibration, 1);
    assert_int_equal(a.k.version, 1);
    assert_true(a.k.fmr == k.fmr);
    store_snapshot_free(&a);
    /* A caller that has this calibration does not get it again. */
    what.calibration = 1;
    assert_int_equal(read(s, &what, &a), ST_OK);
    assert_int_equal(a.calibration, 1);
    assert_int_equal(a.k.version, 0);
    store_snapshot_free(&a);
    /* The clock was set back: the last failure is now, for good. */
    tempdb_sql("UPDATE attempts SET at_ms = at_ms + 1000000000");
    reads = writes = 0;
    assert_int_equal(read(s, &what, &a), ST_OK);
    assert_transactions(1, 1);
    assert_int_equal(a.attempts.age_ms, 0);
    store_snapshot_free(&a);
    assert_int_equal(read(s, &what, &a), ST_OK);
    assert_transactions(1, 0);
    store_snapshot_free(&a);
    /* Also where the caller ends the reading: its lock-out would never end. */
    tempdb_sql("UPDATE attempts SET at_ms = at_ms + 1000000000");
    must(store_snapshot_begin(s, &what, &a, &e));
    fails(store_snapshot_end(&a, ST_EHELD, &e), ST_EHELD);
    store_snapshot_free(&a);
    assert_transactions(1, 1);
    assert_int_equal(read(s, &what, &a), ST_OK);
    store_snapshot_free(&a);
    assert_transactions(1, 0);
    /* By a damaged calibration nobody may decide. */
    tempdb_sql("UPDATE calibrations SET threshold = threshold + 1");
    what.calibration = 0;
    assert_int_equal(read(s, &what, &a), ST_ECORRUPT);
    store_snapshot_free(&a);
    store_close(s);
}

static struct store_audit_entry last_event(struct store *s)
{
    static const enum log_name accesses = LOG_ACCESSES;
    const struct store_audit_filter last = {
        .log = &accesses, .newest = true, .limit = 1, .names = true};
    struct store_audit_entry *list, one;
    size_t n;

    must(store_audit_list(s, &last, &list, &n, NULL, &e));
    assert_int_equal(n, 1);
    one = list[0];
    free(list);
    return one;
}

TEST(test_record)
{
    struct store *s = make();
    struct store_subject alice;
    const struct store_limits limits = {.failures = 2, .wait_s = 30};
    struct store_record what = {.subject = &alice,
                                .as = STORE_RECORD_FAILED,
                                .actor = "test",
                                .kind = "verify",
                                .template_id = t[0].id,
                                .outcome = "no_match",
                                .limits = &limits};
    struct store_recorded out;
    char until[UTC_TEXT], outcome[LOG_TEXT + 1];
    uint64_t seq;
    int64_t ms;

    tempdb_sql("UPDATE subjects SET seen = '2020-01-01T00:00:00.000Z'");
    must(store_subject_get(s, "", "alice", &alice, &e));
    reads = writes = 0;
    for (unsigned i = 0; i < 2; i++) {
        must(store_record_verification(s, &what, &out, &e));
        assert_transactions(0, 1);
        assert_int_equal(out.why, STORE_WAIT_NONE);
        assert_int_equal(out.now.failures, i);
        assert_int_equal(out.warnings, i == 1 ? 1U << STORE_LOCKED_OUT : 0);
    }
    assert_true(utc_read(last_event(s).entry.at, &ms));
    utc_print(ms + 30000, until); /* when it ends, for doors */
    (void)snprintf(outcome, sizeof outcome, "2 failures until %s", until);
    assert_string_equal(last_event(s).entry.outcome, outcome);
    assert_string_equal(last_event(s).subject, "alice");
    assert_string_equal(last_event(s).entry.actor, "test");
    seq = last_event(s).entry.seq;
    assert_int_equal(tempdb_count("subjects WHERE seen > '2026'"), 1);
    /* No more: and nothing is written. */
    must(store_record_verification(s, &what, &out, &e));
    assert_int_equal(out.why, STORE_WAIT_OWN);
    assert_in_range(out.wait_ms, 1, 30000);
    assert_int_equal(last_event(s).entry.seq, seq);
    assert_int_equal(tempdb_attempts(s, "test", "alice").failures, 2);
    what.limits = NULL;
    what.as = STORE_RECORD_UNCOUNTED;
    must(store_record_verification(s, &what, &out, &e));
    assert_int_equal(tempdb_attempts(s, "test", "alice").failures, 2);
    assert_int_equal(last_event(s).entry.seq, seq + 1);
    what.as = STORE_RECORD_PASSED;
    what.outcome = "match";
    must(store_record_verification(s, &what, &out, &e));
    assert_int_equal(tempdb_attempts(s, "test", "alice").failures, 0);
    assert_string_equal(last_event(s).entry.outcome, "match");
    must(store_verify(s, NULL, NULL, &e));
    /* A subject that was seen just now is not written again. */
    must(store_subject_get(s, "", "alice", &alice, &e));
    tempdb_sql("UPDATE subjects SET seen = '2020-01-01T00:00:00.000Z'");
    must(store_record_verification(s, &what, &out, &e));
    assert_int_equal(tempdb_count("subjects WHERE seen > '2026'"), 0);
    store_close(s);
}

/* Without an entry in the access log nothing is counted, and nothing is answered. */
TEST(test_no_event)
{
    struct store *s = make();
    struct store_subject bob;
    struct store_record what = {.subject = &bob,
                                .as = STORE_RECORD_FAILED,
                                .actor = "test",
                                .kind = "verify",
                                .template_id = "",
                                .outcome = "no_match"};
    struct store_recorded out;

    must(store_subject_get(s, "", "bob", &bob, &e));
    must(store_record_verification(s, &what, &out, &e));
    tempdb_sql("UPDATE access_log SET mac = zeroblob(32)");
    fails(store_record_verification(s, &what, &out, &e), ST_ECORRUPT);
    assert_int_equal(tempdb_attempts(s, "test", "bob").failures, 1);
    tempdb_sql("DELETE FROM access_log");
    must(tempdb_erase(s, "test", "bob", &e));
    fails(store_record_verification(s, &what, &out, &e), ST_ENOTFOUND);
    store_close(s);
}

/* Verified as it is known by now; when it was seen then. */
static char see(struct store *s)
{
    struct store_subject alice;
    struct store_record what = {.subject = &alice,
                                .actor = "",
                                .kind = "verify",
                                .template_id = "",
                                .outcome = "match"};
    struct store_recorded out;

    must(store_subject_get(s, "", "alice", &alice, &e));
    must(store_record_verification(s, &what, &out, &e));
    must(store_subject_get(s, "", "alice", &alice, &e));
    return alice.seen[0];
}

/* A time of last use that is old, or still to come, which is a mistake, is set; test_record: once a
 * minute.  Enrolling the same scan again counts too. */
TEST(test_seen)
{
    struct store *s = make();
    struct store_subject alice;
    bool created;

    must(store_subject_get(s, "", "alice", &alice, &e));
    assert_string_equal(alice.seen, t[1].created);
    tempdb_sql("UPDATE subjects SET seen = '1970-01-01T00:00:00.000Z'");
    assert_int_equal(see(s), '2');
    tempdb_sql("UPDATE subjects SET seen = '9026-01-01T00:00:00.000Z'");
    assert_int_equal(see(s), '2');
    tempdb_sql("UPDATE subjects SET seen = NULL");
    must(tempdb_store(s, "", "alice", "", &tempdb_face[0], &t[0], &created, &e));
    assert_false(created);
    must(store_subject_get(s, "", "alice", &alice, &e));
    assert_int_equal(alice.seen[0], '2');
    store_close(s);
}

static void assert_scans(const struct store_scans *is, const char *token, int64_t n,
                         int64_t unusable, int64_t noise_um, int64_t quality)
{
    assert_string_equal(is->token, token);
    assert_int_equal(is->n, n);
    assert_int_equal(is->unusable, unusable);
    assert_int_equal(is->noise_um, noise_um);
    assert_int_equal(is->quality, quality);
}

/* What a token sent on a day, of all daemons; no scan that was enrolled before; none that is not of a face. */
TEST(test_scans)
{
    const struct store_scan good = {.noise_mm = 0.25, .quality = 0.9},
                            poor = {.noise_mm = 1.5, .quality = 0.41234},
                            bad = {.unusable = true, .noise_mm = 9, .quality = 1},
                            wrong = {.noise_mm = (double)NAN, .quality = -1};
    struct store *s = make();
    struct store_subject alice;
    const struct store_probe probe = {.read = {NULL}};
    struct store_record what = {.subject = &alice,
                                .actor = "north",
                                .kind = "verify",
                                .template_id = "",
                                .outcome = "match",
                                .scan = &good};
    struct store_recorded out;
    struct store_scans *list;
    size_t n;

    must(store_subject_get(s, "", "alice", &alice, &e));
    reads = writes = 0;
    must(store_record_verification(s, &what, &out, &e));
    assert_transactions(0, 1);
    what.scan = &poor;
    must(store_record_verification(s, &what, &out, &e));
    what.probe = &probe;
    what.replayed = true;
    must(store_record_verification(s, &what, &out, &e));
    must(store_event_scan(s, "refused", "north", "alice", "no_face verify", &bad, &e));
    must(store_event_scan(s, "identify", "east", "", "no_match of 2", &good, &e));
    must(store_event_scan(s, "identify", "east", "", "no_match of 2", &wrong, &e));
    must(store_scans(s, &list, &n, &e));
    assert_int_equal(n, 2);
    assert_scans(&list[0], "east", 2, 0, 250, 900);
    assert_scans(&list[1], "north", 2, 1, 1750, 1312);
    free(list);
    /* Of another daemon, of another day; a row that is no number, or of no day. */
    tempdb_sql("INSERT INTO scans SELECT day, token, 9, 8, 0, 800, 8000 FROM scans "
               "WHERE token = 'east'");
    tempdb_sql("INSERT INTO scans VALUES ('2020-02-29', 'east', 0, 1, 1, 1, 1)");
    tempdb_sql("INSERT INTO scans SELECT day, 'west', 0, 9000000000000, 0, 0, 0 "
               "FROM scans WHERE token = 'north'");
    tempdb_sql("INSERT INTO scans VALUES ('9999-99-99', 'west', 0, 1, 1, 1, 1)");
    must(store_scans(s, &list, &n, &e));
    assert_int_equal(n, 2);
    assert_scans(&list[0], "east", 10, 0, 1050, 8900);
    free(list);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
}

/* Of old days nothing is left.  The erasure of a subject leaves the counts, which do not name it. */
TEST(test_days_trim)
{
    struct store *s = make();

    must(tempdb_record(s, "bob", STORE_RECORD_FAILED, &e));
    must(tempdb_erase(s, "test", "bob", &e));
    tempdb_sql("INSERT INTO scans VALUES ('2020-02-29', 'east', 0, 1, 1, 1, 1)");
    tempdb_sql("INSERT INTO days SELECT '2020-02-29', decision, bins, daemon FROM days");
    must(store_days_trim(s, &e));
    assert_int_equal(tempdb_count("scans"), 1);
    assert_int_equal(tempdb_count("scans WHERE day > '2026' AND n = 1"), 1);
    assert_int_equal(tempdb_count("days"), 1);
    must(store_days_trim(s, &e));
    assert_int_equal(tempdb_count("scans"), 1);
    store_close(s);
}
