/* guard.h -- limits the number of connections, in all and from one address, and the time of each step of a
 * request.  libmicrohttpd's own timeout starts again with every byte: a client that sends or reads one byte
 * now and then would stay for ever.  A thread shuts down the sockets that are past their deadline;
 * libmicrohttpd then closes them as if the client had disconnected.  The thread also notices clients that
 * disconnect during the work on their request, when libmicrohttpd does not watch their sockets. */
#ifndef SERVER_GUARD_H
#define SERVER_GUARD_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct guard;
struct guard_peer; /* a connection */
struct sockaddr;

struct guard_rules {
    unsigned connections; /* limit in all */
    unsigned per_address; /* limit of one address (address_key()); 0: no limit */
    bool local_too;       /* per_address holds for loopback addresses too */
    unsigned timeout_s;   /* time of a step, s */
    unsigned waiting;     /* connections of proxies that do not count yet (proxy.h) */
};

/* A body or a response may take timeout_s, and a second more for each GUARD_BYTES_PER_S that were
 * transferred.  The time left never exceeds timeout_s: a client that sends much and then nothing is closed
 * like all others. */
#define GUARD_BYTES_PER_S 8192.0
/* A body as a whole may take this many times timeout_s: with 10 s and 64 MB that is 1.8 Mbit/s. */
#define GUARD_BODY_FACTOR 30
/* An open connection without a request is kept this many times timeout_s, and an endless response of which the client
 * takes nothing. */
#define GUARD_IDLE_FACTOR 3

enum guard_step {
    GUARD_REQUEST, /* the first request: TLS's handshake and the headers, in timeout_s */
    GUARD_IDLE,    /* between two requests */
    GUARD_HEADERS, /* headers of a further request */
    GUARD_BODY,
    GUARD_WORK, /* work of the daemon: no deadline */
    GUARD_RESPONSE,
    GUARD_STREAM, /* a response without an end, while there is something to be sent */
    GUARD_NSTEPS
};

struct guard_state {
    unsigned open;               /* connections now */
    uint64_t refused_total;      /* connections refused by the limit in all */
    uint64_t refused_address;    /* connections refused by the limit of an address */
    uint64_t late[GUARD_NSTEPS]; /* connections closed past a deadline, by step */
    uint64_t crowded_out;        /* connections closed to make room for a new one */
    uint64_t gone; /* clients that disconnected during their body or the work on it */
    uint64_t proxy_header; /* calls of guard_note_header() */
};

/* guard_start(rules, out, e): Starts the thread, and raises the limit of open files as far as needed.  If that
 * is not allowed, lowers rules->connections and logs it.  Returns ST_OK or ST_ENOMEM. */
enum status guard_start(const struct guard_rules *rules, struct guard **out,
                        struct errinfo *e);

/* guard_admit(l, addr): Returns true if the daemon may accept a connection from addr.  If there are too many in
 * all, closes a connection without a complete request to make room: the oldest one of the address that has most of
 * them.  For a connection of the same address it does so only after a second.  Cost: O(connections).
 *   addr  any family; NULL: a Unix socket */
bool guard_admit(struct guard *l, const struct sockaddr *addr);

/* guard_open(l, fd, addr): Returns a new connection, at GUARD_REQUEST.  NULL: out of memory.
 *   fd  borrowed until guard_close() */
struct guard_peer *guard_open(struct guard *l, int fd, const struct sockaddr *addr);

/* guard_close(p): Removes p.  Its fd must still be open. */
void guard_close(struct guard_peer *p);

/* guard_begin(p, step): Begins a step and its time.  GUARD_HEADERS after GUARD_REQUEST changes nothing. */
void guard_begin(struct guard_peer *p, enum guard_step step);

/* guard_more(p, bytes): Records that the step has transferred more bytes. */
void guard_more(struct guard_peer *p, size_t bytes);

/* guard_work(p, gone, arg): Begins GUARD_WORK.  Calls gone(arg) once, on the guard's thread and before the next
 * guard_begin() of p returns, if the client resets the connection, or has closed its side after 2 s of work.
 * gone() must not call the guard. */
void guard_work(struct guard_peer *p, void (*gone)(void *arg), void *arg);

/* guard_linger(l, fd): Takes ownership of fd, and closes it when the client has closed its side, after 2 s, or at
 * once if too many linger (RFC 9112 section 9.6).  Closing a socket with unread bytes resets the connection, and a client that is still
 * sending could lose the response.
 *   fd  non-blocking */
void guard_linger(struct guard *l, int fd);

/* guard_note_header(l): Counts a connection of a proxy that was closed because of its header (proxy.h). */
void guard_note_header(struct guard *l);

/* guard_look(l, out): Copies the counters. */
void guard_look(struct guard *l, struct guard_state *out);

/* guard_stop(l): Stops the thread; no connection is left.  NULL is allowed. */
void guard_stop(struct guard *l);

#endif
