#include "ctl.h"

#include <stdarg.h>
#include <stdio.h>

int ctl_usage(struct ctl *c, const char *fmt, ...)
{
    va_list args;

    c->e.code = ST_EINVAL;
    va_start(args, fmt);
    (void)vsnprintf(c->e.msg, sizeof c->e.msg, fmt, args);
    va_end(args);
    return EXIT_USAGE;
}

int ctl_fail(struct ctl *c, enum status st)
{
    static const int code[ST_COUNT] = {[ST_OK] = EXIT_FINE,
                                       [ST_EINVAL] = EXIT_DATA,
                                       [ST_ENOMEM] = EXIT_OSERR,
                                       [ST_ELIMIT] = EXIT_DATA,
                                       [ST_ETOOFEW] = EXIT_DATA,
                                       [ST_ENOTFINITE] = EXIT_DATA,
                                       [ST_ERANGE] = EXIT_DATA,
                                       [ST_EDEGENERATE] = EXIT_DATA,
                                       [ST_EUNITS] = EXIT_DATA,
                                       [ST_ENOTFACE] = EXIT_DATA,
                                       [ST_EQUALITY] = EXIT_DATA,
                                       [ST_ECORRUPT] = EXIT_DATA,
                                       [ST_EVERSION] = EXIT_DATA,
                                       [ST_ENOTFOUND] = EXIT_NOINPUT,
                                       [ST_EEXISTS] = EXIT_DATA,
                                       [ST_EMISMATCH] = EXIT_DATA,
                                       [ST_EDENIED] = EXIT_NOPERM,
                                       [ST_EBUSY] = EXIT_TEMPFAIL,
                                       [ST_EIO] = EXIT_IOERR,
                                       [ST_EDB] = EXIT_SOFTWARE,
                                       [ST_EINTERNAL] = EXIT_SOFTWARE,
                                       [ST_EHELD] = EXIT_NOPERM};

    c->e.code = st;
    return code[st];
}
