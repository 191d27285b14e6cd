/* worker.h -- what one worker thread owns and reuses for each request. */
#ifndef SERVER_WORKER_H
#define SERVER_WORKER_H
#include "admission.h"
#include "face.h"
#include "status.h"

struct app;     /* app.h */
struct builder; /* builder.h */

struct worker {
    struct app *app;
    struct admission_context compare; /* its memory, and the models of app's cache */
    struct builder *builder;
    struct face probe, other;
};

/* worker_open(w, app): w must stay where it is until worker_close().  ST_OK, ST_ENOMEM. */
enum status worker_open(struct worker *w, struct app *app);
void worker_close(struct worker *w); /* an empty one is allowed */

#endif
