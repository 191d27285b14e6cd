#define _DEFAULT_SOURCE /* SO_ATTACH_FILTER */
#include "backlog.h"

#include <linux/filter.h>
#include <poll.h>
#include <stdint.h>
#include <sys/socket.h>
#include <time.h>

#include "logger.h"

#define SETTLE_MS 50.0 /* for handshakes that are half done */

/* TCP's flags are at byte 13 of its header: drop a segment with SYN and without ACK. */
static struct sock_filter no_syn[] = {
    BPF_STMT(BPF_LD | BPF_B | BPF_ABS, 13),
    BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0x12), /* SYN, ACK */
    BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x02, 0, 1),
    BPF_STMT(BPF_RET | BPF_K, 0), /* drop */
    BPF_STMT(BPF_RET | BPF_K, UINT32_MAX),
};

void backlog_empty(int fd, double ms)
{
    const struct sock_fprog program = {sizeof no_syn / sizeof *no_syn, no_syn};
    const struct timespec pause = {0, 5 * 1000 * 1000};
    const double end = logger_clock_ms() + ms;
    double busy = logger_clock_ms();
    struct pollfd p = {.fd = fd, .events = POLLIN};

    /* Without the filter, which a kernel may lack, a new connection may still be reset. */
    (void)setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program);
    for (double now = busy; now < end && now < busy + SETTLE_MS;
         now = logger_clock_ms()) {
        if (poll(&p, 1, 0) > 0)
            busy = now;
        (void)nanosleep(&pause, NULL);
    }
}
