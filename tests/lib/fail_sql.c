#include "fail_sql.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <string.h>

#include "errinfo.h"
#include "sql.h"

static atomic_ulong count, fail;
static _Atomic enum status fault;
static _Thread_local bool reading_failed; /* the last sql_next() */
/* what is only sent has no result yet that could fail */
static _Thread_local bool ahead;

void fail_sql_at(unsigned long n, enum status st)
{
    count = 0;
    fail = n;
    fault = st;
}

unsigned long fail_sql_count(void)
{
    return count;
}

static bool fails(void)
{
    return !ahead && atomic_fetch_add(&count, 1) + 1 == fail;
}

static enum status failed(struct errinfo *e)
{
    return errinfo_set(e, fault, "failed by the test");
}

/* The linker knows the real functions of those that the test wraps. */
#define WRAPPED(f)                                                                       \
    __attribute__((weak)) __typeof__(f) __real_##f;                                      \
    __typeof__(f) __wrap_##f

WRAPPED(sql_begin);
WRAPPED(sql_query);
WRAPPED(sql_first);
WRAPPED(sql_next);
WRAPPED(sql_done);
WRAPPED(sql_end);
WRAPPED(sql_run);
WRAPPED(sql_run_one);
WRAPPED(sql_ahead);

enum status __wrap_sql_begin(struct sql *d, enum sql_begin how, struct sql_txn **t,
                             struct errinfo *e)
{
    return fails() ? failed(e) : __real_sql_begin(d, how, t, e);
}

enum status __wrap_sql_query(struct sql_txn *t, const char *text,
                             const struct sql_value *value, size_t n,
                             struct sql_rows **out, struct errinfo *e)
{
    *out = NULL;
    return fails() ? failed(e) : __real_sql_query(t, text, value, n, out, e);
}

enum status __wrap_sql_first(struct sql_txn *t, const char *text,
                             const struct sql_value *value, size_t n,
                             struct sql_rows **out, struct errinfo *e)
{
    *out = NULL;
    return fails() ? failed(e) : __real_sql_first(t, text, value, n, out, e);
}

bool __wrap_sql_next(struct sql_rows *r)
{
    reading_failed = fails();
    return !reading_failed && __real_sql_next(r);
}

enum status __wrap_sql_done(struct sql_rows *r, enum status st, struct errinfo *e)
{
    const bool now = (st == ST_OK && fails()) || reading_failed;

    st = __real_sql_done(r, st, e);
    reading_failed = false;
    return now && st == ST_OK ? failed(e) : st;
}

enum status __wrap_sql_end(struct sql_txn *t, enum status st, struct errinfo *e)
{
    const bool now = fails() && st == ST_OK;

    st = __real_sql_end(t, st, e);
    return now && st == ST_OK ? failed(e) : st;
}

enum status __wrap_sql_run(struct sql_txn *t, const char *text,
                           const struct sql_value *value, size_t n, struct errinfo *e)
{
    return strcmp(text, "ROLLBACK") != 0 && fails()
               ? failed(e)
               : __real_sql_run(t, text, value, n, e);
}

enum status __wrap_sql_run_one(struct sql_txn *t, const char *text,
                               const struct sql_value *value, size_t n, struct errinfo *e)
{
    return fails() ? failed(e) : __real_sql_run_one(t, text, value, n, e);
}

bool __wrap_sql_ahead(struct sql_txn *t, bool on)
{
    ahead = __real_sql_ahead(t, on) && on;
    return ahead;
}
