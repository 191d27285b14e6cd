/* Templates of another engine are re-encoded from their points, in memory or for good:
 * with the same bits, however often. */
#include "expect.h"
#include "codec.h"
#include "digest.h"
#include "face.h"
#include "facegen.h"
#include "model.h"
#include "model_digest.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define POINTS 1500
#define BYTES  65536 /* more than a model of so many points */

enum { SHIPPED, SHIFTED, HOLDS, HOLLOW, ENGINES }; /* the models */

static struct surface_model model[ENGINES];
static struct surface_work *work[ENGINES];
static struct errinfo e;

struct bytes {
    size_t n;
    unsigned char b[BYTES];
};

static void encode(const struct surface_face *f, struct bytes *out)
{
    out->n = surface_encoded_size(f);
    assert_true(out->n <= BYTES);
    surface_encode(f, out->b);
}

static void assert_same(const struct bytes *a, const struct bytes *b)
{
    assert_int_equal(a->n, b->n);
    assert_memory_equal(a->b, b->b, a->n);
}

/* towards: 1, or -1 for a hollow face. */
static void make(uint64_t subject, double spikes, double towards, int engine,
                 struct surface_face *f)
{
    static struct dvec3 pts[POINTS];
    struct facegen_scan s;
    size_t n;

    facegen_default(&s);
    s.subject = subject;
    s.points = POINTS;
    s.spikes = spikes;
    facegen_pose(&s, 6, 10);
    n = facegen_sample(&s, pts);
    for (size_t i = 0; i < n; i++)
        pts[i].z *= towards;
    assert_int_equal(face_build(pts, n, work[engine], f, NULL), ST_OK);
}

/* The three that are not the shipped one: another mean face; the same one, and so the
 * same mark, but fitted otherwise; one that no face resembles. */
static void make_models(void)
{
    for (int i = 0; i < ENGINES; i++) {
        model[i] = model_default;
        for (uint32_t k = 0; k < GRID_N; k++) {
            if (i == SHIFTED)
                model[i].mean[k] += 2;
            if (i == HOLDS && k % 2 == 0)
                model[i].identity.mode[k][0] *= 3;
            if (i == HOLLOW)
                model[i].mean[k] = -model[i].mean[k];
        }
        work[i] = surface_work_new(&model[i]);
        assert_non_null(work[i]);
    }
    assert_int_equal(model_mean_id(&model[HOLDS]), model_mean_id(&model_default));
}

/* ---- faces */

/* Laying spikes flat again would change the points once more. */
TEST(test_spikes)
{
    static struct bytes first, again;
    char digest[65], same[65];
    struct surface_face f = {0};

    make(1, 0.05, 1, SHIPPED, &f);
    assert_int_equal(digest_points(&f, digest), ST_OK);
    assert_int_equal(face_rebuild(&f, work[SHIPPED]), ST_OK);
    encode(&f, &first);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(face_rebuild(&f, work[i % 2]), ST_OK);
        assert_int_equal(digest_points(&f, same), ST_OK);
        assert_string_equal(digest, same);
    }
    assert_int_equal(face_rebuild(&f, work[SHIPPED]), ST_OK);
    encode(&f, &again);
    assert_same(&first, &again);
    face_free(&f);
}

/* A template of another engine, marked as this one's. */
TEST(test_engines)
{
    static struct bytes theirs, ours, again;

    for (int i = SHIFTED; i <= HOLDS; i++) {
        struct surface_face f = {0}, g = {0};

        make(2, 0, 1, i, &f);
        make(2, 0, 1, SHIPPED, &g);
        encode(&f, &theirs);
        encode(&g, &ours);
        assert_int_equal(ours.n, theirs.n);
        assert_memory_not_equal(ours.b, theirs.b, ours.n);
        must(codec_decode(theirs.b, theirs.n, work[SHIPPED], &f));
        assert_int_equal(face_rebuild(&f, work[SHIPPED]), ST_OK);
        encode(&f, &again);
        assert_same(&ours, &again);
        assert_memory_equal(&f.quality, &g.quality, sizeof f.quality);
        face_free(&f);
        face_free(&g);
    }
}

TEST(test_same_engine)
{
    assert_true(
        surface_same_engine("surfaced/1 measure/2 model/a", "x/2 measure/2 model/a"));
    assert_false(surface_same_engine("surfaced/1 measure/2 model/a",
                                     "surfaced/1 measure/3 model/a"));
    assert_false(surface_same_engine("surfaced/1 measure/2 model/a",
                                     "surfaced/1 measure/2 model/b"));
    assert_false(
        surface_same_engine("surfaced/1 measure/2", "surfaced/1 measure/2 model/a"));
    assert_false(surface_same_engine("old", "old"));
}

/* ---- templates */

static struct store *open_for(int engine)
{
    struct store *s = tempdb_open(STORE_CREATE);

    store_use_model(s, &model[engine]);
    return s;
}

static void load(struct store *s, const char *id, int engine, struct bytes *out)
{
    struct store_template t;
    struct surface_face *f = NULL;

    if (store_template_load(s, id, &t, work[engine], &f, &e) != ST_OK)
        fail_msg("%s", e.msg);
    encode(f, out);
    surface_face_free(f);
}

static uint64_t count(struct store *s)
{
    uint64_t n = 99;

    must(store_reencode_count(s, &n, &e));
    return n;
}

/* Loaded as the shipped engine makes it before and after it is stored so. */
TEST(test_store)
{
    static struct bytes ours, loaded;
    struct store_template was, is;
    struct surface_face f = {0}, *g = NULL;
    char(*due)[STORE_ID_LEN + 1];
    struct store *s;
    bool done;
    size_t n;

    for (int i = SHIFTED; i <= HOLDS; i++) {
        make(4, 0, 1, SHIPPED, &f);
        encode(&f, &ours);
        make(4, 0, 1, i, &f);
        s = open_for(i);
        tempdb_enroll(s, "x", "left", &f, &was);
        assert_int_equal(count(s), 0);
        store_close(s);

        s = open_for(SHIPPED);
        assert_true(store_template_outdated(s, &was));
        assert_int_equal(count(s), 1);
        load(s, was.id, SHIPPED, &loaded);
        assert_same(&ours, &loaded);
        must(store_reencode_due(s, &due, &n, &e));
        assert_int_equal(n, 1);
        assert_string_equal(due[0], was.id);
        free(due);

        must(store_reencode(s, "test", was.id, work[SHIPPED], &g, &is, &done, &e));
        assert_true(done);
        assert_string_equal(is.engine, store_made_by(s));
        must(store_template_get(s, was.id, &is, &e));
        assert_string_equal(is.engine, store_made_by(s));
        assert_string_equal(is.created, was.created);
        assert_string_equal(is.digest, was.digest);
        assert_string_equal(is.label, "left");
        load(s, was.id, SHIPPED, &loaded);
        assert_same(&ours, &loaded);
        assert_int_equal(count(s), 0);
        must(store_reencode(s, "test", was.id, work[SHIPPED], &g, &is, &done, &e));
        assert_false(done);
        must(store_verify(s, NULL, NULL, &e));
        store_close(s);
        tempdb_remove();
    }
    face_free(&f);
    surface_face_free(g);
}

/* A template that cannot be re-encoded is never compared, and stays. */
TEST(test_stays)
{
    static struct bytes before, after;
    struct store_template was, is;
    struct surface_face f = {0}, *g = NULL;
    struct store *s = open_for(HOLLOW);
    bool done = true;

    make(2, 0, -1, HOLLOW, &f);
    tempdb_enroll(s, "x", "left", &f, &was);
    load(s, was.id, HOLLOW, &before);
    store_close(s);

    s = open_for(SHIPPED);
    fails(store_template_load(s, was.id, &is, work[SHIPPED], &g, &e), ST_EVERSION);
    assert_non_null(strstr(e.msg, was.id));
    assert_null(g);
    fails(store_reencode(s, "test", was.id, work[SHIPPED], &g, &is, &done, &e),
          ST_EVERSION);
    assert_false(done);
    assert_int_equal(count(s), 1);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);

    s = open_for(HOLLOW);
    load(s, was.id, HOLLOW, &after);
    assert_same(&before, &after);
    assert_int_equal(count(s), 0);
    store_close(s);
    tempdb_remove();
    face_free(&f);
    surface_face_free(g);
}

BEFORE_ALL(set_up)
{
    make_models();
    assert_int_equal(tempdb_begin(NULL), 0);
}

AFTER_ALL(tear_down)
{
    for (int i = 0; i < ENGINES; i++)
        surface_work_free(work[i]);
    assert_int_equal(tempdb_end(NULL), 0);
}
