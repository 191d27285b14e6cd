#include "cloudtext.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "errinfo.h"
#include "number.h"

enum status cloudtext_fail(struct cloudtext *t, enum status st, const char *fmt, ...)
{
    char what[160];
    va_list ap;

    va_start(ap, fmt);
    (void)vsnprintf(what, sizeof what, fmt, ap);
    va_end(ap);
    if (t->line > 0)
        return errinfo_set(t->e, st, "line %lu: %s", (unsigned long)t->line, what);
    return errinfo_set(t->e, st, "byte %zu: %s", (size_t)(t->p - t->start), what);
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

bool cloudtext_find(struct cloudtext *t)
{
    for (cloudtext_blank(t); cloudtext_eol(t) && t->p < t->end; cloudtext_blank(t))
        cloudtext_newline(t);
    return t->p < t->end;
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

enum status cloudtext_pass(struct cloudtext *t)
{
    size_t len;

    (void)cloudtext_word(t, &len);
    return len > 0 ? ST_OK : cloudtext_fail(t, ST_EINVAL, "the line has too few numbers");
}

enum status cloudtext_row_end(struct cloudtext *t)
{
    cloudtext_blank(t);
    return cloudtext_eol(t)
               ? ST_OK
               : cloudtext_fail(t, ST_EINVAL,
                                "the line has more numbers than the header says");
}

enum status cloudtext_cut_off(struct cloudtext *t, uint64_t n, uint64_t row)
{
    return cloudtext_fail(t, ST_EINVAL,
                          "the header promises %llu points, the data ends in number %llu",
                          (unsigned long long)n, (unsigned long long)row + 1);
}

bool cloudtext_is(const char *word, size_t len, const char *what)
{
    return strlen(what) == len && memcmp(word, what, len) == 0;
}

bool cloudtext_like(const char *word, size_t len, const char *what)
{
    return strlen(what) == len && strncasecmp(word, what, len) == 0;
}

bool cloudtext_count(const char *word, size_t len, uint64_t *out)
{
    *out = 0;
    for (size_t i = 0; i < len; i++) {
        if (word[i] < '0' || word[i] > '9' || i == 18)
            return false;
        *out = 10 * *out + (uint64_t)(word[i] - '0');
    }
    return len > 0;
}

bool cloudtext_is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool cloudtext_comment(const struct cloudtext *t)
{
    return *t->p == '#' || *t->p == '%' ||
           (t->end - t->p > 1 && t->p[0] == '/' && t->p[1] == '/');
}

static bool ends_number(const struct cloudtext *t, const char *p)
{
    return p == t->end || *p == ' ' || *p == '\t' || *p == '\n' || *p == '\r' ||
           *p == ',' || *p == ';' || (*p == '\\' && t->continued);
}

/* The end of NaN or infinity at t->p, as programs write them; NULL: there is none. */
static const char *not_finite(const struct cloudtext *t)
{
    static const char *const words[] = {"nan", "inf", "infinity"};
    const char *p = t->p + (t->p < t->end && (*t->p == '+' || *t->p == '-')), *q = p;
    size_t len;

    while (!ends_number(t, q))
        q++;
    len = (size_t)(q - p);
    if (len >= 4 && memcmp(p, "1.#", 3) == 0) /* 1.#INF, 1.#QNAN, 1.#IND */
        return q;
    if (len >= 4 && strncasecmp(p, "nan(", 4) == 0)
        return q;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (cloudtext_like(p, len, words[i]))
            return q;
    return NULL;
}

enum status cloudtext_number(struct cloudtext *t, double *out)
{
    const char *after;

    cloudtext_blank(t);
    after = number_read(t->p, t->end, out);
    if (after == NULL || !ends_number(t, after)) {
        if ((after = not_finite(t)) == NULL)
            return cloudtext_fail(
                t, ST_EINVAL,
                cloudtext_eol(t) ? "the line has too few numbers"
                : *t->p == ','   ? "a number is expected here: is it a decimal comma?"
                                 : "a number is expected here");
        *out = NAN;
    }
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
    const char *p = t->p, *end = t->end;

    for (; end > p && memchr("\x1A\r\n", end[-1], 3) != NULL; end--)
        if (end[-1] == '\x1A')
            t->end = end - 1; /* Ctrl-Z ends a text file of MS-DOS */
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
