/* row_template.h -- the rows of templates, inside a transaction. */
#ifndef DB_ROW_TEMPLATE_H
#define DB_ROW_TEMPLATE_H
#include "row_subject.h"
#include "store_types.h"

struct sql_rows;  /* sql.h */
struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

/* Receives one template; model is valid during the call only.  Its status ends the
 * reading where it is not ST_OK. */
typedef enum status row_template_use(void *arg, const struct store_template *t,
                                     const void *model, size_t len, struct errinfo *e);

/* row_template_get(x, id, t, e): ST_ENOTFOUND; ST_ECORRUPT, and t->subject is "".
 * row_template_key(x, id, t, k, e): its subject's key too, to be wiped.
 * row_template_load(x, id, t, use, arg, e): with its model. */
enum status row_template_get(struct store_txn *x, const char *id,
                             struct store_template *t, struct errinfo *e);
enum status row_template_key(struct store_txn *x, const char *id,
                             struct store_template *t, struct row_crypt_key *k,
                             struct errinfo *e);
enum status row_template_load(struct store_txn *x, const char *id,
                              struct store_template *t, row_template_use *use, void *arg,
                              struct errinfo *e);

/* row_template_list(x, subject, count, out, n, e): of a subject's row, oldest first; released by
 * free().  ST_ECORRUPT: there are not as many as that row says.
 * row_template_ids(x, subject, out, n, e): the ids alone; a malformed one is "???...".
 * row_template_newest(x, subject, id, e): the last one's id, "" where there is none.
 * row_template_same(x, p, digest, t, found, e): the subject's template of this digest. */
enum status row_template_list(struct store_txn *x, int64_t subject, uint32_t count,
                              struct store_template **out, size_t *n, struct errinfo *e);
enum status row_template_ids(struct store_txn *x, int64_t subject,
                             char (**out)[STORE_ID_LEN + 1], size_t *n,
                             struct errinfo *e);
enum status row_template_newest(struct store_txn *x, int64_t subject,
                                char id[STORE_ID_LEN + 1], struct errinfo *e);
enum status row_template_same(struct store_txn *x, const struct row_subject *p,
                              const char *digest, struct store_template *t, bool *found,
                              struct errinfo *e);

/* row_template_tell(x, by, kind, subject, id, outcome, e): append to the changes what an act
 * leaves of the row, as it is now: nothing where it was deleted. */
enum status row_template_tell(struct store_txn *x, const struct store_act *by,
                              const char *kind, const char *subject, const char *id,
                              const char *outcome, struct errinfo *e);

/* row_template_see(x, see, arg, e): every row as it is, not verified, without its model. */
enum status row_template_see(struct store_txn *x, row_event_see *see, void *arg,
                             struct errinfo *e);

/* row_template_add(x, p, t, model, len, e): a new row, complete.
 * row_template_write(x, k, t, model, len, e): engine, triangles, quality and model of *t in the
 * place of what is there, under the subject's key k.
 * row_template_found(x, p, t, e): what row_template_same() finds it by, under x's vault.
 * row_template_delete(x, id, e). */
enum status row_template_add(struct store_txn *x, const struct row_subject *p,
                             const struct store_template *t, const void *model,
                             size_t len, struct errinfo *e);
enum status row_template_write(struct store_txn *x, const struct row_crypt_key *k,
                               const struct store_template *t, const void *model,
                               size_t len, struct errinfo *e);
enum status row_template_found(struct store_txn *x, const struct row_subject *p,
                               const struct store_template *t, struct errinfo *e);
enum status row_template_delete(struct store_txn *x, const char *id, struct errinfo *e);

/* row_template_each(s, part, parts, use, report, arg, e): every template of one moment, or the
 * part'th of so many shares of them, from 0 on, in a transaction of its own; a damaged row is
 * reported and passed over. */
enum status row_template_each(struct store *s, unsigned part, unsigned parts,
                              row_template_use *use,
                              void (*report)(void *arg, const char *line), void *arg,
                              struct errinfo *e);

#endif
