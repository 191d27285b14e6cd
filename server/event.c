#include "event.h"

#include "app.h"
#include "errinfo.h"
#include "log.h"
#include "metrics.h"
#include "request.h"
#include "store.h"

void event_lost(struct request *r, const char *kind, const struct errinfo *e)
{
    struct log_entry l;

    metrics_lost_event(r->app->metrics);
    metrics_database_error(r->app->metrics, e->code);
    log_begin(&l, "error", "event lost");
    log_text(&l, "request_id", r->id);
    log_text(&l, "event", kind);
    log_text(&l, "fault", e->msg);
    log_end(&l);
}

void event_add(struct request *r, const char *kind, const char *outcome)
{
    struct errinfo e = {0};

    if (store_event(r->app->store, kind, r->actor, r->subject, r->template_id, outcome,
                    &e) != ST_OK)
        event_lost(r, kind, &e);
}
