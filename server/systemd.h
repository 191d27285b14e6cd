/* systemd.h -- the signals of the daemon, and the protocol of a service manager: systemd's sd_notify(3), its
 * watchdog, and sockets that it passes.  Without a service manager only the signals work.  From the main
 * thread. */
#ifndef SERVER_SYSTEMD_H
#define SERVER_SYSTEMD_H
#include <stdbool.h>

/* What systemd_wait() calls, with arg. */
struct systemd_hooks {
    void (*reload)(void *arg);  /* on SIGHUP */
    bool (*healthy)(void *arg); /* false: the watchdog is not notified */
    void *arg;
};

/* systemd_begin(): Blocks the signals of systemd_wait() in this thread and in those that it starts, and
 * ignores the signals that are errors of write(). */
void systemd_begin(void);

/* systemd_ready(url): Tells the service manager that the daemon serves at url. */
void systemd_ready(const char *url);

/* systemd_pause(ms): Waits for ms.  Returns true if SIGTERM or SIGINT came. */
bool systemd_pause(unsigned ms);

/* systemd_wait(hooks): Waits for SIGTERM or SIGINT, tells the service manager that the daemon stops, and
 * returns the signal.  Until then SIGHUP reloads, and a healthy daemon notifies the watchdog twice in each
 * of its periods. */
int systemd_wait(const struct systemd_hooks *hooks);

#endif
