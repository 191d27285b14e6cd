#include "scans.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "access.h"
#include "app.h"
#include "cloud.h"
#include "cloudwrite.h"
#include "describe.h"
#include "dry_run.h"
#include "json.h"
#include "logger.h"
#include "metrics.h"
#include "params.h"
#include "request.h"
#include "sample.h"
#include "show.h"
#include "store.h"
#include "worker.h"

/* of a scan as it came */
#define SHOWN_POINTS 20000

static void scans_respond(struct request *r, const struct worker *w,
                          const struct dry_run *t, const struct describe_times *times,
                          const struct cloudpoints *shown)
{
    const bool face = t->verification == ST_OK;
    struct json *j = json_new();
    struct show show;

    metrics_check(r->app->metrics, t->enrolment == ST_OK ? METRICS_ENROLLABLE
                                   : face                ? METRICS_USABLE
                                                         : METRICS_UNUSABLE);
    if (shown == NULL || (!face && shown->n == 0)) {
        describe_dry_run(j, t, w->probe, times);
        request_respond(r, 200, json_compact(j));
        return;
    }
    json_object(j, "extras");
    describe_dry_run(j, t, w->probe, times);
    json_close(j);
    (void)show_scan(face ? w->probe : NULL, shown->at, shown->n, SHOWN_POINTS,
                    t->found.scan.view, j, &show);
    request_bytes(r, "model/gltf-binary", show.glb, show.len);
}

void scans_check(struct request *r, struct worker *w)
{
    const struct sample_options o = {.stop = &r->gone};
    struct describe_times times = {0};
    bool shown = false;
    struct cloudpoints c;
    struct dry_run t = {0};
    const double start = logger_clock_ms();
    double parsed;
    enum status st;

    if (!params_surface(r, &shown))
        return;
    st = cloud_take(r, &c, &t.why);
    if (r->response.http != 0) /* a parameter */
        return;
    parsed = logger_clock_ms();
    request_stage(r, REQUEST_PARSE, times.parse = parsed - start);
    if (st == ST_OK) {
        st = dry_run_run("points", &c, &o, w->compare.work, &w->probe, &t);
        request_stage(r, REQUEST_PREPARE, times.prepare = logger_clock_ms() - parsed);
    } else if (dry_run_is_refusal(st)) {
        const struct errinfo e = t.why;

        dry_run_unread(st, &e, &t);
        st = ST_OK;
    }
    times.total = logger_clock_ms() - r->start_ms;
    if (st == ST_OK && !request_gone(r))
        scans_respond(r, w, &t, &times, shown ? &c : NULL);
    else if (!request_gone(r))
        request_fail(r, &t.why);
    cloudpoints_free(&c);
}

static void send_ply(struct request *r, const struct surface_face *f)
{
    char *text = NULL;
    size_t len = 0;
    FILE *to = open_memstream(&text, &len);
    bool whole;

    if (to != NULL) {
        whole = cloudwrite_ply(to, f, NULL) == ST_OK;
        if (fclose(to) != 0 || !whole) {
            free(text);
            text = NULL;
        }
    }
    request_bytes(r, "model/ply", (unsigned char *)text, len);
}

static void send_glb(struct request *r, const struct surface_face *f,
                     const struct store_template *t)
{
    struct json *j = json_new();
    struct show show;

    json_object(j, "extras");
    describe_template(j, t, f, true);
    json_close(j);
    (void)show_scan(f, NULL, 0, 1, NULL, j, &show);
    request_bytes(r, "model/gltf-binary", show.glb, show.len);
}

void scans_template(struct request *r, struct worker *w)
{
    struct store_template t;
    struct errinfo e = {0};
    bool ply = false;
    enum status st;

    if (!params_format(r, &ply))
        return;
    st = store_template_load(r->app->store, r->template_id, &t, w->compare.work,
                             &w->probe, &e);
    if (st != ST_OK) {
        request_fail(r, &e);
        return;
    }
    if (ply)
        send_ply(r, w->probe);
    else
        send_glb(r, w->probe, &t);
    if (r->response.http == 200) {
        memcpy(r->subject, t.subject, sizeof r->subject);
        access_event(r, "surface", "sent");
    }
}

void scans_asymmetry(struct request *r, struct worker *w)
{
    const double start = logger_clock_ms();
    double parsed, prepared, measured;
    struct surface_asymmetry result = {0};
    struct json *j;
    struct cloudpoints c = {0};
    struct sample_found found;
    enum surface_status st;

    if (cloud_read(r, &c) != ST_OK)
        return;
    parsed = logger_clock_ms();
    request_stage(r, REQUEST_PARSE, parsed - start);
    if (cloud_build(r, &c, "points", false, w->compare.work, &w->probe, &found) != ST_OK)
        goto out;
    prepared = logger_clock_ms();
    request_stage(r, REQUEST_PREPARE, prepared - parsed);
    if ((st = surface_asymmetry(w->compare.work, w->probe, &result)) != SURFACE_OK) {
        request_problem(r, status_from(st), "measuring the asymmetry: %s",
                        surface_message(st));
        goto out;
    }
    measured = logger_clock_ms();
    request_stage(r, REQUEST_MINIMAL, measured - prepared);
    j = json_new();
    describe_scan(j, "scan", &found);
    describe_asymmetry(j, &result, w->probe, store_made_by(r->app->store),
                       &(struct describe_times){.parse = parsed - start,
                                                .prepare = prepared - parsed,
                                                .minimal = measured - prepared,
                                                .total = measured - r->start_ms});
    request_respond(r, 200, json_compact(j));
out:
    cloudpoints_free(&c);
}
