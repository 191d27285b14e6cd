#include "cloudheading.h"

#include <math.h>
#include <string.h>

#include "cloudtext.h"
#include "cloudunit.h"

bool cloudheading_is(const struct cloudtext *t)
{
    struct cloudtext at = *t;
    double value;

    at.e = NULL;
    return (cloudtext_is_letter(*t->p) || *t->p == '"') &&
           cloudtext_number(&at, &value) != ST_OK;
}

static bool is_filler(char c)
{
    return c == ' ' || c == '_' || c == '(' || c == ')' || c == '[' || c == ']' ||
           c == '/';
}

/* "x", "x_mm", "x (mm)", "X[m]": what follows the letter is a unit, or nothing. */
static bool unit_behind(const char *p, size_t len, double *mm)
{
    while (len > 0 && is_filler(*p)) {
        p++;
        len--;
    }
    while (len > 0 && is_filler(p[len - 1]))
        len--;
    return len == 0 || cloudunit_mm(p, len, mm);
}

/* What of column[] has this name, or -1. */
static int role_named(const char *name, size_t len, double *mm)
{
    static const char *const points[] = {"points:0", "points:1", "points:2"};
    static const char *const normals[][2] = {
        {"nx", "normal_x"}, {"ny", "normal_y"}, {"nz", "normal_z"}};

    for (int i = 0; i < 3; i++) {
        if (len > 0 && (name[0] | 32) == 'x' + i && unit_behind(name + 1, len - 1, mm))
            return i;
        if (cloudtext_like(name, len, points[i]))
            return i;
        if (cloudtext_like(name, len, normals[i][0]) ||
            cloudtext_like(name, len, normals[i][1]))
            return 3 + i;
    }
    return -1;
}

static char separator_of(const char *p, const char *end)
{
    static const char marks[] = ",;\t";

    for (const char *m = marks; *m != '\0'; m++)
        if (memchr(p, *m, (size_t)(end - p)) != NULL)
            return *m;
    return ' ';
}

/* The next field of [*p, end), without blanks and quotation marks round it; false: there are
 * no more.  Where blanks separate, no field is empty. */
static bool next_field(const char **p, const char *end, char by, const char **field,
                       size_t *len)
{
    const char *q = *p, *last;

    while (q < end && (*q == ' ' || (by == ' ' && *q == '\t')))
        q++;
    if (q > end || (q == end && by == ' '))
        return false;
    *field = q;
    while (q < end && *q != by && !(by == ' ' && *q == '\t'))
        q++;
    last = q;
    *p = q + 1;
    while (last > *field && last[-1] == ' ')
        last--;
    if (last - *field >= 2 && **field == '"' && last[-1] == '"') {
        ++*field;
        last--;
    }
    *len = (size_t)(last - *field);
    return true;
}

static const char *line_end(const struct cloudtext *t)
{
    struct cloudtext at = *t;

    while (!cloudtext_eol(&at))
        at.p++;
    return at.p;
}

/* Reads the names; false: one is there twice, or x, y, z are not all there. */
static bool read_names(struct cloudheading *h, const char *p, const char *end)
{
    const char *field;
    bool twice = false;
    size_t len;

    for (; next_field(&p, end, h->separator, &field, &len); h->fields++) {
        const int role = role_named(field, len, &h->unit_mm);

        if (role < 0)
            continue;
        twice = twice || h->column[role] >= 0;
        h->column[role] = (int)h->fields;
        h->last = h->fields;
    }
    h->normals = h->column[3] >= 0 && h->column[4] >= 0 && h->column[5] >= 0;
    return !twice && h->column[0] >= 0 && h->column[1] >= 0 && h->column[2] >= 0;
}

enum status cloudheading_take(struct cloudheading *h, struct cloudtext *t, bool comment)
{
    const char *p = t->p, *const end = line_end(t);
    struct cloudheading found = {.column = {-1, -1, -1, -1, -1, -1}};
    bool named, any;

    while (comment && p < end && (*p == '#' || *p == '/' || *p == ' ' || *p == '\t'))
        p++;
    found.separator = separator_of(p, end);
    named = read_names(&found, p, end);
    any = found.column[0] >= 0 || found.column[1] >= 0 || found.column[2] >= 0;
    if (named) {
        *h = found;
        if (!comment && found.separator != ' ')
            h->fields = 0; /* settled */
    } else if (!comment && found.separator != ' ' && (found.fields > 3 || any)) {
        return cloudtext_fail(t, ST_EINVAL,
                              "the heading does not name one column x, one y and one z");
    }
    return ST_OK;
}

void cloudheading_settle(struct cloudheading *h, const struct cloudtext *t)
{
    const char *p = t->p, *const end = line_end(t), *field;
    const char by = separator_of(p, end);
    unsigned n = 0;
    size_t len;

    if (h->fields == 0)
        return;
    while (next_field(&p, end, by, &field, &len))
        n++;
    if (n == h->fields)
        h->separator = by;
    else
        *h = (struct cloudheading)CLOUDHEADING_NONE;
    h->fields = 0;
}

int cloudheading_role(const struct cloudheading *h, unsigned i)
{
    const int most = h->normals ? 6 : 3;

    for (int role = 0; role < most; role++)
        if (h->column[role] == (int)i)
            return role;
    return -1;
}
