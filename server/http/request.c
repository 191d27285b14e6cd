#include "request.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sodium.h>

#include "errinfo.h"
#include "errmap.h"
#include "mem.h"
#include "json.h"
#include "utf8.h"

enum request_method request_method(const char *name)
{
    if (strcmp(name, "GET") == 0 || strcmp(name, "HEAD") == 0)
        return REQUEST_GET;
    if (strcmp(name, "POST") == 0)
        return REQUEST_POST;
    if (strcmp(name, "PATCH") == 0)
        return REQUEST_PATCH;
    if (strcmp(name, "DELETE") == 0)
        return REQUEST_DELETE;
    if (strcmp(name, "OPTIONS") == 0)
        return REQUEST_OPTIONS;
    return REQUEST_OTHER;
}

enum request_media request_media(const char *type, enum cloudformat *format)
{
    static const char merge[] = "application/merge-patch+json";
    static const char form[] = "multipart/form-data";
    size_t len;

    *format = CLOUDFORMAT_ANY;
    if (type == NULL)
        return REQUEST_NO_MEDIA;
    type += strspn(type, " \t");
    len = strcspn(type, "; \t,");
    if (len == strlen(merge) && strncasecmp(type, merge, len) == 0)
        return REQUEST_MERGE;
    if (len == strlen(form) && strncasecmp(type, form, len) == 0)
        return REQUEST_FORM;
    if (!cloudformat_media(type, len, format))
        return REQUEST_OTHER_MEDIA;
    return *format == CLOUDFORMAT_JSON ? REQUEST_JSON : REQUEST_SCAN;
}

void request_set_id(struct request *r, const char *given, unsigned long serial)
{
    static const char safe[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                               "0123456789._-";
    static uint32_t process;
    size_t len = given == NULL ? 0 : strlen(given);

    if (len >= 1 && len <= REQUEST_ID_MAX && strspn(given, safe) == len) {
        memcpy(r->id, given, len + 1);
        return;
    }
    if (process == 0) /* only ever called from the one I/O thread */
        process = randombytes_random() | 1;
    (void)snprintf(r->id, sizeof r->id, "%08lx-%08lx", (unsigned long)process, serial);
}

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    c = (char)(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

enum status request_decode(const char *s, size_t len, bool plus, char *out, size_t size)
{
    size_t n = 0;

    *out = '\0';
    for (size_t i = 0; i < len; i++) {
        char c = s[i];

        if (c == '%') {
            int hi = len - i > 2 ? hex_digit(s[i + 1]) : -1;
            int lo = len - i > 2 ? hex_digit(s[i + 2]) : -1;

            if (hi < 0 || lo < 0 || hi + lo == 0)
                return ST_EINVAL;
            c = (char)(unsigned char)(hi * 16 + lo);
            i += 2;
        } else if (c == '+' && plus) {
            c = ' ';
        }
        if (n + 1 >= size)
            return ST_ELIMIT;
        out[n++] = c;
    }
    out[n] = '\0';
    return ST_OK;
}

enum status request_query(const struct request *r, const char *name, char *out,
                          size_t size)
{
    const char *p = strchr(r->target, '?');
    size_t namelen = strlen(name);

    *out = '\0';
    while (p != NULL && *p != '\0') {
        size_t len = strcspn(++p, "&");
        size_t key = strcspn(p, "=&");

        if (key == namelen && memcmp(p, name, key) == 0) {
            const char *value = p + key + (p[key] == '=');

            return request_decode(value, len - (size_t)(value - p), true, out, size);
        }
        p += len;
    }
    return ST_ENOTFOUND;
}

uint64_t request_sender(const struct request *r)
{
    return r->actor[0] != '\0' ? strtoull(r->actor + STORE_ID_LEN - 16, NULL, 16)
                               : r->address;
}

void request_stage(struct request *r, enum request_stage stage, double ms)
{
    r->stage_ms[stage] += ms;
    r->stages |= 1u << stage;
}

const char *request_stage_name(enum request_stage stage)
{
    static const char *const names[REQUEST_STAGES] = {"queue", "parse", "prepare",
                                                      "score", "align", "minimal"};

    return names[stage];
}

static void set_body(struct request *r, int http, const char *type, char *body)
{
    if (r->response.file != NULL)
        (void)fclose(r->response.file);
    r->response.file = NULL;
    r->response.name = NULL;
    mem_free(r->response.body);
    r->response.http = http;
    r->response.problem = 0;
    r->response.type = type;
    r->response.body = body;
    r->response.page = NULL;
    r->response.len = body == NULL ? 0 : strlen(body);
}

void request_text(struct request *r, const char *type, char *text)
{
    if (text == NULL)
        request_problem(r, ST_ENOMEM, "no memory for the response");
    else
        set_body(r, 200, type, text);
}

void request_bytes(struct request *r, const char *type, unsigned char *bytes, size_t len)
{
    if (bytes == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for the response");
        return;
    }
    set_body(r, 200, type, NULL);
    r->response.body = (char *)bytes;
    r->response.len = len;
}

void request_page(struct request *r, const char *type, const void *text, size_t len)
{
    set_body(r, 200, type, NULL);
    r->response.page = text;
    r->response.len = len;
}

void request_file(struct request *r, const char *type, FILE *file, size_t len,
                  const char *name)
{
    set_body(r, 200, type, NULL);
    r->response.file = file;
    r->response.len = len;
    r->response.name = name;
}

void request_stream(struct request *r, struct events_stream *stream)
{
    set_body(r, 200, "text/event-stream", NULL);
    r->response.stream = stream;
}

void request_not_modified(struct request *r)
{
    set_body(r, 304, NULL, NULL);
}

void request_respond(struct request *r, int http, char *json)
{
    if (json == NULL)
        request_problem(r, ST_ENOMEM, "no memory for the response");
    else
        set_body(r, http, "application/json", json);
}

void request_written(struct request *r, int http, char *json)
{
    if (!r->minimal) {
        request_respond(r, http, json);
        return;
    }
    free(json);
    set_body(r, http == 200 ? 204 : http, NULL, NULL);
    r->response.minimal = true;
}

void request_refuse(struct request *r, unsigned kind, char *json)
{
    const struct errmap *m = errmap_get(kind);

    if (m->http == 503)
        r->response.retry_after = 1;
    if (m->http == 401)
        r->response.challenge = true;
    if (kind == ST_ETOKEN)
        r->response.bad_token = true;
    r->response.location[0] = '\0';
    set_body(r, m->http, "application/problem+json", json);
    r->response.problem = kind;
}

void request_template(struct request *r, const char *id)
{
    (void)snprintf(r->response.location, sizeof r->response.location, "/v1/templates/%s",
                   id);
}

/* Names that the client gave are quoted, and may be anything, or cut in a character. */
static void make_plain(char *text)
{
    size_t n;

    for (char *p = text; *p != '\0'; p += n) {
        n = utf8_character(p, strlen(p));
        if (n == 0 || utf8_is_control(p)) {
            *p = '?';
            n = 1;
        }
    }
}

void request_problem(struct request *r, unsigned kind, const char *fmt, ...)
{
    const struct errmap *m = errmap_get(kind);
    char detail[512];
    const char *told = detail;
    va_list ap;

    va_start(ap, fmt);
    (void)vsnprintf(detail, sizeof detail, fmt, ap);
    va_end(ap);
    if (m->http == 500 || m->http == 503) {
        (void)snprintf(r->fault, sizeof r->fault, "%s", detail);
        if (kind != ERRMAP_OVERLOAD && kind != ERRMAP_NOT_READY)
            told = m->http == 500        ? "The log has an entry with this request_id."
                   : kind == ST_EREFUSED ? "The daemon's log says why."
                                         : "Please try again later.";
    }
    make_plain(detail);
    (void)snprintf(r->told, sizeof r->told, "%s", told);
    request_refuse(r, kind, json_compact(errmap_problem(m, told, r->id)));
}

void request_fail(struct request *r, const struct errinfo *e)
{
    r->failed = e->code;
    request_problem(r, (unsigned)e->code, "%s", e->msg);
}

bool request_gone(struct request *r)
{
    if (!atomic_load_explicit(&r->gone, memory_order_relaxed))
        return false;
    request_problem(r, ERRMAP_OVERLOAD, "the client has gone");
    return true;
}

void request_free(struct request *r)
{
    free(r->target);
    mem_free(r->body);
    mem_free(r->response.body);
    if (r->response.file != NULL)
        (void)fclose(r->response.file);
    free(r->last_event);
    sodium_memzero(r->token, sizeof r->token);
}
