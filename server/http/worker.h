/* worker.h -- what a worker thread owns and reuses for each request. */
#ifndef SERVER_WORKER_H
#define SERVER_WORKER_H
#include "status.h"
#include "templates.h"

struct app; /* app.h */

struct worker {
    struct app *app;
    struct templates_context compare; /* working memory, and the faces of app's cache */
    struct surface_face *probe, *other;
    bool large; /* a large request was handled since worker_wipe() */
};

/* worker_open(w, app): Prepares w, which must stay where it is until worker_close().  ST_OK, ST_ENOMEM. */
enum status worker_open(struct worker *w, struct app *app);

/* worker_wipe(w): Between two requests: wipes the faces that w has worked on, and gives the memory of large
 * requests back to the system.  Cost: some 100 us. */
void worker_wipe(struct worker *w);

/* worker_close(w): Releases what w owns.  An empty w is allowed. */
void worker_close(struct worker *w);

#endif
