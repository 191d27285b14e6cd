#include "store_state.h"

#include "log_txn.h"
#include "rows_digest.h"
#include "sql_file.h"

void store_state_set(struct store_fault *f, const struct errinfo *why)
{
    if (!atomic_flag_test_and_set(&f->begun)) {
        f->why = *why;
        atomic_store(&f->stands, true);
    }
}

bool store_state_get(struct store_fault *f, struct errinfo *e)
{
    if (!atomic_load(&f->stands))
        return false;
    if (e != NULL)
        *e = f->why;
    return true;
}

static void count(void *arg, const char *line)
{
    struct errinfo *first = arg;

    if (first->code == ST_OK)
        (void)errinfo_set(first, ST_EREFUSED, "%s", line);
}

/* Is it worth another try?  Whoever writes the file can keep the rows from being read: a table of
 * another name, a row that is too large. */
static bool may_pass(enum status st)
{
    return st == ST_EBUSY || st == ST_EIO || st == ST_ENOMEM;
}

enum status store_state_verify(struct log_txn *t, store_report *report, void *arg,
                               struct errinfo *e)
{
    static const char advice[] =
        "restore a backup (surfacectl restore), or see surfacectl check-database";
    struct errinfo first = {ST_OK, ""}, why;
    store_report *const tell = report != NULL ? report : count;
    void *const to = report != NULL ? arg : &first;
    unsigned char sum[LOG_DIGEST];
    uint64_t bad, lost, twice = 0;
    bool same = false;
    enum status st;

    sql_file_forget(t->sql);
    if ((st = rows_digest(t, tell, to, sum, &bad, &why)) != ST_OK ||
        (st = sql_file_check_indexes(t->sql, tell, to, &lost, &why)) != ST_OK ||
        (lost == 0 && (st = rows_digest_twice(t, tell, to, &twice, &why)) != ST_OK) ||
        (st = log_txn_agrees(t, sum, &same, &why)) != ST_OK) {
        if (may_pass(st))
            return errinfo_set(e, st, "%s", why.msg);
        tell(to, why.msg);
        return errinfo_set(e, ST_EREFUSED, "%s", why.msg);
    }
    if (!same)
        tell(to, rows_digest_problem);
    if (bad == 0 && lost == 0 && twice == 0 && same)
        return ST_OK;
    return errinfo_set(e, ST_EREFUSED, "the database is not as it was written%s%s: %s",
                       first.msg[0] != '\0' ? ": " : "", first.msg, advice);
}
