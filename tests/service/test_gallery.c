/* A gallery has exactly those who may be found, whatever has changed since it was followed last: compared with a
 * list kept by hand, over random changes.  Failures of memory and damaged rows hide nobody silently. */
/* link: -Wl,--wrap=aligned_alloc -Wl,--wrap=malloc -Wl,--wrap=calloc */

#include "brute.h"
#include "clouds.h"
#include "errinfo.h"
#include "fail_alloc.h"
#include "gallery.h"
#include "groups.h"
#include "tempdb.h"
#include "unit.h"

#define PEOPLE 12
#define ROUNDS 200

struct one { /* as it should be */
    bool is, disabled, out, expired;
    char groups[GROUPS_SIZE];
    unsigned char uid[STORE_UID];
    char template_id[TEMPDB_FACES][STORE_ID_LEN + 1]; /* "": none */
};

static const char *const labels[] = {"", "a", "b", "a,b", "c"};
static struct draw rng;
static struct store *store;
static struct gallery *gallery;
static struct one one[PEOPLE];
static struct errinfo e;

BEFORE_ALL(set_up)
{
    rng = draw_stream(brute_seed("test_gallery"), 0, 0);
}

static void begin(size_t bytes)
{
    store_close(store);
    gallery_free(gallery);
    memset(one, 0, sizeof one);
    store = tempdb_fresh();
    gallery = gallery_new(bytes);
    assert_non_null(gallery);
}

AFTER_ALL(tear_down)
{
    gallery_free(gallery);
    store_close(store);
}

static enum status follow(void *arg)
{
    struct store_people *p;
    enum status st = store_people_begin(store, "", 0, &p, &e);

    (void)arg;
    if (st == ST_OK)
        st = store_people_end(p, gallery_follow(gallery, p, &e), &e);
    return st;
}

static const char *name(int i)
{
    static char text[16];

    (void)snprintf(text, sizeof text, "p%d", i);
    return text;
}

static int below(int n)
{
    return (int)(draw_next(&rng) % (uint64_t)n);
}

static size_t templates(const struct one *p)
{
    size_t n = 0;

    for (int f = 0; f < TEMPDB_FACES; f++)
        n += p->template_id[f][0] != '\0';
    return n;
}

static const unsigned char *uid_of(int i)
{
    static struct store_subject is;

    must(store_subject_get(store, "", name(i), &is, &e));
    return is.uid;
}

/* ---- changes */

static void enroll(int i, int f)
{
    unsigned char d[SURFACE_DESCRIPTOR];
    const struct store_sample sample = {.face = &tempdb_face[f], .descriptor = d};
    const struct store_enroll what = {
        .actor = "test", .subject = name(i), .label = "", .sample = &sample, .n = 1};
    struct store_template t;
    bool created;

    d[0] = (unsigned char)below(8);
    for (int k = 1; k < SURFACE_DESCRIPTOR; k++)
        d[k] = (unsigned char)(below(21) - 10);
    must(store_enroll(store, &what, &t, &created, &e));
    memcpy(one[i].uid, uid_of(i), STORE_UID);
    memcpy(one[i].template_id[f], t.id, sizeof t.id);
    one[i].is = true;
}

static void set(int i)
{
    struct one *p = &one[i];
    const bool identify = p->out, disabled = !p->disabled;
    const char *groups = labels[below(5)];
    struct store_subject_change what = {.reference = "x"};

    switch (below(3)) {
    case 0:
        what.identify = &identify;
        p->out = !identify;
        break;
    case 1:
        what.disabled = &disabled;
        p->disabled = disabled;
        break;
    default:
        what.groups = groups;
        (void)snprintf(p->groups, sizeof p->groups, "%s", groups);
    }
    must(store_subject_set(store, "test", name(i), &what, &e));
}

static void change(void)
{
    const int i = below(PEOPLE), f = below(TEMPDB_FACES);
    struct one *p = &one[i];

    switch (below(8)) {
    case 0:
        if (p->is)
            must(tempdb_erase(store, "test", name(i), &e));
        memset(p, 0, sizeof *p);
        break;
    case 1:
        if (p->template_id[f][0] != '\0')
            must(store_template_delete(store, "test", p->template_id[f], &e));
        p->template_id[f][0] = '\0';
        break;
    case 2:
    case 3:
    case 4:
        if (p->is)
            set(i);
        break;
    default:
        enroll(i, f);
    }
}

/* ---- the comparison */

static bool is_found(const struct one *p, const char *bound, const char *group)
{
    return p->is && templates(p) > 0 && !p->disabled && !p->out && !p->expired &&
           groups_meet(bound, p->groups) &&
           (group[0] == '\0' || groups_meet(group, p->groups));
}

static void check(const char *bound, const char *group, size_t most)
{
    const struct gallery_search what = {.probe = &tempdb_face[0],
                                        .bound = bound,
                                        .group = group,
                                        .floor = -1e9,
                                        .most = most};
    struct gallery_found found;
    size_t wanted = 0;

    must(gallery_find(gallery, tempdb_work, &what, &found, &e));
    for (int i = 0; i < PEOPLE; i++)
        wanted += is_found(&one[i], bound, group);
    assert_int_equal(found.searched, wanted);
    assert_int_equal(found.skipped, 0);
    assert_int_equal(found.n, wanted < most ? wanted : most);
    for (size_t k = 0; k < found.n; k++) {
        int i = 0;

        while (i < PEOPLE &&
               (!one[i].is || memcmp(one[i].uid, found.uid[k], STORE_UID) != 0))
            i++;
        assert_true(i < PEOPLE && is_found(&one[i], bound, group));
        for (size_t m = 0; m < k; m++) /* each once */
            assert_memory_not_equal(found.uid[m], found.uid[k], STORE_UID);
    }
    gallery_found_free(&found);
}

static void check_all(void)
{
    struct gallery_state is;
    size_t people = 0, all = 0;

    must(follow(NULL));
    for (int b = 0; b < 5; b++) {
        check(labels[b], "", PEOPLE);
        check("", b == 3 ? "" : labels[b], 1 + (size_t)below(PEOPLE));
    }
    for (int i = 0; i < PEOPLE; i++)
        if (is_found(&one[i], "", "")) {
            people++;
            all += templates(&one[i]);
        }
    is = gallery_state(gallery);
    assert_int_equal(is.subjects, people);
    assert_int_equal(is.templates, all);
}

TEST(test_changes)
{
    begin(SIZE_MAX);
    assert_int_equal(gallery_phase(gallery), GALLERY_LOADING);
    for (int round = 0; round < ROUNDS; round++) {
        for (int n = below(4); n > 0; n--)
            change();
        check_all();
    }
    assert_int_equal(gallery_phase(gallery), GALLERY_READY);
    gallery_free(gallery); /* another one, from the beginning */
    gallery = gallery_new(SIZE_MAX);
    check_all();
}

TEST(test_expired)
{
    begin(SIZE_MAX);
    enroll(0, 0);
    enroll(1, 1);
    check_all();
    tempdb_expire(store, name(1));
    one[1].expired = true;
    check_all();
    gallery_free(gallery);
    gallery = gallery_new(SIZE_MAX);
    check_all();
    enroll(1, 2);
    check_all();
    must(store_subject_set(store, "test", name(1),
                           &(struct store_subject_change){.expires = ""}, &e));
    one[1].expired = false;
    check_all();
}

TEST(test_older)
{
    struct store_people *before;

    begin(SIZE_MAX);
    enroll(0, 0);
    must(store_people_begin(store, "", 0, &before, &e));
    enroll(1, 1);
    check_all();
    must(gallery_follow(gallery, before, &e)); /* stays as new as it is */
    check("", "", PEOPLE);
    must(store_people_end(before, ST_OK, &e));
}

static size_t skipped(void)
{
    const struct gallery_search what = {
        .probe = &tempdb_face[0], .bound = "", .group = "", .floor = -1e9, .most = 1};
    struct gallery_found found;
    size_t n;

    must(follow(NULL));
    must(gallery_find(gallery, tempdb_work, &what, &found, &e));
    n = found.skipped;
    gallery_found_free(&found);
    return n;
}

/* Templates of another engine, or damaged, are counted. */
TEST(test_skipped)
{
    begin(SIZE_MAX);
    for (int i = 0; i < 3; i++)
        enroll(i, i);
    assert_int_equal(skipped(), 0);
    store_use_model(store, NULL);
    tempdb_sql("UPDATE templates SET about = zeroblob(100) WHERE template_key = 2");
    assert_int_equal(skipped(), 0); /* nothing says that it has changed */
    must(store_subject_set(store, "test", name(1),
                           &(struct store_subject_change){.reference = "y"}, &e));
    assert_int_equal(skipped(), 1);
    assert_int_equal(gallery_state(gallery).subjects, 2);
    gallery_free(gallery);
    gallery = gallery_new(SIZE_MAX);
    assert_int_equal(skipped(), 1);
    assert_int_equal(gallery_state(gallery).subjects, 2);
}

/* More templates of one subject than are asked for at first, all more alike than the other subject's. */
TEST(test_many_templates)
{
    static struct dvec3 pts[800];
    unsigned char d[SURFACE_DESCRIPTOR];
    static struct surface_face f;
    const struct store_sample sample = {.face = &f, .descriptor = d};
    const struct store_enroll what = {
        .actor = "test", .subject = name(0), .label = "", .sample = &sample, .n = 1};
    struct store_template t;
    bool created;

    begin(SIZE_MAX);
    assert_int_equal(surface_describe(tempdb_work, &tempdb_face[0], d), SURFACE_OK);
    for (uint64_t k = 0; k < 12; k++) {
        assert_int_equal(
            face_build(pts, clouds_scan(7, k, 800, pts), tempdb_work, &f, NULL), ST_OK);
        must(store_enroll(store, &what, &t, &created, &e));
        face_free(&f);
    }
    (void)snprintf(one[0].template_id[0], sizeof t.id, "%s", t.id);
    one[0].is = true;
    enroll(1, 1);
    memcpy(one[0].uid, uid_of(0), STORE_UID);
    must(follow(NULL));
    for (size_t most = 1; most < 4; most++)
        check("", "", most);
}

TEST(test_full)
{
    begin(100000); /* less than one chunk of the index */
    enroll(0, 0);
    assert_int_equal(follow(NULL), ST_ELIMIT);
    assert_int_equal(gallery_phase(gallery), GALLERY_FULL);
    assert_int_equal(gallery_state(gallery).templates, 0);
    assert_int_equal(follow(NULL), ST_ELIMIT);
}

static enum status begin_and_follow(void *arg)
{
    gallery_free(gallery);
    return (gallery = gallery_new(SIZE_MAX)) != NULL ? follow(arg) : ST_ENOMEM;
}

TEST(test_no_memory)
{
    begin(SIZE_MAX);
    for (int i = 0; i < 5; i++)
        enroll(i, i % TEMPDB_FACES);
    assert_true(fail_alloc_walk(begin_and_follow, NULL) > 1);
    check_all();
    enroll(5, 0);
    must(tempdb_erase(store, "test", name(1), &e));
    memset(&one[1], 0, sizeof one[1]);
    assert_true(fail_alloc_walk(follow, NULL) > 0);
    check_all();
}
