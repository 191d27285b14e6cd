#include "routes.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "app.h"
#include "auth.h"
#include "errinfo.h"
#include "json.h"
#include "mem.h"
#include "params.h"
#include "recent.h"
#include "request.h"
#include "store.h"
#include "utc.h"

#define LIVE_DEFAULT 100

/* scores: may those of what did not match be told? */
static void describe_entry(struct json *j, const struct recent_entry *e, bool scores)
{
    const bool told = e->scored && (scores || strcmp(e->outcome, "match") == 0);
    char at[UTC_TEXT];

    utc_print(e->at_ms, at);
    json_object(j, NULL);
    json_number(j, "seq", (double)e->seq);
    json_text(j, "at", at);
    json_text(j, "kind", e->kind);
    json_text_or_null(j, "subject", e->subject);
    json_text_or_null(j, "token", e->token_name);
    json_text(j, "outcome", e->outcome);
    json_text(j, "code", e->code);
    json_text_or_null(j, "detail", e->detail);
    json_score(j, "score", told ? e->score : NAN);
    json_score(j, "threshold", told ? e->threshold : NAN);
    json_number(j, "overlap", told ? e->overlap : NAN);
    json_text(j, "request_id", e->request_id);
    json_close(j);
}

void live_recent(struct request *r, struct worker *w)
{
    size_t after = 0, most = LIVE_DEFAULT, n;
    struct recent_entry *entry;
    uint64_t last;
    struct json *j;

    (void)w;
    if (!params_count(r, "after", 1, SIZE_MAX, &after) ||
        !params_count(r, "limit", 1, RECENT_MOST, &most))
        return;
    if ((entry = mem_array(most, sizeof *entry)) == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for the latest requests");
        return;
    }
    n = recent_read(r->app->recent, after, most, entry, &last);
    j = json_new();
    json_array(j, "recent");
    for (size_t i = 0; i < n; i++)
        describe_entry(j, &entry[i], auth_scores(r));
    json_close(j);
    json_number(j, "last", (double)last);
    request_respond(r, 200, json_compact(j));
    mem_free(entry);
}

void live_reset(struct request *r, struct worker *w)
{
    struct errinfo e = {0};

    (void)w;
    if (store_attempts_reset(r->app->store, r->actor, r->subject, &e) == ST_OK)
        r->response.http = 204;
    else
        request_fail(r, &e);
}

void live_reset_token(struct request *r, struct worker *w)
{
    struct errinfo e = {0};

    (void)w;
    if (store_attempts_reset_token(r->app->store, r->actor, r->token_id, &e) == ST_OK)
        r->response.http = 204;
    else
        request_fail(r, &e);
}
