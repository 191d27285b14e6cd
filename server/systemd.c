#include "systemd.h"

#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <time.h>
#include <unistd.h>
#include <systemd/sd-daemon.h>

#include "errinfo.h"

/* The signals that systemd_wait() waits for. */
static void waited_for(sigset_t *set)
{
    (void)sigemptyset(set);
    (void)sigaddset(set, SIGTERM);
    (void)sigaddset(set, SIGINT);
    (void)sigaddset(set, SIGHUP);
}

void systemd_begin(void)
{
    sigset_t set;

    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN); /* a file at its limit is an error of write() */
    waited_for(&set);
    (void)pthread_sigmask(SIG_BLOCK, &set, NULL);
}

bool systemd_pause(unsigned ms)
{
    const struct timespec pause = {ms / 1000, (long)(ms % 1000) * 1000000};
    sigset_t set;
    int sig;

    waited_for(&set);
    sig = sigtimedwait(&set, NULL, &pause);
    return sig == SIGTERM || sig == SIGINT;
}

void systemd_ready(const char *url)
{
    (void)sd_notifyf(0, "READY=1\nSTATUS=listening on %s", url);
}

static void reload(const struct systemd_hooks *hooks)
{
    struct timespec now;

    /* The time is for Type=notify-reload: it tells this reload from one before. */
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    (void)sd_notifyf(0, "RELOADING=1\nMONOTONIC_USEC=%lld",
                     (long long)now.tv_sec * 1000000 + now.tv_nsec / 1000);
    hooks->reload(hooks->arg);
    (void)sd_notify(0, "READY=1");
}

int systemd_wait(const struct systemd_hooks *hooks)
{
    struct timespec pause = {60, 0};
    uint64_t watchdog_us = 0;
    const bool watched = sd_watchdog_enabled(0, &watchdog_us) > 0;
    sigset_t set;
    int sig;

    waited_for(&set);
    if (watched) {
        pause.tv_sec = (time_t)(watchdog_us / 2000000);
        pause.tv_nsec = (long)(watchdog_us / 2 % 1000000 * 1000);
    }
    for (;;) {
        if (watched && hooks->healthy(hooks->arg))
            (void)sd_notify(0, "WATCHDOG=1");
        sig = sigtimedwait(&set, NULL, &pause);
        if (sig == SIGHUP) {
            reload(hooks);
        } else if (sig > 0) {
            (void)sd_notify(0, "STOPPING=1");
            return sig;
        }
    }
}
