#define _GNU_SOURCE /* strcasestr() */
#include "headers.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "capture.h"
#include "errmap.h"
#include "request.h"

#define BLANKS " \t"

/* ---- framing */

/* RFC 9110, section 5.6.2. */
static bool is_token(const char *s)
{
    static const char others[] = "!#$%&'*+-.^_`|~0123456789";

    for (; *s != '\0'; s++)
        if (!((*s | 0x20) >= 'a' && (*s | 0x20) <= 'z') && strchr(others, *s) == NULL)
            return false;
    return true;
}

static bool is_line(const char *s)
{
    for (; *s != '\0'; s++)
        if (((unsigned char)*s < ' ' && *s != '\t') || *s == 0x7f)
            return false;
    return true;
}

/* libmicrohttpd (0.9.75) appends a folded line (RFC 9112, section 5.2) to the name, in a new
 * place: "Content-: 9" and " Length" make a Content-Length that no proxy sees.  Of all other
 * headers the value stands behind the name, with the colon's place and blanks between. */
static bool is_folded(const char *name, const char *value)
{
    const uintptr_t end = (uintptr_t)name + strlen(name) + 1;

    return (uintptr_t)value < end ||
           (uintptr_t)value - end > strspn((const char *)end, BLANKS);
}

/* A host and perhaps a port (RFC 3986, section 3.2), or nothing. */
static bool is_host(const char *s)
{
    return s[strspn(s, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
                       "-._~!$&'()*+,;=:[]%")] == '\0';
}

/* One of the headers that may come once? */
static void headers_count(struct headers_framing *f, const char *name, const char *value)
{
    if (strcasecmp(name, "Host") == 0) {
        if (f->has_host)
            f->wrong = "more than one Host header";
        else if (!is_host(value))
            f->wrong = "the Host header must be a host and a port";
        f->has_host = true;
    } else if (strcasecmp(name, "Authorization") == 0) {
        if (f->has_authorization)
            f->wrong = "more than one Authorization header: send one token";
        f->has_authorization = true;
    }
}

static void take_framing(struct headers_framing *f, const char *name, const char *value)
{
    const bool coding = strcasecmp(name, "Transfer-Encoding") == 0;

    if (name[0] == '\0' || !is_token(name) || value == NULL || is_folded(name, value) ||
        !is_line(value)) {
        f->wrong = "a header must be a line with a name, a colon and a value";
        return;
    }
    headers_count(f, name, value);
    if (!coding && strcasecmp(name, "Content-Length") != 0)
        return;
    if (f->has_length)
        f->wrong = "more than one Content-Length or Transfer-Encoding";
    f->has_length = true;
    f->coded = f->coded || coding;
    f->other_coding = f->other_coding || (coding && strcasecmp(value, "chunked") != 0);
}

bool headers_refuse(struct request *r, const struct headers_framing *f,
                    const char *version)
{
    if (f->wrong != NULL)
        request_problem(r, ST_EINVAL, "%s", f->wrong);
    else if (!f->has_host && strcmp(version, "HTTP/1.1") == 0)
        request_problem(r, ST_EINVAL, "HTTP/1.1 needs a Host header");
    else if (f->other_coding)
        request_problem(r, ERRMAP_TRANSFER, "Transfer-Encoding may be chunked");
    else if (f->coded && strcmp(version, "HTTP/1.1") != 0)
        request_problem(r, ST_EINVAL, "HTTP/1.0 has no Transfer-Encoding");
    else
        return false;
    return true;
}

/* ---- what they mean */

/* One preference, s[0..len-1]: name[=value][;parameters]. */
static void take_preference(struct request *r, const char *s, size_t len)
{
    size_t name = strcspn(s, "=;, \t"), at = name;
    bool quoted;

    if (name > len || name != 6 || strncasecmp(s, "return", 6) != 0 || r->has_return)
        return;
    at += strspn(s + at, BLANKS);
    if (s[at] != '=')
        return;
    at += 1 + strspn(s + at + 1, BLANKS);
    quoted = s[at] == '"';
    s += at + quoted;
    r->has_return = true;
    r->minimal = strncasecmp(s, "minimal", 7) == 0 &&
                 strchr(quoted ? "\"" : " \t;,", s[7]) != NULL;
}

static void take_preferences(struct request *r, const char *s)
{
    while (*s != '\0') {
        size_t len;
        bool quoted = false;

        s += strspn(s, BLANKS ",");
        for (len = 0; s[len] != '\0' && (quoted || s[len] != ','); len++)
            if (s[len] == '"')
                quoted = !quoted;
        take_preference(r, s, len);
        s += len;
    }
}

/* Does a list of codings have gzip, and not with the weight 0?  RFC 9110, section 12.5.3. */
static bool accepts_gzip(const char *s)
{
    while (*s != '\0') {
        const size_t len = strcspn(s += strspn(s, BLANKS ","), ",");
        const size_t name = strcspn(s, ",; \t");
        const char *q = memchr(s, '=', len);

        if ((name == 4 && strncasecmp(s, "gzip", 4) == 0) || (name == 1 && *s == '*'))
            return q == NULL || strtod(q + 1, NULL) > 0;
        s += len;
    }
    return false;
}

static void take_text(char *to, size_t size, const char *value)
{
    (void)snprintf(to, size, "%s", strlen(value) < size ? value : "?");
}

void headers_take(struct request *r, struct headers_framing *f, const char *name,
                  const char *value)
{
    take_framing(f, name, value);
    if (value == NULL)
        value = "";
    if (strcasecmp(name, "Content-Encoding") == 0)
        r->coding = r->coding == INFLATE_NONE ? inflate_coding(value) : INFLATE_OTHER;
    else if (strcasecmp(name, "Capture-Signature") == 0)
        capture_take(r, value);
    else if (strcasecmp(name, "Prefer") == 0)
        take_preferences(r, value);
    else if (strcasecmp(name, "Accept-Encoding") == 0)
        r->gzip = r->gzip || accepts_gzip(value);
    else if (strcasecmp(name, "Accept") == 0)
        r->streams = r->streams || strcasestr(value, "text/event-stream") != NULL;
    else if (strcasecmp(name, "Last-Event-ID") == 0 && r->last_event == NULL)
        r->last_event = strdup(value);
    else if (strcasecmp(name, "Access-Control-Request-Method") == 0)
        r->preflight = true;
    else if (strcasecmp(name, "Origin") == 0)
        take_text(r->origin, sizeof r->origin, value);
    else if (strcasecmp(name, "Host") == 0)
        take_text(r->host, sizeof r->host, value);
    else if (strcasecmp(name, "Sec-Fetch-Site") == 0)
        r->cross_site = strcasecmp(value, "cross-site") == 0;
    else if (strcasecmp(name, "If-None-Match") == 0 &&
             strlen(value) < sizeof r->none_match)
        memcpy(r->none_match, value, strlen(value) + 1);
}
