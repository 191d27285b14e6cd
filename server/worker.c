#include "worker.h"

#include "app.h"
#include "cache.h"
#include "errinfo.h"
#include "log.h"

static enum status hold(void *arg, const char *id, struct face_work *work,
                        const struct face **out, struct errinfo *e)
{
    const struct worker *w = arg;

    return cache_hold(w->app->cache, w->app->store, id, work, out, e);
}

static void release(void *arg, const struct face *f)
{
    const struct worker *w = arg;

    cache_release(w->app->cache, f);
}

static void pass_over(void *arg, const struct errinfo *e)
{
    struct log_entry l;

    (void)arg;
    log_begin(&l, "warn", "template passed over");
    log_text(&l, "fault", e->msg);
    log_end(&l);
}

enum status worker_open(struct worker *w, struct app *app)
{
    *w = (struct worker){
        .app = app,
        .compare = {.store = app->store,
                    .work = face_work_new(app->model),
                    .clock_ms = log_clock_ms,
                    .hold = hold,
                    .release = release,
                    .pass_over = pass_over,
                    .arg = w},
    };
    return w->compare.work != NULL ? ST_OK : ST_ENOMEM;
}

void worker_close(struct worker *w)
{
    face_free(&w->probe);
    face_free(&w->other);
    face_work_free(w->compare.work);
    *w = (struct worker){0};
}
