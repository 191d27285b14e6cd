/* audit.h -- the audit log as it is shown and written to a file, the same from daemon and command. */
#ifndef SERVICE_AUDIT_H
#define SERVICE_AUDIT_H
#include <stdatomic.h>
#include <stdio.h>
#include "store.h"

struct json; /* json.h */

/* What has happened lately, of a list of kinds (struct store_audit_filter). */
#define AUDIT_RECENT "verify,enroll,enroll_mismatch,locked_out"

/* audit_describe(j, a): an entry, as members of the object that is open in j. */
void audit_describe(struct json *j, const struct store_audit_entry *a);

struct audit_export {
    struct store *store;
    struct log_entry end;        /* the signed change that says so */
    struct store_audit_place to; /* what it covers */
    char public_key[2 * CRYPT_KEY + 1];
    const struct store_audit_filter *filter; /* of a table: what is in it */
    size_t most;                             /* bytes of a table; 0: any number */
    const atomic_bool
        *stop; /* NULL; or another thread sets it where nobody wants the rest */
};

/* audit_export_begin(s, actor, x, e): it is recorded, and *x set, but filter and stop.
 * audit_export_lines(to, x, e): both logs up to x->end as JSON, signed (`audit verify FILE`), sound or
 * not: anyone who verifies the file finds what is wrong.  audit_export_table(to, x, e): for people,
 * as CSV with names, what x->filter leaves.  Each is a newfile_writer of a const struct audit_export;
 * memory constant.  ST_EBUSY: stopped; ST_ESIZE: the table has more than x->most; ST_EIO. */
enum status audit_export_begin(struct store *s, const char *actor, struct audit_export *x,
                               struct errinfo *e);
enum status audit_export_lines(FILE *to, const void *x, struct errinfo *e);
enum status audit_export_table(FILE *to, const void *x, struct errinfo *e);

#endif
