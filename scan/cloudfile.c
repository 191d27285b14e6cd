#include "cloudfile.h"

#include <string.h>

#include "cloudply.h"
#include "cloudtext.h"
#include "mem.h"

/* The points of a text file, with room for as many as its lines and bytes could hold. */
struct points {
    struct dvec3 *at;
    size_t n, room, max;
};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static enum status points_add(struct points *list, struct cloudtext *t, struct dvec3 p)
{
    if (list->n == list->max)
        return cloudtext_fail(t, ST_ELIMIT, "more points than the limit of %zu",
                              list->max);
    list->at[list->n++] = p; /* a line each, of 6 bytes or more: there is room */
    return ST_OK;
}

/* ---- OBJ */

static enum status obj_vertex(struct cloudtext *t, struct points *list)
{
    double value[8];
    unsigned n = 0;
    enum status st;

    for (cloudtext_blank(t); n < 3 || !cloudtext_eol(t); cloudtext_blank(t)) {
        if (n == 8)
            return cloudtext_fail(t, ST_EINVAL, "more than 8 numbers for a vertex");
        if ((st = cloudtext_number(t, &value[n++])) != ST_OK)
            return st;
        if (!cloudtext_eol(t) && (*t->p == ',' || *t->p == ';'))
            return cloudtext_fail(t, ST_EINVAL,
                                  "numbers of an OBJ file are set apart by blanks");
    }
    return points_add(list, t, (struct dvec3){value[0], value[1], value[2]});
}

static enum status obj_parse(struct cloudtext *t, struct points *list)
{
    t->continued = true;
    while (t->p < t->end) {
        const char *word;
        size_t len;
        enum status st;

        word = cloudtext_word(t, &len);
        if (len != 0 && word[0] == '#') {
            t->continued = false; /* a comment ends with its line whatever is in it */
            cloudtext_skip(t);
            t->continued = true;
            continue;
        }
        if (cloudtext_is(word, len, "v")) {
            if ((st = obj_vertex(t, list)) != ST_OK)
                return st;
        } else if (len != 0 && !is_letter(word[0])) {
            t->p = word;
            return cloudtext_fail(t, ST_EINVAL, "not a line of an OBJ file");
        }
        cloudtext_skip(t);
    }
    return ST_OK;
}

/* ---- XYZ */

/* After a number: pass over what separates it from the next; 0 at the line's end. */
static char xyz_separator(struct cloudtext *t)
{
    const char *before = t->p;

    cloudtext_blank(t);
    if (cloudtext_eol(t))
        return 0;
    if (*t->p == ',' || *t->p == ';')
        return *t->p++;
    return t->p != before ? ' ' : 0;
}

static enum status xyz_line(struct cloudtext *t, struct points *list)
{
    double value[3];
    char first, second;
    enum status st;

    if ((st = cloudtext_number(t, &value[0])) != ST_OK)
        return st;
    first = xyz_separator(t);
    if ((st = cloudtext_number(t, &value[1])) != ST_OK)
        return st;
    second = xyz_separator(t);
    if ((st = cloudtext_number(t, &value[2])) != ST_OK)
        return st;
    if (first != second)
        return cloudtext_fail(t, ST_EINVAL, "mixed separators: is it a decimal comma?");
    return points_add(list, t, (struct dvec3){value[0], value[1], value[2]});
}

static bool xyz_comment(const struct cloudtext *t)
{
    return *t->p == '#' || (t->end - t->p > 1 && t->p[0] == '/' && t->p[1] == '/');
}

static bool xyz_heading(const struct cloudtext *t)
{
    struct cloudtext at = *t;
    double ignored;

    at.err = NULL;
    return (is_letter(*t->p) || *t->p == '"') &&
           cloudtext_number(&at, &ignored) != ST_ENOTFINITE;
}

static enum status xyz_parse(struct cloudtext *t, struct points *list)
{
    bool first = true;

    while (t->p < t->end) {
        enum status st;

        cloudtext_blank(t);
        if (!cloudtext_eol(t) && !xyz_comment(t)) {
            if (!(first && xyz_heading(t)) && (st = xyz_line(t, list)) != ST_OK)
                return st;
            first = false;
        }
        cloudtext_skip(t);
    }
    return ST_OK;
}

/* ---- which of them */

static void skip_bom(struct cloudtext *t)
{
    if (t->end - t->p >= 3 && memcmp(t->p, "\xEF\xBB\xBF", 3) == 0)
        t->p += 3;
}

/* By the first line that is not a comment. */
static enum status recognise(const struct cloudtext *text, enum cloudfile_format *format)
{
    static const char *const obj[] = {"v", "vn", "vt", "vp",     "o",
                                      "g", "s",  "f",  "mtllib", "usemtl"};
    struct cloudtext t = *text;
    const char *word;
    size_t len;

    if (t.end - t.p > 3 && memcmp(t.p, "ply", 3) == 0 &&
        (t.p[3] == '\n' || t.p[3] == '\r' || t.p[3] == ' ')) {
        *format = CLOUDFILE_PLY;
        return ST_OK;
    }
    skip_bom(&t);
    for (;;) {
        cloudtext_blank(&t);
        if (t.p == t.end)
            return cloudtext_fail(&t, ST_EINVAL, "there are no points in it");
        if (!cloudtext_eol(&t) && !xyz_comment(&t))
            break;
        cloudtext_skip(&t);
    }
    word = cloudtext_word(&t, &len);
    for (size_t i = 0; i < sizeof obj / sizeof *obj; i++) {
        if (cloudtext_is(word, len, obj[i])) {
            *format = CLOUDFILE_OBJ;
            return ST_OK;
        }
    }
    t.p = word;
    if (!is_letter(*word) && memchr("\"+-.0123456789", *word, 14) == NULL)
        return cloudtext_fail(&t, ST_EINVAL, "neither a PLY nor an OBJ nor an XYZ file");
    *format = CLOUDFILE_XYZ;
    return ST_OK;
}

static enum status text_parse(struct cloudtext *t, enum cloudfile_format format,
                              size_t max_points, struct dvec3 **out, size_t *n)
{
    struct points list = {NULL, 0, 0, max_points};
    size_t bytes;
    enum status st;

    skip_bom(t);
    if ((st = cloudtext_plain(t)) != ST_OK)
        return st;
    bytes = (size_t)(t->end - t->p);
    list.room = cloudtext_lines(t);
    if (list.room > bytes / 6 + 1) /* the shortest: "1 1 1" and a line end */
        list.room = bytes / 6 + 1;
    if (list.room > max_points)
        list.room = max_points;
    if ((list.at = mem_array(list.room, sizeof *list.at)) == NULL)
        return ST_ENOMEM;
    st = format == CLOUDFILE_OBJ ? obj_parse(t, &list) : xyz_parse(t, &list);
    if (st == ST_OK && list.n == 0)
        st = cloudtext_fail(t, ST_EINVAL, "there are no points in it");
    if (st != ST_OK) {
        mem_free(list.at);
        return st;
    }
    *out = list.at;
    *n = list.n;
    return ST_OK;
}

enum status cloudfile_parse(const void *bytes, size_t len, enum cloudfile_format format,
                            size_t max_points, struct dvec3 **out, size_t *n,
                            struct cloudfile_error *err)
{
    struct cloudtext t;
    enum status st;

    *out = NULL;
    *n = 0;
    t.start = t.p = bytes;
    t.end = t.start + len;
    t.line = 1;
    t.continued = false;
    t.err = err;
    if (len == 0)
        return cloudtext_fail(&t, ST_EINVAL, "there are no points in it");
    if (format == CLOUDFILE_ANY && (st = recognise(&t, &format)) != ST_OK)
        return st;
    if (format == CLOUDFILE_PLY)
        return cloudply_parse(&t, max_points, out, n);
    return text_parse(&t, format, max_points, out, n);
}
