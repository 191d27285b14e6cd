#include "worker.h"

#include <malloc.h>
#include <sodium.h>

#include "app.h"
#include "builder.h"
#include "cache.h"
#include "errinfo.h"
#include "logger.h"

static const struct face *find(void *arg, const char *id)
{
    const struct worker *w = arg;

    return cache_find(w->app->cache, id);
}

static uint64_t mark(void *arg)
{
    const struct worker *w = arg;

    return cache_mark(w->app->cache);
}

static const struct face *keep(void *arg, uint64_t since, const struct store_template *t,
                               struct face *f)
{
    const struct worker *w = arg;

    return cache_keep(w->app->cache, since, t->id,
                      store_template_outdated(w->app->store, t), f);
}

static void release(void *arg, const struct face *f)
{
    const struct worker *w = arg;

    cache_release(w->app->cache, f);
}

static void pass_over(void *arg, const struct errinfo *e)
{
    struct logger_line l;

    (void)arg;
    logger_begin(&l, "warn", "template passed over");
    logger_text(&l, "fault", e->msg);
    logger_end(&l);
}

enum status worker_open(struct worker *w, struct app *app, bool kept)
{
    *w = (struct worker){
        .app = app,
        .kept = kept,
        .compare = {.store = app->store,
                    .work = face_work_new(app->model),
                    .clock_ms = logger_clock_ms,
                    .find = find,
                    .mark = mark,
                    .keep = keep,
                    .release = release,
                    .pass_over = pass_over,
                    .arg = w},
    };
    w->builder = builder_start(app->model);
    if (w->compare.work != NULL && w->builder != NULL)
        return ST_OK;
    worker_close(w);
    return ST_ENOMEM;
}

void worker_wipe(struct worker *w)
{
    face_work_wipe(w->compare.work);
    builder_wipe(w->builder);
    face_free(&w->probe);
    face_free(&w->other);
    sodium_stackzero(BUILDER_STACK);
    if (w->large)
        (void)malloc_trim(0);
    w->large = false;
}

void worker_close(struct worker *w)
{
    builder_stop(w->builder);
    face_free(&w->probe);
    face_free(&w->other);
    face_work_free(w->compare.work);
    *w = (struct worker){0};
}
