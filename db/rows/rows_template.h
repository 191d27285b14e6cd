/* rows_template.h -- the templates' rows, inside a transaction, and their encoded faces. */
#ifndef DB_ROWS_TEMPLATE_H
#define DB_ROWS_TEMPLATE_H
#include "rows_subject.h"

struct rows_template { /* an authentic row */
    struct store_template one;
    int64_t revision;
    uint64_t number; /* number among the subject's templates, in the order of enrolment */
    unsigned char mac[CRYPT_HASH];
    /* Set when the row is written: the subject, keyed hashes of both digests, encrypted columns. */
    unsigned char uid[STORE_UID], by_used[CRYPT_HASH], by_read[CRYPT_HASH];
    struct sql_field_blob about;
    unsigned char descriptor[SURFACE_DESCRIPTOR + CRYPT_OVER]; /* encrypted */
};

extern const struct rows_table rows_templates;

/* Receives a template.  Any status but ST_OK and ST_ECORRUPT ends the reading. */
typedef enum status rows_template_use(void *arg, const struct rows_template *row,
                                      const struct rows_subject *of, const void *face,
                                      size_t len, struct errinfo *e);

/* rows_template_get(t, id, out, of, e): Reads a template and its subject.  ST_ENOTFOUND: also if the actor of t
 * is bound to other groups than the subject's; ST_ECORRUPT. */
enum status rows_template_get(struct log_txn *t, const char *id,
                              struct rows_template *out, struct rows_subject *of,
                              struct errinfo *e);

/* rows_template_list(t, of, out, n, e): Lists the subject's templates, oldest first.
 *   of   the query uses only of->lookup, which is known before the subject's row was read
 *   out  a new array of *n elements, to be released by free()
 * ST_ECORRUPT: also if one is missing: a hidden template must not make another the oldest. */
enum status rows_template_list(struct log_txn *t, const struct rows_subject *of,
                               struct rows_template **out, size_t *n, struct errinfo *e);

/* rows_template_same(t, uid, used, read, id, e): Finds the subject's template that was made of the same points.
 *   used, read  digests of the points as used and as read, 64 digits each; "": unknown
 *   id          receives the template's id; "": there is none
 * ST_ENOTFOUND: there is no such subject. */
enum status rows_template_same(struct log_txn *t, const unsigned char uid[STORE_UID],
                               const char *used, const char *read,
                               char id[STORE_ID_LEN + 1], struct errinfo *e);

/* rows_template_descriptor(row, of, out, e): Decrypts the descriptor (surface_describe()).  ST_ECORRUPT. */
enum status rows_template_descriptor(const struct rows_template *row,
                                     const struct rows_subject *of,
                                     unsigned char out[SURFACE_DESCRIPTOR],
                                     struct errinfo *e);

/* rows_template_face(t, row, of, face, len, e): Reads and decrypts the face of a template.
 *   face  to be released by rows_template_wipe(), also after a failure */
enum status rows_template_face(struct log_txn *t, const struct rows_template *row,
                               const struct rows_subject *of, unsigned char **face,
                               size_t *len, struct errinfo *e);

/* rows_template_heads(t, of, row, n, mesh, face, len, e): Reads and decrypts the heads of the faces of all templates
 * of a subject, by one query.
 *   mesh  true: of a subject with one template its whole face, which is then mostly needed
 *   row   [n] as from rows_template_list()
 *   face  [n], len [n]: receive the heads, each to be released by rows_template_wipe(), also after a failure */
enum status rows_template_heads(struct log_txn *t, const struct rows_subject *of,
                                const struct rows_template *row, size_t n, bool mesh,
                                unsigned char **face, size_t *len, struct errinfo *e);

/* rows_template_wipe(face, len): Wipes and releases a face; NULL is allowed. */
void rows_template_wipe(unsigned char *face, size_t len);

/* rows_template_each(t, part, parts, faces, use, report, arg, e): Calls use() for each template of the part'th of
 * `parts` shares, from 0 on.  Calls report() for a damaged template, and if use() returns ST_ECORRUPT.
 *   faces  false: they are not read, and use() receives NULL */
enum status rows_template_each(struct log_txn *t, unsigned part, unsigned parts,
                               bool faces, rows_template_use *use, store_report *report,
                               void *arg, struct errinfo *e);

struct rows_face { /* a face and its descriptor, plain; borrowed */
    const void *face;
    size_t len; /* bytes of face */
    const unsigned char *descriptor;
};

/* rows_template_add(t, of, row, face, e): Adds a template described by row->one, with its face.  Writes the
 * subject's row too. */
enum status rows_template_add(struct log_txn *t, struct rows_subject *of,
                              struct rows_template *row, const struct rows_face *face,
                              struct errinfo *e);

/* rows_template_write(t, of, row, face, e): Replaces row->one and the face.  Writes the subject's row too. */
enum status rows_template_write(struct log_txn *t, struct rows_subject *of,
                                struct rows_template *row, const struct rows_face *face,
                                struct errinfo *e);

/* rows_template_delete(t, of, row, e): Deletes a template with its face.  Writes the subject's row too; if the
 * subject is deleted itself, use rows_table_delete(). */
enum status rows_template_delete(struct log_txn *t, struct rows_subject *of,
                                 const struct rows_template *row, struct errinfo *e);

/* rows_template_accept(t, of, e): Makes the present templates the ones that the subject must have. */
enum status rows_template_accept(struct log_txn *t, struct rows_subject *of,
                                 struct errinfo *e);

#endif
