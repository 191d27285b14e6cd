/* row_cloud.h -- scans that are no new ones when they come again, inside a transaction. */
#ifndef DB_ROW_CLOUD_H
#define DB_ROW_CLOUD_H
#include "store_types.h"

struct row_subject; /* row_subject.h */
struct store_txn;   /* store_txn.h */

/* row_cloud_known(t, who, probe, now, known, e): is it the cloud of a template of the subject, as
 * it was read or as it was used, or a probe that is kept, and not for a retry of probe->retry?
 * row_cloud_keep(t, who, probe, now, known, e): keeps it for probe->keep_ms, for a retry unless
 * this is one; *known: another process has done so just now.  What is kept for long enough goes,
 * and of a subject all but the last STORE_PROBES. */
enum status row_cloud_known(struct store_txn *t, const struct store_subject *who,
                            const struct store_probe *probe, int64_t now, bool *known,
                            struct errinfo *e);
enum status row_cloud_keep(struct store_txn *t, const struct store_subject *who,
                           const struct store_probe *probe, int64_t now, bool *known,
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
