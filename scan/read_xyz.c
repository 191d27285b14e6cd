#include "read.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>

#include "cloudformat.h"
#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudunit.h"
#include "errinfo.h"
#include "number.h"
#include "status.h"

#define NOT_NUMBERS "this is no list of numbers: a point is three numbers on a line"

/* Text with a point on each line: what separates the fields of a line, the names above the columns,
 * and the numbers. */

struct columns {
    int column[6];  /* of x, y, z, nx, ny, nz; of a normal -1 if there is none */
    int last;       /* of these columns */
    int fields;     /* names in a heading that is still to be settled; 0: none */
    char separator; /* ' ', ',', ';' or a tab; 0: by each line */
    bool comment;   /* the heading was a comment */
    bool blank;     /* the heading began with a blank, as between two fields */
    bool normals;
    double unit_mm; /* as in "x (cm)"; 0: it is not said */
};

/* Without a heading: the first three columns. */
#define COLUMNS_FIRST                                                                    \
    {                                                                                    \
        .column = {0, 1, 2, -1, -1, -1}, .last = 2                                       \
    }

/* What is left of a line, and what separates its fields. */
struct fields {
    const char *p, *end;
    char by;
};

struct field {
    const char *p;
    size_t len;
    bool quoted;
};

/* ---- the fields of a line */

/* Returns true if a digit follows each comma in [p, end). */
static bool commas_are_decimal(const char *p, const char *end)
{
    while ((p = memchr(p, ',', (size_t)(end - p))) != NULL)
        if (++p == end || *p < '0' || *p > '9')
            return false;
    return true;
}

/* The first of semicolon, comma and tab that is in [p, end), or a blank.  Commas between tabs may be
 * decimal ones. */
static char separator_of(const char *p, const char *end)
{
    const size_t len = (size_t)(end - p);

    if (memchr(p, ';', len) != NULL)
        return ';';
    if (memchr(p, ',', len) != NULL)
        return memchr(p, '\t', len) != NULL && commas_are_decimal(p, end) ? '\t' : ',';
    return memchr(p, '\t', len) != NULL ? '\t' : ' ';
}

/* The line at t. */
static struct fields fields_of(const struct cloudtext *t, char separator)
{
    struct fields f = {.p = t->p, .end = t->p};

    while (f.end < t->end && *f.end != '\n' && *f.end != '\r')
        f.end++;
    f.by = separator != 0 ? separator : separator_of(f.p, f.end);
    return f;
}

static bool ends_field(const struct fields *f, const char *q)
{
    return *q == f->by || (f->by == ' ' && *q == '\t');
}

/* The next field, without blanks and quotation marks round it; false: there are no more.
 * If blanks separate, no field is empty. */
static bool next_field(struct fields *f, struct field *out)
{
    const char *q = f->p, *last;
    bool quoted = false;

    while (q < f->end && (*q == ' ' || (f->by == ' ' && *q == '\t')))
        q++;
    if (q > f->end || (q == f->end && f->by == ' '))
        return false;
    out->p = q;
    for (; q < f->end && (quoted || !ends_field(f, q)); q++)
        quoted ^= *q == '"';
    last = q;
    f->p = q + 1;
    while (last > out->p && (last[-1] == ' ' || last[-1] == '\t'))
        last--;
    out->quoted = last - out->p >= 2 && *out->p == '"' && last[-1] == '"';
    out->p += out->quoted;
    out->len = (size_t)(last - out->p) - out->quoted;
    return true;
}

/* Reads a field as a number: NaN if it is empty or says that there is no value.  A comma in it is a
 * decimal one.  Returns false if it is something else. */
static bool take_value(const struct field *f, double *out)
{
    static const char *const none[] = {"", "na", "n/a", "#n/a", "<na>", "null", "none"};
    const char *const end = f->p + f->len, *comma;
    struct cloudtext at = {.p = f->p, .end = end};
    char text[64];

    if (cloudtext_number(&at, out) == ST_OK && at.p == end)
        return true;
    if ((comma = memchr(f->p, ',', f->len)) != NULL && f->len <= sizeof text) {
        memcpy(text, f->p, f->len);
        text[comma - f->p] = '.';
        at = (struct cloudtext){.p = text, .end = text + f->len};
        return cloudtext_number(&at, out) == ST_OK && at.p == at.end;
    }
    *out = (double)NAN;
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        if (cloudtext_like(f->p, f->len, none[i]))
            return true;
    return false;
}

/* ---- a heading */

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
static int role_named(const struct field *f, double *mm)
{
    static const char *const names[][2] = {
        {"points:0", "points_0"}, {"points:1", "points_1"}, {"points:2", "points_2"},
        {"nx", "normal_x"},       {"ny", "normal_y"},       {"nz", "normal_z"}};

    for (int i = 0; i < 6; i++)
        if ((i < 3 && f->len > 0 && (f->p[0] | 32) == 'x' + i &&
             unit_behind(f->p + 1, f->len - 1, mm)) ||
            cloudtext_like(f->p, f->len, names[i][0]) ||
            cloudtext_like(f->p, f->len, names[i][1]))
            return i;
    return -1;
}

/* Names that a program makes up are a stem and a number that counts: "0,1,2", "V1 V2 V3",
 * "Column1;Column2;Column3"; an index before them has no name.  *first is the column of the first one;
 * numbers alone begin with 0 and are not between blanks, for they may be a point. */
static bool names_count(struct fields f, int *first)
{
    struct field stem = {NULL, 0, false}, name;
    uint64_t from = 0, number;
    int n = 0;

    *first = 0;
    while (next_field(&f, &name)) {
        size_t len = name.len;

        if (len == 0 && n == 0 && *first == 0) {
            *first = 1;
            continue;
        }
        while (len > 0 && name.p[len - 1] >= '0' && name.p[len - 1] <= '9')
            len--;
        if (!cloudtext_count(name.p + len, name.len - len, &number))
            return false;
        if (n++ == 0) {
            stem = (struct field){name.p, len, false};
            from = number;
        } else if (len != stem.len || memcmp(name.p, stem.p, len) != 0 ||
                   number != from + (uint64_t)n - 1) {
            return false;
        }
    }
    return n >= 3 &&
           (stem.len > 0 ? cloudtext_is_letter(*stem.p) : from == 0 && f.by != ' ');
}

/* Reads the names; returns false if one is there twice, or x, y, z are not all there. */
static bool read_names(struct columns *c, struct fields f)
{
    struct field name;
    bool twice = false;
    int first;

    if (names_count(f, &first))
        *c = (struct columns){.column = {first, first + 1, first + 2, -1, -1, -1},
                              .last = first + 2,
                              .separator = f.by};
    for (; next_field(&f, &name); c->fields++) {
        const int role = role_named(&name, &c->unit_mm);

        if (role < 0)
            continue;
        twice = twice || (c->column[role] >= 0 && c->column[role] != c->fields);
        c->column[role] = c->fields;
        c->last = c->fields;
    }
    c->normals = c->column[3] >= 0 && c->column[4] >= 0 && c->column[5] >= 0;
    return !twice && c->column[0] >= 0 && c->column[1] >= 0 && c->column[2] >= 0;
}

/* Returns true if the line is names: its first field that is not empty is no value. */
static bool is_heading(struct fields f)
{
    const struct fields line = f;
    struct field first;
    double value;
    int column;

    while (next_field(&f, &first) && first.len == 0)
        ;
    return first.len > 0 &&
           ((cloudtext_is_letter(*first.p) && !take_value(&first, &value)) ||
            names_count(line, &column));
}

/* Returns true if three fields of the line are numbers. */
static bool is_point(struct fields f)
{
    struct field field;
    double value;
    int n = 0;

    while (next_field(&f, &field))
        n += take_value(&field, &value) && isfinite(value);
    return n >= 3;
}

/* The line at t as a heading; t does not move.  Names are x, y, z, with a unit behind them or without,
 * and Points:0, Points:1, Points:2; nx, ny, nz or normal_x, normal_y, normal_z; in any case, quoted or
 * not; or names that count.  A line without them is no heading: the first three columns.
 * Returns ST_OK; ST_EINVAL if it separates columns by commas, semicolons or tabs, and has only
 * some of x, y and z, or one of them twice, or none among more than three: better no points
 * than wrong ones. */
static enum status heading_take(struct columns *c, struct cloudtext *t, bool comment)
{
    struct fields f = fields_of(t, c->separator);
    struct columns found = {.column = {-1, -1, -1, -1, -1, -1}, .comment = comment};
    struct cloudtext next = *t;
    bool named, any;

    while (comment && f.p < f.end && memchr("#/% \t", *f.p, 5) != NULL)
        f.p++;
    found.separator = f.by;
    found.blank = f.by == ' ' && f.p < f.end && *f.p == ' ';
    named = read_names(&found, f);
    any = found.column[0] >= 0 || found.column[1] >= 0 || found.column[2] >= 0;
    if (named) {
        *c = found;
    } else if (!comment && f.by != ' ' && (found.fields > 3 || any)) {
        cloudtext_skip(&next);
        return cloudtext_fail(
            t, ST_EINVAL,
            is_point(fields_of(&next, 0))
                ? "the heading does not name one column x, one y and one z"
                : NOT_NUMBERS);
    }
    return ST_OK;
}

/* Returns true if the rows have a name that the heading does not have: as pandas writes it, with a blank in
 * its place; as R does, in quotation marks, or counting from 1. */
static bool has_row_names(const struct columns *c, const struct cloudtext *t, char by)
{
    struct fields line = fields_of(t, by), second;
    struct cloudtext next = *t;
    struct field name;

    cloudtext_skip(&next);
    second = fields_of(&next, by);
    return next_field(&line, &name) &&
           (c->blank || name.quoted ||
            (cloudtext_is(name.p, name.len, "1") && next_field(&second, &name) &&
             cloudtext_is(name.p, name.len, "2")));
}

/* t is at the first line of data.  Names between blanks or in a comment may be a sentence: they count
 * if there is one for each field. */
static void heading_settle(struct columns *c, const struct cloudtext *t)
{
    const bool sure = !c->comment && c->separator != ' ';
    const char by = sure ? c->separator : fields_of(t, 0).by;
    struct fields line = fields_of(t, by);
    struct field field = {NULL, 0, false};
    int n = 0;

    if (c->fields == 0)
        return;
    while (next_field(&line, &field))
        n++;
    n -= field.len == 0; /* a separator ends the line */
    if (n == c->fields + 1 && !c->comment && has_row_names(c, t, by)) {
        for (int i = 0; i < 6; i++)
            c->column[i] += c->column[i] >= 0;
        c->last++;
    } else if (n != c->fields && !sure) {
        *c = (struct columns)COLUMNS_FIRST;
        return;
    }
    c->separator = by;
    c->fields = 0;
}

/* What of column[] the column i is, or -1. */
static int role_of(const struct columns *c, int i)
{
    const int most = c->normals ? 6 : 3;

    for (int role = 0; role < most; role++)
        if (c->column[role] == i)
            return role;
    return -1;
}

/* ---- the lines */

/* A file while it is read. */
struct read_xyz_reading {
    struct cloudtext *t;
    struct cloudlist *list;
    struct columns columns;
    bool begun;   /* a line of data or a heading was met */
    bool counted; /* PTS: a line says how many points follow it */
    uint64_t due; /* of them, not read yet */
};

bool read_xyz_is(const struct cloudtext *t)
{
    return cloudtext_is_letter(*t->p) || memchr("\",;+-.0123456789", *t->p, 16) != NULL;
}

static enum status not_a_number(struct read_xyz_reading *r, const struct field *f)
{
    double ignored;
    const char *end = f->p + f->len, *after = number_read(f->p, end, &ignored);

    if (after != NULL && after < end && memchr(" \t,;", *after, 4) != NULL)
        return cloudtext_fail(r->t, ST_EINVAL,
                              "mixed separators: is it a decimal comma?");
    return cloudtext_fail(r->t, ST_EINVAL,
                          r->list->out.read == 0 ? NOT_NUMBERS
                                                 : "a number is expected here");
}

/* The coordinates of a line, by the columns. */
static enum status read_point(struct read_xyz_reading *r)
{
    const struct columns *c = &r->columns;
    struct fields line = fields_of(r->t, c->separator);
    double value[6] = {0};

    if (c->separator == 0 && line.by == '\t' &&
        memchr(line.p, ',', (size_t)(line.end - line.p)) == NULL)
        line.by = ' '; /* no heading says that each tab ends a field */
    for (int i = 0; i <= c->last; i++) {
        const int role = role_of(c, i);
        struct field field;

        if (!next_field(&line, &field))
            return cloudtext_fail(r->t, ST_EINVAL, "the line has too few numbers");
        if (role >= 0 && !take_value(&field, &value[role]))
            return not_a_number(r, &field);
    }
    r->t->p = line.end;
    return cloudlist_point(r->list, value, c->normals);
}

static enum status check_due(struct read_xyz_reading *r)
{
    if (r->due == 0)
        return ST_OK;
    return cloudtext_fail(r->t, ST_EINVAL,
                          "%llu points fewer than the count of the PTS file says",
                          (unsigned long long)r->due);
}

/* Is a count alone on this line?  Then it is passed over. */
static bool take_count(struct read_xyz_reading *r, uint64_t *out)
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

/* Excel's "sep=;", which may be quoted. */
static bool take_separator(struct read_xyz_reading *r)
{
    const struct fields f = fields_of(r->t, ' ');
    const char *p = f.p + (f.p < f.end && *f.p == '"');

    if (f.end - p < 5 || strncasecmp(p, "sep=", 4) != 0)
        return false;
    r->columns.separator = p[4];
    return true;
}

/* A line that is neither blank nor a comment. */
static enum status read_xyz_read_line(struct read_xyz_reading *r)
{
    const bool first = !r->begun;
    uint64_t count;
    enum status st;

    if (first && r->columns.separator == 0 && take_separator(r))
        return ST_OK;
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
    if (first && is_heading(fields_of(r->t, r->columns.separator)))
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
    struct read_xyz_reading r = {.t = t, .list = list, .columns = COLUMNS_FIRST};

    while (t->p < t->end) {
        const char *const line = t->p;
        enum status st = ST_OK;

        cloudtext_blank(t);
        if (!cloudtext_eol(t)) {
            if (!cloudtext_comment(t) || strncmp(t->p, "#N/A", 4) == 0) { /* Excel's */
                t->p = line; /* a tab may end an empty field */
                st = read_xyz_read_line(&r);
            } else if (!r.begun) {
                st = heading_take(&r.columns, t, true);
            }
        }
        if (st != ST_OK)
            return st;
        cloudtext_skip(t);
    }
    if (r.begun && list->out.read == 0 && !r.counted && r.columns.separator == 0)
        return errinfo_set(t->e, ST_EINVAL, NOT_NUMBERS);
    list->out.unit_mm = r.columns.unit_mm;
    return check_due(&r);
}
