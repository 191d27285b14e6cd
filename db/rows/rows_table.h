/* rows_table.h -- what is the same for subjects, templates, tokens, devices and calibrations.
 * A row is a struct; a table of fields says which of its members are columns.  Each row carries a
 * MAC over the table's name and every column before the MAC, among them the row's id and revision.
 * It is computed from the values that are written, never from what is read back, and each change
 * goes into the digest of the change log (log_txn.h). */
#ifndef DB_ROWS_TABLE_H
#define DB_ROWS_TABLE_H
#include "log_txn.h"
#include "sql_read.h"

#define ROWS_COLUMNS 20   /* that a table has before the MAC, at most */
#define ROWS_SIZE    4096 /* bytes of a row's struct, at most */

struct rows_table {
    const char *name, *noun; /* noun: before an id, where there is no such row */
    const char *
        all; /* a query of all rows: the columns of the fields, the MAC, the row's key, and what is
               * not authenticated, since a row that cannot be read whole is a damaged one */
    const char *insert,
        *update; /* the fields and the MAC; of the row with the id and MAC before */
    const char *remove;  /* the row of an id and a MAC */
    const char *drop[2]; /* delete the row of a key, first what refers to it; or NULL */
    int columns;         /* fields: the id, the revision, ... */
    const struct sql_field *field;
    size_t mac, size; /* the MAC's offset in the struct, and the struct's size */
    int id; /* the column by which messages name a row; -1: a subject's, which have
                         none in the clear */
    /* What the columns say, what is encrypted in them, and columns after the key; false: not
     * possible.  NULL: nothing else. */
    bool (*complete)(const struct log_txn *t, const struct sql_rows *r, int col,
                     void *row);
};

/* rows_table_is(t, table, r, col, mac): has the current row, whose columns begin at col, its MAC?
 * *mac: that MAC.
 * rows_table_read(t, table, r, col, row, e): it, as the struct.  ST_ECORRUPT: it has not, or a
 * column is impossible; then *row is wiped.
 * rows_table_damaged(table, r, col, e): ST_ECORRUPT and a text that names the row. */
bool rows_table_is(const struct log_txn *t, const struct rows_table *table,
                   const struct sql_rows *r, int col, unsigned char mac[CRYPT_HASH]);
enum status rows_table_read(const struct log_txn *t, const struct rows_table *table,
                            const struct sql_rows *r, int col, void *row,
                            struct errinfo *e);
enum status rows_table_damaged(const struct rows_table *table, const struct sql_rows *r,
                               int col, struct errinfo *e);

/* rows_table_find(t, table, text, by, value, id, row, e): the row of a query for one value, of which
 * the column `by` is that (-1: it is not compared): an index is not authenticated and may lead to
 * another row.  ST_ENOTFOUND: there is none, and the text names the id; ST_ECORRUPT.
 * rows_table_list(t, table, text, value, nv, size, list, n, e): the rows of a query; *list, an array of
 * the first `size` bytes of each row's struct, is released by free().
 * rows_table_all(t, table, size, list, n, e): of the query `all`. */
enum status rows_table_find(struct log_txn *t, const struct rows_table *table,
                            const char *text, int by, struct sql_value value,
                            const char *id, void *row, struct errinfo *e);
enum status rows_table_list(struct log_txn *t, const struct rows_table *table,
                            const char *text, const struct sql_value *value, size_t nv,
                            size_t size, void **list, size_t *n, struct errinfo *e);
enum status rows_table_all(struct log_txn *t, const struct rows_table *table, size_t size,
                           void **list, size_t *n, struct errinfo *e);

/* rows_table_insert(t, table, row, e): of revision 1.  rows_table_update(t, table, row, e): of the
 * next one, in the place of the row that has its MAC.  Both set revision and MAC in *row.
 * rows_table_delete(t, table, row, e): the row of this id that has this MAC.
 * ST_ECORRUPT unless exactly one row was changed. */
enum status rows_table_insert(struct log_txn *t, const struct rows_table *table,
                              void *row, struct errinfo *e);
enum status rows_table_update(struct log_txn *t, const struct rows_table *table,
                              void *row, struct errinfo *e);
enum status rows_table_delete(struct log_txn *t, const struct rows_table *table,
                              const void *row, struct errinfo *e);

/* ---- fields that are encrypted together, in one column (db/FORMAT.md) */

/* rows_table_encrypt(key, label, field, n, row, out): to out, bound to the label.
 * rows_table_decrypt(key, label, field, n, in, row): false: not what was encrypted, or impossible. */
void rows_table_encrypt(const unsigned char key[CRYPT_KEY],
                        const struct sql_field_blob *label, const struct sql_field *field,
                        size_t n, const void *row, struct sql_field_blob *out);
bool rows_table_decrypt(const unsigned char key[CRYPT_KEY],
                        const struct sql_field_blob *label, const struct sql_field *field,
                        size_t n, const struct sql_field_blob *in, void *row);

#endif
