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
    int64_t since;
    struct every *thread;
};

/* Is it known not to be there?  Not so where the store is busy. */
static bool is_gone(enum status st)
{
    return st == ST_ENOTFOUND || st == ST_ECORRUPT;
}

static void drop_templates(const struct app *app)
{
    struct store_template t;
    size_t n;
    char(*ids)[STORE_ID_LEN + 1] = cache_list(app->cache, &n);

    for (size_t i = 0; i < n; i++)
        if (is_gone(store_template_get(app->store, ids[i], &t, NULL)))
            cache_forget(app->cache, ids[i]);
    free(ids);
}

static void look(void *arg)
{
    struct erasures *x = arg;
    bool erased;

    if (store_erased_since(x->app->store, &x->since, &erased, NULL) == ST_OK && erased)
        drop_templates(x->app);
}

struct erasures *erasures_start(struct app *app)
{
    struct erasures *x = calloc(1, sizeof *x);

    if (x == NULL)
        return NULL;
    x->app = app;
    if ((x->thread = every_start("erasures", LOOK_MS, look, x)) == NULL) {
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
