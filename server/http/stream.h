/* stream.h -- one stream of events (events.h): its place in the log, its buffer, its request or connection.  The caller
 * of each function holds the lock of the streams. */
#ifndef SERVER_STREAM_H
#define SERVER_STREAM_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include "store.h"

struct events;     /* events.h */
struct guard_peer; /* guard.h */
struct request;    /* request.h */

#define STREAM_BUFFER ((size_t)64 << 10) /* bytes for a client that are in memory */

struct stream_connection {
    void *conn; /* argument of suspend() and resume(), which any thread calls */
    void (*suspend)(void *conn); /* events_read() is not called until resume() */
    void (*resume)(void *conn);
    int fd;
    struct guard_peer *place;
};

#define STREAM_END  (-1) /* of events_read(): the response ends */
#define STREAM_GONE (-2) /* the client has gone */

struct events_stream {
    struct events *of;
    uint64_t *sent; /* counter of all events */
    struct events_stream *prev, *next;
    uint64_t serial;
    /* Members below are protected by the lock of `of`, as those before. */
    struct store_audit_place place; /* what the client has got, or has in the buffer */
    bool live;                      /* place is not before the head's */
    bool full, failed;              /* of the last page: no room for all; not read */
    bool ended;                     /* after the buffer the response ends */
    bool unchecked;   /* the token may have been revoked or rotated since the last look */
    int64_t until_ms; /* end of the secret, ms since 1970 */
    double wrote_ms;  /* when something was put into the buffer */
    char *buf;        /* [STREAM_BUFFER], or NULL: empty */
    size_t from, len; /* what is in it: buf[from..len-1] */
    /* A request that waits. */
    struct request *r; /* NULL: endless */
    void (*done)(void *arg);
    void *arg;
    size_t limit, n; /* events in the buffer */
    double end_ms;
    /* A connection. */
    struct stream_connection to; /* zeros: none yet */
    bool suspended, gone;
    /* Constant. */
    char token[STORE_ID_LEN + 1], groups[GROUPS_SIZE];
    int64_t revision; /* of the token's row, when the secret was new */
    /* On the I/O thread only. */
    bool sending;
};

/* stream_new(ev, r, place): Returns a stream for the token of r, in no list.  NULL: out of memory. */
struct events_stream *stream_new(struct events *ev, const struct request *r,
                                 const struct store_audit_place *place);

/* stream_free(s): Releases s. */
void stream_free(struct events_stream *s);

/* stream_held(s): Returns the bytes in the buffer. */
size_t stream_held(const struct events_stream *s);

/* stream_give(s, a, text): Puts an entry that lies behind the stream's place into the buffer, if the token may see it, and
 * moves the place on.  Returns false, with s as before, if there is no room, or if a request has all that it wants.
 *   text  event_text(); NULL: the entry is no event */
bool stream_give(struct events_stream *s, const struct store_audit_entry *a,
                 const char *text);

/* stream_put_place(s, comment): Puts the present id without data: a client that was sent nothing else goes on there.
 *   comment  line before it; "": none */
void stream_put_place(struct events_stream *s, const char *comment);

/* stream_covers(a, b): Returns true if place a is at or behind b in every log. */
bool stream_covers(const struct store_audit_place *a, const struct store_audit_place *b);

/* stream_pass(p, q): Moves p on to q in every log in which q lies behind. */
void stream_pass(struct store_audit_place *p, const struct store_audit_place *q);

/* stream_judge(s, t): Sets the end of the secret by the present row of the token: a rotation leaves the secret valid for a
 * while, a second one does not. */
void stream_judge(struct events_stream *s, const struct store_token *t);

/* stream_end(s): Ends the response after the buffer. */
void stream_end(struct events_stream *s);

/* stream_take(s, to, max): Is events_read() without the guard. */
ssize_t stream_take(struct events_stream *s, char *to, size_t max);

/* stream_respond(s, valid, failed): Sets the response of a request that waits.
 *   valid   its token still is
 *   failed  the log cannot be read */
void stream_respond(struct events_stream *s, bool valid, bool failed);

#endif
