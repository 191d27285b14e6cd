#include "erasures.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "app.h"
#include "cache.h"
#include "every.h"
#include "store.h"

#define LOOK_MS 400 /* between two looks */

struct erasures {
    struct app *app;
    int64_t since; /* number of the last change whose erasures have left the cache */
    struct every *thread;
};

/* Drops each cached template that the store no longer has, or has damaged.  Returns true if the
 * store answered for each.  Stops at the first template without an answer, and drops it too, so
 * that the next look comes further. */
static bool drop_templates(const struct app *app)
{
    struct store_template t;
    bool answered;
    size_t n;
    char(*ids)[STORE_ID_LEN + 1] = cache_list(app->cache, &n);

    answered = ids != NULL;
    for (size_t i = 0; answered && i < n; i++) {
        const enum status st = store_template_get(app->store, ids[i], &t, NULL);

        if (st != ST_OK)
            cache_forget(app->cache, ids[i]);
        answered = st == ST_OK || st == ST_ENOTFOUND || st == ST_ECORRUPT;
    }
    free(ids);
    return answered;
}

static void erasures_look(void *arg)
{
    struct erasures *x = arg;
    int64_t to = x->since;
    bool erased;

    if (store_erased_since(x->app->store, &to, &erased, NULL) == ST_OK &&
        (!erased || drop_templates(x->app)))
        x->since = to;
}

struct erasures *erasures_start(struct app *app)
{
    struct erasures *x = calloc(1, sizeof *x);

    if (x == NULL)
        return NULL;
    x->app = app;
    if ((x->thread = every_start("erasures", LOOK_MS, erasures_look, x)) == NULL) {
        free(x);
        return NULL;
    }
    return x;
}

void erasures_stop(struct erasures *x)
{
    if (x != NULL)
        every_stop(x->thread);
    free(x);
}
