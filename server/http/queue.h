/* queue.h -- a bounded queue of requests, and the workers that serve it.
 * The queue shares time fairly among senders, however long their requests take: it serves next the waiting sender
 * that has had the least processor time (start-time fair queueing; Goyal, Vin and Cheng 1996).  It does not
 * interrupt a request.  Therefore, of two or more workers one takes no heavy requests: no large ones, and no
 * requests of a sender whose last ones took long. */
#ifndef SERVER_QUEUE_H
#define SERVER_QUEUE_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"

struct app;
struct queue;
struct request;
struct worker;

enum queue_kind {
    QUEUE_TOKEN, /* check of a token, which takes little time: before all other kinds */
    QUEUE_SMALL,
    QUEUE_LARGE
};

/* queue_start(app, workers, limit, run, out): Starts the workers.  ST_OK, ST_ENOMEM.
 *   limit  number of requests that may wait
 *   run    called on a worker w with a request r; the queue does not own r afterwards */
enum status queue_start(struct app *app, unsigned workers, unsigned limit,
                        void (*run)(struct worker *w, struct request *r),
                        struct queue **out);

/* queue_push(q, r, kind, sender): Adds r to the queue.  Returns NULL, or a request that the queue rejects and no
 * longer owns.  A stopped queue rejects r.  A full queue rejects the last request of the sender with the most
 * waiting requests if that sender has more of them than r's sender, else r.  Cost: O(limit).
 *   sender  number of the sender: request_sender() */
struct request *queue_push(struct queue *q, struct request *r, enum queue_kind kind,
                           uint64_t sender);

/* queue_drop(q, r): Removes r if it waits.  Returns true if it did.  Cost: O(waiting requests). */
bool queue_drop(struct queue *q, const struct request *r);

/* queue_stop(q): Serves the waiting requests, takes no more, and ends the workers. */
void queue_stop(struct queue *q);

/* queue_free(q): Releases q after queue_stop().  NULL is allowed. */
void queue_free(struct queue *q);

struct queue_state {
    unsigned waiting, running; /* requests now */
    uint64_t served;           /* requests since the start */
};

/* queue_look(q, out): Copies the numbers. */
void queue_look(struct queue *q, struct queue_state *out);

#endif
