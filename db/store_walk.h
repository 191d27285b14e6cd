/* store_walk.h -- the audit log verified, and the rows by it: every entry and checkpoint of both
 * chains as it was written, in its place, none missing; every row of subjects, templates, tokens,
 * devices and calibrations what the changes leave of it (row_check.h). */
#ifndef DB_STORE_WALK_H
#define DB_STORE_WALK_H
#include "store_chain.h"

/* store_audit_verify(s, report, arg, out, e): read-only.  report() is called once a problem,
 * with the entry that it is about, the last for a row that no entry is about.  About 5 us
 * an entry, and as much a row. */
enum status store_audit_verify(struct store *s, store_chain_report *report, void *arg,
                               struct store_audit *out, struct errinfo *e);

/* store_state_verify(s, report, arg, out, e): the same but for the uses: all on which answers
 * depend.  ST_EREFUSED: the changes themselves are not as they were written, so that rows may be
 * older ones unnoticed.  From then on the store remembers the latest change of each object: also
 * one that is deleted while the store is open is missed (store_latest.h).  Before other threads
 * use the store. */
enum status store_state_verify(struct store *s, store_chain_report *report, void *arg,
                               struct store_audit *out, struct errinfo *e);

/* store_walk_add(out, w): what a walk that came to its end has found, but for its entries. */
void store_walk_add(struct store_audit *out, const struct store_chain_walk *w);

#endif
