/* manager -- for the tests: runs a program as a service manager would.
 *   manager NOTES [--socket] [--watchdog USEC] COMMAND...
 * The program's notifications are appended to the file NOTES, one line each (line breaks
 * become spaces).  --socket: the program gets a socket that listens on 127.0.0.1.  It is
 * started by exec() and has this process's id. */
#include <netinet/in.h>
#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#define PASSED 3 /* the first descriptor that is passed, by sd_listen_fds(3) */

static void fail(const char *what)
{
    perror(what);
    exit(1);
}

/* Writes the messages to the file until the program has ended. */
static void take_notes(int from, const char *path, pid_t program)
{
    const struct timeval wait = {.tv_usec = 100000};
    FILE *notes = fopen(path, "a");
    char text[1000];
    ssize_t n;

    if (notes == NULL ||
        setsockopt(from, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait) != 0)
        fail(path);
    while ((n = recv(from, text, sizeof text - 1, 0)) >= 0 || getppid() == program) {
        if (n < 0)
            continue;
        text[n] = '\0';
        for (char *c = text; (c = strchr(c, '\n')) != NULL;)
            *c = ' ';
        (void)fprintf(notes, "%s\n", text);
        (void)fflush(notes);
    }
    exit(0);
}

static void open_notes(const char *path)
{
    struct sockaddr_un un = {.sun_family = AF_UNIX};
    const pid_t me = getpid();
    pid_t child;
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);

    if (snprintf(un.sun_path, sizeof un.sun_path, "%s.socket", path) >=
        (int)sizeof un.sun_path)
        fail("a path that is too long");
    (void)unlink(un.sun_path);
    if (fd < 0 || bind(fd, (const struct sockaddr *)&un, sizeof un) != 0)
        fail(un.sun_path);
    if ((child = fork()) < 0)
        fail("fork");
    if (child == 0)
        take_notes(fd, path, me);
    (void)close(fd);
    if (setenv("NOTIFY_SOCKET", un.sun_path, 1) != 0)
        fail("setenv");
}

static void pass_socket(void)
{
    struct sockaddr_in in = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    char pid[24];
    int fd = socket(AF_INET, SOCK_STREAM, 0);

    (void)snprintf(pid, sizeof pid, "%ld", (long)getpid());
    if (fd < 0 || bind(fd, (const struct sockaddr *)&in, sizeof in) != 0 ||
        listen(fd, 100) != 0 || (fd != PASSED && dup2(fd, PASSED) < 0) ||
        (fd != PASSED && close(fd) != 0) || setenv("LISTEN_FDS", "1", 1) != 0 ||
        setenv("LISTEN_PID", pid, 1) != 0)
        fail("a socket to pass");
}

int main(int argc, char **argv)
{
    char **command = argv + 2;

    if (argc < 3) {
        (void)fputs("manager NOTES [--socket] [--watchdog USEC] COMMAND...\n", stderr);
        return 2;
    }
    open_notes(argv[1]);
    if (strcmp(*command, "--socket") == 0) {
        pass_socket();
        command++;
    }
    if (*command != NULL && strcmp(*command, "--watchdog") == 0) {
        if (command[1] == NULL || setenv("WATCHDOG_USEC", command[1], 1) != 0)
            fail("--watchdog");
        command += 2;
    }
    if (*command != NULL)
        (void)execvp(*command, command);
    fail("the command");
    return 1;
}
