#include "expiry.h"

#include <stdlib.h>

#include "app.h"
#include "errinfo.h"
#include "logger.h"
#include "metrics.h"
#include "store.h"

#define DAY_MS (86400.0 * 1e3)

static void expiry_tell(const struct store_token *t)
{
    struct logger_line l;

    logger_begin(&l, "warn", "a token expires soon: surfacectl token rotate --expires");
    logger_text(&l, "token", t->id);
    logger_text(&l, "name", t->name);
    logger_text(&l, "expires_at", t->expires);
    logger_end(&l);
}

void expiry_look(struct expiry *x, const struct app *app)
{
    const double now = logger_clock_ms();
    const bool due = x->told_ms == 0 || now - x->told_ms >= DAY_MS;
    struct store_token *t;
    struct errinfo e = {0};
    int64_t next = INT64_MAX;
    size_t n, soon = 0;

    if (store_token_list(app->store, "", &t, &n, &e) != ST_OK) {
        logger_line("warn", "the tokens' expiry cannot be read", "reason", e.msg);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        const int64_t left = store_token_left(&t[i]);

        if (left > 0 && left < next)
            next = left;
        if (left == 0 || left > STORE_TOKEN_SOON_S)
            continue;
        soon++;
        if (due)
            expiry_tell(&t[i]);
    }
    free(t);
    metrics_tokens(app->metrics, soon, next);
    if (due)
        x->told_ms = now;
}
