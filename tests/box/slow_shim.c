/* slow_shim -- loaded into a program (LD_PRELOAD): waits before a listening socket is removed from an
 * epoll set: the main thread 0.3 s, other threads 0.6 s.  The main thread's next steps are done by then. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

static int listens(int fd)
{
    int yes = 0;
    socklen_t len = sizeof yes;

    return getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &yes, &len) == 0 && yes;
}

int epoll_ctl(int set, int what, int fd, struct epoll_event *ev)
{
    const struct timespec pause = {0, gettid() == getpid() ? 300000000 : 600000000};
    int (*real)(int, int, int, struct epoll_event *);
    void *symbol = dlsym(RTLD_NEXT, "epoll_ctl");

    memcpy(&real, &symbol, sizeof real);
    if (what == EPOLL_CTL_DEL && listens(fd))
        (void)nanosleep(&pause, NULL);
    return real(set, what, fd, ev);
}
