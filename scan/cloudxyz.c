#include "cloudxyz.h"

#include <string.h>

#include "cloudtext.h"
#include "vec.h"

bool cloudxyz_is(const struct cloudtext *t)
{
    return cloudtext_is_letter(*t->p) || memchr("\"+-.0123456789", *t->p, 14) != NULL;
}

/* After a number: pass over what separates it from the next; 0 at the line's end. */
static char separator(struct cloudtext *t)
{
    const char *before = t->p;

    cloudtext_blank(t);
    if (cloudtext_eol(t))
        return 0;
    if (*t->p == ',' || *t->p == ';')
        return *t->p++;
    return t->p != before ? ' ' : 0;
}

static enum status read_line(struct cloudtext *t, struct cloudtext_points *list)
{
    double value[3];
    char first, second;
    enum status st;

    if ((st = cloudtext_number(t, &value[0])) != ST_OK)
        return st;
    first = separator(t);
    if ((st = cloudtext_number(t, &value[1])) != ST_OK)
        return st;
    second = separator(t);
    if ((st = cloudtext_number(t, &value[2])) != ST_OK)
        return st;
    if (first != second)
        return cloudtext_fail(t, ST_EINVAL, "mixed separators: is it a decimal comma?");
    return cloudtext_point(t, list, (struct dvec3){value[0], value[1], value[2]});
}

static bool is_heading(const struct cloudtext *t)
{
    struct cloudtext at = *t;
    double ignored;

    at.err = NULL;
    return (cloudtext_is_letter(*t->p) || *t->p == '"') &&
           cloudtext_number(&at, &ignored) != ST_ENOTFINITE;
}

enum status cloudxyz_parse(struct cloudtext *t, struct cloudtext_points *list)
{
    bool first = true;

    while (t->p < t->end) {
        enum status st;

        cloudtext_blank(t);
        if (!cloudtext_eol(t) && !cloudtext_comment(t)) {
            if (!(first && is_heading(t)) && (st = read_line(t, list)) != ST_OK)
                return st;
            first = false;
        }
        cloudtext_skip(t);
    }
    return ST_OK;
}
