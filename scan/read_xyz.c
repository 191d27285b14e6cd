#include "read.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "cloudformat.h"
#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudunit.h"
#include "status.h"

/* The names above the columns of a text file with points. */

struct heading {
    int column[6];   /* of x, y, z, nx, ny, nz; of a normal -1 where there is none */
    unsigned last;   /* of these columns */
    unsigned fields; /* names in the heading that is still to be settled; 0: none */
    char separator;  /* ' ', ',', ';' or a tab, by the heading; 0: any, by each line */
    bool normals;
    double unit_mm; /* as in "x (cm)"; 0: it is not said */
};

/* Without a heading: the first three columns. */
#define HEADING_NONE                                                                     \
    {                                                                                    \
        .column = {0, 1, 2, -1, -1, -1}, .last = 2                                       \
    }

/* heading_is(t): does the line begin with a word, and not with NaN? */
static bool heading_is(const struct cloudtext *t)
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
static bool read_names(struct heading *h, const char *p, const char *end)
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

/* heading_take(h, t, comment): the line at t as a heading; t does not move.  Names are
 * x, y, z, with a unit behind them or without, and Points:0, Points:1, Points:2; nx, ny, nz or
 * normal_x, normal_y, normal_z; in any case, quoted or not.  A line without them is no
 * heading: the first three columns.
 * Returns ST_OK; ST_EINVAL it separates columns by commas, semicolons or tabs, and has only
 * some of x, y and z, or one of them twice, or none among more than three: better no points
 * than wrong ones. */
static enum status heading_take(struct heading *h, struct cloudtext *t, bool comment)
{
    const char *p = t->p, *const end = line_end(t);
    struct heading found = {.column = {-1, -1, -1, -1, -1, -1}};
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

/* heading_settle(h, t): t is at the first line of data.  A heading that was words
 * between blanks, or a comment, counts only if it has as many as the line has fields. */
static void heading_settle(struct heading *h, const struct cloudtext *t)
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
        *h = (struct heading)HEADING_NONE;
    h->fields = 0;
}

/* heading_role(h, i): what of column[] the column i is, or -1. */
static int heading_role(const struct heading *h, unsigned i)
{
    const int most = h->normals ? 6 : 3;

    for (int role = 0; role < most; role++)
        if (h->column[role] == (int)i)
            return role;
    return -1;
}

/* A file while it is read. */
struct reading {
    struct cloudtext *t;
    struct cloudlist *list;
    struct heading columns;
    bool begun;   /* a line of data or a heading was met */
    bool counted; /* PTS: a line says how many points follow it */
    uint64_t due; /* of them, not read yet */
};

bool read_xyz_is(const struct cloudtext *t)
{
    return cloudtext_is_letter(*t->p) || memchr("\"+-.0123456789", *t->p, 14) != NULL;
}

/* After a field: pass over what separates it from the next; 0 at the line's end. */
static char separator(const struct reading *r)
{
    struct cloudtext *t = r->t;
    const char *before = t->p;

    if (r->columns.separator == '\t') { /* of which each ends a field, empty or not */
        while (t->p < t->end && *t->p == ' ')
            t->p++;
        return t->p < t->end && *t->p == '\t' ? *t->p++ : 0;
    }
    cloudtext_blank(t);
    if (cloudtext_eol(t))
        return 0;
    if (*t->p == ',' || *t->p == ';')
        return *t->p++;
    return t->p != before ? ' ' : 0;
}

/* Pass over a field that is not needed, whatever is in it. */
static void skip_field(struct reading *r)
{
    struct cloudtext *t = r->t;
    const char until = r->columns.separator;
    bool quoted = false;

    if (until != '\t')
        cloudtext_blank(t);
    for (; !cloudtext_eol(t); t->p++) {
        if (*t->p == '"')
            quoted = !quoted;
        if (!quoted && (*t->p == until || (until == ' ' && *t->p == '\t')))
            return;
    }
}

/* The coordinates of a line, by the columns. */
static enum status read_point(struct reading *r)
{
    const struct heading *c = &r->columns;
    double value[6] = {0};
    char first = 0;
    enum status st;

    for (unsigned i = 0; i <= c->last; i++) {
        const int role = heading_role(c, i);

        if (role < 0)
            skip_field(r);
        else if (c->separator == '\t' && (cloudtext_eol(r->t) || *r->t->p == '\t'))
            return cloudtext_fail(r->t, ST_EINVAL, "a number is expected here");
        else if ((st = cloudtext_number(r->t, &value[role])) != ST_OK)
            return st;
        if (i < c->last) {
            const char by = separator(r);

            if (i == 0)
                first = by;
            else if (by != first && by != 0)
                return cloudtext_fail(r->t, ST_EINVAL,
                                      "mixed separators: is it a decimal comma?");
        }
    }
    st = cloudlist_add(r->list, (struct dvec3){value[0], value[1], value[2]});
    if (st == ST_OK && c->normals)
        st = cloudlist_normal(r->list, (struct dvec3){value[3], value[4], value[5]});
    return st;
}

static enum status check_due(struct reading *r)
{
    if (r->due == 0)
        return ST_OK;
    return cloudtext_fail(r->t, ST_EINVAL,
                          "%llu points fewer than the count of the PTS file says",
                          (unsigned long long)r->due);
}

/* Is a count alone on this line?  Then it is passed over. */
static bool take_count(struct reading *r, uint64_t *out)
{
    struct cloudtext at = *r->t;
    size_t len;
    const char *word = cloudtext_word(&at, &len);

    cloudtext_blank(&at);
    if (!cloudtext_eol(&at) || !cloudtext_count(word, len, out))
        return false;
    r->t->p = at.p;
    return true;
}

/* A line that is neither blank nor a comment. */
static enum status read_line(struct reading *r)
{
    const bool first = !r->begun;
    uint64_t count;
    enum status st;

    r->begun = true;
    if ((first || r->counted) && take_count(r, &count)) {
        if (r->counted && r->list->out.read == 0 && r->due > 0)
            return cloudtext_fail(
                r->t, ST_EVERSION,
                "a PTX file is not read: send PTS, or " CLOUDFORMAT_READ);
        st = check_due(r);
        r->counted = true;
        r->due = count;
        return st;
    }
    if (first && heading_is(r->t))
        return heading_take(&r->columns, r->t, false);
    if (r->counted && r->due-- == 0)
        return cloudtext_fail(r->t, ST_EINVAL,
                              "more points than the count of the PTS file says");
    if (r->list->out.read == 0)
        heading_settle(&r->columns, r->t);
    return read_point(r);
}

enum status read_xyz_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;
    struct reading r = {.t = t, .list = list, .columns = HEADING_NONE};

    while (t->p < t->end) {
        enum status st = ST_OK;

        cloudtext_blank(t);
        if (!cloudtext_eol(t)) {
            if (!cloudtext_comment(t))
                st = read_line(&r);
            else if (!r.begun)
                st = heading_take(&r.columns, t, true);
        }
        if (st != ST_OK)
            return st;
        cloudtext_skip(t);
    }
    list->out.unit_mm = r.columns.unit_mm;
    return check_due(&r);
}
