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
    struct sockaddr_storage ss; /* address, with the port that the kernel chose */
    socklen_t len;
    dev_t
        device; /* device and inode of a Unix socket's file: only this file is removed */
    ino_t inode;
    bool passed; /* a service manager passed it, and goes on listening */
};

/* listen_start(o, s, e): Takes the socket that a service manager passed, or opens one at the address of the
 * options.  The socket listens and is non-blocking.  A Unix socket gets the mode 0660; a file of its name is
 * replaced only if it is a socket that no process listens on.
 * ST_EIO, ST_EINVAL: the message says why, and s->fd is -1. */
enum status listen_start(const struct options *o, struct listen_socket *s,
                         struct errinfo *e);

/* listen_end(s): Stops listening: the kernel refuses new connections.  On a socket that the service manager
 * passed, they wait in the backlog until the next process accepts them.  Removes a Unix socket's file if it is still
 * the same file.  s->fd stays open for a thread that may be using it. */
void listen_end(struct listen_socket *s);

/* listen_close(s): Calls listen_end() and closes s->fd, which no thread uses any more.  Two calls are
 * allowed. */
void listen_close(struct listen_socket *s);

#endif
