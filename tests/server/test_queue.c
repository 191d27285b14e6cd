/* The queue: senders take turns, a full queue refuses those who have most waiting, one worker
 * stays free of large requests, and one for senders that have nothing running, and what waits can
 * be dropped. */
#include <pthread.h>
#include <semaphore.h>
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

#define MOST 64

static struct app app;
static struct request request[MOST];
static int order[MOST]; /* in which they were run */
static bool on_kept[MOST];
static atomic_int ran, runs;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static sem_t gate; /* run() waits for it, but for the requests from `held` on */
static atomic_int held;

static void run(struct worker *w, struct request *r)
{
    (void)atomic_fetch_add(&runs, 1);
    while (r - request < atomic_load(&held) && sem_wait(&gate) != 0)
        ;
    (void)pthread_mutex_lock(&lock);
    on_kept[r - request] = w->kept;
    order[atomic_load(&ran)] = (int)(r - request);
    (void)atomic_fetch_add(&ran, 1);
    (void)pthread_mutex_unlock(&lock);
}

/* So many more requests come to their end. */
static void let(int n)
{
    while (n-- > 0)
        (void)sem_post(&gate);
}

static void wait_for(const atomic_int *what, int n)
{
    const struct timespec pause = {0, 1000 * 1000};

    for (int i = 0; i < 20000 && atomic_load(what) < n; i++)
        (void)nanosleep(&pause, NULL);
    assert_int_equal(atomic_load(what), n);
}

static struct queue *start_idle(unsigned workers, unsigned limit)
{
    struct queue *q;

    atomic_store(&ran, 0);
    atomic_store(&runs, 0);
    atomic_store(&held, MOST);
    assert_int_equal(sem_init(&gate, 0, 0), 0);
    assert_int_equal(queue_start(&app, workers, limit, run, &q), ST_OK);
    return q;
}

/* A queue whose workers wait at the gate, each with one of the first requests. */
static struct queue *start(unsigned workers, unsigned limit)
{
    struct queue *q = start_idle(workers, limit);

    for (unsigned i = 0; i < workers; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 99));
    wait_for(&runs, (int)workers);
    return q;
}

/* What waits still comes to its end. */
static void finish(struct queue *q)
{
    struct queue_state s;

    let(MOST);
    queue_stop(q);
    assert_ptr_equal(queue_push(q, &request[1], QUEUE_SMALL, 1), &request[1]);
    queue_look(q, &s);
    assert_int_equal(s.waiting, 0);
    assert_int_equal(s.running, 0);
    assert_int_equal(s.served, atomic_load(&ran));
    queue_free(q);
    (void)sem_destroy(&gate);
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
    finish(q);
    assert_memory_equal(order, wanted, sizeof wanted);
}

/* Who comes later is not before those who have waited, nor behind for what tokens were checked. */
static void test_later(void **state)
{
    static const int wanted[] = {0, 4, 5, 6, 7, 8, 9, 1, 2, 10, 3, 11};
    struct queue *q = start(1, MOST);

    (void)state;
    for (int i = 1; i <= 3; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 1));
    for (int i = 4; i <= 9; i++)
        assert_null(queue_push(q, &request[i], QUEUE_TOKEN, 4));
    let(7);
    wait_for(&runs, 8); /* request 1 runs */
    assert_null(queue_push(q, &request[10], QUEUE_SMALL, 5));
    assert_null(queue_push(q, &request[11], QUEUE_SMALL, 5));
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
    finish(q);
    assert_int_equal(atomic_load(&ran), 4);
}

/* The others have large ones to do: the one that is kept does what is small, and waits else. */
static void test_kept(void **state)
{
    const struct timespec wiped = {0, 500 * 1000 * 1000};
    struct queue *q = start_idle(3, MOST);
    struct queue_state s;

    (void)state;
    for (int i = 0; i < 4; i++)
        assert_null(queue_push(q, &request[i], QUEUE_LARGE, 1));
    wait_for(&runs, 2);
    atomic_store(&held, 4);
    for (int i = 4; i < 10; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 1));
    wait_for(&ran, 6); /* while two large ones wait at the gate */
    for (int i = 4; i < 10; i++) {
        assert_int_equal(order[i - 4], i);
        assert_true(on_kept[i]);
    }
    queue_look(q, &s);
    assert_int_equal(s.waiting, 2);
    let(4);
    wait_for(&ran, 10);
    for (int i = 0; i < 4; i++)
        assert_false(on_kept[i]);
    (void)nanosleep(&wiped, NULL); /* now each sleeps until it is woken */
    for (int i = 10; i < 20; i++) {
        assert_null(
            queue_push(q, &request[i], i % 3 == 0 ? QUEUE_LARGE : QUEUE_SMALL, 1));
        wait_for(&ran, i + 1);
        if (i % 3 == 0)
            (void)nanosleep(&wiped, NULL);
    }
    finish(q);
    q = start(1, MOST); /* the only one takes all */
    assert_null(queue_push(q, &request[1], QUEUE_LARGE, 1));
    let(2);
    wait_for(&ran, 2);
    assert_false(on_kept[1]);
    finish(q);
}

/* Pushes what one sender wants at once, and waits until so many run in all. */
static void push(struct queue *q, int from, int n, uint64_t sender, int all)
{
    for (int i = from; i < from + n; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, sender));
    wait_for(&runs, all);
}

static void assert_waiting(struct queue *q, unsigned n)
{
    const struct timespec little = {0, 20 * 1000 * 1000};
    struct queue_state s;

    (void)nanosleep(&little, NULL);
    queue_look(q, &s);
    assert_int_equal(s.waiting, n);
}

/* The last free worker is for who has nothing running, as long as there is anybody else. */
static void test_last_free(void **state)
{
    struct queue *q = start_idle(4, MOST);

    (void)state;
    push(q, 0, 4, 1, 4); /* alone: all of them */
    let(4);
    wait_for(&ran, 4);
    push(q, 4, 1, 2, 5);
    push(q, 5, 3, 1, 7); /* two of three */
    assert_waiting(q, 1);
    assert_null(queue_push(q, &request[8], QUEUE_TOKEN, 1)); /* takes no time */
    wait_for(&runs, 8);
    finish(q);

    q = start_idle(3, MOST);
    push(q, 0, 1, 1, 1);
    push(q, 1, 1, 2, 2);
    push(q, 2, 2, 1, 2); /* wait, though a worker is free */
    assert_waiting(q, 2);
    push(q, 4, 1, 3, 3); /* for this one */
    finish(q);

    q = start_idle(3, MOST);
    assert_null(queue_push(q, &request[0], QUEUE_TOKEN, 2)); /* is nobody who waits */
    wait_for(&runs, 1);
    push(q, 1, 2, 1, 3);
    finish(q);
}

static double clock_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

/* It stays free for 200 ms after the others' last request, and no longer. */
static void test_about(void **state)
{
    const struct timespec wiped = {0, 500 * 1000 * 1000};
    struct queue *q = start_idle(2, MOST);
    double ended;

    (void)state;
    push(q, 0, 1, 2, 1);
    ended = clock_ms();
    let(1);
    wait_for(&ran, 1);
    push(q, 1, 1, 1, 2);
    let(1);
    wait_for(&ran, 2);
    push(q, 2, 2, 1, 4);
    assert_true(clock_ms() - ended >= 200);
    let(2);
    wait_for(&ran, 4);
    ended = clock_ms();
    for (int i = 0; i < 20; i++) { /* alone by now: at once */
        push(q, 4 + 2 * i, 2, 1, 6 + 2 * i);
        let(2);
        wait_for(&ran, 6 + 2 * i);
    }
    assert_true(clock_ms() - ended < 20 * 200);
    (void)nanosleep(&wiped, NULL); /* now each sleeps until it is woken */
    push(q, 44, 1, 2, 45);
    let(1);
    wait_for(&ran, 45);
    push(q, 45, 2, 1, 47); /* the second by a worker that slept all the while */
    finish(q);
}

static void *stop(void *q)
{
    queue_stop(q);
    return NULL;
}

/* Nothing is left to anybody: only this worker can take it. */
static void test_closed(void **state)
{
    struct queue *q = start_idle(3, MOST);
    pthread_t thread;

    (void)state;
    push(q, 0, 1, 1, 1);
    push(q, 1, 1, 2, 2);
    assert_null(queue_push(q, &request[2], QUEUE_LARGE, 1));
    assert_waiting(q, 1);
    assert_int_equal(pthread_create(&thread, NULL, stop, q), 0);
    wait_for(&runs, 3);
    let(3);
    assert_int_equal(pthread_join(thread, NULL), 0);
    finish(q);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_turns),     cmocka_unit_test(test_later),
        cmocka_unit_test(test_full),      cmocka_unit_test(test_kept),
        cmocka_unit_test(test_last_free), cmocka_unit_test(test_about),
        cmocka_unit_test(test_closed),
    };

    return cmocka_run_group_tests_name("queue", tests, NULL, NULL);
}
