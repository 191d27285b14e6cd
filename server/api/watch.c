#include "routes.h"

#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "event.h"
#include "events.h"
#include "params.h"
#include "place.h"
#include "request.h"
#include "store.h"

#define LIMIT_DEFAULT 100
#define LIMIT_MAX     1000
#define LAST_MAX      100
#define WAIT_MAX      60   /* s */
#define PAGE          1000 /* entries that are in memory at a time */
#define LOOKED        20000 /* entries that are looked at for the last events: some 50 ms */

/* The place before an entry that was read from the end on. */
static void step_back(struct store_audit_place *p, const struct log_entry *entry)
{
    if (entry->log == LOG_CHANGES) {
        p->changes = entry->seq - 1;
        p->change_mark = 0;
    } else {
        p->accesses[entry->daemon] = entry->seq - 1;
        p->access_mark[entry->daemon] = 0;
    }
}

/* Moves *place from the end of the log back to before the last events that the token of r may see. */
static enum status find_last(struct request *r, size_t last,
                             struct store_audit_place *place, struct errinfo *e)
{
    struct store_audit_filter f = {.newest = true, .most = PAGE, .names = true};
    size_t looked = 0;
    enum status st = ST_OK;

    while (st == ST_OK && last > 0 && looked < LOOKED && !f.from.end) {
        struct store_audit_entry *a = NULL;
        size_t n = 0;

        st = store_audit_list(r->app->store, &f, &a, &n, &f.from, e);
        for (size_t i = 0; i < n && last > 0; i++) {
            const struct log_entry *entry = &a[i].entry;

            step_back(place, entry);
            last -=
                event_type(entry) != NULL && event_visible(&a[i], r->actor, r->groups);
        }
        looked += PAGE;
        free(a);
    }
    return st;
}

/* False: r->response says what is wrong. */
static bool take_cursor(struct request *r, const char *name, const char *text,
                        struct store_audit_place *place)
{
    struct errinfo e = {0};
    bool known;

    if (!place_read(text, 0, place)) {
        request_problem(r, ERRMAP_PARAMETER, "%s is not the cursor of an event", name);
        return false;
    }
    if (store_audit_known(r->app->store, place, &known, &e) != ST_OK) {
        request_fail(r, &e);
        return false;
    }
    if (known)
        return true;
    request_problem(
        r, ERRMAP_CURSOR,
        "%s lies behind the end of this database's log, or is of another "
        "database: the database was restored or replaced. Begin anew with last=",
        name);
    return false;
}

/* Where the client wants to begin. */
static bool take_begin(struct request *r, struct store_audit_place *place)
{
    const bool resumed = r->last_event != NULL && r->last_event[0] != '\0';
    char after[PLACE_MAX] = "";
    struct errinfo e = {0};
    bool known;
    size_t last = SIZE_MAX;
    enum status st;

    if (!params_text(r, "after", after, sizeof after) ||
        !params_count(r, "last", 0, LAST_MAX, &last))
        return false;
    if (resumed) /* also with after or last, which the first request had */
        return take_cursor(r, "Last-Event-ID", r->last_event, place);
    if (after[0] != '\0' && last != SIZE_MAX) {
        request_problem(r, ERRMAP_PARAMETER, "after and last: one of them");
        return false;
    }
    if (after[0] != '\0')
        return take_cursor(r, "after", after, place);
    if ((st = store_audit_end(r->app->store, place, &e)) == ST_OK && last != SIZE_MAX &&
        (st = find_last(r, last, place, &e)) == ST_OK)
        st = store_audit_known(r->app->store, place, &known, &e); /* with the marks */
    if (st != ST_OK)
        request_fail(r, &e);
    return st == ST_OK;
}

void watch_events(struct request *r, struct worker *w)
{
    struct events *ev = r->app->events;
    struct store_audit_place place = {.changes = 0};
    size_t limit = 0, wait_s = SIZE_MAX;
    struct events_stream *s;

    (void)w;
    if (!params_count(r, "limit", 1, LIMIT_MAX, &limit) ||
        !params_count(r, "wait", 0, WAIT_MAX, &wait_s))
        return;
    if (r->streams && (limit != 0 || wait_s != SIZE_MAX)) {
        request_problem(r, ERRMAP_PARAMETER,
                        "limit and wait are for application/json: a stream has no end");
        return;
    }
    if (limit == 0)
        limit = LIMIT_DEFAULT;
    if (wait_s == SIZE_MAX)
        wait_s = 0;
    if (!take_begin(r, &place) || (s = events_open(ev, r, &place, r->streams ? 0 : limit,
                                                   1000.0 * (double)wait_s)) == NULL)
        return;
    if (r->streams)
        request_stream(r, s);
    else
        r->waits = s;
}
