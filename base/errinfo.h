/* errinfo.h -- a status with its text, in the caller's memory: no allocation on the error
 * path.  The message says what was wrong and where; never a coordinate or a token. */
#ifndef DB_ERRINFO_H
#define DB_ERRINFO_H
#include "status.h"

struct errinfo {
    enum status code;
    char msg[240];
};

/* errinfo_set(e, st, fmt, ...): fill *e (NULL is allowed) and return st. */
__attribute__((format(printf, 3, 4))) enum status
errinfo_set(struct errinfo *e, enum status st, const char *fmt, ...);

#endif
