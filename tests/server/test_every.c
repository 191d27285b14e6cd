/* A thread that does the same again and again.  No time is measured: what waits too long hangs. */
#define _GNU_SOURCE /* pthread_getname_np() */
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>

#include "every.h"
#include "unit.h"

static void pause_ms(long ms)
{
    (void)nanosleep(&(struct timespec){0, ms * 1000000}, NULL);
}

static void look(void *arg)
{
    (void)atomic_fetch_add((atomic_int *)arg, 1);
}

TEST(test_again_and_again)
{
    atomic_int looks = 0;
    struct every *x = every_start("often", 1, look, &looks);
    int then;

    assert_non_null(x);
    while (atomic_load(&looks) < 3)
        pause_ms(1);
    every_stop(x);
    then = atomic_load(&looks);
    pause_ms(20);
    assert_int_equal(atomic_load(&looks), then);
}

TEST(test_at_once_and_stopped_while_it_waits)
{
    atomic_int looks = 0;
    struct every *x = every_start("seldom", 3600 * 1000, look, &looks);

    assert_non_null(x);
    while (atomic_load(&looks) < 1)
        pause_ms(1);
    pause_ms(20);
    every_stop(x);
    assert_int_equal(atomic_load(&looks), 1);
    every_stop(NULL);
}

struct slow {
    atomic_bool begun, done;
    char name[16];
};

static void look_slowly(void *arg)
{
    struct slow *s = arg;

    atomic_store(&s->begun, true);
    pause_ms(50);
    (void)pthread_getname_np(pthread_self(), s->name, sizeof s->name);
    atomic_store(&s->done, true);
}

TEST(test_a_call_is_waited_for)
{
    struct slow s = {.name = ""};
    struct every *x = every_start("slow", 1000, look_slowly, &s);

    assert_non_null(x);
    while (!atomic_load(&s.begun))
        pause_ms(1);
    every_stop(x);
    assert_true(atomic_load(&s.done));
    assert_string_equal(s.name, "slow");
}
