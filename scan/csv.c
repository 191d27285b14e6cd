#include "csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "number.h"
#include "readfile.h"

struct csv {
    char *path, *text, *at, *end;
    unsigned line, row_line; /* of at; where the present row began */
    bool list;               /* it has no heading */
    bool blanks;             /* they separate its fields, not commas */
    int nhead, nfield;
    char *head[CSV_MAX_COLUMNS], *field[CSV_MAX_COLUMNS];
};

static enum status bad_row(const struct csv *t, struct errinfo *e, const char *what)
{
    return errinfo_set(e, ST_EINVAL, "%.120s, line %u, field %d: %s", t->path, t->line,
                       t->nfield + 1, what);
}

/* The line's end at *p (LF or CR LF), as a number of bytes; 0: none. */
static int line_end(const char *p)
{
    return p[0] == '\n' ? 1 : p[0] == '\r' && p[1] == '\n' ? 2 : 0;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

/* Does a field end before *p? */
static bool separates(const struct csv *t, const char *p)
{
    return line_end(p) != 0 || (t->blanks ? is_blank(*p) : *p == ',');
}

static void skip_blanks(struct csv *t)
{
    while (is_blank(*t->at))
        t->at++;
}

/* What stands between quotation marks, moved together; t->at goes behind the last. */
static enum status read_quoted(struct csv *t, char **begin, char **stop,
                               struct errinfo *e)
{
    char *to = ++t->at;

    *begin = to;
    for (; t->at < t->end; t->at++) {
        if (t->at[0] == '"' && t->at[1] == '"') {
            t->at++;
        } else if (t->at[0] == '"') {
            break;
        } else if (t->at[0] == '\0') {
            return bad_row(t, e, "a NUL byte");
        } else if (t->at[0] == '\n') {
            t->line++;
        }
        *to++ = *t->at;
    }
    if (t->at == t->end)
        return bad_row(t, e, "a quotation is not closed");
    *stop = to;
    t->at++;
    if (!t->blanks)
        skip_blanks(t);
    if (t->at < t->end && !separates(t, t->at))
        return bad_row(t, e, "text after a closing quotation mark");
    return ST_OK;
}

static enum status read_plain(struct csv *t, char **begin, char **stop, struct errinfo *e)
{
    *begin = t->at;
    while (t->at < t->end && !separates(t, t->at)) {
        if (*t->at == '\0')
            return bad_row(t, e, "a NUL byte");
        t->at++;
    }
    *stop = t->at;
    while (*stop > *begin && is_blank((*stop)[-1]))
        --*stop;
    return ST_OK;
}

/* Go to the next line that is a row. */
static void skip_lines(struct csv *t)
{
    int n;

    for (;;) {
        if (t->list)
            skip_blanks(t);
        if (t->list && *t->at == '#')
            t->at += strcspn(t->at, "\n");
        if ((n = line_end(t->at)) == 0)
            return;
        t->at += n;
        t->line++;
    }
}

/* Read a row, in place.  Empty lines are passed over; *more is false at the end. */
static enum status csv_read_row(struct csv *t, bool *more, struct errinfo *e)
{
    const char *row;
    bool last = false;

    skip_lines(t);
    *more = t->at < t->end;
    row = t->at;
    t->row_line = t->line;
    t->nfield = 0;
    while (*more && !last) {
        char *begin = t->at, *stop = t->at;
        enum status st;
        int ends;

        if (t->nfield == CSV_MAX_COLUMNS)
            return errinfo_set(e, ST_ELIMIT, "%.120s, line %u: more than %d fields",
                               t->path, t->line, CSV_MAX_COLUMNS);
        skip_blanks(t);
        st = *t->at == '"' ? read_quoted(t, &begin, &stop, e)
                           : read_plain(t, &begin, &stop, e);
        if (st != ST_OK)
            return st;
        if (t->at - row > CSV_MAX_LINE)
            return errinfo_set(e, ST_ELIMIT, "%.120s, line %u: longer than %d bytes",
                               t->path, t->row_line, CSV_MAX_LINE);
        if (t->blanks) { /* at the line's end they separate nothing */
            char *behind = t->at;

            skip_blanks(t);
            if (t->at != t->end && line_end(t->at) == 0)
                t->at = behind;
        }
        ends = line_end(t->at);
        last = t->at == t->end || ends != 0;
        t->at += last ? ends : 1; /* or what separates */
        t->line += ends != 0;
        *stop = '\0'; /* only now: it may lie on what was looked at */
        t->field[t->nfield++] = begin;
    }
    return ST_OK;
}

/* From the file's first byte; of a list, which of the two separates. */
static void csv_begin(struct csv *t, size_t len)
{
    t->at = t->text;
    t->end = t->text + len;
    t->line = 1;
    if (len >= 3 && memcmp(t->text, "\xEF\xBB\xBF", 3) == 0)
        t->at += 3;
    if (t->list) {
        skip_lines(t);
        t->blanks = t->at[strcspn(t->at, ",\n")] != ',';
    }
}

static enum status read_head(struct csv *t, struct errinfo *e)
{
    bool more;
    enum status st;

    if ((st = csv_read_row(t, &more, e)) == ST_OK && !more)
        st = errinfo_set(e, ST_EINVAL, "%.160s: empty, not even a heading", t->path);
    if (st != ST_OK)
        return st;
    memcpy(t->head, t->field, sizeof t->head);
    t->nhead = t->nfield;
    for (int i = 0; i < t->nhead; i++)
        if (t->head[i][0] != '\0' && csv_column(t, t->head[i]) != i)
            return errinfo_set(e, ST_EINVAL,
                               "%.120s, line %u: two columns are named %.40s", t->path,
                               t->row_line, t->head[i]);
    return ST_OK;
}

enum status csv_open(const char *path, bool list, struct csv **out, struct errinfo *e)
{
    struct csv *t = calloc(1, sizeof *t);
    unsigned char *bytes = NULL;
    size_t len;
    enum status st;

    *out = NULL;
    if (t == NULL || (t->path = strdup(path)) == NULL) {
        st = errinfo_set(e, ST_ENOMEM, "%.160s: out of memory", path);
    } else {
        t->list = list;
        st = readfile_all(path, CSV_MAX_FILE, &bytes, &len, e);
        t->text = (char *)bytes;
    }
    if (st == ST_OK) {
        csv_begin(t, len);
        if (!list)
            st = read_head(t, e);
    }
    if (st == ST_OK)
        *out = t;
    else
        csv_close(t);
    return st;
}

void csv_close(struct csv *t)
{
    if (t == NULL)
        return;
    free(t->path);
    free(t->text);
    free(t);
}

int csv_column(const struct csv *t, const char *name)
{
    for (int i = 0; i < t->nhead; i++)
        if (strcasecmp(t->head[i], name) == 0)
            return i;
    return -1;
}

enum status csv_need(const struct csv *t, const char *name, int *column,
                     struct errinfo *e)
{
    if ((*column = csv_column(t, name)) >= 0)
        return ST_OK;
    return errinfo_set(e, ST_EINVAL, "%.120s, line 1: no column is named %s", t->path,
                       name);
}

enum status csv_next(struct csv *t, bool *more, struct errinfo *e)
{
    const enum status st = csv_read_row(t, more, e);

    if (st == ST_OK && *more && !t->list && t->nfield != t->nhead)
        return errinfo_set(e, ST_EINVAL, "%.120s, line %u: %d fields, the heading has %d",
                           t->path, t->row_line, t->nfield, t->nhead);
    return st;
}

const char *csv_field(const struct csv *t, int column)
{
    return column < 0 || column >= t->nfield ? "" : t->field[column];
}

int csv_fields(const struct csv *t)
{
    return t->nfield;
}

unsigned csv_line(const struct csv *t)
{
    return t->row_line;
}

enum status csv_bad(const struct csv *t, int column, struct errinfo *e, const char *what)
{
    if (t->list && column < 0)
        return errinfo_set(e, ST_EINVAL, "%.120s, line %u: %.200s", t->path, t->row_line,
                           what);
    if (t->list)
        return errinfo_set(e, ST_EINVAL, "%.120s, line %u, field %d: %.200s", t->path,
                           t->row_line, column + 1, what);
    return errinfo_set(e, ST_EINVAL, "%.100s, line %u, column %.30s: %.80s", t->path,
                       t->row_line, column < 0 ? "?" : t->head[column], what);
}

enum status csv_number(const struct csv *t, int column, double *out, struct errinfo *e)
{
    const char *text = csv_field(t, column), *end = text + strlen(text);

    *out = NAN;
    if (text == end || number_read(text, end, out) != end || !isfinite(*out))
        return csv_bad(t, column, e, "not a number");
    return ST_OK;
}
