#include "docs.h"

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
    request_page(r, type, text);
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

void docs_openapi(struct request *r, struct worker *w)
{
    (void)w;
    request_page(r, "application/json", openapi_json);
}
