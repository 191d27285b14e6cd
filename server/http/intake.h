/* intake.h -- may a token have something more stored now?  Two limits, so that a token with enroll
 * alone cannot fill the disk: how many subjects and templates a token may add within an hour, and a
 * reserve of the disk that is left to verifications, which write too.
 * The counts are in memory alone, of this process.  With more tokens at once than there is room for
 * those that have added least are forgotten.  Safe on any thread. */
#ifndef SERVER_INTAKE_H
#define SERVER_INTAKE_H
#include <stdbool.h>
#include <stddef.h>

struct intake;
struct request;

/* intake_new(per_hour, db, reserve): per_hour: 0: no limit.  db: the database's file, borrowed;
 * reserve: bytes that must be free on its file system.  NULL: out of memory. */
struct intake *intake_new(unsigned per_hour, const char *db, size_t reserve);
void intake_free(struct intake *x); /* NULL is allowed */

/* intake_take(x, token, n, now_ms): n > 0 more for the token; 0: they are taken; else
 * none is, and it is the seconds until there is room for one.  Where there is room for
 * one, n are taken.
 * intake_give(x, token, n): n of those that were taken were not stored. now_ms:
 * logger_clock_ms(). */
unsigned intake_take(struct intake *x, const char *token, unsigned n, double now_ms);
void intake_give(struct intake *x, const char *token, unsigned n);

/* intake_full(x, left): is less than the reserve free?  *left: bytes that are; may be NULL. */
bool intake_full(const struct intake *x, unsigned long long *left);

/* intake_admit(r, n): room on the disk, and n taken for r's token.  False: r->response says why
 * not. */
bool intake_admit(struct request *r, unsigned n);

#endif
