/* intake.h -- may something more be stored now?  Two limits, so that a token with enroll alone cannot
 * fill the disk: how many subjects and templates a token may add within an hour, which the store
 * counts, and a reserve of the disk that is left to verifications, which write too.
 * Safe on any thread. */
#ifndef SERVER_INTAKE_H
#define SERVER_INTAKE_H
#include <stdbool.h>
#include <stddef.h>

struct errinfo;
struct request;
struct store_allowance;

/* intake_full(db, reserve, left): are fewer bytes than the reserve free on that file's disk?  *left:
 * those that are; may be NULL. */
bool intake_full(const char *db, size_t reserve, unsigned long long *left);

/* intake_admit(r, a): is there room on the disk?  *a: of r's token, for the store.  False: r->response
 * says why not.
 * intake_refuse(r, a, e): the store has found no room in *a. */
bool intake_admit(struct request *r, struct store_allowance *a);
void intake_refuse(struct request *r, const struct store_allowance *a,
                   const struct errinfo *e);

#endif
