/* errinfo.h -- a status with a message, in the caller's memory: the error path allocates nothing.  A message
 * names the object and the error, and never contains a coordinate or a token. */
#ifndef BASE_ERRINFO_H
#define BASE_ERRINFO_H
#include "status.h"

struct errinfo {
    enum status code;
    char msg[480];
};

/* errinfo_set(e, st, fmt, ...): Fills *e (NULL is allowed) and returns st. */
__attribute__((format(printf, 3, 4))) enum status
errinfo_set(struct errinfo *e, enum status st, const char *fmt, ...);

/* errinfo_memory(e): Fills *e (NULL is allowed) with "out of memory", and returns ST_ENOMEM. */
enum status errinfo_memory(struct errinfo *e);

#endif
