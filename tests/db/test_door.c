/* A year at a door, by a clock of the test's own: how often people are locked out whom the scanner
 * does not recognise at once, and how far attackers get (docs/threat-model.md, "Trying faces").  All
 * is one transaction of the store, and the rules are the daemon's: what store_record_verification()
 * reads and counts of attempts. */
#include "errinfo.h"
#include "rates.h"
#include "rows_attempts.h"
#include "store_txn.h"
#include "tempdb.h"
#include "unit.h"

#define SECOND INT64_C(1000)
#define MINUTE (60 * SECOND)
#define HOUR   (60 * MINUTE)
#define DAY    (24 * HOUR)

#define PEOPLE 200
#define DAYS   250
#define VISITS 4 /* of a person a day, at most */

static const struct store_limits limits = {3, 30, 30}; /* the defaults */

static struct errinfo e;
static struct store *store;
static struct store_subject person[PEOPLE];
static struct log_txn t;
static uint64_t seed;
static unsigned warned[STORE_WARNINGS];
static enum store_wait waits_for; /* after attempt() */

BEFORE_ALL(set_up)
{
    store = tempdb_fresh();
    for (unsigned i = 0; i < PEOPLE; i++) {
        char id[8];

        (void)snprintf(id, sizeof id, "p%u", i);
        tempdb_add(store, id);
        must(store_subject_get(store, "", id, &person[i], &e));
    }
}

AFTER_ALL(tear_down)
{
    store_close(store);
}

static void begin(void)
{
    const struct store_use use = {.subject = 0};

    must(store_begin_use(store, NULL, SQL_LAZY, &use, &t, &e));
    seed = 1;
    memset(warned, 0, sizeof warned);
}

static void end(void)
{
    for (unsigned i = 0; i < PEOPLE; i++)
        must(rows_attempts_clear(&t, &person[i], &e));
    must(store_end(store, &t, ST_OK, &e));
}

static bool chance(unsigned percent)
{
    return rates_below(&seed, 100) < percent;
}

/* A time from least on, before most; at most 49 days apart. */
static int64_t between(int64_t least, int64_t most)
{
    return least + (int64_t)rates_below(&seed, (uint32_t)(most - least));
}

static int64_t wait_ms(const char *token, unsigned who, int64_t now,
                       struct store_recorded *out)
{
    bool future;

    *out = (struct store_recorded){.why = STORE_WAIT_NONE};
    must(rows_attempts_get(&t, &person[who], token, now, &out->now, &future, &e));
    return store_attempts_wait_ms(&limits, &out->now, &waits_for);
}

/* Returns 0, or how long the token must wait: then nothing was decided. */
static int64_t attempt(const char *token, unsigned who, int64_t now, bool match)
{
    struct store_recorded out;
    const struct store_record what = {.subject = &person[who],
                                      .as = match ? STORE_RECORD_PASSED
                                                  : STORE_RECORD_FAILED,
                                      .actor = token,
                                      .limits = &limits};
    const int64_t wait = wait_ms(token, who, now, &out);

    if (wait > 0)
        return wait;
    must(store_record_attempt(&t, &what, now, &out, &e));
    for (unsigned i = 0; i < STORE_WARNINGS; i++)
        warned[i] += (out.warnings & 1U << i) != 0;
    return 0;
}

/* ---- people */

struct visit {
    int64_t at;
    unsigned who;
};

struct year {
    unsigned days; /* of all people together */
    unsigned visits;
    unsigned waits;       /* visits with a lock-out */
    unsigned long_waits;  /* refusals for more than a minute */
    unsigned person_days; /* with a lock-out */
    unsigned of_most;     /* by the nine of ten who are recognised well */
    unsigned closed;      /* visits at which a token had failed at too many subjects */
};

static int by_time(const void *a, const void *b)
{
    const int64_t x = ((const struct visit *)a)->at, y = ((const struct visit *)b)->at;

    return (x > y) - (x < y);
}

/* One in ten fails at 20 to 30 attempts in a hundred, the others at 1 to 7. */
static unsigned rate(unsigned who)
{
    return who % 10 == 0 ? 20 + who / 10 % 11 : 1 + who % 7;
}

/* Tries again after some seconds until it matches.  Gives up after one failure in twenty, after six,
 * and at most lock-outs that are long.  Returns true if there was a lock-out. */
static bool visit(struct year *y, const char *token, const struct visit *v)
{
    /* one visit in fifty: a bag in the way, the sun, a new pair of glasses */
    const unsigned percent = chance(2) ? 50 : rate(v->who);
    bool locked = false;
    int64_t now = v->at, wait;

    y->visits++;
    for (unsigned tries = 0; tries < 6; now += between(3 * SECOND, 10 * SECOND)) {
        const bool match = !chance(percent);

        if ((wait = attempt(token, v->who, now, match)) > 0) {
            y->closed += waits_for == STORE_WAIT_SUBJECTS;
            y->long_waits += wait > MINUTE;
            y->waits += !locked;
            locked = true;
            if (wait > 2 * MINUTE || chance(30))
                break;
            now += wait;
        } else if (match || chance(5)) {
            break;
        } else {
            tries++;
        }
    }
    return locked;
}

static size_t plan_day(int64_t day, struct visit *v)
{
    size_t n = 0;

    for (unsigned i = 0; i < PEOPLE; i++) {
        v[n++] = (struct visit){day + between(8 * HOUR, 9 * HOUR), i}; /* the rush hour */
        if (chance(60)) {
            v[n++] = (struct visit){day + between(12 * HOUR, 13 * HOUR), i};
            v[n++] = (struct visit){day + between(13 * HOUR, 14 * HOUR), i};
        }
        if (chance(50))
            v[n++] = (struct visit){day + between(16 * HOUR, 19 * HOUR), i};
    }
    qsort(v, n, sizeof *v, by_time);
    return n;
}

static struct year live(unsigned doors)
{
    static const char *const door[] = {"north", "south", "east", "west"};
    static struct visit v[PEOPLE * VISITS];
    const unsigned days =
        tempdb_server ? DAYS / 10 : DAYS; /* each query is a round trip */
    struct year y = {.days = days * PEOPLE};

    for (unsigned d = 0; d < days; d++) {
        bool locked[PEOPLE] = {false};
        const size_t n = plan_day((d / 5 * 7 + d % 5 + 1) * DAY, v);

        for (size_t i = 0; i < n; i++) {
            const char *token = chance(70) ? door[0] : door[rates_below(&seed, doors)];

            locked[v[i].who] |= visit(&y, token, &v[i]);
        }
        for (unsigned i = 0; i < PEOPLE; i++) {
            y.person_days += locked[i];
            y.of_most += locked[i] && rate(i) < 20;
        }
    }
    print_message(
        "%u doors, %u days: %u visits, %u with a lock-out, %u refusals for more than a "
        "minute; on %u of %u days of a person, %u of them of most people's; %u "
        "told, %u closed\n",
        doors, days, y.visits, y.waits, y.long_waits, y.person_days, y.days, y.of_most,
        warned[STORE_ATTEMPTS_PATTERN], y.closed);
    return y;
}

/* The bounds of docs/threat-model.md. */
static void assert_honest(const struct year *y)
{
    assert_true(y->closed == 0);
    assert_true(y->waits * 200 < y->visits);
    assert_true(y->long_waits * 1000 < y->visits);
    assert_true(y->person_days * 70 < y->days);
    assert_true(y->of_most * 150 < y->days);
    assert_true(warned[STORE_ATTEMPTS_PATTERN] <= 6);
}

TEST(test_year)
{
    struct year y;

    begin();
    y = live(1);
    end();
    assert_honest(&y);
}

TEST(test_doors)
{
    struct year y;

    begin();
    y = live(4);
    end();
    assert_honest(&y);
}

/* 300 people an hour, ten hours, of whom each tenth is not recognised at first. */
TEST(test_busy)
{
    struct year y = {0};

    begin();
    for (unsigned i = 0; i < 3000; i++) {
        const struct visit v = {DAY + i * 12 * SECOND, i % PEOPLE};
        int64_t now = v.at;

        while (!chance(90)) {
            if (attempt("door", v.who, now, false) > 0)
                y.closed += waits_for == STORE_WAIT_SUBJECTS;
            now += 4 * SECOND;
        }
        if (attempt("door", v.who, now, true) > 0)
            y.closed += waits_for == STORE_WAIT_SUBJECTS;
    }
    end();
    assert_int_equal(y.closed, 0);
}

/* 30 people fail within an hour and go away: others pass, each failure more makes them wait for two
 * minutes at most. */
TEST(test_unrecognised)
{
    int64_t now = DAY;

    begin();
    for (unsigned i = 0; i < 30; i++, now += MINUTE)
        assert_int_equal(attempt("door", i, now, false), 0);
    assert_int_equal(attempt("door", 30, now, true), MINUTE);
    assert_int_equal(waits_for, STORE_WAIT_SUBJECTS);
    assert_int_equal(attempt("door", 7, now, true), 0); /* one of the 30 */
    assert_int_equal(attempt("door", 7, now, false), 0);
    now += 2 * MINUTE;
    for (unsigned i = 31; i < PEOPLE; i++)
        assert_int_equal(attempt("door", i, now, true), 0);
    assert_int_equal(attempt("door", 30, now, false), 0);
    assert_int_equal(attempt("door", 31, now, true), 2 * MINUTE);
    assert_int_equal(attempt("another door", 31, now, true), 0);
    end();
}

/* ---- attackers */

/* How many attempts on one person tokens get that try whenever they may. */
static unsigned attempts_in(int64_t time, unsigned tokens)
{
    unsigned n = 0;

    begin();
    for (int64_t now = DAY; now < DAY + time;) {
        int64_t next = time;

        for (unsigned i = 0; i < tokens; i++) {
            char token[] = {'t', (char)('0' + i), '\0'};
            const int64_t wait = attempt(token, 0, now, false);

            n += wait == 0;
            next = wait < next ? wait : next;
        }
        now += next;
    }
    end();
    return n;
}

TEST(test_one_subject)
{
    assert_int_equal(attempts_in(HOUR, 1), 9);
    assert_int_equal(attempts_in(47 * DAY, 1), 60);
    assert_int_equal(warned[STORE_LOCKED_OUT], 58);
    assert_int_equal(warned[STORE_ATTEMPTS_PATTERN], 6);
    assert_int_equal(attempts_in(DAY, 1), 14);
    assert_int_equal(attempts_in(HOUR, 7), 10);
    assert_int_equal(attempts_in(DAY, 7), 33);
    assert_int_equal(attempts_in(30 * DAY, 7), 288);
}

/* Seven tokens, two attempts each: the third is a lock-out. */
TEST(test_many_tokens)
{
    int64_t now = DAY, wait;

    begin();
    for (unsigned i = 0; i < 14; i++) {
        char token[] = {'t', (char)('0' + i / 2), '\0'};

        assert_int_equal(warned[STORE_LOCKED_OUT], i < 3 ? 0 : i - 2);
        while ((wait = attempt(token, 0, now, false)) > 0) {
            assert_true(i >= 3);
            now += wait;
        }
    }
    end();
    assert_in_range(now - DAY, 10000 * SECOND, 10100 * SECOND);
}

/* One face on everybody. */
TEST(test_spraying)
{
    unsigned n = 0, in_hour[6] = {0};

    begin();
    for (int64_t now = DAY; n < PEOPLE && now < DAY + 6 * HOUR;) {
        const int64_t wait = attempt("thief", n, now, false);

        if (wait == 0)
            in_hour[(now - DAY) / HOUR]++, n++;
        now += wait;
    }
    assert_int_equal(warned[STORE_MANY_SUBJECTS], n / 10);
    end();
    assert_int_equal(in_hour[0], 59);
    for (unsigned i = 1; i < 5; i++)
        assert_in_range(in_hour[i], 1, 30);
}

struct between {
    const char *what;
    unsigned visits, attempts; /* a day, of the person; before each of the visits */
    int64_t before;            /* so long */
    bool first;                /* only before the first of the day */
    unsigned told;             /* at which attempt it is told */
};

static unsigned until_told(const struct between *b)
{
    unsigned n = 0;

    for (unsigned i = 0;; i++) {
        const int64_t at =
            (1 + i / b->visits) * DAY + 8 * HOUR + i % b->visits * 9 * HOUR / b->visits;

        assert_true(i < 1000);
        for (unsigned j = 0; j < b->attempts && (!b->first || i % b->visits == 0); j++) {
            n += attempt("door", 0, at - b->before + j * SECOND, false) == 0;
            if (warned[STORE_ATTEMPTS_PATTERN] > 0)
                return n;
        }
        assert_int_equal(attempt("door", 0, at, true), 0);
    }
}

/* Below the lock-out, between the matches of the right person, by the same token. */
TEST(test_between)
{
    static const struct between all[] = {
        {"one attempt before each pass", 2, 1, HOUR, false, 12},
        {"two", 2, 2, HOUR, false, 16},
        {"one, minutes before the pass", 4, 1, 5 * MINUTE, false, 73},
        {"two", 4, 2, 5 * MINUTE, false, 37},
        {"two a night, two passes a day", 2, 2, 7 * HOUR, true, 19},
        {"two a night, four passes a day", 4, 2, 7 * HOUR, true, 37},
        {"one a night, four passes a day", 4, 1, 7 * HOUR, true, 73},
    };

    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        unsigned n;

        begin();
        n = until_told(&all[i]);
        end();
        if (n != all[i].told)
            fail_msg("%s: told at attempt %u", all[i].what, n);
    }
}
