/* The templates of a subject with each other: which fits; one without a decision, one of another engine; a
 * client that has gone. */
#include "clouds.h"
#include "errinfo.h"
#include "json.h"
#include "pairs.h"
#include "tempdb.h"
#include "unit.h"

#define POINTS 1500

static struct store *store;
static struct errinfo e;

BEFORE_ALL(set_up)
{
    store = tempdb_fresh();
}

AFTER_ALL(tear_down)
{
    store_close(store);
}

/* A scan's points within +-x of the nose, as a template. */
static void enrol(const char *subject, uint64_t person, uint64_t scan, double x)
{
    static struct dvec3 pts[POINTS];
    const size_t all = clouds_scan(person, scan, POINTS, pts);
    struct store_template t;
    struct surface_face f = {0};
    size_t n = 0;

    for (size_t i = 0; i < all; i++)
        if (fabs(pts[i].x) < x)
            pts[n++] = pts[i];
    assert_int_equal(face_build(pts, n, tempdb_work, &f, NULL), ST_OK);
    tempdb_enroll(store, subject, "", &f, &t);
    face_free(&f);
}

static void compare(const char *subject, struct pairs *p)
{
    static struct templates_context c;

    c = (struct templates_context){.store = store, .work = tempdb_work};
    assert_int_equal(pairs_run(&c, subject, "test", NULL, p, &e), ST_OK);
}

TEST(test_fits)
{
    struct pairs p;

    enrol("alice", 1, 0, 200);
    compare("alice", &p);
    assert_int_equal(p.n, 0);
    assert_int_equal(p.fit[0], PAIRS_UNKNOWN);
    pairs_free(&p);
    enrol("alice", 1, 1, 200);
    enrol("alice", 2, 0, 200);
    compare("alice", &p);
    assert_int_equal(p.n, 3);
    assert_int_equal(p.one[0].result.decision, SURFACE_MATCH);
    assert_int_equal(p.fit[0], PAIRS_FITS); /* as many for it as against it */
    assert_int_equal(p.fit[1], PAIRS_FITS);
    assert_int_equal(p.fit[2], PAIRS_MISFIT);
    assert_int_equal(p.matches[2], 0);
    pairs_free(&p);
}

/* A strip of the face decides nothing, and is no misfit. */
TEST(test_unknown)
{
    struct pairs p;

    enrol("bob", 3, 0, 200);
    enrol("bob", 3, 1, 200);
    enrol("bob", 3, 2, 14);
    compare("bob", &p);
    assert_int_equal(p.one[1].result.decision, SURFACE_INCONCLUSIVE);
    assert_int_equal(p.fit[2], PAIRS_UNKNOWN);
    assert_int_equal(p.fit[0], PAIRS_FITS);
    pairs_free(&p);
}

TEST(test_gone)
{
    struct templates_context c = {.store = store, .work = tempdb_work};
    const atomic_bool stop = true;
    struct pairs p;

    assert_int_equal(pairs_run(&c, "alice", "test", &stop, &p, &e), ST_EBUSY);
    pairs_free(&p);
    assert_int_equal(pairs_run(&c, "nobody", "test", NULL, &p, &e), ST_ENOTFOUND);
    pairs_free(&p);
}

/* A face that there is not, and scores that are not told. */
TEST(test_left_out)
{
    struct pairs p;

    struct json *j = json_new();

    compare("alice", &p);
    surface_face_free(p.templates.face[1]);
    p.templates.face[1] = NULL;
    pairs_describe(j, &p, false, "engine");
    char *text = json_compact(j);
    assert_non_null(strstr(text, "\"compared\":false"));
    assert_non_null(strstr(text, "\"score\":null"));
    free(text);
    pairs_free(&p);
}
