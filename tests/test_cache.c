/* The template cache: its bound, who goes first, models that are dropped while they are
 * held, and many threads at once. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "cache.h"
#include "errinfo.h"
#include "facegen.h"
#include "store.h"

#define FACES   5
#define POINTS  600
#define THREADS 4

static char dir[64], path[96];
static struct store *store;
static struct store_template tmpl[FACES];
static struct face_work *work;
static struct errinfo e;

static int set_up(void **state)
{
    static struct dvec3 pts[POINTS];
    struct facegen_scan s;
    struct face f = {0};
    bool created;

    (void)state;
    (void)snprintf(dir, sizeof dir, "/tmp/surfaced-test.XXXXXX");
    assert_non_null(mkdtemp(dir));
    (void)snprintf(path, sizeof path, "%s/db", dir);
    assert_int_equal(store_open(path, STORE_CREATE, &store, &e), ST_OK);
    work = face_work_new(NULL);
    assert_non_null(work);
    for (uint64_t i = 0; i < FACES; i++) {
        facegen_default(&s);
        s.subject = i;
        s.points = POINTS;
        assert_int_equal(face_build(pts, facegen_sample(&s, pts), work, &f, NULL), ST_OK);
        assert_int_equal(store_enroll(store, "test", "x", "", &f, &tmpl[i], &created, &e),
                         ST_OK);
    }
    face_free(&f);
    return 0;
}

static int tear_down(void **state)
{
    static const char *const suffix[] = {"", "-wal", "-shm"};
    char name[128];

    (void)state;
    face_work_free(work);
    store_close(store);
    for (size_t i = 0; i < 3; i++) {
        (void)snprintf(name, sizeof name, "%s%s", path, suffix[i]);
        (void)unlink(name);
    }
    return rmdir(dir);
}

static const struct face *hold(struct cache *c, size_t i)
{
    const struct face *f;

    assert_int_equal(cache_hold(c, store, tmpl[i].id, work, &f, &e), ST_OK);
    assert_int_equal(f->mesh.nv, tmpl[i].points);
    return f;
}

static void use(struct cache *c, size_t i)
{
    cache_release(c, hold(c, i));
}

static void test_hit(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;
    const struct face *a, *b;

    (void)state;
    assert_non_null(c);
    a = hold(c, 0);
    b = hold(c, 0);
    assert_ptr_equal(a, b);
    cache_look(c, &s);
    assert_int_equal(s.hits, 1);
    assert_int_equal(s.misses, 1);
    assert_int_equal(s.entries, 1);
    cache_release(c, a);
    cache_release(c, b);
    cache_release(c, NULL);
    cache_free(c);
    cache_free(NULL);
}

/* What was used longest ago goes first, and the bound holds throughout. */
static void test_bound(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;
    size_t one;

    (void)state;
    use(c, 0);
    cache_look(c, &s);
    one = s.bytes;
    assert_true(one > (size_t)POINTS * 60);
    cache_free(c);

    c = cache_new(3 * one + one / 2); /* three fit, all being of about one size */
    for (size_t i = 0; i < FACES; i++) {
        use(c, i);
        cache_look(c, &s);
        assert_true(s.bytes <= s.limit);
        assert_true(s.entries <= 3);
    }
    use(c, 2);
    use(c, 0); /* drops 3: 2 was used after it */
    cache_look(c, &s);
    assert_int_equal(s.hits, 1);
    use(c, 2);
    use(c, 4);
    cache_look(c, &s);
    assert_int_equal(s.hits, 3);
    use(c, 3);
    cache_look(c, &s);
    assert_int_equal(s.hits, 3);
    cache_free(c);
}

/* A model that is dropped while it is held stays whole until it is given back. */
static void test_dropped_while_held(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;
    const struct face *a = hold(c, 0), *b;

    (void)state;
    cache_forget(c, tmpl[0].id);
    cache_forget(c, tmpl[0].id);
    cache_forget(c, tmpl[1].id); /* never was there */
    cache_look(c, &s);
    assert_int_equal(s.entries, 0);
    assert_int_equal(s.bytes, 0);
    assert_int_equal(a->mesh.nv, tmpl[0].points);
    b = hold(c, 0);
    assert_ptr_not_equal(a, b);
    cache_release(c, a);
    cache_release(c, b);
    cache_free(c);

    c = cache_new(1); /* nothing fits: every model is its holder's alone */
    a = hold(c, 0);
    cache_look(c, &s);
    assert_int_equal(s.entries, 0);
    cache_release(c, a);
    cache_free(c);
}

static void test_unknown(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    const struct face *f;

    (void)state;
    assert_int_equal(
        cache_hold(c, store, "00000000000000000000000000000000", work, &f, &e),
        ST_ENOTFOUND);
    assert_null(f);
    cache_free(c);
}

static void *hammer(void *arg)
{
    struct cache *c = arg;
    struct face_work *w = face_work_new(NULL);
    uint32_t r = 1;
    intptr_t bad = w == NULL;

    for (int i = 0; i < 400 && !bad; i++) {
        const struct face *f;
        size_t k;

        r = r * 1664525u + 1013904223u;
        k = (r >> 16) % FACES;
        if (r % 7 == 0)
            cache_forget(c, tmpl[k].id);
        bad = cache_hold(c, store, tmpl[k].id, w, &f, NULL) != ST_OK ||
              f->mesh.nv != tmpl[k].points;
        cache_release(c, f);
    }
    face_work_free(w);
    return (void *)bad;
}

static void test_threads(void **state)
{
    struct cache *c = cache_new((size_t)POINTS * 75 * 3);
    pthread_t t[THREADS];
    void *bad;

    (void)state;
    for (size_t i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&t[i], NULL, hammer, c), 0);
    for (size_t i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_join(t[i], &bad), 0);
        assert_null(bad);
    }
    cache_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hit),
        cmocka_unit_test(test_bound),
        cmocka_unit_test(test_dropped_while_held),
        cmocka_unit_test(test_unknown),
        cmocka_unit_test(test_threads),
    };

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
