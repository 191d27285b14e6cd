#include "ident.h"

#include <string.h>

#include "errinfo.h"

bool ident_consists(const char *text, const char *set, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    return n >= min && n <= max && strspn(text, set) == n;
}

bool ident_printable(const char *text, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    for (size_t i = 0; i < n; i++)
        if (text[i] < ' ' || text[i] > '~')
            return false;
    return n >= min && n <= max;
}

/* A client that joins paths would turn "." and ".." into another request. */
bool ident_subject_valid(const char *subject)
{
    return ident_consists(
               subject,
               "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-@:", 1,
               IDENT_SUBJECT) &&
           strcmp(subject, ".") != 0 && strcmp(subject, "..") != 0;
}

bool ident_id_valid(const char *id)
{
    return ident_consists(id, "0123456789abcdef", IDENT_ID, IDENT_ID);
}

enum status ident_subject(const char *subject, struct errinfo *e)
{
    if (ident_subject_valid(subject))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL,
                       "a subject id is 1 to %d characters of A-Z a-z 0-9 . _ - @ :, and "
                       "not . or ..",
                       IDENT_SUBJECT);
}

enum status ident_id(const char *id, const char *what, struct errinfo *e)
{
    if (ident_id_valid(id))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL, "a %s id is %d characters of 0-9 a-f", what,
                       IDENT_ID);
}
