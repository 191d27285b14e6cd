/* Tokens that are bound to groups: what exists for them. */
#include "forge.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;
static char east[STORE_ID_LEN + 1], both[STORE_ID_LEN + 1]; /* tokens, by their groups */

enum { EAST, BOTH, WEST, NONE, PEOPLE };
static const char *const name[PEOPLE] = {"p-east", "p-both", "p-west", "p-none"};
static char template_id[PEOPLE][STORE_ID_LEN + 1];

static void bound(struct store *s, const char *groups, char id[STORE_ID_LEN + 1])
{
    struct store_token t;
    char secret[65];

    must(store_token_create(s, "test", groups, STORE_SCOPE_ALL & ~STORE_SCOPE_AUDIT,
                            groups, 0, secret, &t, &e));
    memcpy(id, t.id, sizeof t.id);
}

static struct store *people(void)
{
    static const char *const groups[PEOPLE] = {"east", "east,west", "west", ""};
    struct store *s = tempdb_fresh();

    for (int i = 0; i < PEOPLE; i++) {
        struct store_subject one = {.identify = true};
        struct store_template t;

        (void)snprintf(one.id, sizeof one.id, "%s", name[i]);
        (void)snprintf(one.groups, sizeof one.groups, "%s", groups[i]);
        must(store_subject_add(s, "test", &one, &e));
        tempdb_enroll(s, name[i], "", &tempdb_face[i], &t);
        memcpy(template_id[i], t.id, sizeof t.id);
    }
    bound(s, "east", east);
    bound(s, "east,west", both);
    return s;
}

/* ---- every call that names a subject or a template */

static enum status call(struct store *s, int k, const char *subject, const char *id)
{
    static const bool no = false;
    struct store_template t, *list = NULL;
    struct store_subject one;
    struct store_worst worst;
    struct store_receipt r = {.templates = 0};
    struct store_snapshot out;
    struct surface_face *f = NULL;
    enum status st = ST_OK;
    size_t n;

    switch (k) {
    case 0:
        return store_subject_get(s, east, subject, &one, &e);
    case 1:
        st = store_template_list(s, east, subject, &list, &n, &e);
        free(list);
        return st;
    case 2:
        return store_attempts_worst(s, east, subject, NULL, &worst, &e);
    case 3:
        return store_attempts_reset(s, east, subject, &e);
    case 4:
        return store_subject_set(s, east, subject,
                                 &(struct store_subject_change){.hold = &no}, &e);
    case 5:
        return store_subject_set(s, east, subject,
                                 &(struct store_subject_change){.groups = "east"}, &e);
    case 6:
    case 7: {
        const struct store_snapshot_of of = {
            .subject = k == 6 ? subject : NULL, .template_id = id, .token = east};

        st = store_snapshot_end(&out, store_snapshot_begin(s, &of, &out, &e), &e);
        store_snapshot_free(&out);
        return st;
    }
    case 8:
        return store_template_get(s, east, id, &t, &e);
    case 9:
        st = store_template_load(s, east, id, &t, tempdb_work, &f, &e);
        surface_face_free(f);
        return st;
    case 10:
        return store_template_delete(s, east, id, &e);
    default:
        st = store_subject_erase(s, east, subject, &r, &e);
        store_receipt_free(&r);
        return st;
    }
}

#define CALLS 12

/* Without the ids that the caller has sent, which stand at the end. */
static void cut(char *text, const char *id)
{
    char *at = strstr(text, id);

    if (at != NULL)
        *at = '\0';
}

TEST(test_outside_is_missing)
{
    static const char missing[] = "ffffffffffffffffffffffffffffffff";
    struct store *s = people();

    for (int k = 0; k < CALLS; k++) {
        char wanted[sizeof e.msg];

        fails(call(s, k, "nobody", missing), ST_ENOTFOUND);
        cut(e.msg, "nobody");
        cut(e.msg, missing);
        memcpy(wanted, e.msg, sizeof wanted);
        for (int i = WEST; i <= NONE; i++) {
            fails(call(s, k, name[i], template_id[i]), ST_ENOTFOUND);
            cut(e.msg, name[i]);
            cut(e.msg, template_id[i]);
            assert_string_equal(e.msg, wanted);
        }
    }
    for (int i = EAST; i <= BOTH; i++)
        for (int k = 0; k < CALLS; k++)
            must(call(s, k, name[i], template_id[i]));
    store_close(s);
    assert_int_equal(tempdb_count("subjects"), 2);
    assert_int_equal(tempdb_count("templates"), 2);
}

/* ---- lists */

static size_t search(struct store *s, const char *actor, const char *group, size_t limit,
                     char out[200])
{
    struct store_search what = {.part = "", .group = group, .limit = limit};
    struct store_subject *page;
    size_t pages = 0, n;

    out[0] = '\0';
    do {
        must(store_subject_search(s, actor, &what, &page, &n, &what.after, &e));
        for (size_t i = 0; i < n; i++)
            (void)snprintf(out + strlen(out), 200 - strlen(out), "%s[%s] ", page[i].id,
                           page[i].groups);
        free(page);
        pages++;
    } while (what.after != 0);
    return pages;
}

TEST(test_search)
{
    struct store *s = people();
    char out[200];
    struct store_search what = {.part = "", .group = "", .limit = 1};
    struct store_subject *page;
    int64_t next;
    size_t n;

    assert_int_equal(search(s, "", "", 10, out), 1);
    assert_string_equal(out, "p-east[east] p-both[east,west] p-west[west] p-none[] ");
    assert_int_equal(search(s, "", "west", 1, out), 2);
    assert_string_equal(out, "p-both[east,west] p-west[west] ");
    assert_int_equal(search(s, east, "", 1, out), 2);
    assert_string_equal(out, "p-east[east] p-both[east] ");
    assert_int_equal(search(s, both, "", 1, out), 3);
    assert_string_equal(out, "p-east[east] p-both[east,west] p-west[west] ");
    (void)search(s, east, "west", 10, out); /* its own groups alone are known */
    assert_string_equal(out, "");
    must(store_subject_search(s, east, &what, &page, &n, &next, &e));
    assert_int_equal(next, page[0].key); /* not where the next subject of others is */
    free(page);
    store_close(s);
}

/* What a verification reads has no group of others either. */
TEST(test_snapshot)
{
    const struct store_snapshot_of of = {.subject = "p-both", .token = east};
    struct store *s = people();
    struct store_snapshot out;

    must(store_snapshot_end(&out, store_snapshot_begin(s, &of, &out, &e), &e));
    assert_string_equal(out.subject.groups, "east");
    store_snapshot_free(&out);
    store_close(s);
}

/* ---- new subjects */

static enum status add(struct store *s, const char *actor, const char *id,
                       const char *groups)
{
    struct store_subject one = {.identify = true};

    (void)snprintf(one.id, sizeof one.id, "%s", id);
    (void)snprintf(one.groups, sizeof one.groups, "%s", groups);
    return store_subject_add(s, actor, &one, &e);
}

static const char *groups_of(struct store *s, const char *id)
{
    static struct store_subject one;

    must(store_subject_get(s, "", id, &one, &e));
    return one.groups;
}

static enum status enroll(struct store *s, const char *actor, const char *subject,
                          const char *groups)
{
    const struct store_sample sample = {.face = &tempdb_face[3]};
    const struct store_enroll what = {.actor = actor,
                                      .subject = subject,
                                      .label = "",
                                      .sample = &sample,
                                      .n = 1,
                                      .groups = groups};
    struct store_template t;
    bool created;

    return store_enroll(s, &what, &t, &created, &e);
}

TEST(test_new_subjects)
{
    struct store *s = people();

    must(add(s, both, "a", ""));
    assert_string_equal(groups_of(s, "a"), "east,west");
    must(add(s, both, "b", "west"));
    assert_string_equal(groups_of(s, "b"), "west");
    fails(add(s, both, "c", "north"), ST_EDENIED);
    fails(add(s, both, "c", "east,north"), ST_EDENIED);
    fails(add(s, east, "p-west", ""), ST_EEXISTS);
    fails(add(s, "", "c", "No Label"), ST_EINVAL);
    must(enroll(s, east, "d", NULL));
    assert_string_equal(groups_of(s, "d"), "east");
    must(enroll(s, "", "e", "y,x"));
    assert_string_equal(groups_of(s, "e"), "x,y");
    must(enroll(s, east, "p-both", NULL));
    fails(enroll(s, east, "p-west", NULL), ST_EEXISTS);
    fails(enroll(s, east, "p-none", NULL), ST_EEXISTS);
    store_close(s);
    assert_int_equal(tempdb_count("subjects"), 8);
    assert_int_equal(tempdb_count("templates"), 7);
}

/* ---- changes */

static enum status set(struct store *s, const char *actor, const char *id,
                       const char *groups)
{
    return store_subject_set(s, actor, id,
                             &(struct store_subject_change){.groups = groups}, &e);
}

TEST(test_change_groups)
{
    struct store *s = people();

    must(set(s, "", "p-none", "z,y,z"));
    assert_string_equal(groups_of(s, "p-none"), "y,z");
    must(set(s, "", "p-none", ""));
    assert_string_equal(groups_of(s, "p-none"), "");
    fails(set(s, "", "p-none", "a,"), ST_EINVAL);
    /* One that is bound changes its own groups, and leaves the others as they are. */
    must(set(s, east, "p-both", "east"));
    assert_string_equal(groups_of(s, "p-both"), "east,west");
    must(set(s, both, "p-east", "west"));
    assert_string_equal(groups_of(s, "p-east"), "west");
    fails(set(s, east, "p-both", ""), ST_EDENIED);
    fails(set(s, east, "p-both", "east,west"), ST_EDENIED);
    fails(set(s, east, "p-west", "west"), ST_EDENIED);
    fails(set(s, east, "nobody", "west"),
          ST_EDENIED); /* no more than of one that is there */
    must(set(s, "", "p-both", "1,2,3,4,5,6,7,east"));
    fails(set(s, both, "p-both", "east,west"), ST_EINVAL);
    store_close(s);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'set_groups'"), 5);
}

TEST(test_identify)
{
    static const bool yes = true, no = false;
    struct store *s = people();
    struct store_subject one = {.id = "shy"};

    must(store_subject_add(s, "test", &one, &e));
    must(store_subject_set(s, "test", "p-east",
                           &(struct store_subject_change){.identify = &no}, &e));
    must(store_subject_get(s, east, "p-east", &one, &e));
    assert_false(one.identify);
    must(store_subject_set(s, "test", "shy",
                           &(struct store_subject_change){.identify = &yes}, &e));
    must(store_subject_get(s, "", "shy", &one, &e));
    assert_true(one.identify);
    store_close(s);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'opt_out'"), 2);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'opt_in'"), 1);
}

/* The longest of everything fits into a row. */
TEST(test_longest)
{
    struct store *s = tempdb_fresh();
    struct store_subject one = {.identify = true}, got;

    memset(one.id, 'i', sizeof one.id - 1);
    memset(one.reference, 'r', sizeof one.reference - 1);
    memset(one.purpose, 'p', sizeof one.purpose - 1);
    for (char c = 'a'; c < 'a' + GROUPS_MAX; c++) {
        char label[GROUPS_LABEL + 1] = "";

        memset(label, c, GROUPS_LABEL);
        must(groups_add(one.groups, label, &e));
    }
    must(store_subject_add(s, "test", &one, &e));
    must(store_subject_get(s, "", one.id, &got, &e));
    assert_string_equal(got.groups, one.groups);
    assert_string_equal(got.purpose, one.purpose);
    store_close(s);
}

/* ---- tokens */

TEST(test_tokens)
{
    struct store *s = people();
    struct store_token t, *list;
    char secret[65], other[STORE_ID_LEN + 1], west[STORE_ID_LEN + 1];
    size_t n;

    must(store_token_create(s, east, "child", STORE_SCOPE_READ, "", 0, secret, &t, &e));
    assert_string_equal(t.groups, "east");
    must(store_token_check(s, secret, &t, &e));
    assert_string_equal(t.groups, "east");
    fails(store_token_create(s, east, "x", STORE_SCOPE_READ, "west", 0, secret, &t, &e),
          ST_EDENIED);
    fails(store_token_create(s, "", "x", STORE_SCOPE_ALL, "west", 0, secret, &t, &e),
          ST_EINVAL);
    fails(store_token_create(s, east, "x", STORE_SCOPE_AUDIT, "", 0, secret, &t, &e),
          ST_EINVAL);
    must(store_token_create(s, "", "all", STORE_SCOPE_ALL, "", 0, secret, &t, &e));
    memcpy(other, t.id, sizeof other);
    bound(s, "west", west);
    must(store_token_list(s, east, &list, &n, &e));
    assert_int_equal(n, 2); /* itself, and its child */
    free(list);
    must(store_token_list(s, both, &list, &n, &e));
    assert_int_equal(n, 4);
    free(list);
    for (int i = 0; i < 3; i++) {
        const char *id = i == 0 ? other : i == 1 ? west : both;

        fails(store_token_get(s, east, id, &t, &e), ST_ENOTFOUND);
        fails(store_token_rotate(s, east, id, 0, STORE_SAME_END, secret, &t, &e),
              ST_ENOTFOUND);
        fails(store_token_revoke(s, east, id, &e), ST_ENOTFOUND);
        fails(store_attempts_reset_token(s, east, id, &e), ST_ENOTFOUND);
    }
    must(store_token_revoke(s, both, west, &e));
    store_close(s);
}

/* A row whose groups are no list, or that has audit too, is damaged. */
TEST(test_damaged)
{
    static const char *const groups[] = {"'west,east'", "'east,'", "'East'", "'east'"};

    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
        struct store *s = tempdb_fresh();
        struct store_token t;
        char secret[65], text[100];

        must(store_token_create(s, "", "all", i < 3 ? STORE_SCOPE_READ : STORE_SCOPE_ALL,
                                "", 0, secret, &t, &e));
        store_close(s);
        (void)snprintf(text, sizeof text, "UPDATE tokens SET groups = %s", groups[i]);
        must(forge_sql(tempdb_path, &tempdb_key, text, &e));
        s = tempdb_open(STORE_WRITE);
        fails(store_token_check(s, secret, &t, &e), ST_ECORRUPT);
        store_close(s);
    }
}
