/* store_txn.h -- an open store, and its transactions. */
#ifndef DB_STORE_TXN_H
#define DB_STORE_TXN_H
#include <stdatomic.h>
#include "log_txn.h"
#include "rows_types.h"
#include "store_state.h"

struct surface_model; /* libsurface.h */

struct store {
    struct sql *sql;
    char *path;
    const struct surface_model *model; /* store_use_model() */
    char made_by[SURFACE_ENGINE_SIZE];
    struct crypt *crypt;
    struct log log;
    char *anchor;         /* its file; NULL: there is none */
    atomic_bool verified; /* the rows, against the digest */
    bool open;            /* store_open() has succeeded */
    struct store_fault refusal, anchor_fault;
};

/* store_begin(s, how, t, e): as sql_begin().  ST_EREFUSED: the database is not the one that was
 * opened, or an older one, or its rows are not those of the last change.
 * store_end(s, t, st, e): as sql_end().
 * store_refuse(s, st, why, e): st, for why; where it is ST_EREFUSED, every other transaction fails
 * with it from now on.
 * store_scrub(s): deleted bytes leave the file and its WAL, after an erasure. */
enum status store_begin(struct store *s, enum sql_begin how, struct log_txn *t,
                        struct errinfo *e);
enum status store_end(struct store *s, struct log_txn *t, enum status st,
                      struct errinfo *e);
enum status store_refuse(struct store *s, enum status st, const struct errinfo *why,
                         struct errinfo *e);
void store_scrub(struct store *s);

/* store_act_begin(s, actor, how, by, t, e): log_act() and store_begin(). */
enum status store_act_begin(struct store *s, const char *actor, enum sql_begin how,
                            struct log_act *by, struct log_txn *t, struct errinfo *e);

#endif
