/* rows_subject.h -- the subjects' rows, inside a transaction. */
#ifndef DB_ROWS_SUBJECT_H
#define DB_ROWS_SUBJECT_H
#include "rows_table.h"
#include "rows_types.h"

struct rows_subject { /* a row as it was read and found authentic; to be wiped */
    struct store_subject one;
    int64_t revision;
    unsigned char mac[CRYPT_HASH];
    unsigned char templates[LOG_DIGEST]; /* of its templates' rows, as log_txn_sum() */
    uint64_t added;                      /* templates, so far: the number of the newest */
    unsigned char wrapped[CRYPT_WRAPPED], key[CRYPT_KEY]; /* the subject's own */
    unsigned char lookup[CRYPT_HASH];                     /* what it is found by */
    struct sql_field_blob about;                          /* encrypted */
};

extern const struct rows_table rows_subjects;

/* The columns that rows_table_read() reads, of the table s, and their number. */
#define ROWS_SUBJECT                                                                     \
    "s.uid, s.revision, s.lookup, s.key, s.about, s.created, s.expires, s.hold, "        \
    "s.disabled, s.mac, s.subject_key, s.seen, "                                         \
    "(SELECT count(*) FROM templates x WHERE x.uid = s.uid)"
#define ROWS_SUBJECT_N 13

/* rows_subject_find(t, subject, out, e), rows_subject_get(t, uid, out, e): by id, by uid.
 * ST_ENOTFOUND, ST_ECORRUPT.
 * rows_subject_list(t, after, limit, out, n, e): in the order of creation, those whose key is
 * greater than `after`.
 * rows_subject_due(t, now, out, n, e): that have expired by now, the longest ago first.  Both
 * arrays are released by free(). */
enum status rows_subject_find(struct log_txn *t, const char *subject,
                              struct rows_subject *out, struct errinfo *e);
enum status rows_subject_get(struct log_txn *t, const unsigned char uid[STORE_UID],
                             struct rows_subject *out, struct errinfo *e);
enum status rows_subject_list(struct log_txn *t, int64_t after, size_t limit,
                              struct store_subject **out, size_t *n, struct errinfo *e);
enum status rows_subject_due(struct log_txn *t, const char *now,
                             struct store_subject **out, size_t *n, struct errinfo *e);

/* rows_subject_add(t, one, out, e): a new row of *one, under one->uid or where that is 0 a new
 * one, with a key of its own, and without templates.
 * rows_subject_write(t, p, e): what p->one says by now, but uid, created, seen and the key;
 * and p->templates and p->added.
 * rows_subject_seen(t, uid, at, e): it was seen, which is not authenticated.
 * rows_table_delete() deletes it with its attempts, when it has no templates any more. */
enum status rows_subject_add(struct log_txn *t, const struct store_subject *one,
                             struct rows_subject *out, struct errinfo *e);
enum status rows_subject_write(struct log_txn *t, struct rows_subject *p,
                               struct errinfo *e);
enum status rows_subject_seen(struct log_txn *t, const unsigned char uid[STORE_UID],
                              const char *at, struct errinfo *e);

#endif
