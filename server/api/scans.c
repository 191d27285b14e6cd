#include "routes.h"

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

    metrics_event(r->app->metrics, t->enrolment == ST_OK ? METRICS_ENROLLABLE
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
    struct dry_run t = {0};
    bool shown = false;
    struct cloud *c;
    struct cloudpoints *p;
    double start, parsed;
    enum status st;

    if (!params_surface(r, &shown) || (c = cloud_open(r, 1)) == NULL)
        return;
    start = logger_clock_ms();
    st = session_read(&c->session, &r->gone, &t.why);
    p = &c->session.frame[0].points;
    parsed = logger_clock_ms();
    if (st == ST_OK) {
        request_stage(r, REQUEST_PARSE, times.parse = parsed - start);
        st = dry_run_run("points", p, &o, w->compare.work, &w->probe, &t);
        request_stage(r, REQUEST_PREPARE, times.prepare = logger_clock_ms() - parsed);
    } else if (dry_run_is_refusal(st)) {
        const struct errinfo e = t.why;

        dry_run_unread(st, &e, &t);
        st = ST_OK;
    }
    times.total = logger_clock_ms() - r->start_ms;
    if (st == ST_OK && !request_gone(r))
        scans_respond(r, w, &t, &times, shown ? p : NULL);
    else if (!request_gone(r))
        request_fail(r, &t.why);
    cloud_free(c);
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
    st = store_template_load(r->app->store, r->actor, r->template_id, &t, w->compare.work,
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

static void asymmetry(struct request *r, struct worker *w, const struct cloud *c)
{
    const double start = logger_clock_ms();
    struct surface_asymmetry result = {0};
    const enum surface_status st = surface_asymmetry(w->compare.work, w->probe, &result);
    const double *stage = r->stage_ms;
    struct json *j;

    if (st != SURFACE_OK) {
        request_problem(r, status_from(st), "measuring the asymmetry: %s",
                        surface_message(st));
        return;
    }
    request_stage(r, REQUEST_MINIMAL, logger_clock_ms() - start);
    j = json_new();
    describe_scan(j, "scan", &c->session.found);
    describe_asymmetry(
        j, &result, w->probe, store_made_by(r->app->store),
        &(struct describe_times){.parse = stage[REQUEST_PARSE],
                                 .prepare = stage[REQUEST_PREPARE],
                                 .minimal = stage[REQUEST_MINIMAL],
                                 .total = logger_clock_ms() - r->start_ms});
    request_respond(r, 200, json_compact(j));
}

void scans_asymmetry(struct request *r, struct worker *w)
{
    struct cloud *c = cloud_open(r, 1);

    if (c != NULL && cloud_read(r, c) && cloud_build(r, c, false, w))
        asymmetry(r, w, c);
    cloud_free(c);
}
