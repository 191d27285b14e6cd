#include "log_row.h"

#include <inttypes.h>
#include <sodium.h>

#include "errinfo.h"
#include "sql_read.h"

#define F(kind, member) SQL_FIELD(kind, struct log_entry, member)

enum { COL_ACCESS = 10, COL_CHANGE = 14 }; /* columns of either log */

static const struct sql_field columns[COL_CHANGE] = {
    SQL_FIELD_IN(COUNT, struct log_entry, daemon, 0, LOG_DAEMONS - 1),
    SQL_FIELD_IN(NUMBER, struct log_entry, seq, 1, DBL_MAX),
    F(TEXT, at),
    F(TEXT, kind),
    F(TEXT, actor),
    F(BYTES_OR_NONE, uid),
    F(TEXT, object),
    F(TEXT, outcome),
    F(BYTES, hash),
    F(BYTES, mac),
    F(BYTES, digest),
    F(NUMBER, accesses.seq),
    F(BYTES, accesses.hash),
    F(BYTES_OR_NULL, signature),
};

static size_t columns_of(enum log_name log)
{
    return log == LOG_CHANGES ? COL_CHANGE : COL_ACCESS;
}

bool log_row_read(const struct sql_rows *r, enum log_name log, struct log_entry *out)
{
    *out = (struct log_entry){.log = log};
    if (!sql_read_fields(r, 0, columns, columns_of(log), out))
        return false;
    out->is_signed = !sodium_is_zero(out->signature, sizeof out->signature);
    return true;
}

enum status log_row_add(struct sql_txn *t, const struct log_entry *entry,
                        struct errinfo *e)
{
    struct sql_value v[COL_CHANGE];

    sql_field_values(columns, COL_CHANGE, entry, v);
    return sql_run(
        t,
        entry->log == LOG_ACCESSES
            ? "INSERT INTO access_log (" LOG_ROW_ACCESS
              ") VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)"
            : "INSERT INTO change_log (" LOG_ROW_CHANGE
              ") VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14)",
        v, columns_of(entry->log), e);
}

static enum status log_row_read_row(void *log, const struct sql_rows *r, void *out,
                                    struct errinfo *e)
{
    const enum log_name *name = log;
    struct log_entry *entry = out;

    if (log_row_read(r, *name, entry))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT,
                       "entry %" PRIu64 " of the audit log (%s) is damaged", entry->seq,
                       log_word(*name));
}

static int64_t bounded(uint64_t v)
{
    return v < INT64_MAX ? (int64_t)v : INT64_MAX;
}

enum status log_daemons(struct sql_txn *t, uint32_t *n, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st =
        sql_first(t, "SELECT coalesce(max(daemon), 0) FROM access_log", NULL, 0, &r, e);

    *n = 0;
    if (st == ST_OK && !sql_read_count(r, 0, LOG_DAEMONS - 1, n))
        st = errinfo_set(e, ST_ECORRUPT, "an access log of an impossible daemon");
    ++*n;
    return sql_done(r, st, e);
}

enum status log_page(struct sql_txn *t, const struct log_place *at, size_t limit,
                     struct log_entry **out, size_t *n, struct errinfo *e)
{
#define PAGE(columns, table, of)                                                         \
    {                                                                                    \
        "SELECT " columns " FROM " table " WHERE " of "seq > $1 ORDER BY seq LIMIT $2",  \
            "SELECT " columns " FROM " table " WHERE " of                                \
            "seq < $1 ORDER BY seq DESC LIMIT $2"                                        \
    }
    static const char *const text[LOGS][2] = {
        [LOG_CHANGES] = PAGE(LOG_ROW_CHANGE, "change_log", ""),
        [LOG_ACCESSES] = PAGE(LOG_ROW_ACCESS, "access_log", "daemon = $3 AND ")};
#undef PAGE
    const struct sql_value v[] = {
        sql_int(at->newest && at->seq == 0 ? INT64_MAX : bounded(at->seq)),
        sql_int(bounded(limit)), sql_int(at->daemon)};
    enum log_name log = at->log;
    struct sql_rows *r;
    void *list = NULL;
    enum status st =
        sql_query(t, text[log][at->newest], v, log == LOG_CHANGES ? 2 : 3, &r, e);

    st = sql_read_list(r, st, log_row_read_row, &log, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

enum status log_list(struct sql_txn *t, const char *kind, uint64_t after,
                     struct log_entry **out, size_t *n, struct errinfo *e)
{
    enum log_name log = LOG_CHANGES;
    struct sql_rows *r;
    void *list = NULL;
    enum status st =
        SQL_QUERY(t, &r, e,
                  "SELECT " LOG_ROW_CHANGE " FROM change_log WHERE seq > $1 "
                  "AND kind = coalesce($2, kind) ORDER BY seq",
                  sql_int(bounded(after)), kind != NULL ? sql_text(kind) : sql_null());

    st = sql_read_list(r, st, log_row_read_row, &log, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

static enum status walk_log(struct sql_txn *t, struct log_walk *w, const char *text,
                            struct errinfo *e)
{
    struct log_entry entry;
    struct sql_rows *r;
    const enum status st = sql_stream(t, text, NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        if (log_row_read(r, w->log, &entry))
            log_walk_step(w, &entry);
        else
            log_walk_damaged(w, entry.seq);
    }
    return sql_done(r, st, e);
}

enum status log_walk_all(struct sql_txn *t, struct log_walk *w, struct errinfo *e)
{
    enum status st =
        walk_log(t, w, "SELECT " LOG_ROW_CHANGE " FROM change_log ORDER BY seq", e);

    if (st != ST_OK)
        return st;
    log_walk_accesses(w);
    if ((st = walk_log(t, w,
                       "SELECT " LOG_ROW_ACCESS " FROM access_log ORDER BY daemon, seq",
                       e)) == ST_OK)
        log_walk_end(w);
    return st;
}
