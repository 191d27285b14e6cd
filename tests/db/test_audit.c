/* link: -Wl,--wrap=clock_gettime */
/* The audit log: a change of its rows by another program is found, with its place;
 * signatures can be verified without the database. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

#include "errinfo.h"
#include "store.h"
#include "store_chain.h"
#include "store_receipt.h"
#include "tempdb.h"

#define USES 11 /* of the log that is tampered with */

static struct errinfo e;

struct found {
    char lines[20][200];
    unsigned n;
};

static void note(void *arg, enum store_chain chain, uint64_t seq, const char *line)
{
    struct found *f = arg;

    (void)chain;
    assert_true(seq > 0 || f->n > 0 || line[0] != '\0');
    if (f->n < 20)
        (void)snprintf(f->lines[f->n], sizeof f->lines[0], "%llu: %s",
                       (unsigned long long)seq, line);
    f->n++;
}

static struct store_audit verify(struct store *s, struct found *f)
{
    struct store_audit a;

    memset(f, 0, sizeof *f);
    if (store_audit_verify(s, note, f, &a, &e) != ST_OK)
        fail_msg("%s", e.msg);
    assert_int_equal(a.problems, f->n);
    assert_true((a.first > 0) == (f->n > 0));
    return a;
}

/* The wall clock of this program: forty days ago while the first uses are written. */
static bool long_ago;
static int old_uses; /* written() writes so many then */

int __real_clock_gettime(clockid_t clock, struct timespec *ts);
int __wrap_clock_gettime(clockid_t clock, struct timespec *ts);

int __wrap_clock_gettime(clockid_t clock, struct timespec *ts)
{
    const int done = __real_clock_gettime(clock, ts);

    if (clock == CLOCK_REALTIME && long_ago)
        ts->tv_sec -= 40 * 86400;
    return done;
}

static void event(struct store *s, const char *kind, const char *subject)
{
    if (store_event(s, kind, "door", subject, "", "match", &e) != ST_OK)
        fail_msg("%s", e.msg);
}

/* Eleven uses; of the changes the first is the key's, the second and the fourth are checkpoints,
 * when there were four uses, and eight. */
static struct store *written(void)
{
    struct store *s = tempdb_fresh();
    struct store_subject alice = {.id = "alice"};
    struct store_audit_mark m;

    for (int i = 1; i <= USES; i++) {
        long_ago = i <= old_uses;
        event(s, "verify", i % 2 == 0 ? "alice" : "bob");
        if (i == 6)
            assert_int_equal(store_subject_add(s, "test", &alice, &e), ST_OK);
        if (i == 4 || i == 8)
            assert_int_equal(store_audit_sign(s, "test", "checkpoint", &m, &e), ST_OK);
    }
    long_ago = false;
    return s;
}

static void count_line(void *arg, const char *line)
{
    unsigned *lines = arg;

    (*lines)++;
    assert_non_null(strstr(line, "audit log"));
}

/* ---- what was done to it, and the least entry that is found */

static void test_tampered(void **state)
{
    static const struct {
        const char *sql;
        enum store_chain chain;
        uint64_t first;
        const char *line; /* one of those that are reported */
    } cases[] = {
        {"UPDATE events SET outcome = 'x' WHERE chain = 1 AND seq = 3", STORE_CHAIN_USES,
         3, "entry 3 is not what was written"},
        {"UPDATE events SET at = '2020-01-01T00:00:00.000Z' WHERE "
         "chain = 1 AND seq = 2",
         STORE_CHAIN_USES, 2, NULL},
        {"UPDATE events SET kind = 'compare' WHERE chain = 1 AND seq ="
         " 3",
         STORE_CHAIN_USES, 3, NULL},
        {"UPDATE events SET actor = 'nobody' WHERE chain = 1 AND seq ="
         " 1",
         STORE_CHAIN_USES, 1, NULL},
        {"UPDATE events SET subject = zeroblob(16) WHERE chain = 1 AND"
         " seq = 3",
         STORE_CHAIN_USES, 3, NULL},
        {"UPDATE events SET template_id = 'x' WHERE chain = 1 AND seq "
         "= 4",
         STORE_CHAIN_USES, 4, NULL},
        {"UPDATE events SET outcome = '?' WHERE chain = 1 AND seq = 11", STORE_CHAIN_USES,
         11, NULL},
        {"UPDATE events SET object = zeroblob(16) WHERE chain = 1 AND "
         "seq = 2",
         STORE_CHAIN_USES, 2, NULL},
        {"UPDATE events SET row_mac = zeroblob(32) WHERE chain = 1 AND"
         " seq = 2",
         STORE_CHAIN_USES, 2, NULL},
        {"UPDATE events SET uses = 3 WHERE chain = 1 AND seq = 2", STORE_CHAIN_USES, 2,
         NULL},
        {"UPDATE events SET uses_hash = zeroblob(32) WHERE chain = 1 "
         "AND seq = 2",
         STORE_CHAIN_USES, 2, NULL},
        {"UPDATE events SET hash = zeroblob(32) WHERE chain = 1 AND "
         "seq = 1",
         STORE_CHAIN_USES, 1, "entry 1 is not what was written"},
        {"UPDATE events SET hash = zeroblob(32) WHERE chain = 1 AND "
         "seq = 3",
         STORE_CHAIN_USES, 3, NULL},
        {"UPDATE events SET hash = zeroblob(32) WHERE chain = 1 AND "
         "seq = 11",
         STORE_CHAIN_USES, 11, NULL},
        {"UPDATE events SET hash = zeroblob(31) WHERE chain = 1 AND "
         "seq = 3",
         STORE_CHAIN_USES, 3, NULL},
        {"UPDATE events SET outcome = 'x' WHERE chain = 1 AND seq "
         "BETWEEN 2 AND 3",
         STORE_CHAIN_USES, 2, "entries 2 to 3 are not what was written"},
        {"DELETE FROM events WHERE chain = 1 AND seq = 1", STORE_CHAIN_USES, 1,
         "entry 1 is missing"},
        {"DELETE FROM events WHERE chain = 1 AND seq = 3", STORE_CHAIN_USES, 3,
         "entry 3 is missing"},
        {"DELETE FROM events WHERE chain = 1 AND seq = 11", STORE_CHAIN_USES, 11,
         "entry 11 is cut off the end"},
        {"DELETE FROM events WHERE chain = 1 AND seq > 2", STORE_CHAIN_USES, 3,
         "entries 3 to 11 are cut off the end"},
        {"DELETE FROM events WHERE chain = 1", STORE_CHAIN_USES, 1,
         "entries 1 to 11 are cut off the end"},
        {"UPDATE events SET seq = 99 WHERE chain = 1 AND seq = "
         "2;UPDATE events SET seq = 2 WHERE chain = 1 AND seq = "
         "3;UPDATE events SET seq = 3 WHERE chain = 1 AND seq = 99",
         STORE_CHAIN_USES, 2, NULL},
        {"INSERT INTO events SELECT NULL, chain, 12, at, kind, actor, "
         "subject, template_id, outcome, object, row_mac, uses, "
         "uses_hash, hash FROM events WHERE chain = 1 AND seq = 11",
         STORE_CHAIN_USES, 12, "entry 12 is behind the end"},
        {"DELETE FROM events_end WHERE chain = 1", STORE_CHAIN_USES, 11,
         "the end of the audit log is missing"},
        {"UPDATE events_end SET seq = 3 WHERE chain = 1", STORE_CHAIN_USES, 11,
         "the end of the audit log is not"},
        {"UPDATE events_end SET hash = zeroblob(32) WHERE chain = 1", STORE_CHAIN_USES,
         11, NULL},
        {"UPDATE events_end SET mac = zeroblob(32) WHERE chain = 1", STORE_CHAIN_USES, 11,
         NULL},
        {"DELETE FROM events WHERE chain = 1 AND seq > 3; UPDATE "
         "events_end SET seq = 3, hash = (SELECT hash FROM events "
         "WHERE chain = 1 AND seq = 3) WHERE chain = 1 AND chain = 1",
         STORE_CHAIN_USES, 3, "the end of the audit log is not"},
        {"UPDATE events SET outcome = 'x' WHERE chain = 0 AND seq = 3",
         STORE_CHAIN_CHANGES, 3, "entry 3 is not what was written"},
        {"UPDATE events SET at = '2020-01-01T00:00:00.000Z' WHERE "
         "chain = 0 AND seq = 2",
         STORE_CHAIN_CHANGES, 2, NULL},
        {"UPDATE events SET kind = 'compare' WHERE chain = 0 AND seq ="
         " 3",
         STORE_CHAIN_CHANGES, 3, NULL},
        {"UPDATE events SET actor = 'nobody' WHERE chain = 0 AND seq ="
         " 1",
         STORE_CHAIN_CHANGES, 1, NULL},
        {"UPDATE events SET subject = zeroblob(16) WHERE chain = 0 AND"
         " seq = 3",
         STORE_CHAIN_CHANGES, 3, NULL},
        {"UPDATE events SET template_id = 'x' WHERE chain = 0 AND seq "
         "= 4",
         STORE_CHAIN_CHANGES, 4, NULL},
        {"UPDATE events SET outcome = '?' WHERE chain = 0 AND seq = 4",
         STORE_CHAIN_CHANGES, 4, NULL},
        {"UPDATE events SET object = zeroblob(16) WHERE chain = 0 AND "
         "seq = 2",
         STORE_CHAIN_CHANGES, 2, NULL},
        {"UPDATE events SET row_mac = zeroblob(32) WHERE chain = 0 AND"
         " seq = 2",
         STORE_CHAIN_CHANGES, 2, NULL},
        {"UPDATE events SET uses = 3 WHERE chain = 0 AND seq = 2", STORE_CHAIN_CHANGES, 2,
         NULL},
        {"UPDATE events SET uses_hash = zeroblob(32) WHERE chain = 0 "
         "AND seq = 2",
         STORE_CHAIN_CHANGES, 2, NULL},
        {"UPDATE events SET hash = zeroblob(32) WHERE chain = 0 AND "
         "seq = 1",
         STORE_CHAIN_CHANGES, 1, "entry 1 is not what was written"},
        {"UPDATE events SET hash = zeroblob(32) WHERE chain = 0 AND "
         "seq = 3",
         STORE_CHAIN_CHANGES, 3, NULL},
        {"UPDATE events SET hash = zeroblob(32) WHERE chain = 0 AND "
         "seq = 4",
         STORE_CHAIN_CHANGES, 4, NULL},
        {"UPDATE events SET hash = zeroblob(31) WHERE chain = 0 AND "
         "seq = 3",
         STORE_CHAIN_CHANGES, 3, NULL},
        {"UPDATE events SET outcome = 'x' WHERE chain = 0 AND seq "
         "BETWEEN 2 AND 3",
         STORE_CHAIN_CHANGES, 2, "entries 2 to 3 are not what was written"},
        {"DELETE FROM events WHERE chain = 0 AND seq = 1", STORE_CHAIN_CHANGES, 1,
         "entry 1 is missing"},
        {"DELETE FROM events WHERE chain = 0 AND seq = 3", STORE_CHAIN_CHANGES, 3,
         "entry 3 is missing"},
        {"DELETE FROM events WHERE chain = 0 AND seq = 4", STORE_CHAIN_CHANGES, 4,
         "entry 4 is cut off the end"},
        {"DELETE FROM events WHERE chain = 0 AND seq > 2", STORE_CHAIN_CHANGES, 3,
         "entries 3 to 4 are cut off the end"},
        {"DELETE FROM events WHERE chain = 0", STORE_CHAIN_CHANGES, 1,
         "entries 1 to 4 are cut off the end"},
        {"UPDATE events SET seq = 99 WHERE chain = 0 AND seq = "
         "2;UPDATE events SET seq = 2 WHERE chain = 0 AND seq = "
         "3;UPDATE events SET seq = 3 WHERE chain = 0 AND seq = 99",
         STORE_CHAIN_CHANGES, 2, NULL},
        {"INSERT INTO events SELECT NULL, chain, 5, at, kind, actor, "
         "subject, template_id, outcome, object, row_mac, uses, "
         "uses_hash, hash FROM events WHERE chain = 0 AND seq = 4",
         STORE_CHAIN_CHANGES, 5, "entry 5 is behind the end"},
        {"DELETE FROM events_end WHERE chain = 0", STORE_CHAIN_CHANGES, 4,
         "the end of the audit log is missing"},
        {"UPDATE events_end SET seq = 3 WHERE chain = 0", STORE_CHAIN_CHANGES, 4,
         "the end of the audit log is not"},
        {"UPDATE events_end SET hash = zeroblob(32) WHERE chain = 0", STORE_CHAIN_CHANGES,
         4, NULL},
        {"UPDATE events_end SET mac = zeroblob(32) WHERE chain = 0", STORE_CHAIN_CHANGES,
         4, NULL},
        {"DELETE FROM events WHERE chain = 0 AND seq > 3; UPDATE "
         "events_end SET seq = 3, hash = (SELECT hash FROM events "
         "WHERE chain = 0 AND seq = 3) WHERE chain = 0 AND chain = 0",
         STORE_CHAIN_CHANGES, 3, "the end of the audit log is not"},
        {"UPDATE events SET chain = 1, seq = 12 WHERE chain = 0 AND "
         "seq = 4",
         STORE_CHAIN_CHANGES, 4, "entry 12 is behind the end"},
        {"DELETE FROM checkpoints WHERE seq = 2", STORE_CHAIN_CHANGES, 2,
         "its checkpoint is missing"},
        {"UPDATE checkpoints SET at = '2020-01-01T00:00:00.000Z'", STORE_CHAIN_CHANGES, 2,
         "not signed"},
        {"UPDATE checkpoints SET hash = zeroblob(32)", STORE_CHAIN_CHANGES, 2,
         "not signed"},
        {"UPDATE checkpoints SET signature = zeroblob(64)", STORE_CHAIN_CHANGES, 2,
         "not signed"},
        {"UPDATE checkpoints SET seq = 3 WHERE seq = 2", STORE_CHAIN_CHANGES, 2,
         "its checkpoint is missing"},
        {"UPDATE checkpoints SET seq = 40 WHERE seq = 2", STORE_CHAIN_CHANGES, 2,
         "not signed by this key"},
        {"UPDATE checkpoints SET chain = 1 WHERE seq = 2", STORE_CHAIN_CHANGES, 2,
         "not signed by this key"},
        {"DELETE FROM events WHERE chain = 0 AND seq > 1", STORE_CHAIN_CHANGES, 2,
         "entry 2 was signed and is not there"},
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct store *s = written();
        struct store_check check;
        struct store_audit a;
        struct found f;
        unsigned lines = 0;
        bool told = cases[i].line == NULL;

        a = verify(s, &f);
        if (f.n > 0)
            fail_msg("before: %s", f.lines[0]);
        assert_int_equal(a.entries, USES + 4);
        assert_int_equal(a.checkpoints, 2);
        store_close(s); /* an open one would refuse another chain */
        tempdb_sql(cases[i].sql);
        s = tempdb_copy(STORE_WRITE);
        a = verify(s, &f);
        for (unsigned k = 0; k < f.n && k < 20; k++)
            told = told || strstr(f.lines[k], cases[i].line) != NULL;
        if (a.first != cases[i].first || a.chain != cases[i].chain || !told)
            fail_msg("%s: %s, entry %llu: %s", cases[i].sql, store_chain_word(a.chain),
                     (unsigned long long)a.first, f.n > 0 ? f.lines[0] : "nothing");
        if (strstr(cases[i].sql, "zeroblob(31)") == NULL) { /* the table forbids it too */
            assert_int_equal(store_check(s, count_line, &lines, &check, &e), ST_OK);
            assert_int_equal(check.problems, a.problems);
            assert_int_equal(lines, a.problems);
        }
        store_close(s);
    }
}

/* Later events do not hide it, and none is added behind an end without the right MAC. */
static void test_after(void **state)
{
    struct store *s = written();
    struct store_audit a;
    struct found f;

    (void)state;
    tempdb_sql("DELETE FROM events WHERE chain = 1 AND seq > 9");
    event(s, "verify", "alice");
    a = verify(s, &f);
    assert_int_equal(a.first, 10);
    assert_non_null(strstr(f.lines[0], "entries 10 to 11 are missing"));
    assert_int_equal(f.n, 1);
    tempdb_sql("UPDATE events_end SET mac = zeroblob(32)");
    assert_int_equal(store_event(s, "verify", "door", "", "", "", &e), ST_ECORRUPT);
    assert_non_null(strstr(e.msg, "the end of the audit log"));
    tempdb_sql("DELETE FROM events_end; DELETE FROM events; DELETE FROM checkpoints");
    assert_int_equal(store_event(s, "verify", "door", "", "", "", &e), ST_EREFUSED);
    store_close(s);
}

/* An older copy of the file's content in the place of what an open store has seen, with every
 * MAC right, is refused for good; so is another end of the same length. */
static void test_back(void **state)
{
    static const char *const back[] = {
        "UPDATE events_end SET seq = old.seq, hash = old.hash, mac = old.mac "
        "FROM old WHERE events_end.chain = old.chain;"
        "DELETE FROM events WHERE chain = 0 AND seq > (SELECT seq FROM old WHERE chain = 0)",
        "UPDATE events_end SET hash = zeroblob(32) WHERE chain = 0",
        "DELETE FROM events_end WHERE chain = 0",
        "UPDATE events_end SET seq = seq + 1 WHERE chain = 0",
    };

    (void)state;
    for (size_t i = 0; i < sizeof back / sizeof *back; i++) {
        struct store *s = tempdb_fresh();
        struct store_subject alice = {.id = "alice"}, bob = {.id = "bob"};
        struct errinfo why;

        assert_int_equal(store_subject_add(s, "test", &alice, &e), ST_OK);
        tempdb_sql("CREATE TABLE aside.old AS SELECT * FROM events_end");
        assert_int_equal(store_subject_add(s, "test", &bob, &e), ST_OK);
        assert_int_equal(store_subject_get(s, "bob", &bob, &e), ST_OK);
        assert_false(store_refused(s, &why));
        tempdb_sql(back[i]);
        assert_int_equal(store_subject_get(s, "alice", &alice, &e), ST_EREFUSED);
        assert_true(store_refused(s, &why));
        assert_non_null(strstr(why.msg, "not as this program has seen it"));
        tempdb_sql("INSERT INTO events_end SELECT * FROM old WHERE true "
                   "ON CONFLICT (chain) DO NOTHING");
        assert_int_equal(store_event(s, "verify", "door", "", "", "", &e), ST_EREFUSED);
        store_close(s);
    }
}

/* The end of the uses, with its MAC, from before the last change. */
static void test_uses_cut(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_audit_mark m;
    struct store_audit a;
    struct found f;

    (void)state;
    event(s, "verify", "alice");
    tempdb_sql("CREATE TABLE aside.old AS SELECT * FROM events_end WHERE chain = 1");
    event(s, "verify", "mallory");
    assert_int_equal(store_audit_sign(s, "test", "checkpoint", &m, &e), ST_OK);
    tempdb_sql("DELETE FROM events WHERE chain = 1 AND seq = 2;"
               "UPDATE events_end SET seq = old.seq, hash = old.hash, mac = old.mac "
               "FROM old WHERE events_end.chain = 1");
    a = verify(s, &f);
    assert_int_equal(a.chain, STORE_CHAIN_USES);
    assert_int_equal(a.first, 2);
    assert_non_null(strstr(f.lines[0], "the last when the last change was made"));
    store_close(s);
}

/* The oldest uses are cut off; the chain goes on from there, and every other loss is found. */
static void test_trim(void **state)
{
    struct store *s = written();
    struct store_audit a;
    struct found f;
    uint64_t cut;

    (void)state;
    assert_int_equal(store_audit_trim(s, "test", 0, false, &cut, &e), ST_EINVAL);
    assert_int_equal(store_audit_trim(s, "test", 30, false, &cut, &e), ST_OK);
    assert_int_equal(cut, 0); /* none is as old, and nothing is said */
    assert_int_equal(tempdb_number("SELECT count(*) FROM events"), USES + 4);
    store_close(s);
    for (int left = USES; left >= 0; left--) { /* so many are younger */
        char text[400];

        old_uses = USES - left;
        s = written();
        old_uses = 0;
        assert_int_equal(store_audit_trim(s, "test", 30, true, &cut, &e), ST_OK);
        assert_int_equal(cut, USES - left);
        assert_int_equal(tempdb_number("SELECT count(*) FROM events WHERE chain = 1"),
                         USES);
        assert_int_equal(store_audit_trim(s, "test", 30, false, &cut, &e), ST_OK);
        assert_int_equal(cut, USES - left);
        assert_int_equal(tempdb_number("SELECT count(*) FROM events WHERE chain = 1"),
                         left);
        a = verify(s, &f);
        if (f.n > 0)
            fail_msg("%d left: %s", left, f.lines[0]);
        event(s, "verify", "alice");
        a = verify(s, &f);
        assert_int_equal(f.n, 0);
        assert_int_equal(a.entries, left + 1 + 4 + (left < USES));
        (void)snprintf(text, sizeof text,
                       "DELETE FROM events WHERE chain = 1 AND seq = %d",
                       USES - left + 1);
        tempdb_sql(text); /* the next one goes too, without a word */
        a = verify(s, &f);
        assert_int_equal(a.chain, STORE_CHAIN_USES);
        assert_int_equal(a.first, USES - left + 1);
        store_close(s);
    }
}

/* Entries replaced, with hashes that fit, but without the keys: the signature is
 * wrong. */
static void test_made_anew(void **state)
{
    unsigned char hash[STORE_CHAIN_HASH] = {0}, public[VAULT_KEY] = {1};
    struct store_chain_entry entry = {.chain = STORE_CHAIN_USES,
                                      .at = "now",
                                      .kind = "verify",
                                      .actor = "",
                                      .template_id = "",
                                      .outcome = "match"};
    struct store_chain_walk w;
    struct store_chain_mark m = {.chain = STORE_CHAIN_USES, .seq = 3};
    struct found f = {0};

    (void)state;
    store_chain_walk(&w, STORE_CHAIN_USES, public, note, &f);
    for (entry.seq = 1; entry.seq <= 3; entry.seq++) {
        store_chain_next(hash, &entry, hash);
        store_chain_step(&w, &entry, hash);
    }
    assert_int_equal(f.n, 0);
    memcpy(m.hash, hash, sizeof hash);
    store_chain_pass(&w, &m);
    assert_int_equal(f.n, 1);
    assert_non_null(strstr(f.lines[0], "not signed by this key"));
    entry.seq = 2; /* again, out of its place */
    store_chain_step(&w, &entry, hash);
    assert_int_equal(f.n, 2);
    assert_non_null(strstr(f.lines[1], "not in its place"));
    store_chain_stop(&w, 3, hash);
    assert_int_equal(f.n, 2);
}

/* Every thousandth entry is signed by itself. */
static void test_signed(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_audit_mark *marks, m;
    struct store_chain_mark chain = {0};
    unsigned char public[VAULT_KEY];
    struct store_audit a;
    struct found f;
    char text[65];
    size_t n;

    (void)state;
    for (int i = 0; i < 2 * STORE_CHAIN_EVERY + 10; i++)
        event(s, "verify", "alice");
    assert_int_equal(store_audit_sign(s, "test", "export_audit", &m, &e), ST_OK);
    assert_int_equal(m.chain, STORE_CHAIN_CHANGES);
    assert_int_equal(m.seq, 2);
    assert_int_equal(store_audit_sign(s, "test", "verify", &m, &e), ST_EINVAL);
    assert_int_equal(store_audit_marks(s, &marks, &n, &e), ST_OK);
    assert_int_equal(n, 3);
    assert_int_equal(marks[0].seq, 2);
    assert_int_equal(marks[1].chain, STORE_CHAIN_USES);
    assert_int_equal(marks[1].seq, STORE_CHAIN_EVERY);
    assert_int_equal(marks[2].seq, 2 * STORE_CHAIN_EVERY);
    a = verify(s, &f);
    assert_int_equal(a.entries, 2 * STORE_CHAIN_EVERY + 12);
    assert_int_equal(a.checkpoints, 3);
    assert_int_equal(f.n, 0);

    /* With the public key alone. */
    assert_int_equal(store_audit_public(s, text, &e), ST_OK);
    for (size_t i = 0; i < VAULT_KEY; i++)
    public[i] =
        (unsigned char)strtoul((char[]){text[2 * i], text[2 * i + 1], '\0'}, NULL, 16);
    chain.chain = marks[1].chain;
    chain.seq = marks[1].seq;
    memcpy(chain.at, marks[1].at, sizeof chain.at);
    for (size_t i = 0; i < STORE_CHAIN_HASH; i++)
        chain.hash[i] = (unsigned char)strtoul(
            (char[]){marks[1].hash[2 * i], marks[1].hash[2 * i + 1], '\0'}, NULL, 16);
    for (size_t i = 0; i < VAULT_SIGN; i++)
        chain.signature[i] = (unsigned char)strtoul(
            (char[]){marks[1].signature[2 * i], marks[1].signature[2 * i + 1], '\0'},
            NULL, 16);
    assert_true(store_chain_signed(public, &chain));
    chain.seq++;
    assert_false(store_chain_signed(public, &chain));
    free(marks);

    tempdb_sql("DELETE FROM checkpoints WHERE seq = 1000");
    a = verify(s, &f);
    assert_int_equal(a.first, 1000);
    store_close(s);
}

static size_t list(struct store *s, const struct store_audit_filter *filter,
                   struct store_audit_entry **out)
{
    size_t n;

    if (store_audit_list(s, filter, out, &n, &e) != ST_OK)
        fail_msg("%s", e.msg);
    return n;
}

static void test_list(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_subject alice = {.id = "alice"};
    struct store_audit_entry *a;
    size_t n;

    (void)state;
    const enum store_chain uses = STORE_CHAIN_USES;

    assert_int_equal(store_subject_add(s, "token-1", &alice, &e), ST_OK);
    event(s, "verify", "alice");
    event(s, "verify", "bob"); /* no subject */
    event(s, "compare", "");
    assert_int_equal(list(s, &(struct store_audit_filter){.names = true}, &a), 5);
    assert_string_equal(a[0].kind, "create_key");
    assert_string_equal(a[1].kind, "add_subject");
    assert_string_equal(a[1].actor, "token-1");
    assert_string_equal(a[1].subject, "alice");
    assert_int_equal(a[1].chain, STORE_CHAIN_CHANGES);
    assert_int_equal(a[1].seq, 2);
    assert_string_equal(a[2].ref, a[1].ref);
    assert_int_equal(a[2].chain, uses);
    assert_string_not_equal(a[3].ref, a[2].ref);
    assert_string_equal(a[3].subject, "");
    assert_string_equal(a[4].ref, "");
    assert_int_equal(a[4].seq, 3);
    free(a);
    n = list(s, &(struct store_audit_filter){.chain = &uses, .after = 1}, &a);
    assert_int_equal(n, 2);
    assert_int_equal(a[0].seq, 2);
    assert_string_equal(a[0].subject, "");
    free(a);
    n = list(s, &(struct store_audit_filter){.newest = true, .limit = 2}, &a);
    assert_int_equal(n, 2);
    assert_int_equal(a[0].seq, 2);
    free(a);
    assert_int_equal(list(s, &(struct store_audit_filter){.limit = 2}, &a), 2);
    assert_int_equal(a[1].seq, 2);
    free(a);
    assert_int_equal(list(s, &(struct store_audit_filter){.kind = "verify"}, &a), 2);
    free(a);
    assert_int_equal(list(s, &(struct store_audit_filter){.subject = "bob"}, &a), 1);
    free(a);
    assert_int_equal(list(s, &(struct store_audit_filter){.since = "2020"}, &a), 5);
    free(a);
    assert_int_equal(list(s, &(struct store_audit_filter){.since = "9000-01"}, &a), 0);
    free(a);
    assert_int_equal(
        store_audit_list(s, &(struct store_audit_filter){.since = "tuesday"}, &a, &n, &e),
        ST_EINVAL);
    assert_int_equal(
        store_audit_list(s, &(struct store_audit_filter){.subject = "a b"}, &a, &n, &e),
        ST_EINVAL);
    store_close(s);
}

static void test_receipt(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_subject alice = {.id = "alice"};
    struct store_audit_entry *a;
    struct store_erased *erased;
    struct store_receipt r;
    char key[65];
    size_t n;

    (void)state;
    assert_int_equal(store_subject_erase(s, "test", "alice", &r, &e), ST_ENOTFOUND);
    store_receipt_free(&r);
    assert_int_equal(store_subject_add(s, "test", &alice, &e), ST_OK);
    assert_int_equal(store_subject_erase(s, "test", "alice", &r, &e), ST_OK);
    assert_string_equal(r.subject, "alice");
    assert_int_equal(r.templates, 0);
    assert_int_equal(r.seq, 3);
    assert_int_equal(list(s, &(struct store_audit_filter){.after = 2}, &a), 1);
    assert_string_equal(a->hash, r.hash);
    assert_string_equal(a->kind, "delete_subject");
    assert_string_equal(a->at, r.at);
    assert_string_equal(a->actor, "test");
    free(a);
    assert_int_equal(store_audit_public(s, key, &e), ST_OK);
    assert_string_equal(key, r.public_key);
    assert_true(store_receipt_true(&r));
    r.seq++;
    assert_false(store_receipt_true(&r));
    r.seq--;
    r.at[3]++;
    assert_false(store_receipt_true(&r));
    r.at[3]--;
    r.subject[0] = 'b';
    assert_false(store_receipt_true(&r));
    r.subject[0] = 'a';
    r.signature[0] = r.signature[0] == '0' ? '1' : '0';
    assert_false(store_receipt_true(&r));

    assert_int_equal(store_audit_erased(s, NULL, &erased, &n, &e), ST_OK);
    assert_int_equal(n, 1);
    assert_string_equal(erased->at, r.at);
    free(erased);
    assert_int_equal(store_audit_erased(s, "alice", &erased, &n, &e), ST_OK);
    assert_int_equal(n, 1);
    free(erased);
    assert_int_equal(store_audit_erased(s, "bob", &erased, &n, &e), ST_OK);
    assert_int_equal(n, 0);
    assert_int_equal(store_subject_add(s, "test", &alice, &e), ST_OK); /* again */
    assert_int_equal(store_audit_erased(s, NULL, &erased, &n, &e), ST_OK);
    assert_int_equal(
        n, 1); /* the erased subject stays erased, also when its id is enrolled again */
    free(erased);
    store_receipt_free(&r);
    store_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tampered), cmocka_unit_test(test_after),
        cmocka_unit_test(test_back),     cmocka_unit_test(test_uses_cut),
        cmocka_unit_test(test_trim),     cmocka_unit_test(test_made_anew),
        cmocka_unit_test(test_signed),   cmocka_unit_test(test_list),
        cmocka_unit_test(test_receipt),
    };

    return cmocka_run_group_tests_name("audit", tests, tempdb_begin, tempdb_end);
}
