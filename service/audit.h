/* audit.h -- output of the audit log, as JSON and as files, for daemon and command. */
#ifndef SERVICE_AUDIT_H
#define SERVICE_AUDIT_H
#include <stdatomic.h>
#include <stdio.h>
#include "store.h"

struct json; /* json.h */

/* audit_describe(j, a): Writes an entry, as members of the object that is open in j. */
void audit_describe(struct json *j, const struct store_audit_entry *a);

/* audit_receipt(j, r): Writes the receipt of an erasure, as audit_describe(). */
void audit_receipt(struct json *j, const struct store_receipt *r);

struct audit_export {
    struct store *store;
    struct log_entry end;        /* signed change that records the export */
    struct store_audit_place to; /* end of the exported logs */
    char public_key[2 * CRYPT_KEY +
                    1]; /* key that verifies the signature, in hexadecimal */
    const struct store_audit_filter *filter; /* choice of the entries of a table */
    size_t most;                             /* most bytes of a table; 0: no limit */
    const atomic_bool *stop; /* cancellation flag, set by another thread; may be NULL */
};

/* audit_export_begin(s, actor, x, e): Records the export in the change log, and sets *x.  The caller then
 * sets filter, most and stop, which are 0. */
enum status audit_export_begin(struct store *s, const char *actor, struct audit_export *x,
                               struct errinfo *e);

/* audit_export_lines(to, x, e): Writes both logs up to the end of the export as signed JSON, for `audit verify
 * FILE`.  It does not check the logs: verification of the file finds their faults.
 *   x  a const struct audit_export (the function is a newfile_writer)
 * Cost: constant memory.
 * Returns ST_OK; ST_EBUSY: *stop is set; ST_EIO. */
enum status audit_export_lines(FILE *to, const void *x, struct errinfo *e);

/* audit_export_table(to, x, e): Writes the entries that x->filter chooses as CSV for people, with the names of
 * the columns.  As audit_export_lines(); ST_ESIZE: the table has more than x->most bytes. */
enum status audit_export_table(FILE *to, const void *x, struct errinfo *e);

#endif
