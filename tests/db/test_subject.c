/* What is stored of a subject, and how it changes: set, renamed, held, disabled, seen,
 * due; each change is one transaction with its event. */
#include "face.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;

static void enroll(struct store *s, const char *subject, struct store_template *t)
{
    tempdb_enroll(s, subject, "a label", &tempdb_face[0], t);
}

static struct store_subject get(struct store *s, const char *subject)
{
    struct store_subject one;

    must(store_subject_get(s, subject, &one, &e));
    return one;
}

static int64_t changes(const char *kind)
{
    char text[128];

    (void)snprintf(text, sizeof text, "change_log WHERE kind = '%s'", kind);
    return tempdb_count(text);
}

static enum status set(struct store *s, const char *subject, const char *reference,
                       const char *purpose, const char *expires)
{
    return store_subject_set(s, "me", subject,
                             &(struct store_subject_change){.reference = reference,
                                                            .purpose = purpose,
                                                            .expires = expires},
                             &e);
}

static enum status hold(struct store *s, const char *subject, bool held)
{
    return store_subject_set(s, "me", subject,
                             &(struct store_subject_change){.hold = &held}, &e);
}

/* All of a change or nothing, with an event for each part; its templates keep their key. */
TEST(test_set)
{
    const bool yes = true, no = false;
    struct store_subject_change what = {.reference = "C-17",
                                        .purpose = "the door",
                                        .expires = "2031-02-03T04:05:06+01:00",
                                        .hold = &yes,
                                        .disabled = &yes};
    struct store *s = tempdb_fresh();
    struct store_template t, got;
    struct store_subject one;
    char longer[STORE_NOTE_MAX + 2];

    enroll(s, "alice", &t);
    must(store_subject_set(s, "me", "alice", &what, &e));
    one = get(s, "alice");
    assert_string_equal(one.reference, "C-17");
    assert_string_equal(one.purpose, "the door");
    assert_string_equal(one.expires, "2031-02-03T03:05:06.000Z");
    assert_true(one.hold && one.disabled && !one.expired);
    tempdb_expire(s, "alice");
    assert_true(get(s, "alice").expired);
    assert_int_equal(set(s, "alice", NULL, NULL, "2020-01-01"), ST_EINVAL);
    assert_non_null(strstr(e.msg, "in the past"));
    assert_int_equal(set(s, "alice", NULL, "", ""), ST_OK);
    what = (struct store_subject_change){.disabled = &no};
    must(store_subject_set(s, "me", "alice", &what, &e));
    one = get(s, "alice");
    assert_string_equal(one.reference, "C-17");
    assert_string_equal(one.purpose, "");
    assert_string_equal(one.expires, "");
    assert_false(one.disabled);
    assert_int_equal(one.templates, 1);
    must(store_template_get(s, t.id, &got, &e));
    assert_string_equal(got.subject, "alice");
    assert_string_equal(got.label, "a label");

    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_int_equal(set(s, "alice", longer, NULL, NULL), ST_EINVAL);
    what = (struct store_subject_change){.purpose = "a\nb", .hold = &no};
    fails(store_subject_set(s, "me", "alice", &what, &e), ST_EINVAL);
    assert_int_equal(set(s, "alice", NULL, NULL, "tomorrow"), ST_EINVAL);
    assert_int_equal(set(s, "nobody", "x", NULL, NULL), ST_ENOTFOUND);
    assert_int_equal(set(s, "no body", "x", NULL, NULL), ST_EINVAL);
    what = (struct store_subject_change){0};
    must(store_subject_set(s, "me", "alice", &what, &e));
    fails(store_subject_set(s, "me", "nobody", &what, &e), ST_ENOTFOUND);
    assert_string_equal(get(s, "alice").reference, "C-17");
    assert_true(get(s, "alice").hold);
    assert_int_equal(changes("set_subject"), 3);
    assert_int_equal(changes("hold_subject"), 1);
    assert_int_equal(changes("release_subject"), 0);
    assert_int_equal(changes("disable_subject"), 1);
    assert_int_equal(changes("enable_subject"), 1);
    store_close(s);
}

TEST(test_rename)
{
    struct store *s = tempdb_fresh();
    struct store_template t, *list;
    struct store_subject one;
    size_t n;

    enroll(s, "alice", &t);
    enroll(s, "bob", &t);
    assert_int_equal(set(s, "alice", "C-17", NULL, NULL), ST_OK);
    fails(store_subject_rename(s, "me", "alice", "bob", &e), ST_EEXISTS);
    fails(store_subject_rename(s, "me", "alice", "alice", &e), ST_EEXISTS);
    fails(store_subject_rename(s, "me", "alice", "a b", &e), ST_EINVAL);
    fails(store_subject_rename(s, "me", "nobody", "carol", &e), ST_ENOTFOUND);
    assert_int_equal(changes("rename_subject"), 0);
    must(store_subject_rename(s, "me", "alice", "carol", &e));
    assert_int_equal(changes("rename_subject"), 1);
    fails(store_subject_get(s, "alice", &one, &e), ST_ENOTFOUND);
    one = get(s, "carol");
    assert_string_equal(one.id, "carol");
    assert_string_equal(one.reference, "C-17");
    must(store_template_list(s, "carol", &list, &n, &e));
    assert_int_equal(n, 1);
    assert_string_equal(list[0].subject, "carol");
    free(list);

    /* Another subject may get the old id, also after an erasure. */
    enroll(s, "alice", &t);
    must(tempdb_erase(s, "", "alice", &e));
    assert_int_equal(changes("delete_subject"), 1);
    must(store_subject_rename(s, "", "carol", "alice", &e));
    store_close(s);
}

TEST(test_hold)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    struct store_subject one;

    enroll(s, "alice", &t);
    assert_int_equal(hold(s, "alice", true), ST_OK);
    assert_int_equal(hold(s, "alice", true), ST_OK);
    assert_true(get(s, "alice").hold);
    fails(tempdb_erase(s, "", "alice", &e), ST_EHELD);
    fails(store_template_delete(s, "", t.id, &e), ST_EHELD);
    tempdb_expire(s, "alice");
    fails(store_subject_purge(s, "", "alice", &e), ST_EHELD);
    assert_int_equal(get(s, "alice").templates, 1);
    /* The bit alone, without the key, is no release: the row is damaged then. */
    tempdb_sql("UPDATE subjects SET hold = 0");
    fails(store_subject_get(s, "alice", &one, &e), ST_ECORRUPT);
    tempdb_sql("UPDATE subjects SET hold = 1");
    assert_int_equal(hold(s, "alice", false), ST_OK);
    assert_int_equal(changes("hold_subject"), 2);
    assert_int_equal(changes("release_subject"), 1);
    must(store_template_delete(s, "", t.id, &e));
    must(tempdb_erase(s, "", "alice", &e));
    store_close(s);
}

static void see(struct store *s, const struct store_subject *one)
{
    const struct store_record what = {.subject = one,
                                      .actor = "",
                                      .kind = "verify",
                                      .template_id = "",
                                      .outcome = "match"};
    struct store_recorded out = {0};

    must(store_record_verification(s, &what, &out, &e));
}

TEST(test_seen)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    struct store_subject one;
    bool created;

    enroll(s, "alice", &t);
    one = get(s, "alice");
    assert_string_equal(one.seen, t.created);
    tempdb_sql("UPDATE subjects SET seen = '2026-01-01T00:00:00.000Z'");
    one = get(s, "alice");
    see(s, &one);
    assert_true(strcmp(get(s, "alice").seen, t.created) >= 0);
    /* Once a minute; but a time that is still to come is a mistake. */
    one = get(s, "alice");
    tempdb_sql("UPDATE subjects SET seen = NULL");
    see(s, &one);
    assert_string_equal(get(s, "alice").seen, "");
    tempdb_sql("UPDATE subjects SET seen = '9026-01-01T00:00:00.000Z'");
    one = get(s, "alice");
    see(s, &one);
    assert_true(get(s, "alice").seen[0] == '2');
    /* Enrolling the same scan again counts as seen too. */
    tempdb_sql("UPDATE subjects SET seen = NULL");
    must(tempdb_store(s, "", "alice", "", &tempdb_face[0], &t, &created, &e));
    assert_false(created);
    assert_true(get(s, "alice").seen[0] == '2');
    assert_int_equal(changes("enroll"), 1);
    store_close(s);
}

TEST(test_due)
{
    static const struct {
        const char *id, *expires;
    } some[] = {{"never", ""},
                {"later", "9031-01-01T00:00:00.000Z"},
                {"second", ""},
                {"first", ""},
                {"held", ""}};
    struct store *s = tempdb_fresh();
    struct store_subject *due, one;
    size_t n;

    must(store_subject_due(s, &due, &n, &e));
    assert_int_equal(n, 0);
    free(due);
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        memset(&one, 0, sizeof one);
        (void)snprintf(one.id, sizeof one.id, "%s", some[i].id);
        (void)snprintf(one.expires, sizeof one.expires, "%s", some[i].expires);
        must(store_subject_add(s, "", &one, &e));
    }
    tempdb_expire(s, "first");
    tempdb_expire(s, "second");
    tempdb_expire(s, "held");
    assert_int_equal(hold(s, "held", true), ST_OK);
    must(store_subject_due(s, &due, &n, &e));
    assert_int_equal(n, 3);
    assert_string_equal(due[0].id, "first");
    assert_string_equal(due[1].id, "second");
    assert_string_equal(due[2].id, "held");
    assert_true(due[2].hold);
    free(due);
    fails(store_subject_purge(s, "", "never", &e), ST_ENOTFOUND);
    fails(store_subject_purge(s, "", "later", &e), ST_ENOTFOUND);
    fails(store_subject_purge(s, "", "nobody", &e), ST_ENOTFOUND);
    must(store_subject_purge(s, "", "first", &e));
    fails(store_subject_get(s, "first", &one, &e), ST_ENOTFOUND);
    assert_int_equal(changes("delete_subject"), 1);
    store_close(s);
}

TEST(test_vacuum)
{
    struct store *s = tempdb_fresh(), *reader = NULL;
    struct store_stats before, after;
    struct store_template t;
    char id[32];

    for (int i = 0; i < 20; i++) {
        (void)snprintf(id, sizeof id, "s%d", i);
        enroll(s, id, &t);
    }
    for (int i = 0; i < 19; i++) {
        (void)snprintf(id, sizeof id, "s%d", i);
        must(tempdb_erase(s, "", id, &e));
    }
    must(store_stats(s, &before, &e));
    must(store_vacuum(s, &e));
    must(store_stats(s, &after, &e));
    assert_true(after.file_bytes < before.file_bytes / 2);
    assert_int_equal(get(s, "s19").templates, 1);
    enroll(s, "after", &t);
    must(store_open(tempdb_path, STORE_READ, NULL, &reader, &e));
    fails(store_vacuum(reader, &e), ST_EDENIED);
    store_close(reader);
    store_close(s);
}
