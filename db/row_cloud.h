/* row_cloud.h -- the clouds that templates were made of, as they were read, inside a transaction. */
#ifndef DB_ROW_CLOUD_H
#define DB_ROW_CLOUD_H
#include "store_types.h"

struct row_subject; /* row_subject.h */
struct store_txn;   /* store_txn.h */

/* row_cloud_known(t, who, probe, known, e): is it the cloud of a template of the subject, as it was
 * read or as it was used? */
enum status row_cloud_known(struct store_txn *t, const struct store_subject *who,
                            const struct store_probe *probe, bool *known,
                            struct errinfo *e);

/* row_cloud_template(t, p, digest, id, e): the template of the subject that was made of this cloud;
 * "" where none is known. */
enum status row_cloud_template(struct store_txn *t, const struct row_subject *p,
                               const char *digest, char id[STORE_ID_LEN + 1],
                               struct errinfo *e);

/* row_cloud_enroll(t, p, id, digest, e): what the template of this id was made of, as it was
 * read. */
enum status row_cloud_enroll(struct store_txn *t, const struct row_subject *p,
                             const char *id, const char *digest, struct errinfo *e);

#endif
