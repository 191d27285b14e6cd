/* queue.h -- a bounded queue of requests, and the workers that serve it. */
#ifndef SERVER_QUEUE_H
#define SERVER_QUEUE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct app;
struct queue;
struct request;
struct worker;

/* queue_start(app, workers, limit, run, out): limit: requests that may wait.
 * run(w, r) is called on a worker; when it returns, r is no longer the queue's.
 * Returns ST_OK, ST_ENOMEM. */
enum status queue_start(struct app *app, unsigned workers, unsigned limit,
                        void (*run)(struct worker *w, struct request *r),
                        struct queue **out);

/* queue_push(q, r): false at once when the queue is full or closed. */
bool queue_push(struct queue *q, struct request *r);

/* queue_stop(q): no more is taken, what waits is served, the workers end. */
void queue_stop(struct queue *q);
void queue_free(struct queue *q); /* after queue_stop(); NULL is allowed */

struct queue_state {
    unsigned waiting, limit, workers, running;
    uint64_t served; /* since the start */
};

void queue_look(struct queue *q, struct queue_state *out);

#endif
