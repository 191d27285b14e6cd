/* service.h -- the daemon's life by signals and by the protocol of a service manager
 * (systemd's sd_notify(3), its watchdog, sockets that it passes).  Without one, the signals
 * alone work.  From the main thread. */
#ifndef SERVER_SERVICE_H
#define SERVER_SERVICE_H
#include <stdbool.h>
#include "status.h"

struct errinfo;

/* What service_wait() calls, with arg. */
struct service_hooks {
    void (*reload)(void *arg);  /* on SIGHUP */
    bool (*healthy)(void *arg); /* false: the watchdog is not notified */
    void (*hourly)(void *arg);  /* at first, and then every hour */
    void *arg;
};

/* service_begin(): block the signals that service_wait() waits for, in this thread and those
 * that it will start, and ignore those that are errors of write(). */
void service_begin(void);

/* service_ready(url): the start is over, what it serves is at url. */
void service_ready(const char *url);

/* service_pause(ms): waits so long.  true: SIGTERM or SIGINT came. */
bool service_pause(unsigned ms);

/* service_wait(hooks): until SIGTERM or SIGINT, which it returns; the manager knows then that
 * the daemon stops.  Meanwhile SIGHUP reloads, and a healthy daemon notifies the
 * watchdog twice in each of its periods. */
int service_wait(const struct service_hooks *hooks);

#endif
