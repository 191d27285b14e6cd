#include "row_entry.h"

#include <string.h>

#include "sql.h"
#include "store_column.h"

enum { /* the columns of ROW_ENTRY_COLUMNS */
       COL_CHAIN,
       COL_SEQ,
       COL_AT,
       COL_KIND,
       COL_ACTOR,
       COL_SUBJECT,
       COL_TEMPLATE,
       COL_OUTCOME,
       COL_OBJECT,
       COL_ROW,
       COL_USES,
       COL_USES_HASH,
       COL_HASH
};

/* n bytes, or none. */
static bool read_bytes(const struct sql_rows *from, int col, unsigned char *out, size_t n,
                       size_t *got)
{
    *got = sql_column(from, col).n;
    return (sql_column(from, col).type == SQL_BLOB && *got == 0) ||
           (store_column_bytes(from, col, out, n) && *got == n);
}

static enum store_chain read_chain(const struct sql_rows *from, int col)
{
    return sql_column(from, col).i == STORE_CHAIN_CHANGES ? STORE_CHAIN_CHANGES
                                                          : STORE_CHAIN_USES;
}

bool row_entry_mark(const struct sql_rows *from, int col, struct store_chain_mark *m)
{
    memset(m, 0, sizeof *m);
    m->chain = read_chain(from, col);
    m->seq = (uint64_t)sql_column(from, col + 1).i;
    return store_column_text(from, col + 2, m->at, sizeof m->at) &&
           store_column_bytes(from, col + 3, m->hash, sizeof m->hash) &&
           store_column_bytes(from, col + 4, m->signature, sizeof m->signature);
}

bool row_entry_read(const struct sql_rows *from, struct row_entry *r)
{
    int64_t uses;
    bool sound;

    memset(r, 0, sizeof *r);
    r->chain = read_chain(from, COL_CHAIN);
    r->seq = (uint64_t)sql_column(from, COL_SEQ).i;
    sound =
        store_column_text(from, COL_AT, r->at, sizeof r->at) &&
        store_column_text(from, COL_KIND, r->kind, sizeof r->kind) &&
        store_column_text(from, COL_ACTOR, r->actor, sizeof r->actor) &&
        read_bytes(from, COL_SUBJECT, r->ref, sizeof r->ref, &r->nref) &&
        store_column_text(from, COL_TEMPLATE, r->template_id, sizeof r->template_id) &&
        store_column_text(from, COL_OUTCOME, r->outcome, sizeof r->outcome) &&
        read_bytes(from, COL_OBJECT, r->object, sizeof r->object, &r->nobject) &&
        read_bytes(from, COL_ROW, r->row, sizeof r->row, &r->nrow) &&
        store_column_int(from, COL_USES, 0, &uses) &&
        read_bytes(from, COL_USES_HASH, r->uses_hash, sizeof r->uses_hash,
                   &r->nuses_hash) &&
        store_column_bytes(from, COL_HASH, r->hash, sizeof r->hash);
    r->uses = sound ? (uint64_t)uses : 0;
    return sound;
}

struct store_chain_entry row_entry_chain(const struct row_entry *r)
{
    return (struct store_chain_entry){.chain = r->chain,
                                      .seq = r->seq,
                                      .at = r->at,
                                      .kind = r->kind,
                                      .actor = r->actor,
                                      .subject = r->ref,
                                      .nsubject = r->nref,
                                      .template_id = r->template_id,
                                      .outcome = r->outcome,
                                      .object = r->object,
                                      .nobject = r->nobject,
                                      .row = r->row,
                                      .nrow = r->nrow,
                                      .uses = r->uses,
                                      .uses_hash = r->uses_hash,
                                      .nuses_hash = r->nuses_hash};
}
