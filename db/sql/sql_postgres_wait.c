#include "sql_postgres.h"

#include <errno.h>
#include <poll.h>
#include <time.h>

int64_t sql_postgres_wait_clock(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

/* Sends what the socket takes, waits once, and reads what has come.  Returns false if the connection is
 * lost, or `until` has passed. */
static bool sql_postgres_wait_step(PGconn *pg, int64_t until)
{
    const int unsent = PQflush(pg);
    struct pollfd fd = {.fd = PQsocket(pg),
                        .events = (short)(unsent > 0 ? POLLIN | POLLOUT : POLLIN)};
    const int64_t left = until - sql_postgres_wait_clock();
    int n;

    if (unsent < 0 || left <= 0)
        return false;
    n = poll(&fd, 1, (int)left);
    if (n < 0)
        return errno == EINTR;
    return n == 0 || (fd.revents & ~POLLOUT) == 0 || PQconsumeInput(pg) == 1;
}

bool sql_postgres_wait(PGconn *pg, int64_t until)
{
    while (PQisBusy(pg))
        if (!sql_postgres_wait_step(pg, until))
            return false;
    return true;
}

bool sql_postgres_wait_sent(PGconn *pg, int64_t until)
{
    int unsent;

    while ((unsent = PQflush(pg)) > 0)
        if (!sql_postgres_wait_step(pg, until))
            return false;
    return unsent == 0;
}
