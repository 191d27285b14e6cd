/* listen.h -- the socket that the daemon listens on. */
#ifndef SERVER_LISTEN_H
#define SERVER_LISTEN_H
#include <stdbool.h>
#include <sys/socket.h>
#include <sys/types.h>
#include "status.h"

struct errinfo;
struct options;

struct listen_socket {
    int fd;                     /* -1: none */
    struct sockaddr_storage ss; /* with the port that was got */
    socklen_t len;
    dev_t device; /* of a Unix socket's file, so that no other's is removed */
    ino_t inode;
    bool passed; /* another's, who goes on listening when it is closed here */
};

/* listen_start(o, s, e): the socket that a service manager passed, or one at the address of the
 * options: bound, listening, non-blocking; nothing is accepted yet.  A Unix socket gets the mode
 * 0660; a file of its name is replaced only if it is a socket that nobody listens on any more.
 * ST_EIO, ST_EINVAL: the message says why, and s->fd is -1. */
enum status listen_start(const struct options *o, struct listen_socket *s,
                         struct errinfo *e);

/* listen_end(s): who connects from now on is refused, but where the socket was passed: there they
 * wait for the next process that accepts.  A Unix socket's file is removed, if it is still the one
 * that was made.  s->fd stays open, for a thread that may still be using it. */
void listen_end(struct listen_socket *s);

/* listen_close(s): listen_end(), and s->fd is closed: no thread uses it any more.  Closing twice is
 * allowed. */
void listen_close(struct listen_socket *s);

#endif
