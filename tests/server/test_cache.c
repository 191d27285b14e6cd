/* link: -Wl,--wrap=store_template_load */
/* The template cache: its limit, eviction order, models that are dropped while in use, loading
 * ahead, many threads, and templates that are enrolled and deleted meanwhile. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

#include "ahead.h"
#include "app.h"
#include "cache.h"
#include "errinfo.h"
#include "facegen.h"
#include "store.h"
#include "tempdb.h"

#define FACES   5
#define POINTS  600
#define THREADS 4
#define WRITERS 2  /* threads that enroll and delete, each in a subject of its own */
#define ROUNDS  40 /* templates that each of them makes */

static struct face faces[FACES];
static struct store *store;
static struct store_template tmpl[FACES];
static struct face_work *work;
static struct errinfo e;

/* Actions between a load from the store and its return to the cache. */
static struct cache *forgets_meanwhile;
static atomic_int loads;
static atomic_bool held_up; /* loading threads wait until it is false */

static void nap(void)
{
    const struct timespec ms = {.tv_nsec = 1000000};

    (void)nanosleep(&ms, NULL);
}

enum status __real_store_template_load(struct store *s, const char *id,
                                       struct store_template *t, struct face_work *w,
                                       struct face *f, struct errinfo *err);
enum status __wrap_store_template_load(struct store *s, const char *id,
                                       struct store_template *t, struct face_work *w,
                                       struct face *f, struct errinfo *err);

enum status __wrap_store_template_load(struct store *s, const char *id,
                                       struct store_template *t, struct face_work *w,
                                       struct face *f, struct errinfo *err)
{
    enum status st = __real_store_template_load(s, id, t, w, f, err);

    (void)atomic_fetch_add(&loads, 1);
    while (atomic_load(&held_up))
        nap();

    if (forgets_meanwhile != NULL)
        cache_forget(forgets_meanwhile, id);
    return st;
}

static int set_up(void **state)
{
    static struct dvec3 pts[POINTS];
    struct facegen_scan s;

    assert_int_equal(tempdb_begin(state), 0);
    store = tempdb_fresh();
    work = face_work_new(NULL);
    assert_non_null(work);
    for (uint64_t i = 0; i < FACES; i++) {
        facegen_default(&s);
        s.subject = i;
        s.points = POINTS - 10 * (uint32_t)i; /* to distinguish them */
        assert_int_equal(face_build(pts, facegen_sample(&s, pts), work, &faces[i], NULL),
                         ST_OK);
        tempdb_enroll(store, "x", "", &faces[i], &tmpl[i]);
    }
    return 0;
}

static int tear_down(void **state)
{
    for (size_t i = 0; i < FACES; i++)
        face_free(&faces[i]);
    face_work_free(work);
    store_close(store);
    return tempdb_end(state);
}

static const struct face *hold(struct cache *c, size_t i)
{
    const struct face *f;

    assert_int_equal(cache_hold(c, store, tmpl[i].id, work, &f, &e), ST_OK);
    assert_int_equal(f->surface.mesh.nv, tmpl[i].points);
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

/* The least recently used model is evicted, and the limit is never exceeded. */
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

    c = cache_new(3 * one + one / 2); /* room for three: all are about the same size */
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
    assert_int_equal(s.misses - s.entries, s.evictions);
    cache_free(c);
}

/* Without room every hold loads, and nothing is kept. */
static void test_off(void **state)
{
    struct cache *c = cache_new(0);
    struct cache_state s;

    (void)state;
    use(c, 0);
    use(c, 0);
    cache_look(c, &s);
    assert_int_equal(s.hits, 0);
    assert_int_equal(s.misses, 2);
    assert_int_equal(s.bytes, 0);
    assert_int_equal(s.evictions, 0);
    cache_free(c);
}

/* A model that is dropped while it is held stays valid until it is released. */
static void test_dropped_while_held(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;
    const struct face *a = hold(c, 0), *b;

    (void)state;
    cache_forget(c, tmpl[0].id);
    cache_forget(c, tmpl[0].id);
    cache_forget(c, tmpl[1].id); /* was never loaded */
    cache_look(c, &s);
    assert_int_equal(s.entries, 0);
    assert_int_equal(s.bytes, 0);
    assert_int_equal(a->surface.mesh.nv, tmpl[0].points);
    b = hold(c, 0);
    assert_ptr_not_equal(a, b);
    cache_release(c, a);
    cache_release(c, b);
    cache_free(c);

    c = cache_new(1); /* no model fits: each belongs to its holder alone */
    a = hold(c, 0);
    cache_look(c, &s);
    assert_int_equal(s.entries, 0);
    cache_release(c, a);
    cache_free(c);
}

/* A template is deleted while a worker loads it: the worker may use it, but the cache does
 * not keep it. */
static void test_forgotten_while_loaded(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;

    (void)state;
    forgets_meanwhile = c;
    use(c, 0);
    forgets_meanwhile = NULL;
    cache_look(c, &s);
    assert_int_equal(s.entries, 0);
    assert_int_equal(s.bytes, 0);
    use(c, 0);
    cache_look(c, &s);
    assert_int_equal(s.entries, 1);
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

/* ---- loading ahead */

/* The first hold of a model that was loaded ahead is not counted as a hit. */
static void test_ahead(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;

    (void)state;
    cache_load(c, store, tmpl[0].id, work);
    cache_load(c, store, tmpl[0].id, work);
    cache_load(c, store, "00000000000000000000000000000000", work);
    atomic_store(&loads, 0);
    use(c, 0);
    cache_look(c, &s);
    assert_int_equal(s.entries, 1);
    assert_int_equal(s.misses, 2); /* the unknown one too */
    assert_int_equal(s.hits, 0);
    use(c, 0);
    cache_look(c, &s);
    assert_int_equal(s.hits, 1);
    assert_int_equal(atomic_load(&loads), 0);

    forgets_meanwhile = c;
    cache_load(c, store, tmpl[1].id, work);
    forgets_meanwhile = NULL;
    use(c, 1);
    cache_look(c, &s);
    assert_int_equal(s.entries, 2);
    assert_int_equal(atomic_load(&loads), 2);
    cache_free(c);

    c = cache_new(0); /* no room: loading ahead does nothing */
    cache_load(c, store, tmpl[0].id, work);
    assert_int_equal(atomic_load(&loads), 2);
    cache_free(c);
}

static void *load_ahead(void *arg)
{
    struct face_work *w = face_work_new(NULL);

    if (w == NULL)
        return arg;
    cache_load(arg, store, tmpl[0].id, w);
    face_work_free(w);
    return NULL;
}

static void *let_go(void *arg)
{
    for (int i = 0; i < 20; i++)
        nap();
    atomic_store(&held_up, false);
    return arg;
}

/* A hold of a model that is being loaded ahead waits for it; a second load ahead does not. */
static void test_ahead_waits(void **state)
{
    struct cache *c = cache_new(SIZE_MAX);
    pthread_t loader, waker;
    void *failed;

    (void)state;
    atomic_store(&loads, 0);
    atomic_store(&held_up, true);
    assert_int_equal(pthread_create(&loader, NULL, load_ahead, c), 0);
    while (atomic_load(&loads) == 0)
        nap();
    cache_load(c, store, tmpl[0].id, work);
    assert_int_equal(pthread_create(&waker, NULL, let_go, NULL), 0);
    use(c, 0);
    assert_int_equal(pthread_join(loader, &failed), 0);
    assert_null(failed);
    assert_int_equal(pthread_join(waker, NULL), 0);
    assert_int_equal(atomic_load(&loads), 1);
    cache_free(c);
}

/* The thread loads what is asked for; then more is asked for than the queue has room for, and
 * the thread is stopped while it loads. */
static void test_ahead_thread(void **state)
{
    struct app app = {.store = store, .cache = cache_new(SIZE_MAX)};
    struct cache_state s = {0};

    (void)state;
    app.ahead = ahead_start(&app);
    assert_non_null(app.ahead);
    for (size_t i = 0; i < FACES; i++)
        ahead_ask(app.ahead, tmpl[i].id);
    while (s.entries < FACES) {
        nap();
        cache_look(app.cache, &s);
    }
    for (size_t i = 0; i < FACES; i++)
        cache_forget(app.cache, tmpl[i].id);
    for (size_t i = 0; i < 1000; i++)
        ahead_ask(app.ahead, tmpl[i % FACES].id);
    ahead_stop(app.ahead);
    ahead_stop(NULL);
    for (size_t i = 0; i < FACES; i++)
        use(app.cache, i);
    cache_free(app.cache);
}

/* ---- many threads */

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
        if (r % 5 == 0)
            cache_load(c, store, tmpl[k].id, w);
        bad = cache_hold(c, store, tmpl[k].id, w, &f, NULL) != ST_OK ||
              f->surface.mesh.nv != tmpl[k].points;
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

/* ---- templates enrolled and deleted meanwhile, by this process or another */

static struct coming_and_going {
    struct cache *cache;
    struct store *beside;     /* another handle, as surfacectl has; NULL: none */
    atomic_int gone[WRITERS]; /* serial (it is the label) of the last one deleted */
    atomic_int writing;       /* number of running writers */
    atomic_int next;          /* the next writer's number */
} going;

static void *come_and_go(void *arg)
{
    int me = atomic_fetch_add(&going.next, 1);
    intptr_t bad = 0;
    char subject[16];

    (void)arg;
    (void)snprintf(subject, sizeof subject, "w%d", me);
    for (int serial = 1; serial <= ROUNDS && !bad; serial++) {
        struct store *by = serial % 2 != 0 && going.beside != NULL ? going.beside : store;
        struct store_template t;
        char label[16];
        bool created;

        (void)snprintf(label, sizeof label, "%d", serial);
        bad = store_enroll(by, "test", subject, label, &faces[serial % FACES], &t,
                           &created, NULL) != ST_OK ||
              !created || store_template_delete(by, "test", t.id, NULL) != ST_OK;
        if (by == store)
            cache_forget(going.cache, t.id);
        atomic_store(&going.gone[me], serial);
    }
    (void)atomic_fetch_sub(&going.writing, 1);
    return (void *)bad;
}

/* Does what a verification does: lists the subject's templates in the store, then holds them.
 * A template whose deletion was complete before must not be among them. */
static void *look_for_gone(void *arg)
{
    struct face_work *w = face_work_new(NULL);
    intptr_t bad = w == NULL;

    (void)arg;
    for (unsigned i = 0; atomic_load(&going.writing) > 0 && !bad; i++) {
        int gone = atomic_load(&going.gone[i % WRITERS]);
        struct store_template *t = NULL;
        char subject[16];
        size_t n = 0;
        enum status st;

        (void)snprintf(subject, sizeof subject, "w%u", i % WRITERS);
        st = store_template_list(store, subject, &t, &n, NULL);
        bad = st != ST_OK && st != ST_ENOTFOUND;
        for (size_t k = 0; k < n && !bad; k++) {
            const struct face *f;

            if (i % 2 == 0)
                cache_load(going.cache, store, t[k].id, w);
            st = cache_hold(going.cache, store, t[k].id, w, &f, NULL);
            bad = atoi(t[k].label) <= gone || (st != ST_OK && st != ST_ENOTFOUND) ||
                  (st == ST_OK && f->surface.mesh.nv != t[k].points);
            cache_release(going.cache, f);
        }
        free(t);
    }
    face_work_free(w);
    return (void *)bad;
}

static void run_going(struct store *beside)
{
    pthread_t t[WRITERS + THREADS];
    void *bad;

    going = (struct coming_and_going){.cache = cache_new(SIZE_MAX), .beside = beside};
    assert_non_null(going.cache);
    atomic_store(&going.writing, WRITERS);
    for (size_t i = 0; i < WRITERS + THREADS; i++)
        assert_int_equal(
            pthread_create(&t[i], NULL, i < WRITERS ? come_and_go : look_for_gone, NULL),
            0);
    for (size_t i = 0; i < WRITERS + THREADS; i++) {
        assert_int_equal(pthread_join(t[i], &bad), 0);
        assert_null(bad);
    }
}

/* If this process deletes the templates, the cache keeps none of them, even of those that were
 * being loaded. */
static void test_gone(void **state)
{
    struct cache_state s;

    (void)state;
    run_going(NULL);
    cache_look(going.cache, &s);
    assert_int_equal(s.entries, 0);
    cache_free(going.cache);
}

static void test_gone_beside(void **state)
{
    struct store *beside = tempdb_open(STORE_WRITE);

    (void)state;
    run_going(beside);
    cache_free(going.cache);
    store_close(beside);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hit),
        cmocka_unit_test(test_bound),
        cmocka_unit_test(test_off),
        cmocka_unit_test(test_dropped_while_held),
        cmocka_unit_test(test_forgotten_while_loaded),
        cmocka_unit_test(test_unknown),
        cmocka_unit_test(test_ahead),
        cmocka_unit_test(test_ahead_waits),
        cmocka_unit_test(test_ahead_thread),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_gone),
        cmocka_unit_test(test_gone_beside),
    };

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
