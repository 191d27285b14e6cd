/* link: -Wl,--wrap=clock_gettime */
/* The audit log of a store: lists and trims; what another program changes in
 * its rows is found, with its place. */
#include <time.h>

#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define ACCESSES 11

static struct errinfo e;

/* The wall clock of this program: forty days ago while the first accesses are written. */
static bool long_ago;

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
    must(store_event(s, kind, "door", subject, "", "match", &e));
}

struct found {
    struct log_walk w;
    char lines[1000];
};

static void note(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    struct found *f = arg;
    const size_t n = strlen(f->lines);

    (void)snprintf(f->lines + n, sizeof f->lines - n, "%s %llu: %s\n", log_word(log),
                   (unsigned long long)seq, line);
}

static struct found verify(struct store *s)
{
    struct found f = {.lines = ""};

    must(store_audit_verify(s, note, &f, &f.w, &e));
    return f;
}

/* Eleven accesses, `old` of them from long ago; of four changes the second and the last are signed. */
static struct store *written(int old)
{
    struct store *s = tempdb_fresh();
    struct log_entry signed_one;

    for (int i = 1; i <= ACCESSES; i++) {
        long_ago = i <= old;
        event(s, "verify", "");
        if (i == 6)
            tempdb_add(s, "alice");
        if (i == 4 || i == 8)
            must(store_audit_sign(s, "t", LOG_CHECKPOINT, &signed_one, &e));
    }
    long_ago = false;
    return s;
}

/* Of the file: what a walk says of each sort of change is in tests/log/test_log_walk.c. */
TEST(test_tampered)
{
    static const struct {
        const char *sql;
        enum log_name log;
        uint64_t first;
        const char *line;
    } cases[] = {
        {"UPDATE access_log SET outcome = 'x' WHERE seq = 3", LOG_ACCESSES, 3,
         "accesses 3: entry 3 is not what was written"},
        {"UPDATE access_log SET uid = randomblob(16) WHERE seq = 2", LOG_ACCESSES, 2, ""},
        {"UPDATE access_log SET hash = zeroblob(31) WHERE seq = 3", LOG_ACCESSES, 3, ""},
        {"UPDATE access_log SET mac = zeroblob(32) WHERE seq = 5", LOG_ACCESSES, 5, ""},
        {"DELETE FROM access_log WHERE seq = 1", LOG_ACCESSES, 1, "entry 1 is missing"},
        {"DELETE FROM access_log WHERE seq > 6", LOG_ACCESSES, 7,
         "entries 7 to 8 are cut off the end"},
        {"UPDATE access_log SET seq = 99 WHERE seq = 2", LOG_ACCESSES, 2, ""},
        {"UPDATE change_log SET kind = 'x' WHERE seq = 2", LOG_CHANGES, 2, ""},
        {"UPDATE change_log SET digest = zeroblob(72) WHERE seq = 2", LOG_CHANGES, 2, ""},
        {"UPDATE change_log SET at = CAST(zeroblob(100) AS TEXT) WHERE seq = 2",
         LOG_CHANGES, 2, ""},
        {"DELETE FROM change_log WHERE seq = 1", LOG_CHANGES, 1, "entry 1 is missing"},
        {"DELETE FROM change_log WHERE seq = 2", LOG_CHANGES, 2, "entry 2 is missing"},
        {"DELETE FROM subjects", LOG_CHANGES, 4, "the rows are not those of the last"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct store *s = written(0);
        struct found f = verify(s);

        assert_string_equal(f.lines, "");
        assert_int_equal(f.w.entries, ACCESSES + 4);
        assert_int_equal(f.w.checkpoints, 2);
        tempdb_sql(cases[i].sql);
        f = verify(s);
        if (f.w.first != cases[i].first || f.w.first_log != cases[i].log ||
            strstr(f.lines, cases[i].line) == NULL)
            fail_msg("%s: %s", cases[i].sql, f.lines);
        store_close(s);
    }
}

/* The oldest accesses are cut off; the chain goes on from there, and every other loss is found. */
TEST(test_trim)
{
    struct store *s = written(0);
    struct found f;
    uint64_t cut;

    fails(store_audit_trim(s, "test", 0, false, &cut, &e), ST_EINVAL);
    must(store_audit_trim(s, "test", 30, false, &cut, &e));
    assert_int_equal(cut, 0); /* none is as old, and nothing is said */
    store_close(s);
    for (int old = 1; old <= ACCESSES; old++) {
        const int gone = old < ACCESSES ? old : ACCESSES - 1; /* the last one stays */
        char text[100];

        s = written(old);
        for (int dry = 1; dry >= 0; dry--) {
            assert_int_equal(tempdb_count("access_log"), ACCESSES);
            must(store_audit_trim(s, "test", 30, dry != 0, &cut, &e));
            assert_int_equal(cut, gone);
        }
        assert_int_equal(tempdb_number("SELECT min(seq) FROM access_log"), gone + 1);
        assert_string_equal(verify(s).lines, "");
        event(s, "verify", "");
        tempdb_add(s, "bob");
        f = verify(s);
        assert_string_equal(f.lines, "");
        assert_int_equal(f.w.entries, ACCESSES - gone + 1 + 4 + 2);
        (void)snprintf(text, sizeof text, "DELETE FROM access_log WHERE seq = %d",
                       gone + 1); /* the next one goes too, without a word */
        tempdb_sql(text);
        f = verify(s);
        assert_int_equal(f.w.first_log, LOG_ACCESSES);
        assert_int_equal(f.w.first, gone + 1);
        store_close(s);
    }
}

static size_t list(struct store *s, const struct store_audit_filter *filter,
                   struct store_audit_entry **out)
{
    size_t n;

    must(store_audit_list(s, filter, out, &n, &e));
    return n;
}

/* The kinds of the entries, in the order of the list. */
static void assert_kinds(struct store *s, const struct store_audit_filter *filter,
                         const char *wanted)
{
    struct store_audit_entry *a;
    const size_t n = list(s, filter, &a);
    char kinds[200] = "";

    for (size_t i = 0; i < n; i++)
        (void)snprintf(kinds + strlen(kinds), sizeof kinds - strlen(kinds), "%s ",
                       a[i].entry.kind);
    free(a);
    assert_string_equal(kinds, wanted);
}

TEST(test_list)
{
    static const enum log_name accesses = LOG_ACCESSES, changes = LOG_CHANGES;
    struct store *s = tempdb_fresh();
    struct store_audit_entry *a;
    unsigned char uid[STORE_UID];
    size_t n;

    tempdb_add(s, "alice");
    event(s, "verify", "alice");
    event(s, "compare", "bob"); /* no subject */
    tempdb_add(s, "carol");
    event(s, "identify", "");
    assert_kinds(s, &(struct store_audit_filter){.names = false},
                 "create_database add_subject verify compare add_subject identify ");
    assert_int_equal(list(s, &(struct store_audit_filter){.names = true}, &a), 6);
    assert_string_equal(a[1].subject, "alice");
    assert_string_equal(a[1].entry.actor, "test");
    assert_string_equal(a[2].subject, "alice");
    assert_memory_equal(a[1].entry.uid, a[2].entry.uid, STORE_UID);
    memcpy(uid, a[1].entry.uid, sizeof uid);
    assert_string_equal(a[3].subject, "");
    assert_string_equal(a[4].subject, "carol");
    assert_int_equal(a[4].entry.accesses.seq, 2);
    free(a);
    assert_kinds(s,
                 &(struct store_audit_filter){.log = &accesses, .wanted = {.after = 1}},
                 "compare identify ");
    assert_kinds(s,
                 &(struct store_audit_filter){.log = &changes,
                                              .wanted = {.newest = true, .limit = 2}},
                 "add_subject add_subject ");
    assert_kinds(s, &(struct store_audit_filter){.wanted = {.newest = true, .limit = 2}},
                 "add_subject identify ");
    assert_kinds(s, &(struct store_audit_filter){.wanted = {.limit = 3}},
                 "create_database add_subject verify ");
    assert_kinds(s, &(struct store_audit_filter){.wanted = {.kind = "verify"}},
                 "verify ");
    assert_kinds(s, &(struct store_audit_filter){.subject = "alice"},
                 "add_subject verify ");
    assert_kinds(s, &(struct store_audit_filter){.wanted = {.since = "2020"}},
                 "create_database add_subject verify compare add_subject identify ");
    assert_kinds(s, &(struct store_audit_filter){.wanted = {.since = "9000-01"}}, "");
    fails(store_audit_list(s,
                           &(struct store_audit_filter){.wanted = {.since = "tuesday"}},
                           &a, &n, &e),
          ST_EINVAL);
    fails(store_audit_list(s, &(struct store_audit_filter){.subject = "a b"}, &a, &n, &e),
          ST_EINVAL);
    fails(store_audit_list(s, &(struct store_audit_filter){.subject = "bob"}, &a, &n, &e),
          ST_ENOTFOUND);
    fails(store_event(s, "", "", "", "", "", &e), ST_EINVAL);
    fails(store_event(s, "verify", "a\nb", "", "", "", &e), ST_EINVAL);
    fails(store_event(s, "verify", "", "no spaces", "", "", &e), ST_EINVAL);
    /* After the erasure by the uid alone. */
    must(tempdb_erase(s, "test", "alice", &e));
    assert_kinds(s, &(struct store_audit_filter){.wanted = {.uid = uid}, .names = true},
                 "add_subject verify delete_subject ");
    store_close(s);
}
