#include "meta.h"

#include <string.h>

#include "app.h"
#include "face.h"
#include "render.h"
#include "metrics.h"
#include "request.h"

#include "openapi_json.h"

void meta_metrics(struct request *r, struct worker *w)
{
    (void)w;
    request_text(r, "text/plain; version=0.0.4; charset=utf-8", metrics_text(r->app));
}

void meta_openapi(struct request *r, struct worker *w)
{
    (void)w;
    request_answer(r, 200, strdup(openapi_json));
}

void meta_version(struct request *r, struct worker *w)
{
    /* "surfaced/VERSION measure/N model/HHHHHHHH" */
    const char *engine = store_made_by(r->app->store), *from = strchr(engine, '/') + 1;
    char version[32] = "";

    (void)w;
    memcpy(version, from, strcspn(from, " "));
    request_answer(r, 200, render_version(version, engine, __VERSION__));
}
