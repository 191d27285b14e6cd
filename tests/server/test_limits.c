/* Rate limit and lock-out: failed authentication by address, with a clock of the test's own, and a
 * subject's failed verifications by their number and age. */
#include <pthread.h>
#include <sodium.h>

#include "options.h"
#include "store.h"
#include "throttle.h"
#include "unit.h"

#define S 1000.0 /* ms */

/* ---- tokens */

enum { A = 1, B = 2 }; /* addresses */

TEST(test_wrong)
{
    struct throttle *t = throttle_new(10, 60000);
    double now = 5 * S;

    assert_non_null(t);
    for (int i = 0; i < 10; i++) {
        assert_int_equal(throttle_wait(t, A, "x", now), 0);
        throttle_note(t, A, "x", false, now);
    }
    assert_int_equal(throttle_wait(t, A, "x", now), 6); /* 10 a minute */
    assert_int_equal(throttle_wait(t, B, "x", now), 0);
    assert_int_equal(throttle_wait(t, A, "x", now + 2.5 * S), 4);
    assert_int_equal(throttle_wait(t, A, "x", now + 5.9 * S), 1);
    assert_int_equal(throttle_wait(t, A, "x", now + 6.1 * S), 0);
    now += 6.1 * S;
    throttle_note(t, A, "x", false, now);
    assert_int_equal(throttle_wait(t, A, "x", now), 6);
    for (int i = 0; i < 20; i++) /* requests that passed the check before count too */
        throttle_note(t, A, "x", false, now);
    assert_int_equal(throttle_wait(t, A, "x", now), 126);
    assert_int_equal(throttle_wait(t, A, "x", now + 127 * S), 0);
    throttle_free(t);
    throttle_free(NULL);
}

TEST(test_good)
{
    struct throttle *t = throttle_new(1, 60000);

    assert_non_null(t);
    throttle_note(t, A, "mine", true, 0);
    throttle_note(t, A, "x", false, 0);
    throttle_note(t, B, "x", false, 0);
    assert_int_equal(throttle_wait(t, A, "theirs", 0), 60);
    assert_int_equal(throttle_wait(t, A, "mine", 0), 0);
    assert_int_equal(throttle_wait(t, B, "mine", 0), 60); /* was good from a only */
    throttle_note(t, A, "mine", false, 0);                /* revoked */
    assert_int_equal(throttle_wait(t, A, "mine", 0), 120);
    throttle_free(t);
}

/* More addresses than the table has room for: the one with the most failures stays. */
TEST(test_room)
{
    struct throttle *t = throttle_new(10, 60000);

    assert_non_null(t);
    for (int i = 0; i < 20; i++)
        throttle_note(t, A, "x", false, 0);
    for (uint64_t i = 1; i <= 100000; i++)
        throttle_note(t, A + i, "x", false, 0);
    assert_int_equal(throttle_wait(t, A, "x", 0), 66);
    throttle_free(t);
}

static void *send_wrong(void *arg)
{

    for (int i = 0; i < 1000; i++) {
        (void)throttle_wait(arg, A, "x", 0);
        throttle_note(arg, A, "x", false, 0);
    }
    return NULL;
}

TEST(test_threads)
{
    struct throttle *t = throttle_new(60, 60000);
    pthread_t thread[4];

    assert_non_null(t);
    for (int i = 0; i < 4; i++)
        assert_int_equal(pthread_create(&thread[i], NULL, send_wrong, t), 0);
    for (int i = 0; i < 4; i++)
        assert_int_equal(pthread_join(thread[i], NULL), 0);
    assert_int_equal(throttle_wait(t, A, "x", 0), 4000 + 1 - 60);
    throttle_free(t);
}

/* ---- attempts */

TEST(test_attempts)
{
    static const struct {
        uint32_t failures;
        int64_t age_s, wait_s;
    } want[] = {
        {0, 0, 0},      {1, 0, 0},           {2, 0, 0},
        {3, 0, 30},     {3, 29, 1},          {3, 30, 0},
        {3, 1000, 0},   {4, 0, 60},          {5, 20, 100},
        {6, 0, 240},    {14, 0, 61440},      {15, 0, OPTIONS_WAIT_MAX},
        {16, 0, 86400}, {1000000, 0, 86400}, {1000000, 86400, 0},
    };
    struct store_limits a = {3, 30, 5};
    enum store_wait why;

    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        const struct store_attempts own = {.failures = want[i].failures,
                                           .age_ms = want[i].age_s * 1000};

        assert_int_equal(store_attempts_wait_ms(&a, &own, &why), want[i].wait_s * 1000);
        assert_int_equal(why, want[i].wait_s > 0 ? STORE_WAIT_OWN : STORE_WAIT_NONE);
    }
    a.failures = 0;
    assert_int_equal(store_attempts_wait_ms(&a,
                                            &(struct store_attempts){.token = "a",
                                                                     .failures = 1000,
                                                                     .others = 1000,
                                                                     .tried = 1000},
                                            &why),
                     0);
}

/* Failures of other tokens, and for other subjects. */
TEST(test_others)
{
    struct store_limits a = {3, 30, 5};
    struct store_attempts now = {.token = "a", .others = 2};
    enum store_wait why;

    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 0);
    now.others = 3;
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 30000);
    assert_int_equal(why, STORE_WAIT_OTHERS);
    now.others = 1000; /* one token keeps others out for no longer */
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 60000);
    now.others_age_ms = 59999;
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 1);
    /* for a token that has failed itself, the failures of all tokens add up, for an hour at most */
    now = (struct store_attempts){.token = "a", .failures = 1, .others = 2};
    now.age_ms = 1000;
    now.others_age_ms = 20000;
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 29000);
    assert_int_equal(why, STORE_WAIT_OTHERS);
    now.others = 5;
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 239000);
    now.others = UINT32_MAX;
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 3599000);
    now.failures = 14; /* the longest counts */
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 61439000);
    assert_int_equal(why, STORE_WAIT_OWN);
    now = (struct store_attempts){.token = "a", .tried = 4};
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 0);
    now.tried = 5;
    now.tried_age_ms = 1000;
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), STORE_TRIED_MS / 5 - 1000);
    assert_int_equal(why, STORE_WAIT_SUBJECTS);
    now.failures = 1; /* it is one of those */
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 0);
    now.age_ms = STORE_TRIED_MS;
    assert_int_equal(why, STORE_WAIT_NONE);
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), STORE_TRIED_MS / 5 - 1000);
    now.failures = 0;
    now.token[0] = '\0'; /* without tokens it is everybody */
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 0);
    a.subjects = 0;
    now = (struct store_attempts){.token = "a", .tried = 100000};
    assert_int_equal(store_attempts_wait_ms(&a, &now, &why), 0);
}

TEST(test_suspicion)
{
    struct store_attempts was = {.failures = 0};

    assert_int_equal(store_attempts_suspicion(&was, false), 0);
    assert_int_equal(store_attempts_suspicion(&was, true), 3);
    was =
        (struct store_attempts){.failures = 2, .suspicion = 6, .age_ms = STORE_RETRY_MS};
    assert_int_equal(store_attempts_suspicion(&was, false), 4);
    assert_int_equal(store_attempts_suspicion(&was, true), 9);
    was.age_ms++; /* no match followed */
    assert_int_equal(store_attempts_suspicion(&was, false), 10);
    assert_int_equal(store_attempts_suspicion(&was, true), 15);
    was.failures = 0; /* one did */
    assert_int_equal(store_attempts_suspicion(&was, true), 9);
    was.suspicion = 1;
    assert_int_equal(store_attempts_suspicion(&was, false), 0);
    was.suspicion = 1000000;
    assert_int_equal(store_attempts_suspicion(&was, true), 1000000);
}

BEFORE_ALL(set_up)
{
    assert_false(sodium_init() < 0);
}
