#include "cloudtext.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "clouderror.h"
#include "number.h"

enum status cloudtext_fail(struct cloudtext *t, enum status st, const char *fmt, ...)
{
    va_list ap;

    if (t->err == NULL)
        return st;
    t->err->where = (size_t)(t->p - t->start);
    t->err->line = t->line;
    va_start(ap, fmt);
    (void)vsnprintf(t->err->what, sizeof t->err->what, fmt, ap);
    va_end(ap);
    return st;
}

bool cloudtext_eol(const struct cloudtext *t)
{
    return t->p == t->end || *t->p == '\n' || *t->p == '\r';
}

void cloudtext_newline(struct cloudtext *t)
{
    if (t->p == t->end || (*t->p != '\n' && *t->p != '\r'))
        return;
    if (*t->p == '\r' && t->end - t->p > 1 && t->p[1] == '\n')
        t->p++;
    t->p++;
    t->line += t->line != 0;
}

void cloudtext_blank(struct cloudtext *t)
{
    while (t->p < t->end) {
        if (*t->p == ' ' || *t->p == '\t') {
            t->p++;
        } else if (*t->p == '\\' && t->continued && t->end - t->p > 1 &&
                   (t->p[1] == '\n' || t->p[1] == '\r')) {
            t->p++;
            cloudtext_newline(t);
        } else {
            return;
        }
    }
}

void cloudtext_skip(struct cloudtext *t)
{
    while (!cloudtext_eol(t)) {
        t->p++;
        if (t->continued && t->p[-1] == '\\')
            cloudtext_newline(t);
    }
    cloudtext_newline(t);
}

const char *cloudtext_word(struct cloudtext *t, size_t *len)
{
    const char *word;

    cloudtext_blank(t);
    word = t->p;
    while (!cloudtext_eol(t) && *t->p != ' ' && *t->p != '\t')
        t->p++;
    *len = (size_t)(t->p - word);
    return word;
}

bool cloudtext_is(const char *word, size_t len, const char *what)
{
    return strlen(what) == len && memcmp(word, what, len) == 0;
}

bool cloudtext_is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool cloudtext_comment(const struct cloudtext *t)
{
    return *t->p == '#' || (t->end - t->p > 1 && t->p[0] == '/' && t->p[1] == '/');
}

enum status cloudtext_point(struct cloudtext *t, struct cloudtext_points *list,
                            struct dvec3 p)
{
    if (list->n == list->max)
        return cloudtext_fail(t, ST_ELIMIT, "more points than the limit of %zu",
                              list->max);
    list->at[list->n++] = p;
    return ST_OK;
}

static bool ends_number(const struct cloudtext *t, const char *p)
{
    return p == t->end || *p == ' ' || *p == '\t' || *p == '\n' || *p == '\r' ||
           *p == ',' || *p == ';' || (*p == '\\' && t->continued);
}

/* Is the text here one of the ways in which programs write NaN and infinity? */
static bool not_finite(const struct cloudtext *t)
{
    const char *p = t->p;
    size_t left;

    if (p < t->end && (*p == '+' || *p == '-'))
        p++;
    left = (size_t)(t->end - p);
    if (left >= 4 && memcmp(p, "1.#", 3) == 0) /* 1.#INF, 1.#QNAN, 1.#IND */
        return true;
    if (left < 3)
        return false;
    return ((p[0] | 32) == 'n' && (p[1] | 32) == 'a' && (p[2] | 32) == 'n') ||
           ((p[0] | 32) == 'i' && (p[1] | 32) == 'n' && (p[2] | 32) == 'f');
}

enum status cloudtext_number(struct cloudtext *t, double *out)
{
    const char *after;

    cloudtext_blank(t);
    after = number_read(t->p, t->end, out);
    if (after == NULL || !ends_number(t, after)) {
        if (not_finite(t))
            return cloudtext_fail(t, ST_ENOTFINITE,
                                  "a coordinate is not a finite number");
        if (cloudtext_eol(t))
            return cloudtext_fail(t, ST_EINVAL, "the line has too few numbers");
        return cloudtext_fail(t, ST_EINVAL, "a number is expected here");
    }
    if (!isfinite(*out))
        return cloudtext_fail(t, ST_ENOTFINITE, "a coordinate is too large for a number");
    t->p = after;
    return ST_OK;
}

static bool is_control(unsigned char c)
{
    return (c < 32 && c != '\t' && c != '\n' && c != '\r' && c != '\f') || c == 127;
}

enum status cloudtext_plain(struct cloudtext *t)
{
    struct cloudtext at = *t;
    const char *p = t->p;

    while (p < t->end) { /* blocks without a branch in them, which is 10 times faster */
        const size_t len = t->end - p < 4096 ? (size_t)(t->end - p) : 4096;
        unsigned bad = 0;

        for (size_t i = 0; i < len; i++)
            bad |= is_control((unsigned char)p[i]);
        if (bad)
            break;
        p += len;
    }
    if (p == t->end)
        return ST_OK;
    for (; !is_control((unsigned char)*at.p); at.p++)
        at.line += *at.p == '\n';
    return cloudtext_fail(&at, ST_EINVAL, "binary data inside text");
}

size_t cloudtext_lines(const struct cloudtext *t)
{
    size_t n = 1;

    for (const char *p = t->p; p < t->end; p++)
        n += *p == '\n' || *p == '\r';
    return n;
}
