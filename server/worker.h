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
    bool kept;  /* for bodies of up to WORKER_SMALL_POINTS */
    bool large; /* has worked on others since worker_wipe() */
};

#define WORKER_SMALL_POINTS 10000

/* worker_open(w, app, kept): w must stay where it is until worker_close().  ST_OK, ST_ENOMEM. */
enum status worker_open(struct worker *w, struct app *app, bool kept);

/* worker_wipe(w): between two requests: nothing of the faces that w has worked on stays in its
 * memory, and what large ones needed is given back to the system.  Some 100 us. */
void worker_wipe(struct worker *w);
void worker_close(struct worker *w); /* an empty one is allowed */

#endif
