#define ZLIB_CONST /* next_in is const */
#include "routes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sodium.h>
#include <zlib.h>

#include "app.h"
#include "errmap.h"
#include "request.h"

#include "console_api_js.h"
#include "console_audit_js.h"
#include "console_burst_js.h"
#include "console_calibration_js.h"
#include "console_camera_js.h"
#include "console_console_js.h"
#include "console_dom_js.h"
#include "console_enroll_js.h"
#include "console_glb_js.h"
#include "console_groups_js.h"
#include "console_health_js.h"
#include "console_icon_svg.h"
#include "console_identify_js.h"
#include "console_index_html.h"
#include "console_live_js.h"
#include "console_pairs_js.h"
#include "console_people_js.h"
#include "console_person_js.h"
#include "console_report_js.h"
#include "console_scans_js.h"
#include "console_section_js.h"
#include "console_slot_js.h"
#include "console_stage_js.h"
#include "console_style_css.h"
#include "console_tokens_js.h"
#include "console_try_js.h"
#include "console_verdict_js.h"
#include "console_view_js.h"
#include "console_widgets_js.h"
#include "console_words_js.h"
#include "docs_css.h"
#include "docs_html.h"
#include "docs_js.h"
#include "openapi_json.h"
#include "sample_one_again_ply.h"
#include "sample_one_ply.h"
#include "sample_one_turned_ply.h"
#include "sample_other_ply.h"

#define HTML       "text/html; charset=utf-8"
#define CSS        "text/css; charset=utf-8"
#define JAVASCRIPT "text/javascript; charset=utf-8"

/* What a page may do: load its own files, and ask this daemon. */
#define POLICY                                                                           \
    "default-src 'none'; connect-src 'self'; img-src 'self' data: blob:; "               \
    "script-src 'self'; style-src 'self'; base-uri 'none'; form-action 'none'; "         \
    "frame-ancestors 'none'; require-trusted-types-for 'script'; trusted-types 'none'"

static struct page {
    const char *path, *type, *text;
    size_t len;
    /* made when it is asked for first */
    char tag[2][24]; /* by whether it is compressed */
    unsigned char *gzip;
    size_t gzip_len; /* 0: there was no memory, or it would not be shorter */
} pages[] = {
#define PAGE(path, type, text)                                                           \
    {                                                                                    \
        path, type, text, sizeof text - 1, {"", ""}, NULL, 0                             \
    }
    PAGE("/openapi.json", "application/json", openapi_json),
    PAGE("/docs", HTML, docs_html),
    PAGE("/docs/style.css", CSS, docs_css),
    PAGE("/docs/script.js", JAVASCRIPT, docs_js),
    PAGE("/console", HTML, console_index_html),
    PAGE("/console/style.css", CSS, console_style_css),
    PAGE("/console/icon.svg", "image/svg+xml", console_icon_svg),
    PAGE("/console/api.js", JAVASCRIPT, console_api_js),
    PAGE("/console/audit.js", JAVASCRIPT, console_audit_js),
    PAGE("/console/burst.js", JAVASCRIPT, console_burst_js),
    PAGE("/console/calibration.js", JAVASCRIPT, console_calibration_js),
    PAGE("/console/camera.js", JAVASCRIPT, console_camera_js),
    PAGE("/console/console.js", JAVASCRIPT, console_console_js),
    PAGE("/console/dom.js", JAVASCRIPT, console_dom_js),
    PAGE("/console/enroll.js", JAVASCRIPT, console_enroll_js),
    PAGE("/console/glb.js", JAVASCRIPT, console_glb_js),
    PAGE("/console/groups.js", JAVASCRIPT, console_groups_js),
    PAGE("/console/health.js", JAVASCRIPT, console_health_js),
    PAGE("/console/identify.js", JAVASCRIPT, console_identify_js),
    PAGE("/console/live.js", JAVASCRIPT, console_live_js),
    PAGE("/console/pairs.js", JAVASCRIPT, console_pairs_js),
    PAGE("/console/people.js", JAVASCRIPT, console_people_js),
    PAGE("/console/person.js", JAVASCRIPT, console_person_js),
    PAGE("/console/report.js", JAVASCRIPT, console_report_js),
    PAGE("/console/scans.js", JAVASCRIPT, console_scans_js),
    PAGE("/console/section.js", JAVASCRIPT, console_section_js),
    PAGE("/console/slot.js", JAVASCRIPT, console_slot_js),
    PAGE("/console/stage.js", JAVASCRIPT, console_stage_js),
    PAGE("/console/tokens.js", JAVASCRIPT, console_tokens_js),
    PAGE("/console/try.js", JAVASCRIPT, console_try_js),
    PAGE("/console/verdict.js", JAVASCRIPT, console_verdict_js),
    PAGE("/console/view.js", JAVASCRIPT, console_view_js),
    PAGE("/console/widgets.js", JAVASCRIPT, console_widgets_js),
    PAGE("/console/words.js", JAVASCRIPT, console_words_js),
    PAGE("/console/one.ply", "model/ply", sample_one_ply),
    PAGE("/console/one_again.ply", "model/ply", sample_one_again_ply),
    PAGE("/console/one_turned.ply", "model/ply", sample_one_turned_ply),
    PAGE("/console/other.ply", "model/ply", sample_other_ply),
#undef PAGE
};

static void compress_page(struct page *p)
{
    z_stream z = {0};
    const size_t room = compressBound(p->len) + 32;

    if (deflateInit2(&z, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 9,
                     Z_DEFAULT_STRATEGY) != Z_OK)
        return;
    if ((p->gzip = malloc(room)) != NULL) {
        z.next_in = (const unsigned char *)p->text;
        z.avail_in = (unsigned)p->len;
        z.next_out = p->gzip;
        z.avail_out = (unsigned)room;
        if (deflate(&z, Z_FINISH) == Z_STREAM_END && z.total_out < p->len)
            p->gzip_len = z.total_out;
    }
    (void)deflateEnd(&z);
}

/* Once, by the I/O thread. */
static void make_page(struct page *p)
{
    unsigned char hash[crypto_generichash_BYTES_MIN];
    char hex[2 * sizeof hash + 1];

    if (p->tag[0][0] != '\0')
        return;
    (void)crypto_generichash(hash, sizeof hash, (const unsigned char *)p->text, p->len,
                             NULL, 0);
    (void)sodium_bin2hex(hex, sizeof hex, hash, sizeof hash);
    (void)snprintf(p->tag[0], sizeof p->tag[0], "\"%.16s\"", hex);
    (void)snprintf(p->tag[1], sizeof p->tag[1], "\"%.16s-gz\"", hex);
    compress_page(p);
}

/* Has the client what either of the tags names?  RFC 9110, section 13.1.2. */
static bool has_it(const struct page *p, const char *none_match)
{
    return strcmp(none_match, "*") == 0 || strstr(none_match, p->tag[0]) != NULL ||
           strstr(none_match, p->tag[1]) != NULL;
}

static void send_page(struct request *r, struct page *p)
{
    bool gzip;

    make_page(p);
    gzip = r->gzip && p->gzip_len > 0;
    if (has_it(p, r->none_match))
        request_not_modified(r);
    else if (gzip)
        request_page(r, p->type, p->gzip, p->gzip_len);
    else
        request_page(r, p->type, p->text, p->len);
    r->response.etag = p->tag[gzip];
    r->response.gzip = gzip && r->response.http == 200;
    r->response.policy = POLICY;
}

void pages_handle(struct request *r, struct worker *w)
{
    const size_t len = strcspn(r->target, "?");

    (void)w;
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
        if (strncmp(pages[i].path, r->target, len) == 0 && pages[i].path[len] == '\0') {
            send_page(r, &pages[i]);
            return;
        }
    request_problem(r, ERRMAP_ROUTE, "there is no such page");
}

void pages_root(struct request *r, struct worker *w)
{
    (void)w;
    r->response.http = 303;
    (void)snprintf(r->response.location, sizeof r->response.location, "%s",
                   r->app->no_console ? "docs" : "console");
}

void pages_console(struct request *r, struct worker *w)
{
    if (r->app->no_console)
        request_problem(r, ERRMAP_ROUTE, "this daemon was started without the console");
    else
        pages_handle(r, w);
}
