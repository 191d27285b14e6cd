/* admin_record.h -- what the records of an archive (archive.h) say.  Layout: db/FORMAT.md. */
#ifndef DB_ADMIN_RECORD_H
#define DB_ADMIN_RECORD_H
#include <stddef.h>
#include <stdint.h>
#include "rows_template.h"

enum admin_record_kind { ADMIN_RECORD_SUBJECT, ADMIN_RECORD_TEMPLATE, ADMIN_RECORD_END };

struct admin_record_item {
    enum admin_record_kind kind;
    struct store_subject subject;  /* whose; key and templates are 0 */
    struct rows_template template; /* of it, for ADMIN_RECORD_TEMPLATE: one and read */
    const unsigned char *face;     /* of that, len bytes of the record */
    size_t len;
    uint64_t subjects, templates; /* for ADMIN_RECORD_END: how many came before it */
};

#define ADMIN_RECORD_HEAD 2048 /* bytes of a record without a face */

/* admin_record_subject(s, out), admin_record_template(row, out): the record of it, of which the
 * latter is to be followed by the face; they return its bytes. */
size_t admin_record_subject(const struct store_subject *s,
                            unsigned char out[ADMIN_RECORD_HEAD]);
size_t admin_record_template(const struct rows_template *row,
                             unsigned char out[ADMIN_RECORD_HEAD]);

/* admin_record_parse(data, n, item, e): a record, which may come from anyone.  Of *item
 * only what the record says is set: a template's subject is the one that was there before.
 * ST_ECORRUPT.  The face is not looked at. */
enum status admin_record_parse(const unsigned char *data, size_t n,
                               struct admin_record_item *item, struct errinfo *e);

#endif
