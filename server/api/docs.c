#define ZLIB_CONST /* next_in is const */
#include "docs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sodium.h>
#include <zlib.h>

#include "request.h"

#include "docs_css.h"
#include "docs_html.h"
#include "docs_js.h"
#include "openapi_json.h"

/* What the page may do: its own files, and /openapi.json. */
#define POLICY                                                                           \
    "default-src 'none'; connect-src 'self'; img-src data:; script-src 'self'; "         \
    "style-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"

static void send_file(struct request *r, const char *type, const char *text)
{
    request_page(r, type, text, strlen(text));
    r->response.policy = POLICY;
}

void docs_page(struct request *r, struct worker *w)
{
    (void)w;
    send_file(r, "text/html; charset=utf-8", docs_html);
}

void docs_style(struct request *r, struct worker *w)
{
    (void)w;
    send_file(r, "text/css; charset=utf-8", docs_css);
}

void docs_script(struct request *r, struct worker *w)
{
    (void)w;
    send_file(r, "text/javascript; charset=utf-8", docs_js);
}

/* ---- the description, which programs ask for again and again: compressed to a tenth, and not
 * sent to who has it */

static struct {
    char tag[2][24]; /* by whether it is compressed */
    unsigned char *gzip;
    size_t len; /* 0: there is no memory for it */
} description;

static void compress_description(void)
{
    z_stream z = {0};
    const size_t room = compressBound(sizeof openapi_json) + 32;

    if (deflateInit2(&z, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 9,
                     Z_DEFAULT_STRATEGY) != Z_OK)
        return;
    if ((description.gzip = malloc(room)) != NULL) {
        z.next_in = (const unsigned char *)openapi_json;
        z.avail_in = (unsigned)strlen(openapi_json);
        z.next_out = description.gzip;
        z.avail_out = (unsigned)room;
        if (deflate(&z, Z_FINISH) == Z_STREAM_END)
            description.len = z.total_out;
    }
    (void)deflateEnd(&z);
}

/* Once, by the I/O thread. */
static void make_description(void)
{
    unsigned char hash[crypto_generichash_BYTES_MIN];
    char hex[2 * sizeof hash + 1];

    if (description.tag[0][0] != '\0')
        return;
    (void)crypto_generichash(hash, sizeof hash, (const unsigned char *)openapi_json,
                             strlen(openapi_json), NULL, 0);
    (void)sodium_bin2hex(hex, sizeof hex, hash, sizeof hash);
    (void)snprintf(description.tag[0], sizeof description.tag[0], "\"%.16s\"", hex);
    (void)snprintf(description.tag[1], sizeof description.tag[1], "\"%.16s-gz\"", hex);
    compress_description();
}

/* Has the client what either of the tags names?  RFC 9110, section 13.1.2. */
static bool has_it(const char *none_match)
{
    return strcmp(none_match, "*") == 0 ||
           strstr(none_match, description.tag[0]) != NULL ||
           strstr(none_match, description.tag[1]) != NULL;
}

void docs_openapi(struct request *r, struct worker *w)
{
    bool gzip;

    (void)w;
    make_description();
    gzip = r->gzip && description.len > 0;
    if (has_it(r->none_match))
        request_not_modified(r);
    else if (gzip)
        request_page(r, "application/json", description.gzip, description.len);
    else
        request_page(r, "application/json", openapi_json, strlen(openapi_json));
    r->response.etag = description.tag[gzip];
    r->response.gzip = gzip && r->response.http == 200;
}
