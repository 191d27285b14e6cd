/* The template cache: its bound, who goes first, models that are dropped while they are
 * held or read, many threads at once, and templates that come and go meanwhile. */
#include <pthread.h>
#include <stdatomic.h>

#include "cache.h"
#include "errinfo.h"
#include "face.h"
#include "facegen.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define FACES   5
#define POINTS  600
#define THREADS 4
#define WRITERS 2  /* threads that enroll and delete, each in a subject of its own */
#define ROUNDS  40 /* templates that each of them makes */

static struct surface_face faces[FACES];
static struct store *store;
static struct store_template tmpl[FACES];
static struct surface_work *work;
static struct errinfo e;

BEFORE_ALL(set_up)
{
    static struct dvec3 pts[POINTS];
    struct facegen_scan s;

    store = tempdb_fresh();
    work = surface_work_new(NULL);
    assert_non_null(work);
    for (uint64_t i = 0; i < FACES; i++) {
        facegen_default(&s);
        s.subject = i;
        s.points = POINTS - 10 * (uint32_t)i; /* to distinguish them */
        assert_int_equal(face_build(pts, facegen_sample(&s, pts), work, &faces[i], NULL),
                         ST_OK);
        tempdb_enroll(store, "x", "", &faces[i], &tmpl[i]);
    }
}

AFTER_ALL(tear_down)
{
    for (size_t i = 0; i < FACES; i++)
        face_free(&faces[i]);
    surface_work_free(work);
    store_close(store);
}

/* As a worker does it: found, or read and kept; NULL: it is not in the store. */
static const struct cache_held *find_or_load(struct cache *c, const char *id,
                                             struct surface_work *w)
{
    const uint64_t mark = cache_mark(c);
    const struct cache_held *f = cache_find(c, id);
    struct store_template t;
    struct surface_face *loaded = NULL;

    if (f != NULL)
        return f;
    if (store_template_load(store, id, &t, w, &loaded, NULL) != ST_OK)
        return NULL;
    return cache_keep(c, mark, id, false, loaded);
}

static const struct cache_held *hold(struct cache *c, size_t i)
{
    const struct cache_held *f = find_or_load(c, tmpl[i].id, work);

    assert_non_null(f);
    assert_int_equal(f->face->surface.mesh.nv, tmpl[i].points);
    return f;
}

static void use(struct cache *c, size_t i)
{
    cache_release(c, hold(c, i));
}

TEST(test_hit)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;
    const struct cache_held *a, *b;

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
TEST(test_bound)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;
    size_t one;

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
TEST(test_off)
{
    struct cache *c = cache_new(0);
    struct cache_state s;

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
TEST(test_dropped_while_held)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;
    const struct cache_held *a = hold(c, 0), *b;

    cache_forget(c, tmpl[0].id);
    cache_forget(c, tmpl[0].id);
    cache_forget(c, tmpl[1].id); /* was never loaded */
    cache_look(c, &s);
    assert_int_equal(s.entries, 0);
    assert_int_equal(s.bytes, 0);
    assert_int_equal(a->face->surface.mesh.nv, tmpl[0].points);
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

static struct surface_face *load(size_t i)
{
    struct store_template t;
    struct surface_face *f = NULL;

    assert_int_equal(store_template_load(store, tmpl[i].id, &t, work, &f, &e), ST_OK);
    return f;
}

/* Deleted while a worker was reading it: the worker may use it, but it does not stay.  Nor
 * does another, which may be read again. */
TEST(test_forgotten_while_loaded)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct cache_state s;

    for (size_t i = 0; i < 2; i++) {
        const uint64_t mark = cache_mark(c);
        struct surface_face *f = load(i);
        const struct cache_held *held;

        cache_forget(c, tmpl[0].id);
        held = cache_keep(c, mark, tmpl[i].id, false, f);
        assert_non_null(held);
        assert_int_equal(held->face->surface.mesh.nv, tmpl[i].points);
        cache_release(c, held);
        cache_look(c, &s);
        assert_int_equal(s.entries, 0);
        assert_int_equal(s.bytes, 0);
    }
    use(c, 0);
    cache_look(c, &s);
    assert_int_equal(s.entries, 1);
    cache_free(c);
}

/* Two read the same at once: both have it, one of them is kept. */
TEST(test_loaded_twice)
{
    struct cache *c = cache_new(SIZE_MAX);
    struct surface_face *a = load(0), *b = load(0);
    const struct cache_held *first, *second;
    struct cache_state s;

    assert_null(cache_find(c, tmpl[0].id));
    assert_null(cache_find(c, tmpl[0].id));
    first = cache_keep(c, cache_mark(c), tmpl[0].id, false, a);
    second = cache_keep(c, cache_mark(c), tmpl[0].id, true, b);
    assert_ptr_not_equal(first, second);
    cache_look(c, &s);
    assert_int_equal(s.entries, 1);
    assert_int_equal(s.misses, 2);
    assert_int_equal(s.reencoded, 1);
    assert_ptr_equal(cache_find(c, tmpl[0].id), first);
    cache_release(c, first);
    cache_release(c, first);
    cache_release(c, second);
    cache_free(c);
}

/* ---- many threads */

static void *hammer(void *arg)
{
    struct cache *c = arg;
    struct surface_work *w = surface_work_new(NULL);
    uint32_t r = 1;
    intptr_t bad = w == NULL;

    for (int i = 0; i < 400 && !bad; i++) {
        const struct cache_held *f;
        size_t k;

        r = r * 1664525u + 1013904223u;
        k = (r >> 16) % FACES;
        if (r % 7 == 0)
            cache_forget(c, tmpl[k].id);
        f = find_or_load(c, tmpl[k].id, w);
        bad = f == NULL || f->face->surface.mesh.nv != tmpl[k].points;
        cache_release(c, f);
    }
    surface_work_free(w);
    return (void *)bad;
}

TEST(test_threads)
{
    struct cache *c = cache_new((size_t)POINTS * 75 * 3);
    pthread_t t[THREADS];
    void *bad;

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
        bad = tempdb_store(by, "test", subject, label, &faces[serial % FACES], &t,
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
    struct surface_work *w = surface_work_new(NULL);
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
            const struct cache_held *f = find_or_load(going.cache, t[k].id, w);
            bad = atoi(t[k].label) <= gone ||
                  (f != NULL && f->face->surface.mesh.nv != t[k].points);
            cache_release(going.cache, f);
        }
        free(t);
    }
    surface_work_free(w);
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
TEST(test_gone)
{
    struct cache_state s;

    run_going(NULL);
    cache_look(going.cache, &s);
    assert_int_equal(s.entries, 0);
    cache_free(going.cache);
}

TEST(test_gone_beside)
{
    struct store *beside = tempdb_open(STORE_WRITE);

    run_going(beside);
    cache_free(going.cache);
    store_close(beside);
}
