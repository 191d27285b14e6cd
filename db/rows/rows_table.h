/* rows_table.h -- what is the same for subjects, templates, tokens, devices and calibrations:
 * each row carries a MAC over the table's name and every column before the MAC, among them the
 * row's id and revision.  It is computed from the values that are written, never from what is read
 * back, and each change goes into the digest of the change log (log_txn.h). */
#ifndef DB_ROWS_TABLE_H
#define DB_ROWS_TABLE_H
#include "log_txn.h"
#include "sql.h"

#define ROWS_COLUMNS 20 /* that a table has, at most */

struct rows_table {
    const char *name;
    const char *
        all; /* a query of all rows: the columns in their order, the MAC, the row's key */
    const char *remove[2]; /* delete the row of a key, first what refers to it; or NULL */
    int columns;           /* before the MAC */
    int id; /* the column by which messages name a row; -1: a subject's, which have
                        none in the clear */
};

/* rows_table_is(t, table, r, col): has the current row, whose columns begin at col, its MAC?
 * *mac: that MAC. */
bool rows_table_is(const struct log_txn *t, const struct rows_table *table,
                   const struct sql_rows *r, int col, unsigned char mac[CRYPT_HASH]);

/* rows_table_insert(t, table, text, v, mac, e): v[0..columns-1] are set, v[columns] is set here.
 * rows_table_update(t, table, text, v, mac, e): in the place of the row that has the MAC *mac, which
 * the statement must name as its last parameter.  Both leave the new MAC in *mac.
 * rows_table_delete(t, text, id, mac, e): the row of this id that has this MAC; the statement's two
 * parameters.
 * ST_ECORRUPT unless exactly one row was changed. */
enum status rows_table_insert(struct log_txn *t, const struct rows_table *table,
                              const char *text, struct sql_value *v,
                              unsigned char mac[CRYPT_HASH], struct errinfo *e);
enum status rows_table_update(struct log_txn *t, const struct rows_table *table,
                              const char *text, struct sql_value *v,
                              unsigned char mac[CRYPT_HASH], struct errinfo *e);
enum status rows_table_delete(struct log_txn *t, const char *text, struct sql_value id,
                              const unsigned char mac[CRYPT_HASH], struct errinfo *e);

#endif
