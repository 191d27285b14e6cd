/* What a token may add within an hour: exactly, however many add at once and wherever. */
#include <pthread.h>

#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define HOUR_MS 3600000

static _Thread_local struct errinfo e;

static enum status add(struct store *s, const char *token, const char *subject,
                       struct store_allowance *a)
{
    struct store_subject one = {.reference = ""};

    (void)snprintf(one.id, sizeof one.id, "%s", subject);
    return store_subject_add(s, token, a, &one, &e);
}

/* n faces from the first on, as one form. */
static enum status enroll(struct store *s, const char *token, const char *subject,
                          size_t first, size_t n, struct store_allowance *a)
{
    struct store_sample sample[3];
    struct store_template t[3];
    bool created[3];
    const struct store_enroll what = {.actor = token,
                                      .subject = subject,
                                      .label = "",
                                      .sample = sample,
                                      .n = n,
                                      .allowance = a};

    for (size_t i = 0; i < n; i++)
        sample[i] = (struct store_sample){.face = &tempdb_face[first + i]};
    return store_enroll(s, &what, t, created, &e);
}

/* As if it were later by that much. */
static void pass(int64_t ms)
{
    char text[80];

    (void)snprintf(text, sizeof text, "UPDATE allowances SET at_ms = at_ms - %lld",
                   (long long)ms);
    tempdb_sql(text);
}

TEST(test_of_one)
{
    struct store *s = tempdb_fresh();
    struct store_allowance a = {.per_hour = 4}, none = {.per_hour = 0};
    struct store_template t;
    int64_t changes;

    must(add(s, "x", "anna", &a));
    fails(add(s, "x", "anna", &a), ST_EEXISTS); /* takes nothing */
    must(enroll(s, "x", "anna", 0, 1, &a));
    must(enroll(s, "x", "anna", 0, 1, &a)); /* is there already */
    must(enroll(s, "x", "bert", 0, 1, &a)); /* a subject with its first template is one */
    must(add(s, "x", "carl", &a));
    changes = tempdb_count("change_log");
    fails(add(s, "x", "dora", &a), ST_EDENIED);
    assert_string_equal(e.msg, "this token has added 4 templates and subjects within an "
                               "hour, which is its limit");
    assert_in_range(a.wait_ms, HOUR_MS / 4 - 60000, HOUR_MS / 4);
    fails(enroll(s, "x", "dora", 1, 1, &a), ST_EDENIED);
    fails(enroll(s, "x", "anna", 0, 2, &a), ST_EDENIED);
    assert_int_equal(tempdb_count("change_log"), changes);
    assert_int_equal(tempdb_count("subjects"), 3);
    assert_int_equal(tempdb_count("templates"), 2);
    must(enroll(s, "x", "anna", 0, 1, &a)); /* nothing would be stored */

    must(add(s, "y", "dora", &a)); /* another token has its own */
    must(add(s, "x", "emil", &none));
    tempdb_enroll(s, "emil", "", &tempdb_face[0], &t);
    store_close(s);

    s = tempdb_open(STORE_WRITE); /* another daemon, or the same after a restart */
    fails(add(s, "x", "fred", &a), ST_EDENIED);
    must(add(s, "y", "fred", &a));
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
}

TEST(test_comes_back)
{
    struct store *s = tempdb_fresh();
    struct store_allowance a = {.per_hour = 3};

    must(add(s, "x", "a", &a));
    must(add(s, "x", "b", &a));
    must(enroll(s, "x", "a", 0, 3, &a)); /* room for one: a form is taken whole */
    fails(add(s, "x", "c", &a), ST_EDENIED);
    assert_in_range(a.wait_ms, HOUR_MS - 60000, HOUR_MS); /* 5 of 3 */
    pass(HOUR_MS - 60000);
    fails(add(s, "x", "c", &a), ST_EDENIED);
    assert_in_range(a.wait_ms, 0, 60000);
    pass(a.wait_ms);
    must(add(s, "x", "c", &a));
    fails(add(s, "x", "d", &a), ST_EDENIED);
    assert_in_range(a.wait_ms, HOUR_MS / 3 - 60000, HOUR_MS / 3);
    pass(10 * (int64_t)HOUR_MS); /* never more than all of it */
    for (int i = 0; i < 3; i++)
        must(add(s, "x", (char[]){'d', (char)('0' + i), '\0'}, &a));
    fails(add(s, "x", "e", &a), ST_EDENIED);
    a.per_hour = 100; /* another limit: an hour's worth is an hour's worth */
    fails(add(s, "x", "e", &a), ST_EDENIED);
    assert_in_range(a.wait_ms, 1, HOUR_MS / 100);
    store_close(s);
}

/* Of the largest too all of them, and not one more. */
TEST(test_rounding)
{
    static const unsigned limit[] = {1, 7, 1000, 999999, 1000000};
    struct store *s = tempdb_fresh();

    for (size_t i = 0; i < sizeof limit / sizeof *limit; i++) {
        struct store_allowance a = {.per_hour = limit[i]};
        const int64_t one = INT64_C(3600000000) / limit[i];
        char text[200];

        (void)snprintf(text, sizeof text,
                       "DELETE FROM allowances; INSERT INTO allowances VALUES "
                       "('x', %lld, 4000000000000)",
                       (long long)((limit[i] - 1) * one));
        tempdb_sql(text);
        /* 4 * 10^12 ms are ahead: so it begins anew; with the time of now it does not */
        (void)snprintf(text, sizeof text, "s%zu", i);
        must(add(s, "x", text, &a));
        assert_int_equal(a.used_us, 0);
        (void)snprintf(text, sizeof text,
                       "UPDATE allowances SET used_us = %lld, at_ms = at_ms + 4000",
                       (long long)((limit[i] - 1) * one));
        tempdb_sql(text); /* another daemon's clock is ahead a little */
        (void)snprintf(text, sizeof text, "t%zu", i);
        must(add(s, "x", text, &a));
        assert_int_equal(a.used_us, (limit[i] - 1) * one);
        (void)snprintf(text, sizeof text, "UPDATE allowances SET at_ms = at_ms + 4000");
        tempdb_sql(text);
        (void)snprintf(text, sizeof text, "u%zu", i);
        fails(add(s, "x", text, &a), ST_EDENIED);
        assert_in_range(a.wait_ms, 1, (one + 999) / 1000);
    }
    store_close(s);
}

TEST(test_damaged)
{
    static const char *const bad[] = {"used_us = -1", "used_us = 86400000001",
                                      "at_ms = -1"};
    struct store *s = tempdb_fresh();
    struct store_allowance a = {.per_hour = 3};

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[200];

        tempdb_sql("DELETE FROM allowances");
        must(add(s, "x", (char[]){'a', (char)('0' + i), '\0'}, &a));
        (void)snprintf(text, sizeof text, "UPDATE allowances SET %s", bad[i]);
        tempdb_sql(text);
        fails(add(s, "x", "b", &a), ST_ECORRUPT);
        assert_string_equal(e.msg, "allowance of token x: its row is damaged");
    }
    store_close(s);
}

#define THREADS 12
#define ROUNDS  20

struct adder {
    struct store *store;
    char subject[16];
    bool scan;
    pthread_t thread;
    enum status st;
};

static void *run(void *arg)
{
    struct store_allowance a = {.per_hour = 5};
    struct adder *x = arg;

    x->st = x->scan ? enroll(x->store, "x", x->subject, 0, 1, &a)
                    : add(x->store, "x", x->subject, &a);
    return NULL;
}

/* Two daemons, each with several at once. */
TEST(test_at_once)
{
    struct store *s[2] = {tempdb_fresh(), tempdb_open(STORE_WRITE)};
    struct adder x[THREADS];

    for (int round = 0; round < ROUNDS; round++) {
        int added = 0;

        tempdb_sql("DELETE FROM allowances");
        for (int i = 0; i < THREADS; i++) {
            x[i] = (struct adder){.store = s[i % 2], .scan = i % 3 == 0};
            (void)snprintf(x[i].subject, sizeof x[i].subject, "s%d-%d", round, i);
            assert_int_equal(pthread_create(&x[i].thread, NULL, run, &x[i]), 0);
        }
        for (int i = 0; i < THREADS; i++) {
            assert_int_equal(pthread_join(x[i].thread, NULL), 0);
            assert_true(x[i].st == ST_OK || x[i].st == ST_EDENIED);
            added += x[i].st == ST_OK;
        }
        assert_int_equal(added, 5);
        assert_int_equal(tempdb_count("subjects"), 5 * (round + 1));
    }
    store_close(s[0]);
    store_close(s[1]);
}
