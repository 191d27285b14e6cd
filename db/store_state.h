/* store_state.h -- is the database as it was written?  And what was found wrong with it, for good. */
#ifndef DB_STORE_STATE_H
#define DB_STORE_STATE_H
#include <stdatomic.h>
#include <stdbool.h>
#include "errinfo.h"

struct log_txn; /* log_txn.h */

typedef void store_report(void *arg, const char *line);

/* store_state_verify(t, report, arg, e): all rows with a MAC against the digest of the last change,
 * and the indexes by which they are found.  ST_EREFUSED: a difference; report() (or NULL) is called
 * once a problem. */
enum status store_state_verify(struct log_txn *t, store_report *report, void *arg,
                               struct errinfo *e);

/* A fault that stands: written once, and then read by any thread.  All zero at first.
 * store_state_set(f, why): unless another stands.  store_state_get(f, e): does one?  e: why. */
struct store_fault {
    atomic_flag begun;
    atomic_bool stands; /* why is written */
    struct errinfo why;
};
void store_state_set(struct store_fault *f, const struct errinfo *why);
bool store_state_get(struct store_fault *f, struct errinfo *e);

#endif
