/* row_entry.h -- an entry of the audit log as its row has it. */
#ifndef DB_ROW_ENTRY_H
#define DB_ROW_ENTRY_H
#include "row_crypt.h"
#include "store_chain.h"

struct sql_rows; /* sql.h */

/* The columns that row_entry_read() takes, of the table e. */
#define ROW_ENTRY_COLUMNS                                                                \
    "e.chain, e.seq, e.at, e.kind, e.actor, e.subject, e.template_id, e.outcome, "       \
    "e.object, e.row_mac, e.uses, e.uses_hash, e.hash"
#define ROW_ENTRY_N 13

struct row_entry {
    enum store_chain chain;
    uint64_t seq, uses;
    char at[32], kind[STORE_NAME_MAX + 1], actor[STORE_NAME_MAX + 1],
        template_id[STORE_ID_LEN + 1], outcome[STORE_NAME_MAX + 1];
    unsigned char ref[ROW_CRYPT_REF], object[STORE_CHAIN_OBJECT], row[VAULT_HASH],
        uses_hash[STORE_CHAIN_HASH], hash[STORE_CHAIN_HASH];
    size_t nref, nobject, nrow, nuses_hash; /* 0 or all of it */
};

/* row_entry_read(from, out): false: damaged; out->chain and seq are set all the same.
 * row_entry_chain(r): the same to be hashed; it points into *r. */
bool row_entry_read(const struct sql_rows *from, struct row_entry *out);
struct store_chain_entry row_entry_chain(const struct row_entry *r);

/* row_entry_mark(from, col, m): chain, seq, at, hash and signature of a checkpoint from the
 * column col on; false: damaged, and m->chain and seq are set all the same. */
bool row_entry_mark(const struct sql_rows *from, int col, struct store_chain_mark *m);

#endif
