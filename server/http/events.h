/* events.h -- the streams of GET /v1/events: a thread reads the audit log once for all streams that have seen it to its
 * end, and page by page for each that has not.  A stream's place in the log is the truth; its buffer is bounded, and
 * a client that does not read is waited for by no other. */
#ifndef SERVER_EVENTS_H
#define SERVER_EVENTS_H
#include <stddef.h>
#include <stdint.h>
#include "stream.h"

struct app;
struct errinfo;
struct events;
struct request;

#define EVENTS_STREAMS  200               /* open streams, waiting requests included */
#define EVENTS_OF_TOKEN 50                /* of them by one token */
#define EVENTS_BLOCK    ((size_t)4 << 10) /* bytes that are sent at a time */

struct events_state {
    unsigned open; /* open streams, waiting requests included */
    uint64_t sent; /* events given to clients */
};

/* events_start(app): Starts the thread, which reads app->store.  NULL: out of memory. */
struct events *events_start(struct app *app);

/* events_open(ev, r, place, limit, wait_ms): Opens a stream for the token of r, of the events after place.
 *   limit    0: endless, for events_attach(); else for events_wait(): that many events at most
 *   wait_ms  with limit: how long it waits while there is none
 * NULL: there are too many; r->response says so. */
struct events_stream *events_open(struct events *ev, struct request *r,
                                  const struct store_audit_place *place, size_t limit,
                                  double wait_ms);

/* events_wait(s, done, arg): Calls done(arg) once, on any thread, when r->response is set; s then is released.  r
 * belongs to s until then. */
void events_wait(struct events_stream *s, void (*done)(void *arg), void *arg);

/* events_attach(s, to): Lets s go to a connection by events_read(). */
void events_attach(struct events_stream *s, const struct stream_connection *to);

/* events_read(s, to, max): Takes up to max bytes, and returns their number; 0: there are none, and the connection is
 * suspended until there are; STREAM_END, STREAM_GONE. */
ssize_t events_read(struct events_stream *s, char *to, size_t max);

/* events_close(s): Releases s, which no call of events_wait() has.  On the I/O thread; NULL is allowed. */
void events_close(void *s);

/* events_poke(ev): There may be a new entry in the log. */
void events_poke(struct events *ev);

/* events_look(ev, out): Copies the counters. */
void events_look(struct events *ev, struct events_state *out);

/* events_stop(ev): Ends all streams, and opens none any more.  events_free(ev): releases ev, without streams.  NULL is
 * allowed. */
void events_stop(struct events *ev);
void events_free(struct events *ev);

#endif
