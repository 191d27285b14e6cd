/* rows_root.h -- the database's key record. */
#ifndef DB_ROWS_ROOT_H
#define DB_ROWS_ROOT_H
#include "crypt.h"

struct sql_txn; /* sql.h */

/* rows_root_read(t, r, e): Reads the record.  ST_ECORRUPT: it is damaged or missing. */
enum status rows_root_read(struct sql_txn *t, struct crypt_root *r, struct errinfo *e);

/* rows_root_write(t, r, e): Writes the record of a new database. */
enum status rows_root_write(struct sql_txn *t, const struct crypt_root *r,
                            struct errinfo *e);

#endif
