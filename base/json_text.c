#include "json_text.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "mem.h"
#include "number.h"
#include "utf8.h"

#define FIRST_ROOM 64

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Does a number begin at p as RFC 8259, section 6, writes one, up to its exponent?  p is in a text
 * that ends with 0. */
static bool is_number(const char *p)
{
    const char *const first = p + (*p == '-');

    for (p = first; is_digit(*p); p++)
        ;
    return p > first && (*first != '0' || p == first + 1) &&
           (*p != '.' || is_digit(p[1]));
}

static const char *skip_blank(const char *p)
{
    while (*p == ' ' || *p == '\n' || *p == '\r' || *p == '\t')
        p++;
    return p;
}

/* Returns the byte after the point's bracket; NULL: none begins at p. */
static const char *take_point(const char *p, const char *end, struct dvec3 *out)
{
    double xyz[3];

    if (*p++ != '[')
        return NULL;
    for (int i = 0; i < 3; i++) {
        p = skip_blank(p);
        if (!is_number(p) || (p = number_read(p, end, &xyz[i])) == NULL ||
            !isfinite(xyz[i]))
            return NULL;
        p = skip_blank(p);
        if (*p++ != (i < 2 ? ',' : ']'))
            return NULL;
    }
    *out = (struct dvec3){xyz[0], xyz[1], xyz[2]};
    return p;
}

/* Adds one; there is room for *room. */
static bool json_text_add(struct json_points *points, size_t *room, struct dvec3 point)
{
    if (points->n == *room) {
        const size_t n = *room == 0 ? FIRST_ROOM : 2 * *room;
        struct dvec3 *at = mem_grow(points->at, points->n * sizeof *at, n * sizeof *at);

        if (at == NULL)
            return false;
        points->at = at;
        *room = n;
    }
    points->at[points->n++] = point;
    return true;
}

/* points is empty again; returns st. */
static enum status json_text_drop(struct json_points *points, enum status st)
{
    mem_free(points->at);
    *points = (struct json_points){0};
    return st;
}

/* The points at the front of the array whose first byte after the bracket is p, which ends at end
 * with a 0: [x, y, z] of three finite numbers each, correctly rounded.
 *   rest    begin of the remainder for the parser: the array's closing bracket if it has only points; else the
 *           last point before another element, which is not in *out, so that the parser reports an error at
 *           its byte in the document
 * Memory: at most 48 bytes a point, and no less than 1.5 KB.  On failure *out is empty; ST_ELIMIT: more
 * than max points. */
static enum status json_text_read_points(const char *p, const char *end, size_t max,
                                         struct json_points *out, const char **rest)
{
    size_t room = 0;
    struct dvec3 point;
    const char *q;

    *out = (struct json_points){0};
    *rest = p;
    for (bool more = true; more;) {
        p = skip_blank(p);
        if ((q = take_point(p, end, &point)) == NULL)
            break;
        if (out->n == max)
            return json_text_drop(out, ST_ELIMIT);
        if (!json_text_add(out, &room, point))
            return json_text_drop(out, ST_ENOMEM);
        *rest = p;
        p = skip_blank(q);
        if (*p == ']') {
            *rest = p;
            return ST_OK;
        }
        more = *p++ == ',';
    }
    if (out->n <= 1) /* the parser's, or there was none */
        return json_text_drop(out, ST_OK);
    out->n--;
    return ST_OK;
}

static enum status too_many(const struct json_text *t, struct errinfo *e)
{
    return errinfo_set(e, ST_ELIMIT, "more than %zu values", t->max_values);
}

/* Takes the points of the array whose bracket is at *i, which moves to the last byte that
 * is left out.  depth: of its elements. */
static enum status take_array(struct json_text *t, size_t depth, size_t *i,
                              struct errinfo *e)
{
    const size_t array = t->arrays++;
    const char *const first = t->bytes + *i + 1, *rest;
    struct json_points points;
    enum status st;

    if (t->cuts == t->max_cuts || depth == t->max_depth)
        return ST_OK;
    st = json_text_read_points(first, t->bytes + t->len, t->max_values / 4, &points,
                               &rest);
    if (st == ST_ELIMIT)
        return too_many(t, e);
    if (st != ST_OK)
        return errinfo_set(e, st, "no memory for the points");
    if (points.n == 0)
        return ST_OK;
    t->cut[t->cuts++] = (struct json_text_cut){
        .array = array, .at = *i + 1, .len = (size_t)(rest - first), .points = points};
    t->values += 4 * points.n - (*rest == ']'); /* no comma follows the last */
    *i += (size_t)(rest - first);
    return ST_OK;
}

enum status json_text_wrong(const char *p, size_t at, struct errinfo *e)
{
    static const char *const words[] = {"NaN", "nan", "Infinity", "inf"};

    p += *p == '-';
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strncmp(p, words[i], strlen(words[i])) == 0)
            return errinfo_set(e, ST_EINVAL,
                               "not valid JSON at byte %zu: %s is no number of JSON", at,
                               words[i]);
    return errinfo_set(e, ST_EINVAL, "not valid JSON at byte %zu", at);
}

/* Takes the token at *i, and moves *i to its last byte. */
static enum status take_token(struct json_text *t, bool *quoted, size_t *depth, size_t *i,
                              struct errinfo *e)
{
    const char *const p = t->bytes + *i;
    const bool number = !*quoted && (*p == '-' || (*p >= '0' && *p <= '9'));

    if (*quoted && (unsigned char)*p < 0x20)
        return errinfo_set(e, ST_EINVAL, "a control character in a text at byte %zu", *i);
    if (*p == '\0' || (number && !is_number(p)))
        return json_text_wrong(p, *i, e);
    if (*p == '"') {
        *quoted = !*quoted;
    } else if (*quoted && *p == '\\') {
        if (strncmp(p, "\\u0000", 6) == 0)
            return errinfo_set(e, ST_EINVAL, "\\u0000 cannot be in a text");
        ++*i; /* the escaped byte, perhaps a quote; bytes[len] is 0 */
    } else if (number) {
        *i += strspn(p, "0123456789+-.eE") - 1;
    } else if (!*quoted) {
        t->values += *p == ',' || *p == '[' || *p == '{'; /* each but the first follows */
        if ((*p == '[' || *p == '{') && ++*depth > t->max_depth)
            return errinfo_set(e, ST_EINVAL, "deeper than %zu at byte %zu", t->max_depth,
                               *i);
        if ((*p == ']' || *p == '}') && *depth > 0)
            --*depth;
        if (*p == '[')
            return take_array(t, *depth, i, e);
    }
    return ST_OK;
}

enum status json_text_check(struct json_text *t, struct errinfo *e)
{
    const size_t valid = utf8_valid(t->bytes, t->len);
    size_t depth = 0;
    bool quoted = false;
    enum status st = ST_OK;

    if (t->len == 0)
        return errinfo_set(e, ST_EINVAL, "the document is empty");
    if (valid < t->len)
        return errinfo_set(e, ST_EINVAL, "not UTF-8 at byte %zu", valid);
    t->values = 1;
    for (size_t i = 0; i < t->len && st == ST_OK; i++)
        st = take_token(t, &quoted, &depth, &i, e);
    return st == ST_OK && t->values > t->max_values ? too_many(t, e) : st;
}

char *json_text_rest(const struct json_text *t, size_t *len)
{
    size_t from = 0, to = 0;
    char *rest;

    *len = t->len;
    for (size_t i = 0; i < t->cuts; i++)
        *len -= t->cut[i].len;
    if ((rest = malloc(*len + 1)) == NULL)
        return NULL;
    for (size_t i = 0; i < t->cuts; i++) {
        const struct json_text_cut *cut = &t->cut[i];

        memcpy(rest + to, t->bytes + from, cut->at - from);
        to += cut->at - from;
        from = cut->at + cut->len;
    }
    memcpy(rest + to, t->bytes + from, t->len + 1 - from);
    return rest;
}

size_t json_text_place(const struct json_text *t, size_t at)
{
    /* At the cut itself stands a point, which is no error. */
    for (size_t i = 0; i < t->cuts && at > t->cut[i].at; i++)
        at += t->cut[i].len;
    return at;
}

void json_text_free(struct json_text *t)
{
    for (size_t i = 0; i < t->cuts; i++)
        mem_free(t->cut[i].points.at);
}
