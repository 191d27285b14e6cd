/* Tokens and failed attempts: scopes, expiry, rotation, revocation, forged rows. */
#include <time.h>

#include "forge.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;

/* tempdb_sql(), with the MACs set again. */
static void forge(const char *text)
{
    if (forge_sql(tempdb_path, &tempdb_key, text, &e) != ST_OK)
        fail_msg("%s: %s", text, e.msg);
}

static void create(struct store *s, const char *name, unsigned scopes, int64_t life_s,
                   char secret[65], struct store_token *t)
{
    must(store_token_create(s, "test", name, scopes, "", tempdb_in(life_s), secret, t,
                            &e));
    assert_int_equal(strlen(secret), 64);
}

static enum status check(struct store *s, const char *secret)
{
    struct store_token t;
    const enum status st = store_token_check(s, secret, &t, &e);

    assert_true(st == ST_OK || (t.id[0] == '\0' && t.scopes == 0));
    return st;
}

/* ---- tokens */

TEST(test_scopes)
{
    static const char *const bad[] = {
        "",    ",",     "enroll,",     ",read", "read,,read", "Read",
        "rea", "reads", "read verify", "write", " read"};
    char text[STORE_SCOPES_MAX];
    unsigned scopes;

    for (unsigned i = 1; i <= STORE_SCOPE_ALL; i++) {
        rows_scopes_write(i, text);
        assert_true(rows_scopes_read(text, &scopes));
        assert_int_equal(scopes, i);
    }
    assert_string_equal(
        text,
        "verify,enroll,identify,read,delete,manage,tokens,audit,events,score,detail");
    assert_true(rows_scopes_read("delete,enroll,delete", &scopes));
    assert_int_equal(scopes, STORE_SCOPE_DELETE | STORE_SCOPE_ENROLL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(rows_scopes_read(bad[i], &scopes));
}

/* Rights end at once, for every process: by another secret, the end of its grace, revocation, expiry.
 * Over HTTP: tests/box/http-tokens.sh. */
TEST(test_tokens)
{
    struct store *s = tempdb_fresh(), *other = tempdb_open(STORE_WRITE);
    struct store_token t, got, *list;
    char first[65], second[65], third[65];
    size_t n;

    create(s, "gate 1", STORE_SCOPE_VERIFY, 3600, first, &t);
    for (size_t i = 0; i < 64; i++) { /* every character counts */
        const char was = first[i];

        first[i] = was == '0' ? '1' : '0';
        assert_int_equal(check(s, first), ST_EDENIED);
        first[i] = was;
    }
    assert_int_equal(check(s, "' OR 1=1 --"), ST_EDENIED);
    must(store_token_rotate(s, "test", t.id, 0, STORE_SAME_END, second, &got, &e));
    assert_string_equal(got.expires, t.expires);
    assert_int_equal(check(other, first), ST_EDENIED);
    must(store_token_rotate(s, "test", t.id, 60, 0, third, &got, &e));
    assert_string_equal(got.expires, "");
    assert_int_equal(check(other, first), ST_EDENIED); /* is not brought back */
    must(store_token_check(other, second, &got, &e));
    assert_string_equal(got.id, t.id);
    assert_int_equal(got.scopes, STORE_SCOPE_VERIFY);
    forge("UPDATE tokens SET old_until = '2026-01-01T00:00:00.000Z'");
    assert_int_equal(check(other, second), ST_EDENIED);
    assert_int_equal(check(other, third), ST_OK);
    forge("UPDATE tokens SET old_until = '9026-01-01T00:00:00.000Z'");
    for (int i = 0; i < 2; i++)
        must(store_token_revoke(s, "test", t.id, &e));
    assert_int_equal(check(other, second), ST_EDENIED);
    assert_int_equal(check(other, third), ST_EDENIED);
    fails(store_token_rotate(s, "test", t.id, 0, 0, first, &got, &e), ST_EDENIED);
    assert_string_equal(first, "");
    create(s, "gate 2", STORE_SCOPE_ALL, 86400, first, &t);
    forge("UPDATE tokens SET expires = '2026-01-01T00:00:00.000Z' WHERE revoked IS NULL");
    assert_int_equal(check(s, first), ST_EDENIED);
    must(store_token_list(s, "", &list, &n, &e));
    assert_true(n == 2 && list[0].revoked[0] != '\0' && !list[0].expired &&
                list[1].expired);
    free(list);
    must(store_verify(s, NULL, NULL, &e));
    store_close(other);
    store_close(s);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'revoke_token'"), 1);
}

/* No scope, none that is known, a life that is over or never ends; no such token. */
TEST(test_refused)
{
    struct store *s = tempdb_fresh();
    struct store_token t;
    char secret[65];

    fails(store_token_create(s, "", "x", 0, "", 0, secret, &t, &e), ST_EINVAL);
    fails(store_token_create(s, "", "x", STORE_SCOPE_ALL + 1, "", 0, secret, &t, &e),
          ST_EINVAL);
    fails(store_token_create(s, "", "x", 1, "", STORE_SAME_END, secret, &t, &e),
          ST_EINVAL);
    fails(store_token_create(s, "", "x", 1, "", tempdb_in(-1), secret, &t, &e),
          ST_EINVAL);
    fails(store_token_create(s, "", "x", 1, "", tempdb_in(STORE_LIFE_MAX + 1), secret, &t,
                             &e),
          ST_EINVAL);
    fails(store_token_create(s, "", "x", 1, "", INT64_MAX, secret, &t, &e), ST_EINVAL);
    assert_string_equal(secret, "");
    fails(store_token_revoke(s, "", "0123456789abcdef0123456789abcdef", &e),
          ST_ENOTFOUND);
    create(s, "x", 1, STORE_LIFE_MAX, secret, &t);
    assert_int_equal(check(s, secret), ST_OK);
    store_close(s);
}

/* Last use: noted once a minute, and never waited for. */
TEST(test_used)
{
    struct store *s = tempdb_fresh();
    struct store_token t, got;
    char secret[65], once[32];
    struct rawdb *other;
    struct timespec before, after;

    create(s, "gate", STORE_SCOPE_ALL, 0, secret, &t);
    assert_string_equal(t.used, "");
    must(store_token_check(s, secret, &got, &e));
    assert_true(got.used[0] != '\0');
    memcpy(once, got.used, sizeof once);
    must(store_token_check(s, secret, &got, &e));
    assert_string_equal(got.used, once);
    tempdb_sql("UPDATE tokens SET used = '2026-01-01T00:00:00.000Z'");
    must(store_token_check(s, secret, &got, &e));
    assert_true(strcmp(got.used, once) >= 0);
    tempdb_sql(
        "UPDATE tokens SET used = '9026-01-01T00:00:00.000Z'"); /* the clock was wrong */
    must(store_token_check(s, secret, &got, &e));
    assert_true(got.used[0] == '2');

    /* Another process holds the lock for long. */
    tempdb_sql("UPDATE tokens SET used = NULL");
    other = tempdb_raw();
    must(rawdb_run(other, "BEGIN; UPDATE tokens SET used = NULL", &e));
    (void)clock_gettime(CLOCK_MONOTONIC, &before);
    must(store_token_check(s, secret, &got, &e));
    (void)clock_gettime(CLOCK_MONOTONIC, &after);
    assert_string_equal(got.used, "");
    assert_true(after.tv_sec - before.tv_sec < 4); /* a write would wait for 5 s */
    rawdb_close(other);
    must(store_token_check(s, secret, &got, &e));
    assert_true(got.used[0] != '\0');
    store_close(s);

    s = tempdb_open(STORE_READ);
    tempdb_sql("UPDATE tokens SET used = NULL");
    must(store_token_check(s, secret, &got, &e));
    store_close(s);
}

/* ---- failed verifications */

static struct store_recorded record(struct store *s, const char *token,
                                    const char *subject, enum store_record_as as)
{
    struct store_subject one;
    static const struct store_limits limits = {.failures = 3, .wait_s = 0, .subjects = 6};
    struct store_recorded out;
    struct store_record what = {.subject = &one,
                                .as = as,
                                .actor = token,
                                .kind = "verify",
                                .template_id = "",
                                .outcome = "settled",
                                .limits = &limits};

    must(store_subject_get(s, "", subject, &one, &e));
    must(store_record_verification(s, &what, &out, &e));
    return out;
}

static bool many(struct store_recorded out)
{
    return (out.warnings & 1U << STORE_MANY_SUBJECTS) != 0;
}

/* Each token has its own count, sees those of others, and of the subjects that it tried. */
TEST(test_by_token)
{
    static const char *const who[] = {"bob", "carol", "dave"};
    struct store *s = tempdb_fresh();
    struct store_attempts a;
    struct store_recorded out;

    tempdb_add(s, "alice");
    for (size_t i = 0; i < 3; i++)
        tempdb_add(s, who[i]);
    for (uint32_t i = 1; i <= 4; i++) {
        out = record(s, "thief", "alice", STORE_RECORD_FAILED);
        assert_int_equal(out.warnings, i >= 3 ? 1U << STORE_LOCKED_OUT : 0);
    }
    a = tempdb_attempts(s, "thief", "alice");
    assert_int_equal(a.failures, 4);
    assert_int_equal(a.others, 0);
    assert_int_equal(a.tried, 0);
    a = tempdb_attempts(s, "door", "alice");
    assert_int_equal(a.failures, 0);
    assert_int_equal(a.others, 4);
    assert_true(a.others_age_ms < 60000);
    assert_int_equal(tempdb_attempts(s, "thief", "bob").tried, 1);
    assert_int_equal(tempdb_attempts(s, "door", "bob").tried, 0);
    /* A match ends what its own token did, and no more. */
    (void)record(s, "door", "alice", STORE_RECORD_PASSED);
    assert_int_equal(tempdb_attempts(s, "thief", "alice").failures, 4);
    /* The second subject is many here; it is told once. */
    assert_true(many(record(s, "thief", "bob", STORE_RECORD_FAILED)));
    assert_false(many(record(s, "thief", "bob", STORE_RECORD_FAILED)));
    assert_false(many(record(s, "thief", "carol", STORE_RECORD_FAILED)));
    assert_int_equal(tempdb_attempts(s, "thief", "dave").tried, 3);
    assert_int_equal(tempdb_attempts(s, "thief", "carol").tried, 2);
    assert_int_equal(
        tempdb_count("access_log WHERE actor = 'thief' AND "
                     "kind = 'locked_out' AND outcome LIKE '_ failures until 20%Z'"),
        2);
    assert_int_equal(tempdb_count("access_log WHERE actor = 'thief' AND "
                                  "kind = 'many_subjects' AND outcome = '2 subjects'"),
                     1);
    /* A match is free, and frees. */
    (void)record(s, "thief", "carol", STORE_RECORD_PASSED);
    (void)record(s, "thief", "dave", STORE_RECORD_PASSED);
    assert_int_equal(tempdb_attempts(s, "thief", "dave").tried, 2);
    /* An hour later the subjects count only for the warning of a day; a day later the failures count
     * no more for other tokens; a month later the row is gone, when the token fails again. */
    tempdb_sql("UPDATE attempts SET at_ms = at_ms - 3600001");
    assert_int_equal(tempdb_attempts(s, "thief", "dave").tried, 0);
    assert_int_equal(tempdb_attempts(s, "thief", "dave").tried_warn, 2);
    assert_int_equal(tempdb_attempts(s, "door", "alice").others, 4);
    assert_false(many(record(s, "thief", "carol", STORE_RECORD_FAILED)));
    assert_true(many(record(s, "thief", "dave", STORE_RECORD_FAILED)));
    (void)record(s, "thief", "carol", STORE_RECORD_PASSED);
    (void)record(s, "thief", "dave", STORE_RECORD_PASSED);
    tempdb_sql("UPDATE attempts SET at_ms = at_ms - 86400000");
    assert_int_equal(tempdb_attempts(s, "thief", "dave").tried_warn, 0);
    assert_int_equal(tempdb_attempts(s, "thief", "alice").failures, 4);
    assert_int_equal(tempdb_attempts(s, "door", "alice").others, 0);
    tempdb_sql("UPDATE attempts SET at_ms = at_ms - 2419200000");
    (void)record(s, "thief", "dave", STORE_RECORD_FAILED);
    assert_int_equal(tempdb_count("attempts WHERE failures > 0"), 3);
    tempdb_sql("UPDATE attempts SET at_ms = at_ms - 86400000");
    (void)record(s, "door", "dave", STORE_RECORD_FAILED);
    assert_int_equal(tempdb_count("attempts WHERE failures > 0"), 4);
    (void)record(s, "thief", "dave", STORE_RECORD_FAILED);
    assert_int_equal(tempdb_count("attempts"), 2);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
}

/* Failures between matches are told when they are many, and then begin anew.  They count with those of
 * other tokens, and over a restart; a match makes them fewer. */
TEST(test_pattern)
{
    struct store *s = tempdb_fresh();
    unsigned told = 0;

    tempdb_add(s, "alice");
    for (unsigned i = 0; i < 24; i++) {
        const char *token = i % 3 == 0 ? "door" : "gate";

        told += record(s, token, "alice", STORE_RECORD_FAILED).warnings >>
                STORE_ATTEMPTS_PATTERN;
    }
    assert_int_equal(told, 0);
    assert_int_equal(tempdb_attempts(s, "door", "alice").suspicion, 24);
    assert_int_equal(tempdb_attempts(s, "door", "alice").others_suspicion, 48);
    (void)record(s, "door", "alice", STORE_RECORD_PASSED);
    assert_int_equal(tempdb_attempts(s, "door", "alice").suspicion, 22);
    assert_int_equal(tempdb_attempts(s, "door", "alice").failures, 0);
    store_close(s);
    s = tempdb_open(STORE_WRITE);
    (void)record(s, "door", "alice", STORE_RECORD_FAILED);
    assert_int_equal(tempdb_count("access_log WHERE kind = 'attempts_pattern'"), 0);
    told = record(s, "third", "alice", STORE_RECORD_FAILED).warnings;
    assert_true((told & 1U << STORE_ATTEMPTS_PATTERN) != 0);
    assert_int_equal(tempdb_count("access_log WHERE kind = 'attempts_pattern' "
                                  "AND actor = 'third'"),
                     1);
    assert_int_equal(tempdb_count("attempts WHERE suspicion > 0"), 0);
    /* A row without failures is in no list, and no subject that was tried. */
    for (unsigned i = 0; i < 2; i++) {
        (void)record(s, "fourth", "alice", STORE_RECORD_FAILED);
        (void)record(s, "fourth", "alice", STORE_RECORD_PASSED);
        assert_int_equal(tempdb_count("attempts WHERE token = 'fourth'"), 1);
    }
    tempdb_add(s, "bob");
    assert_int_equal(tempdb_attempts(s, "fourth", "bob").tried_warn, 0);
    must(tempdb_erase(s, "test", "bob", &e));
    (void)record(s, "fourth", "alice", STORE_RECORD_PASSED);
    assert_int_equal(tempdb_count("attempts WHERE token = 'fourth'"), 0);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
}

/* They go with the token, with the subject, and when an administrator asks. */
TEST(test_attempts)
{
    struct store *s = tempdb_fresh();
    struct store_attempts *list;
    struct store_token t;
    char secret[65];
    size_t n;

    fails(store_attempts_reset(s, "test", "alice", &e), ST_ENOTFOUND);
    tempdb_add(s, "alice");
    create(s, "door", STORE_SCOPE_VERIFY, 60, secret, &t);
    (void)record(s, t.id, "alice", STORE_RECORD_FAILED);
    (void)record(s, "thief", "alice", STORE_RECORD_FAILED);
    must(store_token_revoke(s, "test", t.id, &e));
    tempdb_sql("UPDATE attempts SET failures = 1000000"); /* the count has a limit */
    (void)record(s, "thief", "alice", STORE_RECORD_FAILED);
    store_close(s);
    s = tempdb_open(STORE_WRITE); /* kept */
    must(store_attempts_list(s, &list, &n, &e));
    assert_int_equal(n, 1);
    assert_string_equal(list[0].subject, "alice");
    assert_string_equal(list[0].token, "thief");
    assert_int_equal(list[0].failures, 1000000);
    assert_true(list[0].at[0] == '2');
    free(list);
    must(store_attempts_reset(s, "test", "alice", &e));
    assert_int_equal(tempdb_count("attempts"), 0);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'reset_attempts' "
                                  "AND actor = 'test'"),
                     1);
    must(tempdb_record(s, "alice", STORE_RECORD_FAILED, &e));
    must(tempdb_erase(s, "test", "alice", &e));
    assert_int_equal(tempdb_count("attempts"), 0);
    store_close(s);
}
