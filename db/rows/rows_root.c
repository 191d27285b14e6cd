#include "rows_root.h"

#include <string.h>

#include "errinfo.h"
#include "sql.h"
#include "sql_read.h"

enum status rows_root_read(struct sql_txn *t, struct crypt_root *r, struct errinfo *e)
{
    struct sql_rows *row;
    uint32_t kind = 0;
    bool good = false;
    enum status st = sql_query(
        t, "SELECT kind, passes, mib, salt, plaintext, public, secrets FROM root", NULL,
        0, &row, e);

    memset(r, 0, sizeof *r);
    if (st == ST_OK && sql_next(row))
        good = sql_read_count(row, 0, CRYPT_PASSPHRASE, &kind) &&
               sql_read_count(row, 1, UINT32_MAX, &r->passes) &&
               sql_read_count(row, 2, UINT32_MAX, &r->mib) &&
               sql_read_bytes(row, 3, r->salt, sizeof r->salt) &&
               sql_read_bytes(row, 4, r->plaintext, sizeof r->plaintext) &&
               sql_read_bytes(row, 5, r->public, sizeof r->public) &&
               sql_read_bytes(row, 6, r->secrets, sizeof r->secrets);
    r->kind = (enum crypt_kind)kind;
    st = sql_done(row, st, e);
    return st != ST_OK || good
               ? st
               : errinfo_set(e, ST_ECORRUPT, "the database's key record is damaged");
}

enum status rows_root_write(struct sql_txn *t, const struct crypt_root *r,
                            struct errinfo *e)
{
    return SQL_RUN(
        t, e,
        "INSERT INTO root (root_key, kind, passes, mib, salt, plaintext, public, "
        "secrets) VALUES (1, $1, $2, $3, $4, $5, $6, $7)",
        sql_int((int64_t)r->kind), sql_int(r->passes), sql_int(r->mib),
        sql_blob(r->salt, sizeof r->salt), sql_blob(r->plaintext, sizeof r->plaintext),
        sql_blob(r->public, sizeof r->public), sql_blob(r->secrets, sizeof r->secrets));
}
