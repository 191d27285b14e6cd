/* link: -Wl,--wrap=clock_gettime */
/* The audit log of a store: trimmed; what another program changes in its rows is found, with its
 * place.  Lists, signed entries and receipts: tests/box/audit.sh. */
#include <time.h>

#include "store.h"
#include "store_txn.h"
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

static void event(struct store *s)
{
    must(store_event(s, "verify", "door", "", "", "match", &e));
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
        event(s);
        if (i == 6)
            tempdb_add(s, "alice");
        if (i == 4 || i == 8)
            must(store_audit_sign(s, "t", LOG_CHECKPOINT, &signed_one, NULL, &e));
    }
    long_ago = false;
    return s;
}

/* Of the file: what a walk says of each sort of change is in tests/log/test_log.c. */
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

#define OLDEST " WHERE seq = (SELECT min(seq) FROM access_log)"

/* The oldest accesses are cut off; the chain goes on from there, and every other loss is found. */
TEST(test_trim)
{
    /* The oldest that is left: as it is not as it was written, it is not cut off, however old. */
    static const char *const tampered[] = {
        "UPDATE access_log SET at = '2020-01-01T00:00:00.000Z'" OLDEST,
        "UPDATE access_log SET mac = zeroblob(32)" OLDEST,
        "DELETE FROM access_log" OLDEST,
    };
    struct store *s = written(0);
    struct found f;
    uint64_t cut;

    fails(store_event(s, "", "", "", "", "", &e), ST_EINVAL);
    fails(store_event(s, "verify", "a\nb", "", "", "", &e), ST_EINVAL);
    fails(store_event(s, "verify", "", "no spaces", "", "", &e), ST_EINVAL);
    fails(store_audit_trim(s, "test", 0, false, &cut, &e), ST_EINVAL);
    must(store_audit_trim(s, "test", 30, false, &cut, &e));
    assert_int_equal(cut, 0); /* none is as old, and nothing is said */
    store_close(s);
    for (int old = 1; old <= ACCESSES; old++) {
        const int gone = old < ACCESSES ? old : ACCESSES - 1; /* the last one stays */

        s = written(old);
        for (int dry = 1; dry >= 0; dry--) {
            assert_int_equal(tempdb_count("access_log"), ACCESSES);
            must(store_audit_trim(s, "test", 30, dry != 0, &cut, &e));
            assert_int_equal(cut, gone);
        }
        assert_int_equal(tempdb_number("SELECT min(seq) FROM access_log"), gone + 1);
        assert_string_equal(verify(s).lines, "");
        for (size_t i = 0; i < sizeof tampered / sizeof *tampered; i++) {
            tempdb_sql("CREATE TABLE aside.was AS SELECT * FROM access_log");
            tempdb_sql(tampered[i]);
            for (int dry = 1; dry >= 0 && gone < ACCESSES - 2; dry--)
                fails(store_audit_trim(s, "test", 30, dry != 0, &cut, &e), ST_ECORRUPT);
            tempdb_sql("DELETE FROM access_log; INSERT INTO access_log SELECT * FROM "
                       "aside.was; DROP TABLE aside.was");
        }
        event(s);
        tempdb_add(s, "bob");
        f = verify(s);
        assert_string_equal(f.lines, "");
        assert_int_equal(f.w.entries, ACCESSES - gone + 1 + 4 + 2);
        tempdb_sql("DELETE FROM access_log" OLDEST); /* one more, without a word */
        f = verify(s);
        assert_int_equal(f.w.first_log, LOG_ACCESSES);
        assert_int_equal(f.w.first, gone + 1);
        store_close(s);
    }
}

/* ---- several daemons' accesses */

#define DAEMONS 3
#define EACH    300 /* entries of each daemon: more than are in memory at a time */

/* Of three daemons in turn; the last one's are all from long ago.  A change after each daemon's
 * third, which names that one. */
static struct store *written_by_several(void)
{
    struct store *s = tempdb_fresh();
    char id[16];

    for (int i = 0; i < DAEMONS * EACH; i++) {
        s->log.daemon = (uint32_t)(i % DAEMONS);
        s->log.found =
            (struct log_end){.seq = 0}; /* another process would have its own */
        long_ago = i % DAEMONS == DAEMONS - 1;
        event(s);
        (void)snprintf(id, sizeof id, "s%d", i);
        if (i / DAEMONS == 2)
            tempdb_add(s, id);
    }
    long_ago = false;
    s->log.daemon = 0;
    return s;
}

/* The pages of a filter are all entries, each once and those of a log in their order; how many. */
static size_t count_pages(struct store *s, bool newest, uint64_t limit)
{
    struct store_audit_filter f = {.newest = newest, .limit = limit};
    uint64_t last[1 + DAEMONS] = {0};
    size_t all = 0;

    if (newest)
        memset(last, 0xff, sizeof last);
    while (!f.from.end) {
        struct store_audit_entry *a;
        size_t n;

        must(store_audit_list(s, &f, &a, &n, &f.from, &e));
        for (size_t i = 0; i < n; i++) {
            const struct log_entry *entry = &a[i].entry;
            uint64_t *was =
                entry->log == LOG_CHANGES ? &last[0] : &last[1 + entry->daemon];

            assert_true(newest ? entry->seq < *was : entry->seq > *was);
            *was = entry->seq;
        }
        all += n;
        free(a);
    }
    return all;
}

TEST(test_several)
{
    struct store *s = written_by_several();
    const int entries = DAEMONS * EACH + 1 + DAEMONS;
    struct store_audit_place to;
    struct log_entry signed_one;
    struct found f = verify(s);
    uint64_t cut;

    assert_string_equal(f.lines, "");
    assert_int_equal(f.w.entries, entries);
    for (int newest = 0; newest < 2; newest++) {
        assert_int_equal(count_pages(s, newest != 0, 7), entries);
        assert_int_equal(count_pages(s, newest != 0, 1000), entries);
    }
    must(store_audit_sign(s, "t", LOG_CHECKPOINT, &signed_one, &to, &e));
    assert_int_equal(to.daemons,
                     DAEMONS); /* it covers all, by a change for each of the others */
    for (int i = 0; i < DAEMONS; i++)
        assert_int_equal(to.accesses[i], EACH);
    assert_int_equal(to.changes, 1 + DAEMONS + DAEMONS);
    must(store_audit_sign(s, "t", LOG_CHECKPOINT, &signed_one, &to, &e));
    assert_int_equal(to.changes, 1 + DAEMONS + DAEMONS + 1); /* nothing has come since */
    must(store_audit_trim(s, "test", 30, false, &cut, &e));
    assert_int_equal(cut, EACH - 1);
    assert_int_equal(tempdb_number("SELECT count(*) FROM access_log WHERE daemon = 2"),
                     1);
    assert_string_equal(verify(s).lines, "");
    tempdb_sql("DELETE FROM access_log WHERE daemon = 1 AND seq = 300");
    f = verify(s);
    assert_string_equal(f.lines,
                        "accesses 300: entry 300 of daemon 1 is cut off the end\n");
    store_close(s);
}

/* A cursor of a client: a place in these logs, and in no other. */
TEST(test_places)
{
    struct store *s = written_by_several();
    struct store_audit_filter all = {.limit = 100};
    struct store_audit_entry *a = NULL;
    struct store_audit_place place, was;
    bool known;
    uint64_t cut;
    size_t n;

    must(store_audit_end(s, &place, &e));
    assert_int_equal(place.changes, 1 + DAEMONS);
    assert_int_equal(place.daemons, DAEMONS);
    for (int i = 0; i < DAEMONS; i++)
        assert_true(place.accesses[i] == EACH && place.access_mark[i] != 0);
    must(store_audit_known(s, &place, &known, &e));
    assert_true(known);
    must(store_audit_list(s, &all, &a, &n, &was, &e)); /* the page's end has its marks */
    assert_int_equal(store_audit_mark(&a[n - 1].entry),
                     a[n - 1].entry.log == LOG_CHANGES
                         ? was.change_mark
                         : was.access_mark[a[n - 1].entry.daemon]);
    free(a);
    must(store_audit_known(s, &was, &known, &e));
    assert_true(known);
    was = place;
    place.change_mark = place.access_mark[1] = 0; /* unknown: filled in */
    must(store_audit_known(s, &place, &known, &e));
    assert_true(known && memcmp(&place, &was, sizeof was) == 0);
    place.access_mark[1] ^= 1; /* of another log */
    must(store_audit_known(s, &place, &known, &e));
    assert_false(known);
    place = was;
    place.change_mark ^= 1;
    must(store_audit_known(s, &place, &known, &e));
    assert_false(known);
    place = was;
    place.accesses[2]++; /* of a later state */
    place.access_mark[2] = 0;
    must(store_audit_known(s, &place, &known, &e));
    assert_false(known);
    place = was;
    place.changes++;
    must(store_audit_known(s, &place, &known, &e));
    assert_false(known);
    place = was;
    place.accesses[2] = 5; /* and cut off: nobody knows */
    place.access_mark[2] = 77;
    must(store_audit_trim(s, "test", 30, false, &cut, &e));
    assert_int_equal(cut, EACH - 1);
    must(store_audit_known(s, &place, &known, &e));
    assert_true(known);
    store_close(s);
}
