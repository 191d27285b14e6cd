/* row_subject.h -- the rows of subjects, inside a transaction. */
#ifndef DB_ROW_SUBJECT_H
#define DB_ROW_SUBJECT_H
#include "sql.h"
#include "row_crypt.h"
#include "row_event.h"
#include "store_types.h"

struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

/* The columns that row_subject_who() reads, of the table s.  Those before the key are what the
 * audit log leaves of the row (row_event.h); the key is authenticated by itself, and when the
 * subject was seen is not. */
#define ROW_SUBJECT_WHO                                                                  \
    "s.uid, s.lookup, s.about, s.created, s.expires, s.hold, s.disabled, s.templates, s.key, s.seen"
#define ROW_SUBJECT_WHO_N 10

/* All that row_subject_read() and lists take. */
#define ROW_SUBJECT_COLUMNS "s.subject_key, " ROW_SUBJECT_WHO

/* row_subject_who(t, r, col, s, k, e): a subject and its key from the columns of
 * ROW_SUBJECT_WHO, which begin at col; s->key is 0.  ST_ECORRUPT: damaged, or
 * not the row that was written last.  *k is to be wiped.
 * row_subject_row(t, r, s, e): from a row of ROW_SUBJECT_COLUMNS; t is a void * for
 * store_column_list(). */
enum status row_subject_who(struct store_txn *t, const struct sql_rows *r, int col,
                            struct store_subject *s, struct row_crypt_key *k,
                            struct errinfo *e);
enum status row_subject_row(void *t, const struct sql_rows *r, void *s,
                            struct errinfo *e);

/* row_subject_lookup(t, subject, out): what a row is found by, as a value; out is its bytes. */
struct sql_value row_subject_lookup(const struct store_txn *t, const char *subject,
                                    unsigned char out[VAULT_HASH]);

struct row_subject { /* a subject in a transaction; to be wiped */
    int64_t row;
    uint32_t templates; /* that it must have */
    struct row_crypt_key key;
};

/* row_subject_find(t, subject, p, e): ST_ENOTFOUND; ST_ECORRUPT: damaged; then *p has the row
 * all the same, 0 where it is another subject's, or where it is missing although nobody erased
 * it.
 * row_subject_same(t, uid, p, who, e): the one with this uid, under whatever id.  ST_ENOTFOUND;
 * ST_ECORRUPT as above, and *who is empty then.
 * row_subject_of(t, template_id, p, who, e): the one that the row of this template names, which may
 * be damaged; ST_ENOTFOUND, ST_ECORRUPT: *who is empty.
 * row_subject_read(t, subject, out, e): all but whether it has expired. */
enum status row_subject_find(struct store_txn *t, const char *subject,
                             struct row_subject *p, struct errinfo *e);
enum status row_subject_same(struct store_txn *t, const unsigned char uid[STORE_UID],
                             struct row_subject *p, struct store_subject *who,
                             struct errinfo *e);
enum status row_subject_of(struct store_txn *t, const char *template_id,
                           struct row_subject *p, struct store_subject *who,
                           struct errinfo *e);
enum status row_subject_read(struct store_txn *t, const char *subject,
                             struct store_subject *out, struct errinfo *e);

/* row_subject_tell(t, by, kind, subject, p, outcome, e): append to the changes what an act leaves
 * of the row, as it is now. */
enum status row_subject_tell(struct store_txn *t, const struct store_act *by,
                             const char *kind, const char *subject,
                             const struct row_subject *p, const char *outcome,
                             struct errinfo *e);

/* row_subject_each(t, see, arg, e): every row as it is, not verified. */
enum status row_subject_each(struct store_txn *t, row_event_see *see, void *arg,
                             struct errinfo *e);

/* row_subject_add(t, about, p, e): with about->uid, or where that is 0 a new one.
 * row_subject_write(t, p, one, e): all of it but created, seen, uid and templates.
 * row_subject_count(t, by, subject, p, more, e): it has so many templates more; an entry says how
 * many these are.
 * row_subject_renew(t, p, one, wrapped, e): the same under another key, p's, wrapped.
 * row_subject_seen(t, subject, at, e): it was seen.
 * row_subject_delete(t, row, e): with its templates and attempts. */
enum status row_subject_add(struct store_txn *t, const struct store_subject *about,
                            struct row_subject *p, struct errinfo *e);
enum status row_subject_write(struct store_txn *t, const struct row_subject *p,
                              const struct store_subject *one, struct errinfo *e);
enum status row_subject_count(struct store_txn *t, const struct store_act *by,
                              const char *subject, const struct row_subject *p, int more,
                              struct errinfo *e);
enum status row_subject_renew(struct store_txn *t, const struct row_subject *p,
                              const struct store_subject *one,
                              const unsigned char wrapped[VAULT_WRAPPED],
                              struct errinfo *e);
enum status row_subject_seen(struct store_txn *t, const char *subject, const char *at,
                             struct errinfo *e);
enum status row_subject_delete(struct store_txn *t, int64_t row, struct errinfo *e);

#endif
