/* rows_subject.h -- the subjects' rows, inside a transaction. */
#ifndef DB_ROWS_SUBJECT_H
#define DB_ROWS_SUBJECT_H
#include "rows_table.h"
#include "rows_types.h"

struct rows_subject { /* an authentic row; to be wiped */
    struct store_subject one;
    int64_t revision;
    unsigned char mac[CRYPT_HASH];
    unsigned char templates[LOG_DIGEST]; /* sum of the summands of its templates' rows */
    uint64_t added;                      /* number of templates added so far */
    unsigned char wrapped[CRYPT_WRAPPED], key[CRYPT_KEY]; /* the subject's key */
    unsigned char lookup[CRYPT_HASH];                     /* keyed hash of the id */
    struct sql_field_blob about;                          /* encrypted columns */
};

extern const struct rows_table rows_subjects;

/* The columns of the table s that rows_table_read() reads, and their number. */
#define ROWS_SUBJECT                                                                     \
    "s.uid, s.revision, s.lookup, s.key, s.about, s.created, s.expires, s.hold, "        \
    "s.disabled, s.mac, s.subject_key, s.seen, "                                         \
    "(SELECT count(*) FROM templates x WHERE x.uid = s.uid)"
#define ROWS_SUBJECT_N 13

/* rows_subject_find(t, subject, out, e): Reads the subject with this id.  Sets out->lookup also if there is
 * none.  ST_ENOTFOUND: also if the actor of t is bound to other groups; ST_ECORRUPT. */
enum status rows_subject_find(struct log_txn *t, const char *subject,
                              struct rows_subject *out, struct errinfo *e);

/* rows_subject_free(t, subject, e): Checks that no subject, of whatever groups, has this id.  ST_EEXISTS. */
enum status rows_subject_free(struct log_txn *t, const char *subject, struct errinfo *e);

/* rows_subject_get(t, uid, out, e): Reads the subject with this uid, of whatever groups.  ST_ENOTFOUND,
 * ST_ECORRUPT. */
enum status rows_subject_get(struct log_txn *t, const unsigned char uid[STORE_UID],
                             struct rows_subject *out, struct errinfo *e);

/* rows_subject_list(t, after, limit, out, n, e): Lists up to limit subjects whose key is greater than after, in
 * the order of creation.
 *   out  a new array of *n elements, to be released by free() */
enum status rows_subject_list(struct log_txn *t, int64_t after, size_t limit,
                              struct store_subject **out, size_t *n, struct errinfo *e);

/* rows_subject_due(t, now, out, n, e): Lists the subjects that have expired by now, the longest expired first.
 * out as in rows_subject_list(). */
enum status rows_subject_due(struct log_txn *t, const char *now,
                             struct store_subject **out, size_t *n, struct errinfo *e);

/* rows_subject_add(t, one, out, e): Adds a subject without templates, with a new key.
 *   one  uid: its uid; zeros: a new one */
enum status rows_subject_add(struct log_txn *t, const struct store_subject *one,
                             struct rows_subject *out, struct errinfo *e);

/* rows_subject_write(t, p, e): Writes p->one except uid, created, seen and key, and p->templates and
 * p->added.  A subject without templates is deleted by rows_table_delete(), with its attempts. */
enum status rows_subject_write(struct log_txn *t, struct rows_subject *p,
                               struct errinfo *e);

/* rows_subject_seen(t, uid, at, e): Sets the time of last use, which is not authenticated. */
enum status rows_subject_seen(struct log_txn *t, const unsigned char uid[STORE_UID],
                              const char *at, struct errinfo *e);

#endif
