#include "meta.h"

#include <string.h>

#include "app.h"
#include "calibration.h"
#include "errinfo.h"
#include "face.h"
#include "json.h"
#include "metrics.h"
#include "queue.h"
#include "request.h"

#include "openapi_json.h"

void meta_health(struct request *r, struct worker *w)
{
    (void)w;
    request_answer(r, 200, json_state("ok"));
}

void meta_ready(struct request *r, struct worker *w)
{
    struct store_calibration k;
    struct errinfo e = {0};

    (void)w;
    if (store_ready(r->app->store, &e) == ST_OK &&
        calibration_in_force(r->app->store, &k, &e) == ST_OK)
        request_answer(r, 200, json_ready(&k));
    else
        request_problem(r, ST_EBUSY, "not ready: %s", e.msg);
}

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
    request_answer(r, 200, json_version(version, engine, __VERSION__));
}
