#include "errinfo.h"

#include <stdarg.h>
#include <stdio.h>

enum status errinfo_set(struct errinfo *e, enum status st, const char *fmt, ...)
{
    if (e != NULL) {
        va_list ap;

        e->code = st;
        va_start(ap, fmt);
        (void)vsnprintf(e->msg, sizeof e->msg, fmt, ap);
        va_end(ap);
    }
    return st;
}

enum status errinfo_memory(struct errinfo *e)
{
    return errinfo_set(e, ST_ENOMEM, "out of memory");
}
