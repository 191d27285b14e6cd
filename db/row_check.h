/* row_check.h -- all rows held against the changes that the audit log tells of: each is what the
 * latest entry of its object leaves, none is missing, none there twice. */
#ifndef DB_ROW_CHECK_H
#define DB_ROW_CHECK_H
#include "row_entry.h"
#include "row_event.h"

struct store_latest; /* store_latest.h */

struct row_check { /* all zero at first */
    struct row_check_left *left;
    size_t n, room;
    uint64_t last; /* entry of changes */
    void (*report)(void *arg, uint64_t seq, const char *line);
    void *arg;
};

/* row_check_add(c, r, e): an entry of changes, in their order.
 * row_check_rows(c, t, report, arg, e): all rows; report() is called once a problem, with the
 * entry that it is about, the last where no entry is.  c is to be freed by row_check_free(). */
enum status row_check_add(struct row_check *c, const struct row_entry *r,
                          struct errinfo *e);
enum status row_check_rows(struct row_check *c, struct store_txn *t,
                           void (*report)(void *arg, uint64_t seq, const char *line),
                           void *arg, struct errinfo *e);

/* row_check_latest(c, l): of each object, once all rows are held; false: no memory. */
bool row_check_latest(const struct row_check *c, struct store_latest *l);
void row_check_free(struct row_check *c);

#endif
