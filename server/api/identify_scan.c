#include "routes.h"

#include "app.h"
#include "auth.h"
#include "capture.h"
#include "cloud.h"
#include "dry_run.h"
#include "errmap.h"
#include "groups.h"
#include "identify.h"
#include "json.h"
#include "logger.h"
#include "outcome.h"
#include "params.h"
#include "request.h"
#include "throttle.h"
#include "worker.h"

/* Is there something to be searched?  Else r->response says why not. */
static bool identify_ready(struct request *r)
{
    if (r->app->gallery == NULL)
        request_problem(r, ERRMAP_GALLERY,
                        "this daemon does not identify: gallery-memory is 0");
    else if (gallery_phase(r->app->gallery) == GALLERY_FULL)
        request_problem(r, ERRMAP_GALLERY,
                        "the descriptors of all templates take more memory than "
                        "gallery-memory allows");
    else if (gallery_phase(r->app->gallery) == GALLERY_LOADING)
        request_problem(r, ERRMAP_GALLERY, "the gallery is being loaded");
    else
        return true;
    return false;
}

/* A search without a match is a guess at all people.  As for wrong tokens, a token that matches again and again
 * never waits. */
static bool identify_allowed(struct request *r)
{
    const unsigned wait_s =
        throttle_wait(r->app->searches, request_sender(r), "", logger_clock_ms());

    if (wait_s == 0)
        return true;
    request_problem(
        r, ERRMAP_SEARCHES,
        "too many searches of this token were without a match within the last "
        "hour: it has to wait");
    r->response.retry_after = wait_s;
    return false;
}

bool identify_scan_may(struct request *r)
{
    return identify_ready(r) && identify_allowed(r);
}

/* The parameters, and the scopes and groups that they need. */
static bool identify_ask(struct request *r, char group[GROUPS_LABEL + 1],
                         struct identify_request *ask)
{
    group[0] = '\0';
    if (!params_group(r, group) ||
        !params_count(r, "candidates", 0, IDENTIFY_MOST, &ask->candidates) ||
        (ask->candidates > 0 && !auth_may(r, STORE_SCOPE_READ)))
        return false;
    ask->actor = r->actor;
    ask->group = group;
    return true;
}

static void identify_respond(struct request *r, struct identification *x)
{
    struct json *j = json_new();

    x->times.total = logger_clock_ms() - r->start_ms;
    identify_describe(j, x, r->minimal, auth_scores(r), store_made_by(r->app->store));
    request_respond(r, 200, json_compact(j));
    r->response.minimal = r->minimal && r->response.http == 200;
}

static void identify_run_request(struct request *r, struct worker *w,
                                 struct identify_request *ask, struct cloud *probe)
{
    struct identification x;
    struct errinfo e = {0};
    enum status st;

    ask->probe = &probe->session;
    ask->face = &w->probe;
    ask->captured = r->capture.captured;
    ask->stop = &r->gone;
    st = identify_run(&w->compare, r->app->gallery, ask, &x, &e);
    outcome_identified(r, &x);
    if (st == ST_OK)
        identify_respond(r, &x);
    else if (st == ST_ELIMIT && gallery_phase(r->app->gallery) == GALLERY_FULL)
        (void)identify_ready(r);
    else if (!request_gone(r) && x.compared == 0 &&
             (dry_run_is_refusal(st) || st == ST_EPEOPLE || st == ST_EINVAL))
        cloud_refuse(r, probe, &e);
    else if (st == ST_EDENIED)
        request_problem(r, ERRMAP_SCOPE, "%s", e.msg);
    else if (!request_gone(r))
        request_fail(r, &e);
    identify_free(&x);
}

void identify_scan(struct request *r, struct worker *w)
{
    char group[GROUPS_LABEL + 1];
    struct identify_request ask = {.candidates = 0};
    struct cloud *probe;

    r->result.kind = "identify";
    if (!identify_ask(r, group, &ask) || !identify_scan_may(r) ||
        (probe = cloud_open(r, MULTIPART_FRAMES_MAX)) == NULL)
        return;
    if (capture_admit(r))
        identify_run_request(r, w, &ask, probe);
    cloud_free(probe);
}
