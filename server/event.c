#include "event.h"

#include "app.h"
#include "errinfo.h"
#include "logger.h"
#include "metrics.h"
#include "request.h"
#include "store.h"

static void lost(struct request *r, const char *kind, const struct errinfo *e)
{
    struct logger_line l;

    metrics_lost_event(r->app->metrics);
    metrics_database_error(r->app->metrics, e->code);
    logger_begin(&l, "error", "event lost");
    logger_text(&l, "request_id", r->id);
    logger_text(&l, "event", kind);
    logger_text(&l, "fault", e->msg);
    logger_end(&l);
}

void event_add(struct request *r, const char *kind, const char *outcome)
{
    struct errinfo e = {0};

    if (store_event(r->app->store, kind, r->actor, r->subject, r->template_id, outcome,
                    &e) != ST_OK)
        lost(r, kind, &e);
}
