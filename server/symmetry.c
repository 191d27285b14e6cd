#include "symmetry.h"

#include "app.h"
#include "asymmetry.h"
#include "cloud.h"
#include "describe.h"
#include "render.h"
#include "logger.h"
#include "request.h"
#include "scan.h"
#include "store.h"
#include "worker.h"

void symmetry_handle(struct request *r, struct worker *w)
{
    const double start = logger_clock_ms();
    double parsed, prepared, measured;
    struct asymmetry result;
    struct cloudpoints c = {0};
    struct scan_found found;
    enum status st;

    if (cloud_read(r, &c) != ST_OK)
        return;
    parsed = logger_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    if (cloud_build(r, &c, "points", false, w->compare.work, &w->probe, &found) != ST_OK)
        goto out;
    prepared = logger_clock_ms();
    request_stage(r, REQUEST_PREPARE, prepared - parsed);
    if ((st = face_asymmetry(&w->probe, w->compare.work, &result)) != ST_OK) {
        request_problem(r, st, "measuring the asymmetry: %s", status_message(st));
        goto out;
    }
    measured = logger_clock_ms();
    request_stage(r, REQUEST_MINIMAL, measured - prepared);
    request_respond(
        r, 200,
        render_asymmetry(&result, &w->probe, &found, store_made_by(r->app->store),
                         &(struct describe_times){.parse = parsed - start,
                                                  .prepare = prepared - parsed,
                                                  .minimal = measured - prepared,
                                                  .total = measured - r->start_ms}));
out:
    cloudpoints_free(&c);
}
