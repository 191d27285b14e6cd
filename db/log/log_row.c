#include "log_row.h"

#include <string.h>

#include "sql.h"
#include "sql_read.h"

enum { /* the columns of LOG_ROW_CHANGE */
       COL_SEQ,
       COL_AT,
       COL_KIND,
       COL_ACTOR,
       COL_UID,
       COL_OBJECT,
       COL_OUTCOME,
       COL_HASH,
       COL_MAC,
       COL_DIGEST,
       COL_ACCESS_SEQ,
       COL_ACCESS_HASH,
       COL_SIGNATURE
};

static const unsigned char nobody[LOG_UID];

static bool read_uid(const struct sql_rows *r, unsigned char out[LOG_UID])
{
    size_t n;
    const void *uid = sql_read_blob(r, COL_UID, 0, LOG_UID, &n);

    if (uid == NULL || (n != 0 && n != LOG_UID))
        return false;
    if (n != 0)
        memcpy(out, uid, n);
    return true;
}

static bool read_change(const struct sql_rows *r, struct log_entry *out)
{
    int64_t seq;

    if (!sql_read_bytes(r, COL_DIGEST, out->digest, sizeof out->digest) ||
        !sql_read_int(r, COL_ACCESS_SEQ, 0, &seq) ||
        !sql_read_bytes(r, COL_ACCESS_HASH, out->accesses.hash, LOG_HASH))
        return false;
    out->accesses.seq = (uint64_t)seq;
    out->is_signed = sql_column(r, COL_SIGNATURE).type != SQL_NULL;
    return !out->is_signed ||
           sql_read_bytes(r, COL_SIGNATURE, out->signature, sizeof out->signature);
}

bool log_row_read(const struct sql_rows *r, enum log_name log, struct log_entry *out)
{
    int64_t seq;

    memset(out, 0, sizeof *out);
    out->log = log;
    if (!sql_read_int(r, COL_SEQ, 1, &seq))
        return false;
    out->seq = (uint64_t)seq;
    return sql_read_text(r, COL_AT, out->at, sizeof out->at) &&
           sql_read_text(r, COL_KIND, out->kind, sizeof out->kind) &&
           sql_read_text(r, COL_ACTOR, out->actor, sizeof out->actor) &&
           read_uid(r, out->uid) &&
           sql_read_text(r, COL_OBJECT, out->object, sizeof out->object) &&
           sql_read_text(r, COL_OUTCOME, out->outcome, sizeof out->outcome) &&
           sql_read_bytes(r, COL_HASH, out->hash, sizeof out->hash) &&
           sql_read_bytes(r, COL_MAC, out->mac, sizeof out->mac) &&
           (log == LOG_ACCESSES || read_change(r, out));
}

enum status log_row_add(struct sql_txn *t, const struct log_entry *entry,
                        struct errinfo *e)
{
    const bool of_none = memcmp(entry->uid, nobody, sizeof nobody) == 0;
    const struct sql_value v[] = {
        [COL_SEQ] = sql_int((int64_t)entry->seq),
        [COL_AT] = sql_text(entry->at),
        [COL_KIND] = sql_text(entry->kind),
        [COL_ACTOR] = sql_text(entry->actor),
        [COL_UID] = sql_blob(entry->uid, of_none ? 0 : sizeof entry->uid),
        [COL_OBJECT] = sql_text(entry->object),
        [COL_OUTCOME] = sql_text(entry->outcome),
        [COL_HASH] = sql_blob(entry->hash, sizeof entry->hash),
        [COL_MAC] = sql_blob(entry->mac, sizeof entry->mac),
        [COL_DIGEST] = sql_blob(entry->digest, sizeof entry->digest),
        [COL_ACCESS_SEQ] = sql_int((int64_t)entry->accesses.seq),
        [COL_ACCESS_HASH] = sql_blob(entry->accesses.hash, LOG_HASH),
        [COL_SIGNATURE] = entry->is_signed
                              ? sql_blob(entry->signature, sizeof entry->signature)
                              : sql_null(),
    };

    if (entry->log == LOG_ACCESSES)
        return sql_run(t,
                       "INSERT INTO access_log (" LOG_ROW_ACCESS
                       ") VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
                       v, COL_DIGEST, e);
    return sql_run(t,
                   "INSERT INTO change_log (" LOG_ROW_CHANGE
                   ") VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13)",
                   v, sizeof v / sizeof *v, e);
}
