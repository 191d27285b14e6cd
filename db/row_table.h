/* row_table.h -- what is the same for templates, tokens and devices: tables whose rows have a
 * random id, by which the changes of the audit log tell of them. */
#ifndef DB_ROW_TABLE_H
#define DB_ROW_TABLE_H
#include "row_event.h"

struct sql_rows; /* sql.h */

struct row_table {
    char label[16];       /* of the MAC */
    const char *word;     /* for messages: "token" */
    int columns;          /* that the MAC is of, from the id on */
    int name;             /* the one of them by which messages name a row */
    const char *all, *of; /* queries of these columns: all rows; that of the id $1 */
};

/* row_table_is(t, table, r, col, name, e): is the current row, whose id is in column col, what
 * the latest change leaves of it?  Else ST_ECORRUPT, with a text.
 * row_table_see(t, table, see, arg, e): all rows.
 * row_table_tell(t, table, id, by, kind, subject, template_id, outcome, e): row_event_leave() of an
 * act on the row of this id, as it is now. */
enum status row_table_is(struct store_txn *t, const struct row_table *table,
                         const struct sql_rows *r, int col, const char *name,
                         struct errinfo *e);
enum status row_table_see(struct store_txn *t, const struct row_table *table,
                          row_event_see *see, void *arg, struct errinfo *e);
enum status row_table_tell(struct store_txn *t, const struct row_table *table,
                           const char *id, const struct store_act *by, const char *kind,
                           const char *subject, const char *template_id,
                           const char *outcome, struct errinfo *e);

#endif
