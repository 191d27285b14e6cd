#include "sql.h"

#include "errinfo.h"

void sql_close(struct sql *d)
{
    if (d != NULL)
        d->driver->close(d);
}

int sql_version(const struct sql *d)
{
    return d->version;
}

enum status sql_begin(struct sql *d, enum sql_begin how, struct sql_txn **t,
                      struct errinfo *e)
{
    return d->driver->begin(d, how, t, e);
}

enum status sql_end(struct sql_txn *t, enum status st, struct errinfo *e)
{
    return t->driver->end(t, st, e);
}

enum status sql_version_now(struct sql_txn *t, int *version, struct errinfo *e)
{
    return t->driver->version(t, version, e);
}

enum status sql_create(struct sql_txn *t, struct errinfo *e)
{
    return t->driver->create(t, e);
}

enum status sql_bytes(struct sql_txn *t, uint64_t *bytes, struct errinfo *e)
{
    return t->driver->bytes(t, bytes, e);
}

enum status sql_lock(struct sql_txn *t, uint32_t key, struct errinfo *e)
{
    return t->driver->lock != NULL ? t->driver->lock(t, key, e) : ST_OK;
}

enum status sql_settle(struct sql_txn *t, struct errinfo *e)
{
    return t->driver->settle != NULL ? t->driver->settle(t, e) : ST_OK;
}

bool sql_ahead(struct sql_txn *t, bool on)
{
    t->ahead = on && t->driver->pipelines;
    return t->driver->pipelines;
}

void sql_prove(struct sql_txn *t, const char *text, const struct sql_value *value,
               size_t n)
{
    if (t->driver->prove != NULL)
        t->driver->prove(t, text, value, n);
}

/* ---- statements */

enum status sql_run(struct sql_txn *t, const char *text, const struct sql_value *value,
                    size_t n, struct errinfo *e)
{
    return t->driver->run(t, text, value, n, false, e);
}

enum status sql_run_one(struct sql_txn *t, const char *text,
                        const struct sql_value *value, size_t n, struct errinfo *e)
{
    return t->driver->run(t, text, value, n, true, e);
}

enum status sql_one_row(uint64_t n, struct errinfo *e)
{
    return errinfo_set(e, ST_ECORRUPT,
                       "a change of one row changed %llu: the database is damaged",
                       (unsigned long long)n);
}

enum status sql_changed(struct sql_txn *t, uint64_t *n, struct errinfo *e)
{
    return t->driver->changed(t, n, e);
}

enum status sql_query(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n, struct sql_rows **out, struct errinfo *e)
{
    return t->driver->query(t, text, value, n, false, out, e);
}

enum status sql_stream(struct sql_txn *t, const char *text, const struct sql_value *value,
                       size_t n, struct sql_rows **out, struct errinfo *e)
{
    return t->driver->query(t, text, value, n, true, out, e);
}

bool sql_next(struct sql_rows *r)
{
    return r != NULL && r->driver->next(r);
}

struct sql_value sql_column(const struct sql_rows *r, int i)
{
    return r->driver->column(r, i);
}

enum status sql_done(struct sql_rows *r, enum status st, struct errinfo *e)
{
    return r != NULL ? r->driver->done(r, st, e) : st;
}

enum status sql_first(struct sql_txn *t, const char *text, const struct sql_value *value,
                      size_t n, struct sql_rows **out, struct errinfo *e)
{
    enum status st = sql_query(t, text, value, n, out, e);

    if (st != ST_OK || sql_next(*out))
        return st;
    st = sql_done(*out, st, e);
    *out = NULL;
    return st == ST_OK ? ST_ENOTFOUND : st;
}
