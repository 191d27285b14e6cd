/* store_archive.h -- what the records of an archive (archive.h) say.  Layout: db/FORMAT.md. */
#ifndef DB_STORE_ARCHIVE_H
#define DB_STORE_ARCHIVE_H
#include <stddef.h>
#include <stdint.h>
#include "store_types.h"

enum store_archive_kind {
    STORE_ARCHIVE_SUBJECT,
    STORE_ARCHIVE_TEMPLATE,
    STORE_ARCHIVE_END
};

struct store_archive_item {
    enum store_archive_kind kind;
    struct store_subject subject;   /* whose; key and templates are 0 */
    struct store_template template; /* of it, for STORE_ARCHIVE_TEMPLATE */
    const unsigned char *model;     /* of that, len bytes of the record */
    size_t len;
    uint64_t subjects, templates; /* for STORE_ARCHIVE_END: how many came before it */
};

#define STORE_ARCHIVE_HEAD 2048 /* bytes of a record without a model */

/* store_archive_subject(s, out), store_archive_template(t, out): the record of it, of which the
 * latter is to be followed by the model; they return its bytes. */
size_t store_archive_subject(const struct store_subject *s,
                             unsigned char out[STORE_ARCHIVE_HEAD]);
size_t store_archive_template(const struct store_template *t,
                              unsigned char out[STORE_ARCHIVE_HEAD]);

/* store_archive_parse(data, n, item, e): a record, which may come from anyone.  Of *item
 * only what the record says is set: a template's subject is the one that was there before.
 * ST_ECORRUPT.  The model is not looked at. */
enum status store_archive_parse(const unsigned char *data, size_t n,
                                struct store_archive_item *item, struct errinfo *e);

#endif
