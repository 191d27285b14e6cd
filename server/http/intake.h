/* intake.h -- may something more be stored now?  A reserve of the disk is left to verifications, which
 * write too, so that a token with enroll alone cannot fill it.  Safe on any thread. */
#ifndef SERVER_INTAKE_H
#define SERVER_INTAKE_H
#include <stdbool.h>
#include <stddef.h>

struct request;

/* intake_full(db, reserve, left): are fewer bytes than the reserve free on that file's disk?  *left:
 * those that are; may be NULL. */
bool intake_full(const char *db, size_t reserve, unsigned long long *left);

/* intake_admit(r): is there room on the disk?  False: r->response says why not. */
bool intake_admit(struct request *r);

#endif
