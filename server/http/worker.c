#include "worker.h"

#include <malloc.h>
#include <sodium.h>

#include "app.h"
#include "logger.h"

/* Deeper than that no thread that computes has its stack. */
#define STACK ((size_t)256 << 10)

enum status worker_open(struct worker *w, struct app *app)
{
    *w = (struct worker){.app = app,
                         .compare = {.store = app->store,
                                     .work = surface_work_new(app->model),
                                     .clock_ms = logger_clock_ms}};
    return w->compare.work != NULL ? ST_OK : ST_ENOMEM;
}

void worker_wipe(struct worker *w)
{
    surface_work_wipe(w->compare.work);
    surface_face_free(w->probe);
    surface_face_free(w->other);
    w->probe = w->other = NULL;
    sodium_stackzero(STACK);
    if (w->large)
        (void)malloc_trim(0);
    w->large = false;
}

void worker_close(struct worker *w)
{
    surface_face_free(w->probe);
    surface_face_free(w->other);
    surface_work_free(w->compare.work);
    *w = (struct worker){0};
}
