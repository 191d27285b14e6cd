/* row_subject.h -- the rows of subjects, inside a transaction. */
#ifndef DB_ROW_SUBJECT_H
#define DB_ROW_SUBJECT_H
#include "sql.h"
#include "row_crypt.h"
#include "store_types.h"

struct store_txn; /* store_txn.h */

/* The columns that row_subject_who() reads, of the table s. */
#define ROW_SUBJECT_WHO                                                                  \
    "s.uid, s.key, s.about, s.created, s.expires, s.seen, s.hold, s.disabled"
#define ROW_SUBJECT_WHO_N 8

/* All that row_subject_read() and lists take. */
#define ROW_SUBJECT_COLUMNS                                                              \
    "s.subject_key, (SELECT count(*) FROM templates t "                                  \
    "WHERE t.subject_key = s.subject_key), " ROW_SUBJECT_WHO

/* row_subject_who(t, r, col, s, k): a subject and its key from the columns of ROW_SUBJECT_WHO,
 * which begin at col; s->key and s->templates are 0.  false: damaged.  *k is to be wiped.
 * row_subject_row(t, r, s, e): from a row of ROW_SUBJECT_COLUMNS; t is a void * for
 * store_column_list(). */
bool row_subject_who(const struct store_txn *t, const struct sql_rows *r, int col,
                     struct store_subject *s, struct row_crypt_key *k);
enum status row_subject_row(void *t, const struct sql_rows *r, void *s,
                            struct errinfo *e);

/* row_subject_lookup(t, subject, out): what a row is found by, as a value; out is its bytes. */
struct sql_value row_subject_lookup(const struct store_txn *t, const char *subject,
                                    unsigned char out[VAULT_HASH]);

struct row_subject { /* a subject in a transaction; to be wiped */
    int64_t row;
    struct row_crypt_key key;
};

/* row_subject_find(t, subject, p, e): ST_ENOTFOUND; ST_ECORRUPT: damaged; then *p has the row
 * all the same, unless it is another subject's.
 * row_subject_same(t, uid, p, who, e): the one with this uid, under whatever id.  ST_ENOTFOUND;
 * ST_ECORRUPT as above, and *who is empty then.
 * row_subject_read(t, subject, out, e): all but whether it has expired. */
enum status row_subject_find(struct store_txn *t, const char *subject,
                             struct row_subject *p, struct errinfo *e);
enum status row_subject_same(struct store_txn *t, const unsigned char uid[STORE_UID],
                             struct row_subject *p, struct store_subject *who,
                             struct errinfo *e);
enum status row_subject_read(struct store_txn *t, const char *subject,
                             struct store_subject *out, struct errinfo *e);

/* row_subject_add(t, about, p, e): with about->uid, or where that is 0 a new one.
 * row_subject_write(t, p, one, e): all of it but created, seen and uid.
 * row_subject_seen(t, subject, at, e): it was seen.
 * row_subject_delete(t, row, e): with its templates and attempts. */
enum status row_subject_add(struct store_txn *t, const struct store_subject *about,
                            struct row_subject *p, struct errinfo *e);
enum status row_subject_write(struct store_txn *t, const struct row_subject *p,
                              const struct store_subject *one, struct errinfo *e);
enum status row_subject_seen(struct store_txn *t, const char *subject, const char *at,
                             struct errinfo *e);
enum status row_subject_delete(struct store_txn *t, int64_t row, struct errinfo *e);

#endif
