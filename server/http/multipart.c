#include "multipart.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "errinfo.h"

#define HEADERS_MAX 4096 /* bytes of a part's headers */
#define BLANK       " \t"

/* ---- parameters of a header: a; name="value"; other=value */

/* One character of a quoted string (RFC 9110 section 5.6.4) or of a token; -1: it ends. */
static int next_char(const char **p, bool quoted)
{
    if (**p == '\0' || (quoted ? **p == '"' : strchr("; \t,\"", **p) != NULL))
        return -1;
    if (quoted && **p == '\\' && (*p)[1] != '\0')
        ++*p;
    return (unsigned char)*(*p)++;
}

/* The value of a parameter into out, as much as there is room for.  False: there is no such
 * parameter, or what follows is malformed. */
static bool parameter(const char *value, const char *name, char *out, size_t size,
                      size_t *len)
{
    const size_t namelen = strlen(name);
    const char *p = value + strcspn(value, ";");

    while (*p == ';') {
        const char *key = p + 1 + strspn(p + 1, BLANK);
        const size_t keylen = strcspn(key, "=; \t\"");
        bool quoted;
        size_t n = 0;

        p = key + keylen;
        if (keylen == 0 || *p++ != '=')
            return false;
        quoted = *p == '"';
        p += quoted;
        for (int c; (c = next_char(&p, quoted)) >= 0; n++)
            if (n + 1 < size)
                out[n] = (char)c;
        if (quoted && *p++ != '"')
            return false;
        p += strspn(p, BLANK);
        out[n < size ? n : size - 1] = '\0';
        *len = n;
        if (keylen == namelen && strncasecmp(key, name, namelen) == 0)
            return true;
    }
    return false;
}

bool multipart_boundary(const char *type, char out[MULTIPART_BOUNDARY_MAX + 1])
{
    static const char allowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                  "0123456789'()+_,-./:=? ";
    size_t len = 0;

    if (parameter(type, "boundary", out, MULTIPART_BOUNDARY_MAX + 1, &len) && len > 0 &&
        len <= MULTIPART_BOUNDARY_MAX && strspn(out, allowed) == len &&
        out[len - 1] != ' ')
        return true;
    out[0] = '\0';
    return false;
}

/* ---- the body */

struct reader {
    const unsigned char *body, *p, *end;
    const char *boundary;
    size_t len; /* length of boundary */
    struct errinfo *e;
};

static enum status wrong(const struct reader *r, const char *what)
{
    return errinfo_set(r->e, ST_EINVAL, "multipart/form-data, byte %zu: %s",
                       (size_t)(r->p - r->body), what);
}

static bool starts(const struct reader *r, const char *text, size_t len)
{
    return (size_t)(r->end - r->p) >= len && memcmp(r->p, text, len) == 0;
}

static void skip_blank(struct reader *r)
{
    while (r->p < r->end && (*r->p == ' ' || *r->p == '\t'))
        r->p++;
}

/* Behind "--" and the boundary, if they are at r->p, and the line ends there or, where the body
 * does, after another "--": then *last. */
static bool take_delimiter(struct reader *r, bool *last)
{
    struct reader t = *r;

    if (!starts(&t, "--", 2))
        return false;
    t.p += 2;
    if (!starts(&t, t.boundary, t.len))
        return false;
    t.p += t.len;
    if ((*last = starts(&t, "--", 2)))
        t.p += 2;
    skip_blank(&t);
    if (starts(&t, "\r\n", 2))
        t.p += 2;
    else if (!*last || t.p < t.end)
        return false;
    r->p = t.p;
    return true;
}

/* The data up to the next delimiter, which is taken. */
static enum status take_data(struct reader *r, struct multipart_file *f, bool *last)
{
    f->data = r->p;
    for (struct reader t = *r; t.p < t.end; t.p++) {
        t.p = memchr(t.p, '\r', (size_t)(t.end - t.p));
        if (t.p == NULL)
            break;
        r->p = t.p + 2;
        if (starts(&t, "\r\n", 2) && take_delimiter(r, last)) {
            f->len = (size_t)(t.p - f->data);
            return ST_OK;
        }
    }
    r->p = r->end;
    return wrong(r, "the body ends before the last boundary");
}

/* The line at r->p into out, without its end. */
static enum status take_line(struct reader *r, char *out, size_t size)
{
    const unsigned char *end = memchr(r->p, '\r', (size_t)(r->end - r->p));
    size_t len;

    if (end == NULL || r->end - end < 2 || end[1] != '\n')
        return wrong(r, "a header without its end of line");
    len = (size_t)(end - r->p);
    if (len >= size || memchr(r->p, '\0', len) != NULL)
        return wrong(r, "a header that is too long, or has a NUL in it");
    memcpy(out, r->p, len);
    out[len] = '\0';
    r->p = end + 2;
    return ST_OK;
}

static bool is(const char *line, size_t len, const char *name)
{
    return strlen(name) == len && strncasecmp(line, name, len) == 0;
}

/* What a header says, if it is one of those that matter. */
static enum status take_header(struct reader *r, const char *line,
                               struct multipart_file *f)
{
    const size_t len = strcspn(line, ":");
    const char *value = line + len + 1;
    size_t n;

    if (len == 0 || line[len] != ':')
        return wrong(r, "a header is malformed");
    value += strspn(value, BLANK);
    if (is(line, len, "Content-Type"))
        (void)snprintf(f->type, sizeof f->type, "%s", value);
    else if (is(line, len, "Content-Encoding"))
        (void)snprintf(f->coding, sizeof f->coding, "%s", value);
    else if (is(line, len, "Content-Transfer-Encoding") &&
             strcasecmp(value, "binary") != 0 && strcasecmp(value, "8bit") != 0)
        return wrong(r, "Content-Transfer-Encoding is not binary");
    else if (is(line, len, "Content-Disposition") &&
             (!is(value, strcspn(value, "; \t"), "form-data") ||
              !parameter(value, "name", f->field, sizeof f->field, &n)))
        return wrong(r, "Content-Disposition is not form-data with a name");
    if (is(line, len, "Content-Disposition") &&
        !parameter(value, "filename", f->name, sizeof f->name, &n))
        f->name[0] = '\0';
    return ST_OK;
}

static enum status take_headers(struct reader *r, struct multipart_file *f)
{
    const unsigned char *const start = r->p;
    char line[1024];
    enum status st;

    while ((st = take_line(r, line, sizeof line)) == ST_OK && line[0] != '\0') {
        if (r->p - start > HEADERS_MAX)
            return wrong(r, "a part has more than 4 KB of headers");
        if ((st = take_header(r, line, f)) != ST_OK)
            return st;
    }
    if (st == ST_OK && f->field[0] == '\0')
        return wrong(r, "a part without Content-Disposition and a name");
    return st;
}

/* The name of one more part to those in list. */
static void note(char *list, size_t size, const char *name)
{
    const size_t len = strlen(list);

    (void)snprintf(list + len, size - len, "%s%.40s", len > 0 ? ", " : "", name);
}

enum status multipart_read(const unsigned char *body, size_t len, const char *boundary,
                           size_t most, struct multipart_file *out, size_t *n,
                           struct errinfo *e)
{
    struct reader r = {.body = body,
                       .p = body,
                       .end = body + len,
                       .boundary = boundary,
                       .len = strlen(boundary),
                       .e = e};
    char names[320] = "", files[64];
    bool last = false, named = true;
    size_t parts = 0;
    enum status st;

    *n = 0;
    if (!take_delimiter(&r, &last) && take_data(&r, &(struct multipart_file){.len = 0},
                                                &last) != ST_OK) { /* a preamble */
        r.p = body;
        return wrong(&r, "no line of the body is the boundary");
    }
    for (; !last && parts <= most;
         parts++) { /* one more than there may be, to name them */
        struct multipart_file f = {.len = 0};

        if ((st = take_headers(&r, &f)) != ST_OK ||
            (st = take_data(&r, &f, &last)) != ST_OK)
            return st;
        note(names, sizeof names, f.field);
        named = named && f.name[0] != '\0';
        if (parts < most)
            out[parts] = f;
    }
    (void)snprintf(files, sizeof files, "1 to %zu files, each with a file name", most);
    if (parts == 0 || parts > most || (parts > 1 && !named))
        return errinfo_set(e, ST_EINVAL,
                           "the form has %s%s%s: send %s, with all else in the query",
                           parts == 0 ? "no parts" : "the parts ", names,
                           last ? "" : ", ...", most == 1 ? "one file alone" : files);
    while (r.p < r.end && strchr(" \t\r\n", *r.p) != NULL && *r.p != '\0')
        r.p++;
    if (r.p != r.end)
        return wrong(&r, "there is more behind the last boundary");
    *n = parts;
    return ST_OK;
}
