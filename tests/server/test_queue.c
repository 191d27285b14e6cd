/* The queue: senders take turns, a full queue refuses those who have most waiting, one worker
 * stays free of large requests, and what waits can be dropped. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

#include "app.h"
#include "queue.h"
#include "request.h"
#include "worker.h"

#define MOST 32

static struct app app;
static struct request request[MOST];
static int order[MOST]; /* in which they were run */
static bool on_kept[MOST];
static atomic_int ran, runs;
static pthread_mutex_t gate; /* run() waits for it */

static void run(struct worker *w, struct request *r)
{
    (void)atomic_fetch_add(&runs, 1);
    (void)pthread_mutex_lock(&gate);
    on_kept[r - request] = w->kept;
    order[atomic_fetch_add(&ran, 1)] = (int)(r - request);
    (void)pthread_mutex_unlock(&gate);
}

static void wait_for(const atomic_int *what, int n)
{
    const struct timespec pause = {0, 1000 * 1000};

    for (int i = 0; i < 20000 && atomic_load(what) < n; i++)
        (void)nanosleep(&pause, NULL);
    assert_int_equal(atomic_load(what), n);
}

/* A queue whose workers wait at the gate, each with one of the first requests. */
static struct queue *start(unsigned workers, unsigned limit)
{
    struct queue *q;

    atomic_store(&ran, 0);
    atomic_store(&runs, 0);
    (void)pthread_mutex_init(&gate, NULL);
    (void)pthread_mutex_lock(&gate);
    assert_int_equal(queue_start(&app, workers, limit, run, &q), ST_OK);
    for (unsigned i = 0; i < workers; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 99));
    wait_for(&runs, (int)workers);
    return q;
}

static void finish(struct queue *q)
{
    queue_stop(q);
    queue_free(q);
    (void)pthread_mutex_destroy(&gate);
}

static void test_turns(void **state)
{
    static const struct {
        unsigned long sender;
        enum queue_kind kind;
    } pushed[] = {{1, QUEUE_SMALL}, {1, QUEUE_SMALL}, {1, QUEUE_LARGE}, {1, QUEUE_SMALL},
                  {2, QUEUE_SMALL}, {3, QUEUE_LARGE}, {2, QUEUE_SMALL}, {4, QUEUE_TOKEN}};
    static const int wanted[] = {0, 8, 1, 5, 6, 2, 7, 3, 4};
    struct queue *q = start(1, MOST);

    (void)state;
    for (int i = 0; i < 8; i++)
        assert_null(queue_push(q, &request[1 + i], pushed[i].kind, pushed[i].sender));
    (void)pthread_mutex_unlock(&gate);
    finish(q);
    assert_memory_equal(order, wanted, sizeof wanted);
}

static void test_full(void **state)
{
    struct queue *q = start(1, 4);
    struct queue_state s;

    (void)state;
    for (int i = 1; i <= 4; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 1));
    assert_ptr_equal(queue_push(q, &request[5], QUEUE_SMALL, 1), &request[5]);
    assert_ptr_equal(queue_push(q, &request[6], QUEUE_SMALL, 2), &request[4]);
    assert_ptr_equal(queue_push(q, &request[7], QUEUE_SMALL, 2), &request[3]);
    assert_ptr_equal(queue_push(q, &request[8], QUEUE_SMALL, 2), &request[8]);
    assert_false(queue_drop(q, &request[8]));
    assert_false(queue_drop(q, &request[0])); /* it runs */
    assert_true(queue_drop(q, &request[1]));
    assert_false(queue_drop(q, &request[1]));
    queue_look(q, &s);
    assert_int_equal(s.waiting, 3);
    assert_int_equal(s.running, 1);
    (void)pthread_mutex_unlock(&gate);
    wait_for(&ran, 4);
    finish(q);
    assert_int_equal(atomic_load(&ran), 4);
}

static void test_kept(void **state)
{
    struct queue *q = start(3, MOST);
    const int kept_was = 1;
    int on = 0;

    (void)state;
    for (int i = 3; i < 20; i++)
        assert_null(
            queue_push(q, &request[i], i % 2 == 0 ? QUEUE_LARGE : QUEUE_SMALL, 1));
    (void)pthread_mutex_unlock(&gate);
    wait_for(&ran, 20);
    for (int i = 0; i < 20; i++)
        if (i >= 3 && i % 2 == 0)
            assert_false(on_kept[i]);
        else
            on += on_kept[i];
    assert_true(on >= kept_was);
    for (int i = 20; i < 30; i++) { /* one at a time: nobody sleeps through it */
        assert_null(
            queue_push(q, &request[i], i % 3 == 0 ? QUEUE_LARGE : QUEUE_SMALL, 1));
        wait_for(&ran, i + 1);
    }
    finish(q);
    q = start(1, MOST); /* the only one takes all */
    assert_null(queue_push(q, &request[1], QUEUE_LARGE, 1));
    (void)pthread_mutex_unlock(&gate);
    wait_for(&ran, 2);
    assert_false(on_kept[1]);
    finish(q);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_turns),
        cmocka_unit_test(test_full),
        cmocka_unit_test(test_kept),
    };

    return cmocka_run_group_tests_name("queue", tests, NULL, NULL);
}
