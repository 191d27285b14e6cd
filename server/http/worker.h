/* worker.h -- what one worker thread owns and reuses for each request. */
#ifndef SERVER_WORKER_H
#define SERVER_WORKER_H
#include "libsurface.h"
#include "status.h"
#include "templates.h"

struct app; /* app.h */

struct worker {
    struct app *app;
    struct templates_context compare; /* its memory, and the faces of app's cache */
    struct surface_face *probe, *other;
    bool large; /* a large request was worked on since worker_wipe() */
};

/* worker_open(w, app): w must stay where it is until worker_close().  ST_OK, ST_ENOMEM. */
enum status worker_open(struct worker *w, struct app *app);

/* worker_passed_over(t): a line in the log where a template of another engine was left out. */
void worker_passed_over(const struct templates *t);

/* worker_wipe(w): between two requests: nothing of the faces that w has worked on stays in its
 * memory, and what large ones needed is given back to the system.  Some 100 us. */
void worker_wipe(struct worker *w);
void worker_close(struct worker *w); /* an empty one is allowed */

#endif
