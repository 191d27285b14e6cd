/* intake.h -- the reserve of disk space for verifications, which write too: a token with the scope enroll
 * alone cannot fill the disk.  Any thread. */
#ifndef SERVER_INTAKE_H
#define SERVER_INTAKE_H
#include <stdbool.h>
#include <stddef.h>

struct request;

/* intake_full(db, reserve, left): Returns true if less than reserve is free on the disk of the file db.
 *   reserve  bytes
 *   left     set to the free bytes; may be NULL */
bool intake_full(const char *db, size_t reserve, unsigned long long *left);

/* intake_admit(r): Returns true if there is room on the disk.  If false, sets r->response. */
bool intake_admit(struct request *r);

#endif
