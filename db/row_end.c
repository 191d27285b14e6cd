#include "row_end.h"

#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "sql.h"
#include "store_column.h"

static enum status take(const struct vault *v, const struct sql_rows *r,
                        enum store_chain chain, uint64_t *seq,
                        unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    unsigned char mac[STORE_CHAIN_HASH], wanted[STORE_CHAIN_HASH];
    bool sound = store_column_bytes(r, 1, hash, STORE_CHAIN_HASH) &&
                 store_column_bytes(r, 2, mac, sizeof mac);

    *seq = (uint64_t)sql_column(r, 0).i;
    if (sound) {
        store_chain_end(v, chain, *seq, hash, wanted);
        sound = sodium_memcmp(mac, wanted, sizeof mac) == 0;
    }
    return sound ? ST_OK
                 : errinfo_set(e, ST_ECORRUPT,
                               "the end of the audit log is not what was written");
}

enum status row_end_read(struct sql_txn *t, const struct vault *v, enum store_chain chain,
                         uint64_t *seq, unsigned char hash[STORE_CHAIN_HASH],
                         struct errinfo *e)
{
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t, &r, e, "SELECT seq, hash, mac FROM events_end WHERE chain = $1",
                  sql_int(chain));
    bool found;

    *seq = 0;
    memset(hash, 0, STORE_CHAIN_HASH);
    if ((found = st == ST_OK && sql_next(r)))
        st = take(v, r, chain, seq, hash, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_ECORRUPT, "the end of the audit log is missing");
}

enum status row_end_has(struct sql_txn *t, enum store_chain chain, uint64_t seq,
                        const unsigned char hash[STORE_CHAIN_HASH], bool *has,
                        struct errinfo *e)
{
    struct sql_rows *r;
    enum status st;

    if ((*has = seq == 0 && sodium_is_zero(hash, STORE_CHAIN_HASH)))
        return ST_OK;
    st = SQL_QUERY(
        t, &r, e, "SELECT 1 FROM events WHERE chain = $1 AND seq = $2 AND hash = $3",
        sql_int(chain), sql_int((int64_t)seq), sql_blob(hash, STORE_CHAIN_HASH));
    *has = st == ST_OK && sql_next(r);
    return sql_done(r, st, e);
}
