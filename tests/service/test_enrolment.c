/* link: -Wl,--wrap=store_enroll */
/* A sample becomes a template if it matches the subject's oldest template or one that was enrolled
 * with scope manage, if it is forced, or if it is the first; of several the others likewise, or where
 * the first is what they have to fit, if they match that one; but not of a disabled or expired
 * subject. */
#include "clouds.h"
#include "enrolment.h"
#include "errinfo.h"
#include "tempdb.h"
#include "unit.h"

#define POINTS 1500

static struct store *store;
static struct surface_face again;    /* another scan of tempdb_face[0]'s person */
static struct surface_face cheek;    /* a part of that */
static struct surface_face other[2]; /* other scans of tempdb_face[1]'s person */
static struct errinfo e;
static const struct surface_face
    *rival; /* enrolled before the next store_enroll(); NULL: none */

enum status __real_store_enroll(struct store *s, const struct store_enroll *what,
                                struct store_template *t, bool *created,
                                struct errinfo *err);
enum status __wrap_store_enroll(struct store *s, const struct store_enroll *what,
                                struct store_template *t, bool *created,
                                struct errinfo *err);

/* A concurrent enrolment between comparing and storing, once. */
enum status __wrap_store_enroll(struct store *s, const struct store_enroll *what,
                                struct store_template *t, bool *created,
                                struct errinfo *err)
{
    const struct surface_face *f = rival;
    struct store_template its;

    rival = NULL;
    if (f != NULL)
        tempdb_enroll(s, "alice", "", f, &its);
    return __real_store_enroll(s, what, t, created, err);
}

static struct enrolment_result each[ENROLMENT_SAMPLES];
static bool manager;

static enum status add_all(const struct surface_face *const f[], size_t n, bool force,
                           struct enrolment_outcome *out)
{
    struct templates_context c = {.store = store, .work = tempdb_work};
    struct store_sample sample[ENROLMENT_SAMPLES] = {{.face = NULL}};
    const struct enrolment x = {.actor = "test",
                                .subject = "alice",
                                .label = "",
                                .sample = sample,
                                .n = n,
                                .manager = manager,
                                .force = force};

    memset(each, 0, sizeof each);
    for (size_t i = 0; i < n; i++)
        if ((sample[i].face = f[i]) == NULL)
            (void)errinfo_set(&each[i].why, ST_EQUALITY, "too poor");
    return enrolment_add(&c, &x, NULL, each, out, &e);
}

static enum status add(const struct surface_face *f, bool force,
                       struct enrolment_outcome *out)
{
    return add_all(&f, 1, force, out);
}

/* Of add_all(): '1' a new template, 's' the same again, '.' it does not fit, '-' it was no
 * face. */
static void assert_taken(const char *what)
{
    for (size_t i = 0; what[i] != '\0'; i++) {
        const bool taken = what[i] == '1' || what[i] == 's';

        assert_int_equal(each[i].why.code, what[i] == '.'   ? ST_EMISMATCH
                                           : what[i] == '-' ? ST_EQUALITY
                                                            : ST_OK);
        assert_int_equal(each[i].created, what[i] == '1');
        assert_int_equal(each[i].tmpl.id[0] != '\0', taken);
        assert_int_equal(each[i].why.msg[0] == '\0', taken);
    }
}

BEFORE_ALL(set_up)
{
    static struct dvec3 pts[POINTS];
    size_t n, part = 0;

    n = clouds_scan(1, 1, POINTS, pts);
    assert_int_equal(face_build(pts, n, tempdb_work, &again, NULL), ST_OK);
    for (size_t i = 0; i < n; i++)
        if (pts[i].x > 20)
            pts[part++] = pts[i];
    assert_int_equal(face_build(pts, part, tempdb_work, &cheek, NULL), ST_OK);
    for (uint64_t i = 0; i < 2; i++) {
        n = clouds_scan(2, i + 1, POINTS, pts);
        assert_int_equal(face_build(pts, n, tempdb_work, &other[i], NULL), ST_OK);
    }
}

AFTER_ALL(tear_down)
{
    face_free(&again);
    face_free(&cheek);
    face_free(&other[0]);
    face_free(&other[1]);
}

BEFORE_EACH(fresh)
{
    store = tempdb_fresh();
}

AFTER_EACH(closed)
{
    store_close(store);
}

TEST(test_fit)
{
    struct enrolment_outcome out;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_true(each[0].created);
    assert_int_equal(out.nearest.compared, 0);
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_true(each[0].created);
    assert_int_equal(out.nearest.compared, 1);
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_false(each[0].created);
    assert_int_equal(add(&tempdb_face[1], false, &out), ST_EMISMATCH);
    assert_int_equal(out.nearest.compared, 1);
    assert_int_equal(out.nearest.result.decision, SURFACE_NO_MATCH);
    assert_non_null(strstr(e.msg, "does not fit"));
    assert_int_equal(add(&tempdb_face[1], true, &out), ST_OK);
    assert_int_equal(out.nearest.compared, 1);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 3);
}

/* A further sample is held against the oldest template, and those that a manager enrolled. */
TEST(test_basis)
{
    struct enrolment_outcome out;
    struct store_template t;
    double first;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_false(each[0].tmpl.manager);
    assert_true(each[0].tmpl.first_score == 0);
    assert_int_equal(add(&again, false, &out), ST_OK);
    first = each[0].tmpl.first_score;
    assert_true(first == out.nearest.result.score && first > 8);
    /* by force, without scope manage: nothing is held against it */
    assert_int_equal(add(&tempdb_face[1], true, &out), ST_OK);
    assert_true(each[0].tmpl.first_score < 0);
    assert_int_equal(store_template_get(store, "", each[0].tmpl.id, &t, &e), ST_OK);
    assert_true(t.first_score == each[0].tmpl.first_score && !t.manager);
    assert_int_equal(add(&other[0], false, &out), ST_EMISMATCH);
    assert_int_equal(out.nearest.compared, 1);
    /* with it, it is */
    manager = true;
    assert_int_equal(add(&other[0], true, &out), ST_OK);
    manager = false;
    assert_true(each[0].tmpl.manager);
    assert_int_equal(store_template_get(store, "", each[0].tmpl.id, &t, &e), ST_OK);
    assert_true(t.manager);
    assert_int_equal(add(&other[1], false, &out), ST_OK);
    assert_int_equal(out.nearest.compared, 2);
    assert_true(each[0].tmpl.first_score < 0 && out.nearest.result.score > 8);
    assert_false(each[0].tmpl.manager);
    assert_int_equal(store_verify(store, NULL, NULL, &e), ST_OK);
}

/* Several, of which the first fits: the others are held against the same templates, not against
 * that one, unless a manager enrolls them. */
TEST(test_several_basis)
{
    const struct surface_face *const burst[] = {&other[0], &again, &other[1]};
    struct enrolment_outcome out;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(add(&tempdb_face[1], true, &out), ST_OK);
    assert_int_equal(add_all(burst, 3, false, &out), ST_OK);
    assert_taken(".1.");
    assert_non_null(strstr(each[2].why.msg, "does not match the first"));
    manager = true;
    assert_int_equal(add(&tempdb_face[2], true, &out), ST_OK);
    assert_int_equal(add_all(burst, 3, false, &out), ST_OK);
    manager = false;
    assert_taken(".s.");
    assert_non_null(strstr(each[2].why.msg, "does not match the first"));
}

/* A sample that has too little in common with the others to tell. */
TEST(test_inconclusive)
{
    struct enrolment_outcome out;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(add(&cheek, false, &out), ST_EMISMATCH);
    assert_int_equal(out.nearest.result.decision, SURFACE_INCONCLUSIVE);
    assert_non_null(strstr(e.msg, "too little in common"));
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 1);
    assert_int_equal(add(&cheek, true, &out), ST_OK);
    assert_true(each[0].created);
}

/* A template that is enrolled between comparing and storing is compared with too. */
TEST(test_meanwhile)
{
    struct enrolment_outcome out;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    rival = &tempdb_face[1];
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_null(rival);
    assert_int_equal(out.nearest.compared, 1);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 3);
}

TEST(test_admitted)
{
    static const bool yes = true, no = false;
    struct enrolment_outcome out;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(store_subject_set(store, "test", "alice",
                                       &(struct store_subject_change){.disabled = &yes},
                                       &e),
                     ST_OK);
    for (int force = 0; force < 2; force++) {
        assert_int_equal(add(&again, force == 1, &out), ST_EDENIED);
        assert_int_equal(out.refusal.admit, TEMPLATES_DISABLED);
        assert_non_null(strstr(e.msg, "alice is disabled"));
    }
    assert_int_equal(store_subject_set(store, "test", "alice",
                                       &(struct store_subject_change){.disabled = &no},
                                       &e),
                     ST_OK);
    tempdb_expire(store, "alice");
    assert_int_equal(add(&again, false, &out), ST_EDENIED);
    assert_int_equal(out.refusal.admit, TEMPLATES_EXPIRED);
    assert_non_null(strstr(e.msg, "alice expired at 20"));
    assert_int_equal(store_subject_set(store, "test", "alice",
                                       &(struct store_subject_change){.expires = ""}, &e),
                     ST_OK);
    assert_int_equal(add(&again, false, &out), ST_OK);
    assert_int_equal(out.refusal.admit, TEMPLATES_ADMITTED);
}

/* Several at once: each that matches the first becomes a template. */
TEST(test_several)
{
    const struct surface_face *const burst[] = {&tempdb_face[0], &tempdb_face[1], &again,
                                                &tempdb_face[0], &cheek,          &again};
    struct enrolment_outcome out;

    assert_int_equal(add_all(burst, 6, false, &out), ST_OK);
    assert_taken("1.1s.s");
    assert_non_null(strstr(each[1].why.msg, "does not match the first"));
    assert_non_null(strstr(each[4].why.msg, "too little in common"));
    assert_string_equal(each[3].tmpl.id, each[0].tmpl.id);
    assert_string_equal(each[5].tmpl.id, each[2].tmpl.id);
    assert_int_equal(out.nearest.compared, 0);
    /* what was compared with another sample alone says nothing of the subject */
    assert_int_equal(tempdb_number("SELECT count(*) FROM access_log"
                                   " WHERE kind = 'enroll_mismatch'"),
                     0);
    assert_int_equal(add_all(burst, 6, false, &out), ST_OK);
    assert_taken("s.ss.s");
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 2);
    assert_int_equal(add_all(burst, 6, true, &out), ST_OK);
    assert_taken("s1ss1s");
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 4);
    assert_int_equal(store_verify(store, NULL, NULL, &e), ST_OK);
}

/* Those before the first that fits are tried as if each had come alone; none fits: the first
 * one's reason. */
TEST(test_first)
{
    const struct surface_face *const burst[] = {&tempdb_face[1], &cheek, &again,
                                                &tempdb_face[1], &tempdb_face[0]};
    struct enrolment_outcome out;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(add_all(burst, 2, false, &out), ST_EMISMATCH);
    assert_taken("..");
    assert_string_equal(e.msg, each[0].why.msg);
    assert_non_null(
        strstr(each[0].why.msg, "matches neither the subject's oldest template"));
    assert_non_null(
        strstr(each[1].why.msg, "too little in common with the subject's oldest"));
    assert_int_equal(tempdb_number("SELECT count(*) FROM access_log"
                                   " WHERE kind = 'enroll_mismatch'"),
                     2);
    assert_int_equal(add_all(burst, 5, false, &out), ST_OK);
    assert_taken("..1.s");
    assert_int_equal(tempdb_number("SELECT count(*) FROM access_log"
                                   " WHERE kind = 'enroll_mismatch'"),
                     5); /* the fourth: that it does not match the first accepted one */
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 2);
}

/* Another enrolment in between: what stands for the burst is compared again, and the burst is
 * stored whole. */
TEST(test_several_meanwhile)
{
    const struct surface_face *const burst[] = {&tempdb_face[2], &again, &tempdb_face[0]};
    struct enrolment_outcome out;

    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    rival = &tempdb_face[1];
    assert_int_equal(add_all(burst, 3, false, &out), ST_OK);
    assert_taken(".1s");
    assert_null(rival);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 3);
}

/* Those that are no faces are passed over, wherever they stand. */
TEST(test_refused)
{
    const struct surface_face *const burst[] = {NULL, &tempdb_face[0], NULL, &again,
                                                NULL};
    struct enrolment_outcome out;

    for (int force = 0; force < 2; force++) {
        assert_int_equal(add_all(burst, 1, force == 1, &out), ST_EQUALITY);
        assert_true(out.none);
        assert_string_equal(e.msg, "too poor");
    }
    assert_int_equal(add_all(burst, 5, false, &out), ST_OK);
    assert_false(out.none);
    assert_taken("-1-1-");
    assert_int_equal(add_all((const struct surface_face *const[]){NULL, &tempdb_face[1]},
                             2, false, &out),
                     ST_EQUALITY);
    assert_true(out.none);
    assert_taken("-.");
    assert_int_equal(add_all(burst, 5, true, &out), ST_OK);
    assert_taken("-s-s-");
}

/* Locked out on the way: nothing is enrolled. */
TEST(test_locked)
{
    struct store_sample sample[] = {{.face = &tempdb_face[1]}, {.face = &again}};
    struct templates_context c = {.store = store, .work = tempdb_work};
    const struct store_limits limits = {.failures = 1, .wait_s = 30};
    const struct enrolment x = {.actor = "test",
                                .subject = "alice",
                                .label = "",
                                .sample = sample,
                                .n = 2,
                                .limits = &limits};
    struct enrolment_outcome out;

    memset(each, 0, sizeof each);
    assert_int_equal(add(&tempdb_face[0], false, &out), ST_OK);
    assert_int_equal(enrolment_add(&c, &x, NULL, each, &out, &e), ST_EDENIED);
    assert_int_equal(out.refusal.why, STORE_WAIT_OWN);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 1);
}

/* What cannot be stored whole is not stored at all. */
TEST(test_all_or_none)
{
    struct surface_face bad = again; /* fits, but the database refuses it */
    const struct surface_face *burst[] = {&tempdb_face[0], &bad};
    struct enrolment_outcome out;

    bad.surface.mesh.nt = 0;
    assert_int_equal(add_all(burst, 2, false, &out), ST_EDB);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 0);
    assert_int_equal(tempdb_number("SELECT count(*) FROM subjects"), 0);
    burst[1] = &again;
    assert_int_equal(add_all(burst, 2, false, &out), ST_OK);
    assert_taken("11");
}

TEST(test_code)
{
    assert_string_equal(enrolment_code(ST_EMISMATCH), "sample_mismatch");
    assert_string_equal(enrolment_code(ST_EQUALITY), "low_quality");
    assert_string_equal(enrolment_code(ST_EINVAL), "malformed");
    assert_null(enrolment_code(ST_OK));
}
