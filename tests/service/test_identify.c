/* An identification finds a person by another scan, with the digits of a verification; it names nobody who may not
 * be found, even if the gallery errs; it is recorded, and what it cannot know is inconclusive. */
/* link: -Wl,--wrap=gallery_follow -Wl,--wrap=store_record_verification */
#include <math.h>

#include "clouds.h"
#include "errinfo.h"
#include "identify.h"
#include "session.h"
#include "tempdb.h"
#include "unit.h"

#define POINTS 1500

static struct store *store;
static struct gallery *gallery;
static struct session session;
static struct surface_face *face;
static struct identification x;
static const char *actor;
static bool stale; /* the gallery is not followed any more */
static struct errinfo e;

enum status __real_gallery_follow(struct gallery *g, struct store_people *p,
                                  struct errinfo *err);
enum status __wrap_gallery_follow(struct gallery *g, struct store_people *p,
                                  struct errinfo *err);
enum status __wrap_gallery_follow(struct gallery *g, struct store_people *p,
                                  struct errinfo *err)
{
    return stale ? ST_OK : __real_gallery_follow(g, p, err);
}

static bool erase_next; /* p1 is erased before the next record of a match */

enum status __real_store_record_verification(struct store *s,
                                             const struct store_record *what,
                                             struct store_recorded *out,
                                             struct errinfo *err);
enum status __wrap_store_record_verification(struct store *s,
                                             const struct store_record *what,
                                             struct store_recorded *out,
                                             struct errinfo *err);
enum status __wrap_store_record_verification(struct store *s,
                                             const struct store_record *what,
                                             struct store_recorded *out,
                                             struct errinfo *err)
{
    if (erase_next)
        must(tempdb_erase(s, "test", "p1", &e));
    erase_next = false;
    return __real_store_record_verification(s, what, out, err);
}

static const char *const name[TEMPDB_FACES] = {"p0", "p1", "p2", "p3"};
static struct store_template enrolled[TEMPDB_FACES];

static void begin(void)
{
    stale = false;
    actor = "test";
    store_close(store);
    gallery_free(gallery);
    (void)surface_work_calibrate(tempdb_work, NULL);
    store = tempdb_fresh();
    gallery = gallery_new(SIZE_MAX);
    for (int i = 0; i < TEMPDB_FACES; i++)
        tempdb_enroll(store, name[i], "", &tempdb_face[i], &enrolled[i]);
}

static void end(void)
{
    if (x.request != NULL)
        identify_free(&x);
    x.request = NULL;
    session_free(&session);
    surface_face_free(face);
    face = NULL;
}

AFTER_ALL(tear_down)
{
    end();
    gallery_free(gallery);
    store_close(store);
}

/* Scan number `scan` of tempdb_face[i]'s person. */
static enum status identify(int i, uint64_t scan, const char *group, size_t candidates)
{
    static struct identify_request r;
    struct templates_context c = {.store = store, .work = tempdb_work};
    struct cloudpoints *p = &session.frame[0].points;

    end();
    session.n = 1;
    session.frame[0].name = "scan";
    p->at = mem_array(POINTS, sizeof *p->at);
    p->n = p->read = clouds_scan((uint64_t)i + 1, scan, POINTS, p->at);
    r = (struct identify_request){.actor = actor,
                                  .group = group,
                                  .candidates = candidates,
                                  .probe = &session,
                                  .face = &face};
    return identify_run(&c, gallery, &r, &x, &e);
}

static void assert_entry(const char *kind, const char *outcome, const char *object)
{
    const struct store_audit_filter last = {.newest = true, .limit = 1, .kind = kind};
    struct store_audit_entry *list;
    size_t n;

    must(store_audit_list(store, &last, &list, &n, NULL, &e));
    assert_int_equal(n, 1);
    assert_string_equal(list[0].entry.outcome, outcome);
    assert_string_equal(list[0].entry.object, object);
    free(list);
}

/* What a verification of person k by the face says. */
static struct surface_comparison verified(int k)
{
    struct templates_context c = {.store = store, .work = tempdb_work};
    const struct templates_of ask = {.subject = name[k]};
    struct templates_nearest n;
    struct templates t;

    must(templates_read(&c, &ask, &t, &e));
    must(templates_nearest(&t, false, face, &n, &e));
    templates_free(&t);
    return n.result;
}

TEST(test_people)
{
    begin();
    for (int i = 0; i < TEMPDB_FACES; i++) {
        char outcome[64];

        must(identify(i, 1, "", TEMPDB_FACES));
        assert_int_equal(x.decision, SURFACE_MATCH);
        assert_string_equal(x.templates.of.subject.id, name[i]);
        assert_string_equal(x.templates.of.t[x.best.index].id, enrolled[i].id);
        assert_true(x.best.result.threshold ==
                    surface_search_threshold(surface_work_calibration(tempdb_work),
                                             TEMPDB_FACES));
        assert_int_equal(x.searched, TEMPDB_FACES);
        assert_int_equal(x.compared, TEMPDB_FACES);
        assert_int_equal(x.n, TEMPDB_FACES);
        for (size_t k = 0; k < x.n; k++) {
            const struct surface_comparison is =
                verified(x.candidate[k].subject[1] - '0');

            assert_true(x.candidate[k].result.score == is.score || is.score < 0);
            assert_true(k == 0 ||
                        x.candidate[k].result.score <= x.candidate[k - 1].result.score);
        }
        (void)snprintf(outcome, sizeof outcome, "match %.1f of 4", x.best.result.score);
        assert_entry("identify", outcome, enrolled[i].id);
        (void)snprintf(outcome, sizeof outcome, "%.1f of 4", x.candidate[3].result.score);
        assert_entry("candidate", outcome, x.candidate[3].template_id);
    }
}

TEST(test_few_candidates)
{
    begin();
    must(identify(1, 1, "", 2));
    assert_int_equal(x.n, 2);
    assert_string_equal(x.candidate[0].subject, name[1]);
    assert_true(x.candidate[0].result.score > x.candidate[1].result.score);
}

static void assert_nobody(int i, const char *group, uint64_t searched)
{
    must(identify(i, 1, group, TEMPDB_FACES));
    assert_int_equal(x.decision, SURFACE_NO_MATCH);
    for (size_t k = 0; k < x.n; k++)
        assert_string_not_equal(x.candidate[k].subject, name[i]);
    if (searched < TEMPDB_FACES || !stale)
        assert_int_equal(x.searched, searched);
}

/* Each with the gallery up to date, then with one that still has them. */
static void check_hidden(void)
{
    const bool no = false, yes = true;

    must(store_subject_set(store, "test", name[0],
                           &(struct store_subject_change){.identify = &no}, &e));
    must(store_subject_set(store, "test", name[1],
                           &(struct store_subject_change){.disabled = &yes}, &e));
    must(tempdb_erase(store, "test", name[2], &e));
    must(store_template_delete(store, "test", enrolled[3].id, &e));
    for (int i = 0; i < TEMPDB_FACES; i++)
        assert_nobody(i, "", stale ? TEMPDB_FACES : 0);
}

TEST(test_hidden)
{
    begin();
    check_hidden();
}

TEST(test_hidden_though_the_gallery_errs)
{
    begin();
    must(identify(0, 1, "", 0));
    stale = true;
    check_hidden();
}

TEST(test_groups)
{
    begin();
    must(store_subject_set(store, "test", name[0],
                           &(struct store_subject_change){.groups = "door"}, &e));
    must(identify(0, 1, "door", 0));
    assert_int_equal(x.decision, SURFACE_MATCH);
    assert_int_equal(x.searched, 1);
    assert_nobody(1, "door", 1);
    assert_nobody(0, "other", 0);
    assert_entry("identify", "no_match of 0 other", "");
    stale = true;
    must(store_subject_set(store, "test", name[0],
                           &(struct store_subject_change){.groups = ""}, &e));
    assert_nobody(0, "door", 1);
}

TEST(test_token_of_a_group)
{
    struct store_token t;
    char secret[65];

    begin();
    must(store_subject_set(store, "test", name[0],
                           &(struct store_subject_change){.groups = "a"}, &e));
    must(store_subject_set(store, "test", name[1],
                           &(struct store_subject_change){.groups = "a,b"}, &e));
    must(store_token_create(store, "test", "t", STORE_SCOPE_IDENTIFY, "a", STORE_NEVER,
                            secret, &t, &e));
    actor = t.id;
    for (int i = 0; i < TEMPDB_FACES; i++) {
        must(identify(i, 1, "", 0));
        assert_int_equal(x.decision, i < 2 ? SURFACE_MATCH : SURFACE_NO_MATCH);
        assert_int_equal(x.searched, 2);
    }
    /* It knows nothing of b, though p1 is in it. */
    assert_int_equal(identify(1, 1, "b", 0), ST_EDENIED);
}

TEST(test_skipped)
{
    begin();
    tempdb_sql("UPDATE templates SET about = zeroblob(100) WHERE template_key = 2");
    must(identify(1, 1, "", 0));
    assert_int_equal(x.decision, SURFACE_INCONCLUSIVE);
    assert_int_equal(x.skipped, 1);
    must(identify(0, 1, "", 0));
    assert_int_equal(x.decision, SURFACE_MATCH);
}

TEST(test_damaged_later)
{
    begin();
    must(identify(1, 1, "", 0));
    tempdb_sql("UPDATE templates SET about = zeroblob(100) WHERE template_key = 2");
    must(identify(1, 1, "", 0));
    assert_int_equal(x.decision, SURFACE_INCONCLUSIVE);
    must(identify(0, 1, "", 0));
    assert_int_equal(x.decision, SURFACE_MATCH);
}

/* A threshold that no two scans of one person reach. */
TEST(test_out_of_reach)
{
    struct store_calibration k = tempdb_calibration(200);

    begin();
    must(store_calibration_add(store, "test", &k, &e));
    must(identify(0, 1, "", 0));
    assert_true(x.best.result.threshold >= 200);
    assert_int_equal(x.decision, SURFACE_INCONCLUSIVE);
}

/* Who is erased between the search and the record is not named: the search is made again. */
TEST(test_erased_meanwhile)
{
    begin();
    must(identify(0, 1, "", 0));
    erase_next = true;
    assert_nobody(1, "", TEMPDB_FACES - 1);
    assert_false(erase_next);
}

/* Among four people a match needs more than in a verification. */
TEST(test_threshold_of_four)
{
    struct store_calibration k = tempdb_calibration(8);

    k.table.knot[k.table.n - 1].rate = 0.2;
    begin();
    must(store_calibration_add(store, "test", &k, &e));
    must(identify(0, 1, "", 0));
    assert_true(x.best.result.threshold > 15);
    assert_true((x.decision == SURFACE_MATCH) ==
                (x.best.result.score >= x.best.result.threshold));
}

/* A search counts the scan's quality, whether it finds someone or not. */
TEST(test_counted)
{
    const bool no = false;
    struct store_scans *list;
    size_t n;

    begin();
    must(identify(0, 1, "", 0));
    must(store_subject_set(store, "test", name[0],
                           &(struct store_subject_change){.identify = &no}, &e));
    must(identify(0, 1, "", 0));
    must(store_scans(store, &list, &n, &e));
    assert_int_equal(n, 1);
    assert_string_equal(list[0].token, "test");
    assert_int_equal(list[0].n, 2);
    assert_int_equal(list[0].unusable, 0);
    assert_int_equal(list[0].noise_um,
                     2 * lround(1000 * surface_face_quality(face).noise_mm));
    assert_int_equal(list[0].quality,
                     2 * lround(1000 * surface_face_quality(face).score));
    free(list);
}
