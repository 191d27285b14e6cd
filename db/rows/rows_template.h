/* rows_template.h -- the templates' rows, inside a transaction, and their encoded faces. */
#ifndef DB_ROWS_TEMPLATE_H
#define DB_ROWS_TEMPLATE_H
#include "rows_subject.h"

struct rows_template { /* a row as it was read and found authentic */
    struct store_template one;
    int64_t revision;
    uint64_t number; /* of its subject's, in the order of enrolment */
    unsigned char mac[CRYPT_HASH];
    /* Set when the row is written: keyed hashes of both digests, what is encrypted. */
    unsigned char uid[STORE_UID], by_used[CRYPT_HASH], by_read[CRYPT_HASH];
    struct sql_field_blob about;
};

extern const struct rows_table rows_templates;

/* Receives one template; its status ends the reading where it is not ST_OK. */
typedef enum status rows_template_use(void *arg, const struct rows_template *row,
                                      const struct rows_subject *of, const void *face,
                                      size_t len, struct errinfo *e);

/* rows_template_get(t, id, out, of, e): with its subject.  ST_ENOTFOUND, ST_ECORRUPT.
 * rows_template_list(t, of, out, n, e): the subject's, oldest first; released by free().
 * ST_ECORRUPT also where they are not all: one that is hidden must not make another the oldest.
 * rows_template_same(t, uid, used, read, id, e): the id of the subject's template that was made of
 * these points as they were used or as they were read (64 digits each, "" for unknown); "" where
 * there is none.  ST_ENOTFOUND: there is no such subject. */
enum status rows_template_get(struct log_txn *t, const char *id,
                              struct rows_template *out, struct rows_subject *of,
                              struct errinfo *e);
enum status rows_template_list(struct log_txn *t, const struct rows_subject *of,
                               struct rows_template **out, size_t *n, struct errinfo *e);
enum status rows_template_same(struct log_txn *t, const unsigned char uid[STORE_UID],
                               const char *used, const char *read,
                               char id[STORE_ID_LEN + 1], struct errinfo *e);

/* rows_template_face(t, row, of, face, len, e): decrypted; wiped and released by
 * rows_template_wipe(), also NULL.
 * rows_template_each(t, part, parts, use, report, arg, e): every template with its face,
 * or the part'th of parts shares of them, from 0 on; a damaged one is reported and
 * skipped. */
enum status rows_template_face(struct log_txn *t, const struct rows_template *row,
                               const struct rows_subject *of, unsigned char **face,
                               size_t *len, struct errinfo *e);
void rows_template_wipe(unsigned char *face, size_t len);
enum status rows_template_each(struct log_txn *t, unsigned part, unsigned parts,
                               rows_template_use *use, store_report *report, void *arg,
                               struct errinfo *e);

/* rows_template_add(t, of, row, face, len, e): a new row of row->one.
 * rows_template_write(t, of, row, face, len, e): what row->one says by now, and another face.
 * rows_template_delete(t, of, row, e): and its face.
 * Each writes the subject's row, *of, too.
 * Of a subject that is deleted itself: rows_table_delete().
 * rows_template_accept(t, of, e): those that there are are all. */
enum status rows_template_add(struct log_txn *t, struct rows_subject *of,
                              struct rows_template *row, const void *face, size_t len,
                              struct errinfo *e);
enum status rows_template_write(struct log_txn *t, struct rows_subject *of,
                                struct rows_template *row, const void *face, size_t len,
                                struct errinfo *e);
enum status rows_template_delete(struct log_txn *t, struct rows_subject *of,
                                 const struct rows_template *row, struct errinfo *e);
enum status rows_template_accept(struct log_txn *t, struct rows_subject *of,
                                 struct errinfo *e);

#endif
