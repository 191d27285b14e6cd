/* store_audit.h -- the events are the audit log: two chains of hashes, whose ends have a MAC of
 * the database's key and which are signed here and there (store_chain.h).  store_walk.h
 * verifies them. */
#ifndef DB_STORE_AUDIT_H
#define DB_STORE_AUDIT_H
#include "store_types.h"

/* store_event(s, kind, actor, subject, template_id, outcome, e): append to the uses; no
 * biometrics in it.  kind: "verify", "compare", ...; subject, template_id and outcome may
 * be "".  Changes (enroll, delete, tokens) write their own.
 * For speed it does not wait for the disk: a power failure may lose the last ones. */
enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *template_id, const char *outcome,
                        struct errinfo *e);

/* store_audit_list(s, filter, out, n, e): entries in their order; a new array released by
 * free().  Nothing of them is verified. */
enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n,
                             struct errinfo *e);

/* store_audit_sign(s, actor, kind, out, e): add an event of this kind ("checkpoint" or
 * "export_audit") and sign it.
 * store_audit_marks(s, out, n, e): all that there are, in their order; released by free().
 * store_audit_public(s, public_key, e): what signatures are verified with.
 * store_audit_signer(s, public_key, was, e): is it that key, or was it before (rekey)? */
enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct store_audit_mark *out, struct errinfo *e);
enum status store_audit_marks(struct store *s, struct store_audit_mark **out, size_t *n,
                              struct errinfo *e);
enum status store_audit_signer(struct store *s, const char *public_key, bool *was,
                               struct errinfo *e);
enum status store_audit_public(struct store *s, char public_key[65], struct errinfo *e);

/* store_audit_erased(s, subject, out, n, e): every subject that was erased, one after the
 * other, or those that had this id last, where it is not NULL; a new array released by free(). */
enum status store_audit_erased(struct store *s, const char *subject,
                               struct store_erased **out, size_t *n, struct errinfo *e);

#endif
