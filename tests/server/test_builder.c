/* The thread that builds the probe: each job runs once, on another thread and before the wait
 * for it returns; a stop waits for nothing that was not begun. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <pthread.h>
#include <string.h>
#include <cmocka.h>

#include "builder.h"
#include "face.h"

struct job {
    pthread_t by;
    struct face_work *work;
    unsigned runs;
};

static void run(void *arg, struct face_work *w)
{
    struct job *j = arg;

    j->by = pthread_self();
    j->work = w;
    j->runs++;
}

static void test_jobs(void **state)
{
    struct builder *b = builder_start(NULL);
    struct job j = {0};

    (void)state;
    assert_non_null(b);
    builder_wait(b);
    for (unsigned i = 1; i <= 1000; i++) {
        builder_begin(b, run, &j);
        builder_wait(b);
        assert_int_equal(j.runs, i);
    }
    builder_wait(b);
    assert_int_equal(j.runs, 1000);
    assert_non_null(j.work);
    assert_false(pthread_equal(j.by, pthread_self()));
    builder_stop(b);
}

static void test_stop(void **state)
{
    struct builder *b = builder_start(NULL);

    (void)state;
    assert_non_null(b);
    builder_stop(b);
    builder_stop(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_jobs),
        cmocka_unit_test(test_stop),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
