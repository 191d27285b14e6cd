/* store_audit.h -- the audit log: the change log and the access log (log.h). */
#ifndef DB_STORE_AUDIT_H
#define DB_STORE_AUDIT_H
#include "log_walk.h"
#include "store_open.h"

/* store_event(s, kind, actor, subject, object, outcome, e): append to the access log; no
 * biometrics in it.  kind: "verify", "compare", ...; subject, an id, object, an id of a template,
 * and outcome may be "".  Changes (enroll, delete, tokens) write their own entries.
 * For speed it does not wait for the disk: a power failure may lose the last ones. */
enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *object, const char *outcome,
                        struct errinfo *e);

struct store_audit_entry {
    struct log_entry entry;
    char subject[STORE_SUBJECT_MAX +
                 1]; /* "": of none, of one that was erased, or names are
                                            not wanted */
};

struct store_audit_filter {   /* all zero: everything */
    const enum log_name *log; /* NULL: both, in the order of their writing */
    struct log_filter wanted; /* uid may be given by subject */
    const char *subject;      /* an id; of one that was erased: wanted.uid */
    bool names;
};

/* store_audit_list(s, filter, out, n, e): entries in their order; a new array released by
 * free().  Nothing of them is verified.  ST_ENOTFOUND: there is no such subject. */
enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n,
                             struct errinfo *e);

/* store_audit_sign(s, actor, kind, out, e): a change of this kind, LOG_CHECKPOINT or LOG_EXPORT,
 * which is signed.
 * store_audit_public(s, public, e): what signatures are verified with.
 * store_audit_has(s, at, has, e): has the change log this entry?
 * store_audit_verify(s, report, arg, out, e): every entry of both logs as it was written, and the
 * rows (store_verify()), which are reported as of the last change.  *out: the walk. */
enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct log_entry *out, struct errinfo *e);
enum status store_audit_public(struct store *s, unsigned char public[CRYPT_KEY],
                               struct errinfo *e);
enum status store_audit_has(struct store *s, const struct log_end *at, bool *has,
                            struct errinfo *e);
enum status store_audit_verify(struct store *s, log_report *report, void *arg,
                               struct log_walk *out, struct errinfo *e);

/* store_audit_trim(s, actor, days, dry, cut, e): the oldest accesses, up to the first that is
 * younger than so many days, 1.., are cut off; the last one stays.  A number of them at a time,
 * each a transaction.  dry: they are only counted.  *cut: how many. */
#define STORE_TRIM_MAX 36500 /* days */
enum status store_audit_trim(struct store *s, const char *actor, unsigned days, bool dry,
                             uint64_t *cut, struct errinfo *e);

#endif
