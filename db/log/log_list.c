#include "log_list.h"

#include <inttypes.h>

#include "errinfo.h"
#include "log_row.h"
#include "sql_read.h"

static enum status read_row(void *log, const struct sql_rows *r, void *out,
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

#define WANTED                                                                           \
    " WHERE seq > $1 AND uid = coalesce($2, uid) AND kind = coalesce($3, kind) "         \
    "AND at >= coalesce($4, at) ORDER BY seq"

static const char *query(enum log_name log, bool newest)
{
    if (log == LOG_CHANGES)
        return newest ? "SELECT * FROM (SELECT " LOG_ROW_CHANGE " FROM change_log" WANTED
                        " DESC LIMIT $5) AS newest ORDER BY seq"
                      : "SELECT " LOG_ROW_CHANGE " FROM change_log" WANTED " LIMIT $5";
    return newest ? "SELECT * FROM (SELECT " LOG_ROW_ACCESS " FROM access_log" WANTED
                    " DESC LIMIT $5) AS newest ORDER BY seq"
                  : "SELECT " LOG_ROW_ACCESS " FROM access_log" WANTED " LIMIT $5";
}

static int64_t bounded(uint64_t v)
{
    return v < INT64_MAX ? (int64_t)v : INT64_MAX;
}

enum status log_list(struct log_txn *t, enum log_name log, const struct log_filter *f,
                     struct log_entry **out, size_t *n, struct errinfo *e)
{
    const struct sql_value v[] = {
        sql_int(bounded(f->after)),
        f->uid != NULL ? sql_blob(f->uid, LOG_UID) : sql_null(),
        sql_text_or_null(f->kind != NULL ? f->kind : ""),
        sql_text_or_null(f->since != NULL ? f->since : ""),
        sql_int(f->limit != 0 ? bounded(f->limit) : INT64_MAX),
    };
    struct sql_rows *r;
    void *list = NULL;
    enum status st =
        sql_query(t->sql, query(log, f->newest), v, sizeof v / sizeof *v, &r, e);

    st = sql_read_list(r, st, read_row, &log, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

static enum status walk_log(struct log_txn *t, struct log_walk *w, const char *text,
                            struct errinfo *e)
{
    struct log_entry entry;
    struct sql_rows *r;
    const enum status st = sql_query(t->sql, text, NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        if (log_row_read(r, w->log, &entry))
            log_walk_step(w, &entry);
        else
            log_walk_damaged(w, entry.seq);
    }
    return sql_done(r, st, e);
}

enum status log_walk_all(struct log_txn *t, struct log_walk *w, struct errinfo *e)
{
    enum status st =
        walk_log(t, w, "SELECT " LOG_ROW_CHANGE " FROM change_log ORDER BY seq", e);

    if (st != ST_OK)
        return st;
    log_walk_accesses(w);
    if ((st = walk_log(t, w, "SELECT " LOG_ROW_ACCESS " FROM access_log ORDER BY seq",
                       e)) == ST_OK)
        log_walk_end(w);
    return st;
}
