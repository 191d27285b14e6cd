#include "rows_root.h"

#include <string.h>

#include "errinfo.h"
#include "sql_read.h"

#define F(kind, member) SQL_FIELD(kind, struct crypt_root, member)

static const struct sql_field columns[] = {
    F(COUNT, kind),      F(COUNT, passes), F(COUNT, mib),     F(BYTES, salt),
    F(BYTES, plaintext), F(BYTES, public), F(BYTES, secrets),
};

_Static_assert(sizeof(enum crypt_kind) == sizeof(uint32_t), "kind is a SQL_FIELD_COUNT");

#define COLUMNS (sizeof columns / sizeof *columns)
#define NAMES   "kind, passes, mib, salt, plaintext, public, secrets"

enum status rows_root_read(struct sql_txn *t, struct crypt_root *r, struct errinfo *e)
{
    struct sql_rows *row;
    enum status st = sql_first(t, "SELECT " NAMES " FROM root", NULL, 0, &row, e);

    memset(r, 0, sizeof *r);
    if (st == ST_ENOTFOUND ||
        (st == ST_OK && !sql_read_fields(row, 0, columns, COLUMNS, r)))
        st = errinfo_set(e, ST_ECORRUPT, "the database's key record is damaged");
    return sql_done(row, st, e);
}

enum status rows_root_write(struct sql_txn *t, const struct crypt_root *r,
                            struct errinfo *e)
{
    struct sql_value v[COLUMNS];

    sql_field_values(columns, COLUMNS, r, v);
    return sql_run(t,
                   "INSERT INTO root (root_key, " NAMES ") "
                   "VALUES (1, $1, $2, $3, $4, $5, $6, $7)",
                   v, COLUMNS, e);
}
