/* Threads that compare at the same time have the same results as one. */
#include <pthread.h>

#include "clouds.h"
#include "face.h"
#include "libsurface.h"
#include "unit.h"

#define POINTS 3000

static struct {
    size_t n;
    struct dvec3 pts[2 * POINTS];
} cloud;

static void scan(uint64_t number)
{
    cloud.n = clouds_scan(19, number, POINTS, cloud.pts);
    assert_true(cloud.n > SURFACE_MIN_POINTS);
}

#define THREADS 4

struct thread {
    pthread_t id;
    const struct surface_face *tmpl;
    struct surface_face probe;
    struct surface_comparison r;
    struct align_result align;
    struct surface_parts parts;
    enum status st;
};

/* Each has its own memory, and builds the same probe. */
static void *compare(void *arg)
{
    struct thread *t = arg;
    struct surface_work *w = surface_work_new(NULL);

    t->st = w == NULL ? ST_ENOMEM : face_build(cloud.pts, cloud.n, w, &t->probe, NULL);
    if (t->st == ST_OK)
        t->st = status_from(surface_compare(w, t->tmpl, &t->probe, &t->r));
    if (t->st == ST_OK)
        t->st = face_align(t->tmpl, &t->probe, w, &t->align);
    if (t->st == ST_OK)
        t->st = status_from(surface_parts(w, t->tmpl, &t->probe, &t->parts));
    surface_work_free(w);
    return NULL;
}

TEST(test_threads)
{
    static struct thread t[THREADS], alone;
    struct surface_work *w = surface_work_new(NULL);
    struct surface_face a = {0};

    assert_non_null(w);
    scan(0);
    assert_int_equal(face_build(cloud.pts, cloud.n, w, &a, NULL), ST_OK);
    surface_work_free(w);
    scan(1);
    alone.tmpl = &a;
    (void)compare(&alone);
    assert_int_equal(alone.st, ST_OK);
    for (int i = 0; i < THREADS; i++) {
        t[i].tmpl = &a;
        assert_int_equal(pthread_create(&t[i].id, NULL, compare, &t[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_join(t[i].id, NULL), 0);
        assert_int_equal(t[i].st, ST_OK);
        assert_memory_equal(&alone.r, &t[i].r, sizeof alone.r);
        assert_memory_equal(&alone.align, &t[i].align, sizeof alone.align);
        assert_memory_equal(&alone.parts, &t[i].parts, sizeof alone.parts);
        assert_memory_equal(&alone.probe.encoding, &t[i].probe.encoding,
                            sizeof alone.probe.encoding);
        face_free(&t[i].probe);
    }
    face_free(&alone.probe);
    face_free(&a);
}
