/* queue.h -- a bounded queue of requests, and the workers that serve it.
 * Time is shared fairly over senders, whatever each request takes: of all that wait, the sender is
 * served next that has had the least of the processor's time (start-time fair queueing; Goyal, Vin and
 * Cheng 1996).  A request that runs is not interrupted: so of two or more workers one takes no
 * heavy requests, that is, large ones and those of a sender whose last ones took long. */
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

enum queue_kind {
    QUEUE_TOKEN, /* a token is checked, which takes no time: before all others */
    QUEUE_SMALL,
    QUEUE_LARGE
};

/* queue_start(app, workers, limit, run, out): limit: requests that may wait.
 * run(w, r) is called on a worker; when it returns, r is no longer the queue's.
 * Returns ST_OK, ST_ENOMEM. */
enum status queue_start(struct app *app, unsigned workers, unsigned limit,
                        void (*run)(struct worker *w, struct request *r),
                        struct queue **out);

/* queue_push(q, r, kind, sender): adds r.  Returns NULL, or the request that gets no place and is no
 * longer the queue's: r itself, or, in a full queue, the last one of the sender with the most
 * waiting, if these are more than r's sender has.  A queue that is stopped takes none.
 * sender: any number that is the same for those who share turns.  O(limit). */
struct request *queue_push(struct queue *q, struct request *r, enum queue_kind kind,
                           uint64_t sender);

/* queue_drop(q, r): true: it was waiting, and is no longer the queue's.  O(waiting). */
bool queue_drop(struct queue *q, const struct request *r);

/* queue_stop(q): no more is taken, what waits is served, the workers end. */
void queue_stop(struct queue *q);
void queue_free(struct queue *q); /* after queue_stop(); NULL is allowed */

struct queue_state {
    unsigned waiting, running;
    uint64_t served; /* since the start */
};

void queue_look(struct queue *q, struct queue_state *out);

#endif
