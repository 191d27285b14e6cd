/* The queue: senders take turns by the time that their requests take, a full queue refuses those
 * who have most waiting, one worker stays free of heavy requests, and what waits can be dropped. */
#include <pthread.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <time.h>

#include "app.h"
#include "queue.h"
#include "request.h"
#include "unit.h"
#include "worker.h"

#define MOST 64

static struct app app;
static struct request request[MOST];
static int order[MOST]; /* in which they were run */
static atomic_int ran, runs;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static sem_t gate; /* run() waits for it, but for the requests from `held` on */
static atomic_int held;
static int slow_ms[MOST];

static void pause_ms(int ms)
{
    const struct timespec t = {0, ms * 1000000L};

    (void)nanosleep(&t, NULL);
}

/* Takes so much of the processor's time. */
static void work_ms(int ms)
{
    struct timespec t;
    double end = 0;

    do {
        (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        const double now = (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;

        if (end == 0)
            end = now + ms;
        else if (now >= end)
            return;
    } while (ms > 0);
}

static void run(struct worker *w, struct request *r)
{
    (void)w;
    (void)pthread_mutex_lock(&lock);
    order[atomic_load(&runs)] = (int)(r - request);
    (void)atomic_fetch_add(&runs, 1); /* a thread that sees it also sees order[] */
    (void)pthread_mutex_unlock(&lock);
    while (r - request < atomic_load(&held) && sem_wait(&gate) != 0)
        ;
    work_ms(slow_ms[r - request]);
    (void)atomic_fetch_add(&ran, 1);
}

/* So many more requests come to their end. */
static void let(int n)
{
    while (n-- > 0)
        (void)sem_post(&gate);
}

static void wait_for(const atomic_int *what, int n)
{
    for (int i = 0; i < 20000 && atomic_load(what) < n; i++)
        pause_ms(1);
    assert_int_equal(atomic_load(what), n);
}

/* A queue whose workers wait at the gate, each with one of the first requests. */
static struct queue *start(unsigned workers, unsigned limit)
{
    struct queue *q;

    atomic_store(&ran, 0);
    atomic_store(&runs, 0);
    atomic_store(&held, MOST);
    memset(slow_ms, 0, sizeof slow_ms);
    assert_int_equal(sem_init(&gate, 0, 0), 0);
    assert_int_equal(queue_start(&app, workers, limit, run, &q), ST_OK);
    for (unsigned i = 0; i < workers; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 99 + i));
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

TEST(test_turns)
{
    static const struct {
        unsigned long sender;
        enum queue_kind kind;
    } pushed[] = {{1, QUEUE_SMALL}, {1, QUEUE_SMALL}, {1, QUEUE_LARGE}, {2, QUEUE_SMALL},
                  {3, QUEUE_LARGE}, {2, QUEUE_SMALL}, {4, QUEUE_TOKEN}};
    static const int first[] = {0, 7};
    struct queue *q = start(1, MOST);
    int turns = 0;

    for (int i = 0; i < 7; i++)
        assert_null(queue_push(q, &request[1 + i], pushed[i].kind, pushed[i].sender));
    finish(q);
    assert_memory_equal(order, first, sizeof first); /* a token before all others */
    for (int i = 2; i < 5; i++) /* then one of each sender, and in a sender's order */
        turns |= 1 << order[i];
    assert_int_equal(turns, 1 << 1 | 1 << 4 | 1 << 5);
}

/* A sender of slow requests waits longer: one slow request against several quick ones. */
TEST(test_time)
{
    struct queue *q = start(1, MOST);
    int slow = 0;

    for (int i = 1; i <= 3; i++) {
        slow_ms[i] = 30;
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 1));
    }
    for (int i = 4; i <= 8; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 2));
    finish(q);
    for (int i = 0; i <= 8; i++) {
        slow += order[i] >= 1 && order[i] <= 3;
        if (order[i] == 6) /* the third quick one comes before the second slow one */
            assert_int_equal(slow, 1);
    }
}

/* A full queue refuses the newest of the sender that has most waiting. */
TEST(test_full)
{
    struct queue *q = start(1, 4);

    for (int i = 1; i <= 4; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 1));
    assert_ptr_equal(queue_push(q, &request[5], QUEUE_SMALL, 1), &request[5]);
    assert_ptr_equal(queue_push(q, &request[6], QUEUE_SMALL, 2), &request[4]);
    assert_ptr_equal(queue_push(q, &request[7], QUEUE_SMALL, 3), &request[3]);
    assert_ptr_equal(queue_push(q, &request[8], QUEUE_SMALL, 2), &request[8]);
    assert_ptr_equal(queue_push(q, &request[9], QUEUE_SMALL, 1), &request[9]);
    finish(q);
    assert_int_equal(atomic_load(&ran), 5);
}

/* Large requests, and requests of a sender whose last ones took long, leave a worker free. */
TEST(test_heavy)
{
    struct queue *q = start(2, MOST);
    struct queue_state s;

    slow_ms[2] = 80;
    assert_null(
        queue_push(q, &request[2], QUEUE_SMALL, 1)); /* of which this is learned */
    let(3);
    wait_for(&ran, 3);
    pause_ms(20);
    for (int i = 3; i <= 5; i++)
        assert_null(queue_push(q, &request[i], i == 4 ? QUEUE_LARGE : QUEUE_SMALL,
                               i == 4 ? 2 : 1));
    wait_for(&runs, 4);
    pause_ms(20);
    assert_int_equal(atomic_load(&runs), 4); /* one of them at a time */
    assert_null(queue_push(q, &request[6], QUEUE_SMALL, 3));
    wait_for(&runs, 5);
    assert_int_equal(order[4], 6);
    queue_look(q, &s);
    assert_int_equal(s.running, 2);
    assert_int_equal(s.waiting, 2);
    finish(q);
}

TEST(test_drop)
{
    struct queue *q = start(1, MOST);
    static const int wanted[] = {0, 1, 3};

    for (int i = 1; i <= 3; i++)
        assert_null(queue_push(q, &request[i], QUEUE_SMALL, 1));
    assert_true(queue_drop(q, &request[2]));
    assert_false(queue_drop(q, &request[2]));
    assert_false(queue_drop(q, &request[0])); /* it runs */
    finish(q);
    assert_int_equal(atomic_load(&ran), 3);
    assert_memory_equal(order, wanted, sizeof wanted);
}

/* More senders than are remembered. */
TEST(test_many_senders)
{
    struct queue *q = start(1, 2);

    atomic_store(&held, 1);
    let(1);
    for (int i = 0; i < 300; i++) {
        assert_null(queue_push(q, &request[1], QUEUE_SMALL, (uint64_t)i));
        wait_for(&ran, i + 2);
        atomic_store(&runs, 1);
    }
    finish(q);
}
