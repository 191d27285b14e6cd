#include <stdlib.h>
#include <string.h>

#include "log_row.h"
#include "store.h"
#include "store_txn.h"

uint32_t store_audit_mark(const struct log_entry *entry)
{
    uint32_t mark = 0;

    for (int i = 0; i < 4; i++)
        mark = mark << 8 | entry->hash[i];
    return mark != 0 ? mark : 1;
}

/* The entry that follows a place; NULL: there is none. */
static enum status next_to(struct log_txn *t, const struct log_place *at,
                           struct log_entry **out, struct errinfo *e)
{
    size_t n = 0;

    *out = NULL;
    return log_page(t->sql, at, 1, out, &n, e);
}

static enum status find_last(struct log_txn *t, struct log_place at, uint64_t *seq,
                             uint32_t *mark, struct errinfo *e)
{
    struct log_entry *entry;
    enum status st;

    at.newest = true;
    st = next_to(t, &at, &entry, e);
    *seq = entry != NULL ? entry->seq : 0;
    *mark = entry != NULL ? store_audit_mark(entry) : 0;
    free(entry);
    return st;
}

enum status store_audit_end(struct store *s, struct store_audit_place *out,
                            struct errinfo *e)
{
    struct log_place at = {.log = LOG_CHANGES};
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = log_daemons(t.sql, &out->daemons, e)) == ST_OK)
        st = find_last(&t, at, &out->changes, &out->change_mark, e);
    at.log = LOG_ACCESSES;
    for (; st == ST_OK && at.daemon < out->daemons; at.daemon++)
        st =
            find_last(&t, at, &out->accesses[at.daemon], &out->access_mark[at.daemon], e);
    out->end = true;
    return store_end(s, &t, st, e);
}

/* The last access of a daemon is never cut off, so that behind the end there is none. */
static enum status look_at(struct log_txn *t, struct log_place at, uint64_t seq,
                           uint32_t *mark, bool *known, struct errinfo *e)
{
    struct log_entry *entry;
    enum status st;

    if (seq == 0)
        return ST_OK;
    at.seq = seq - 1;
    if ((st = next_to(t, &at, &entry, e)) != ST_OK)
        return st;
    if (entry == NULL || (entry->seq != seq && at.log == LOG_CHANGES))
        *known = false;
    else if (entry->seq == seq && *mark == 0)
        *mark = store_audit_mark(entry);
    else if (entry->seq == seq)
        *known = *known && *mark == store_audit_mark(entry);
    free(entry);
    return ST_OK;
}

enum status store_audit_known(struct store *s, struct store_audit_place *place,
                              bool *known, struct errinfo *e)
{
    struct log_place at = {.log = LOG_CHANGES};
    struct log_txn t;
    enum status st;

    *known = true;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = look_at(&t, at, place->changes, &place->change_mark, known, e);
    at.log = LOG_ACCESSES;
    for (; st == ST_OK && at.daemon < place->daemons; at.daemon++)
        st = look_at(&t, at, place->accesses[at.daemon], &place->access_mark[at.daemon],
                     known, e);
    return store_end(s, &t, st, e);
}
