/* rows_table.h -- subjects, templates, tokens, devices and calibrations: the tables whose rows have a MAC.
 * A row is a struct, and a table of fields names the members that are columns.  The MAC covers the table's
 * name and every column before it, among them the row's id and revision.  It is computed from the values
 * that are written, never from values that were read back.  Each change updates the digest of the change
 * log (log_txn.h). */
#ifndef DB_ROWS_TABLE_H
#define DB_ROWS_TABLE_H
#include "log_txn.h"
#include "sql_read.h"

#define ROWS_COLUMNS 20   /* most columns of a table before the MAC */
#define ROWS_SIZE    4096 /* most bytes of a row's struct */

struct rows_table {
    const char *name;
    const char *noun; /* text before an id in the message "there is no ..." */
    /* Query of all rows: the columns of the fields, the MAC, the row's key, then columns without MAC.
     * A row that cannot be read whole is damaged. */
    const char *all;
    const char *insert; /* statement; parameters: the fields, the MAC */
    const char *update; /* statement; parameters: the fields, the MAC, the MAC before */
    const char *remove; /* statement; parameters: the id, the MAC */
    /* Statements that delete the row of a key: first the rows that refer to it; NULL: none. */
    const char *drop[2];
    int columns;                   /* number of fields */
    const struct sql_field *field; /* fields [columns]: the id, the revision, ... */
    size_t mac, size; /* offset of the MAC in the struct, size of the struct */
    int id; /* column by which messages name a row; -1: its key (a subject's id is encrypted) */
    /* Completes *row by encrypted columns and columns after the key, which begin at col.  Returns false
     * if a value is impossible.  NULL: there is nothing to complete. */
    bool (*complete)(const struct log_txn *t, const struct sql_rows *r, int col,
                     void *row);
};

/* rows_table_is(t, table, r, col, mac): Returns true if the current row, whose columns begin at col, has its
 * MAC, and sets mac to it. */
bool rows_table_is(const struct log_txn *t, const struct rows_table *table,
                   const struct sql_rows *r, int col, unsigned char mac[CRYPT_HASH]);

/* rows_table_read(t, table, r, col, row, e): Reads the current row into the struct *row.  ST_ECORRUPT: it does
 * not have its MAC, or a value is impossible; *row is then wiped. */
enum status rows_table_read(const struct log_txn *t, const struct rows_table *table,
                            const struct sql_rows *r, int col, void *row,
                            struct errinfo *e);

/* rows_table_damaged(table, r, col, e): Returns ST_ECORRUPT and a message that names the current row. */
enum status rows_table_damaged(const struct rows_table *table, const struct sql_rows *r,
                               int col, struct errinfo *e);

/* rows_table_missing(table, id, e): Returns ST_ENOTFOUND and a message that names the row. */
enum status rows_table_missing(const struct rows_table *table, const char *id,
                               struct errinfo *e);

/* rows_table_find(t, table, text, by, value, id, row, e): Reads the row of the query text for one value.
 *   by  column that must have this value: an index is not authenticated and may lead to another row; -1:
 *       not compared
 *   id  names the row in the message of ST_ENOTFOUND
 * ST_ENOTFOUND; ST_ECORRUPT: as rows_table_read(), or the index leads to another row. */
enum status rows_table_find(struct log_txn *t, const struct rows_table *table,
                            const char *text, int by, struct sql_value value,
                            const char *id, void *row, struct errinfo *e);

/* rows_table_list(t, table, text, value, nv, size, list, n, e): Reads the rows of a query.
 *   size  bytes of an element: the first ones of the row's struct
 *   list  a new array of *n elements, to be released by free() */
enum status rows_table_list(struct log_txn *t, const struct rows_table *table,
                            const char *text, const struct sql_value *value, size_t nv,
                            size_t size, void **list, size_t *n, struct errinfo *e);

/* rows_table_all(t, table, size, list, n, e): Reads the rows of the query `all`, as rows_table_list(). */
enum status rows_table_all(struct log_txn *t, const struct rows_table *table, size_t size,
                           void **list, size_t *n, struct errinfo *e);

/* rows_table_insert(t, table, row, e): Inserts a row with revision 1.  Sets revision and MAC in *row. */
enum status rows_table_insert(struct log_txn *t, const struct rows_table *table,
                              void *row, struct errinfo *e);

/* rows_table_update(t, table, row, e): Replaces the row that has the MAC of *row, by the next revision.  Sets
 * revision and MAC in *row.  ST_ECORRUPT: not exactly one row was changed. */
enum status rows_table_update(struct log_txn *t, const struct rows_table *table,
                              void *row, struct errinfo *e);

/* rows_table_delete(t, table, row, e): Deletes the row that has the id and the MAC of *row.  ST_ECORRUPT: not
 * exactly one row was deleted. */
enum status rows_table_delete(struct log_txn *t, const struct rows_table *table,
                              const void *row, struct errinfo *e);

/* ---- fields that are encrypted together, in one column (db/FORMAT.md) */

/* rows_table_encrypt(key, label, field, n, row, out): Encrypts n fields of row into *out, bound to the label. */
void rows_table_encrypt(const unsigned char key[CRYPT_KEY],
                        const struct sql_field_blob *label, const struct sql_field *field,
                        size_t n, const void *row, struct sql_field_blob *out);

/* rows_table_decrypt(key, label, field, n, in, row): Decrypts *in into n fields of row.  Returns false if *in
 * was not encrypted with this key and label, or a value is impossible. */
bool rows_table_decrypt(const unsigned char key[CRYPT_KEY],
                        const struct sql_field_blob *label, const struct sql_field *field,
                        size_t n, const struct sql_field_blob *in, void *row);

#endif
