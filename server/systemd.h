/* systemd.h -- the daemon's life by signals and by the protocol of a service manager
 * (systemd's sd_notify(3), its watchdog, sockets that it passes).  Without one, the signals
 * alone work.  From the main thread. */
#ifndef SERVER_SYSTEMD_H
#define SERVER_SYSTEMD_H
#include <stdbool.h>
#include "status.h"

struct errinfo;

/* What systemd_wait() calls, with arg. */
struct systemd_hooks {
    void (*reload)(void *arg);  /* on SIGHUP */
    bool (*healthy)(void *arg); /* false: the watchdog is not notified */
    void (*hourly)(void *arg);  /* at first, and then every hour */
    void *arg;
};

/* systemd_begin(): block the signals that systemd_wait() waits for, in this thread and those
 * that it will start, and ignore those that are errors of write(). */
void systemd_begin(void);

/* systemd_ready(url): the start is over, what it serves is at url. */
void systemd_ready(const char *url);

/* systemd_pause(ms): waits so long.  true: SIGTERM or SIGINT came. */
bool systemd_pause(unsigned ms);

/* systemd_wait(hooks): until SIGTERM or SIGINT, which it returns; the manager knows then that
 * the daemon stops.  Meanwhile SIGHUP reloads, and a healthy daemon notifies the
 * watchdog twice in each of its periods. */
int systemd_wait(const struct systemd_hooks *hooks);

#endif
