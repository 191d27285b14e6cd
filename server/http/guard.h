/* guard.h -- how many connections there may be, in all and from one address, and how long
 * each may take over what it does.  libmicrohttpd's own timeout starts again with every byte,
 * so a client that sends or reads one now and then could stay for ever; here each step of a
 * request has a deadline.  A thread shuts down the sockets that are past theirs, and
 * libmicrohttpd then closes them as if the client had gone.  It also notices clients that go
 * while the daemon works for them: libmicrohttpd does not watch their sockets meanwhile. */
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
    unsigned connections; /* in all */
    unsigned per_address; /* 0: no limit; an IPv6 address counts by its first 64 bits */
    bool local_too;       /* per_address is for loopback addresses, too */
    unsigned timeout_s;
    unsigned waiting; /* sockets that are not counted yet: those of proxies (proxy.h) */
};

/* A body or a response may take timeout_s, and a second more for each GUARD_BYTES_PER_S that were
 * transferred; no more than timeout_s is saved up: a client that sends much and then nothing is
 * closed like others. */
#define GUARD_BYTES_PER_S 8192.0
/* A body as a whole may take this many times timeout_s: with 10 s and 64 MB that is 1.8 Mbit/s. */
#define GUARD_BODY_FACTOR 30
/* An open connection without a request is kept this many times timeout_s. */
#define GUARD_IDLE_FACTOR 3

enum guard_step {
    GUARD_REQUEST, /* the first: TLS's handshake and the headers, in timeout_s */
    GUARD_IDLE,    /* between two requests */
    GUARD_HEADERS, /* of a further request */
    GUARD_BODY,
    GUARD_WORK, /* ours: takes what it takes */
    GUARD_RESPONSE,
    GUARD_NSTEPS
};

struct guard_state {
    unsigned open;               /* connections now */
    uint64_t refused_total;      /* closed at once: too many in all */
    uint64_t refused_address;    /* too many from one address */
    uint64_t late[GUARD_NSTEPS]; /* closed past a deadline, by step */
    uint64_t crowded_out;        /* closed to make room for a new one */
    uint64_t gone; /* clients that went while they sent a body or were worked for */
    uint64_t proxy_header; /* closed before they began: guard_note_header() */
};

/* guard_start(rules, out, e): the limit of open files is raised to what is needed; where that
 * is not allowed there are fewer connections, and the log says so.
 * Returns ST_OK or ST_ENOMEM. */
enum status guard_start(const struct guard_rules *rules, struct guard **out,
                        struct errinfo *e);

/* guard_admit(l, addr): may a connection from there be taken?  O(connections).  Where there are
 * too many in all, one that has no whole request is closed to make room: the oldest of the
 * address that has most of them, and for another of that address only after a second.
 * addr: of any family; NULL as for a Unix socket. */
bool guard_admit(struct guard *l, const struct sockaddr *addr);

/* guard_open(l, fd, addr): a connection begins, with GUARD_REQUEST.  fd is borrowed until
 * guard_close(), which must come before it is closed.  NULL: out of memory. */
struct guard_peer *guard_open(struct guard *l, int fd, const struct sockaddr *addr);
void guard_close(struct guard *l, struct guard_peer *p);

/* guard_begin(l, p, step): from now on p is at step, and its time begins; GUARD_HEADERS
 * after GUARD_REQUEST changes nothing. */
void guard_begin(struct guard *l, struct guard_peer *p, enum guard_step step);

/* guard_more(l, p, bytes): the step has transferred bytes more bytes. */
void guard_more(struct guard *l, struct guard_peer *p, size_t bytes);

/* guard_work(l, p, gone, arg): GUARD_WORK begins; gone(arg) is called once, on the guard's
 * thread and before the next guard_begin() of p returns, if the client goes meanwhile: if it
 * resets the connection, or has closed its side once the work has taken 2 s.  gone must not call
 * the guard. */
void guard_work(struct guard *l, struct guard_peer *p, void (*gone)(void *arg),
                void *arg);

/* guard_linger(l, fd): fd, non-blocking, is the guard's from now on: closed when its client has
 * closed it, or in 2 s; with too many of them at once (RFC 9112 section 9.6).  A socket that is
 * closed with unread bytes in it is reset, and a client that is still sending may lose the response
 * that it has not read yet. */
void guard_linger(struct guard *l, int fd);

/* guard_note_header(l): a proxy's connection was closed because of its header (proxy.h). */
void guard_note_header(struct guard *l);

void guard_look(struct guard *l, struct guard_state *out);

void guard_stop(struct guard *l); /* when no connection is left; NULL is allowed */

#endif
