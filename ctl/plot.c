#include "plot.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* gnuplot with its standard input, output and error; 0 or an errno. */
static int start(const int in[2], int out, int err, pid_t *pid)
{
    static char name[] = "gnuplot", defaults[] = "--default-settings"; /* no ~/.gnuplot */
    char *argv[] = {name, defaults, NULL};
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attr;
    sigset_t pipes;
    int why = posix_spawn_file_actions_init(&files);

    if (why != 0)
        return why;
    if ((why = posix_spawnattr_init(&attr)) != 0) {
        (void)posix_spawn_file_actions_destroy(&files);
        return why;
    }
    (void)sigemptyset(&pipes);
    (void)sigaddset(&pipes, SIGPIPE);
    if ((why = posix_spawn_file_actions_adddup2(&files, in[0], STDIN_FILENO)) == 0 &&
        (why = posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO)) == 0 &&
        (why = posix_spawn_file_actions_adddup2(&files, err, STDERR_FILENO)) == 0 &&
        (why = posix_spawnattr_setsigdefault(&attr, &pipes)) == 0 &&
        (why = posix_spawnattr_setflags(&attr, POSIX_SPAWN_SETSIGDEF)) == 0)
        why = posix_spawnp(pid, name, &files, &attr, argv, environ);
    (void)posix_spawnattr_destroy(&attr);
    (void)posix_spawn_file_actions_destroy(&files);
    return why;
}

/* The last line of what gnuplot complained that says anything. */
static void complaint(FILE *err, char *text, size_t room)
{
    char line[160];
    size_t blank;

    (void)snprintf(text, room, "it did not say why");
    rewind(err);
    while (fgets(line, sizeof line, err) != NULL) {
        line[strcspn(line, "\n")] = '\0';
        blank = strspn(line, " \t^");
        if (line[blank] != '\0')
            (void)snprintf(text, room, "%s", line + blank);
    }
}

static enum status finish(pid_t pid, FILE *err, struct errinfo *e)
{
    char text[160];
    int status;

    while (waitpid(pid, &status, 0) < 0)
        if (errno != EINTR)
            return errinfo_set(e, ST_EIO, "gnuplot: %s", strerror(errno));
    if (WIFSIGNALED(status))
        return errinfo_set(e, ST_EIO, "gnuplot was ended by signal %d", WTERMSIG(status));
    if (WEXITSTATUS(status) == 0)
        return ST_OK;
    complaint(err, text, sizeof text);
    return errinfo_set(e, ST_EINVAL, "gnuplot: %s", text);
}

enum status plot_run(int out, void (*script)(FILE *to, const void *arg), const void *arg,
                     struct errinfo *e)
{
    struct sigaction ignore = {.sa_handler = SIG_IGN}, before;
    FILE *err = tmpfile(),
         *to = NULL; /* a file, not a pipe: it never has to be drained */
    int in[2] = {-1, -1}, why = 0;
    enum status st = ST_OK;
    pid_t pid;

    (void)sigaction(SIGPIPE, &ignore, &before);
    if (err == NULL || pipe(in) != 0 || fcntl(in[0], F_SETFD, FD_CLOEXEC) != 0 ||
        fcntl(in[1], F_SETFD, FD_CLOEXEC) != 0 || (to = fdopen(in[1], "w")) == NULL)
        why = errno;
    else
        why = start(in, out, fileno(err), &pid);
    if (why == ENOENT)
        st = errinfo_set(e, ST_ENOTFOUND, "gnuplot is not installed (gnuplot-nox)");
    else if (why != 0)
        st = errinfo_set(e, ST_EIO, "gnuplot: %s", strerror(why));
    if (in[0] >= 0)
        (void)close(in[0]);
    if (st == ST_OK)
        script(to, arg);
    if (to != NULL)
        (void)fclose(
            to); /* the end of the script; EPIPE shows in gnuplot's exit status */
    else if (in[1] >= 0)
        (void)close(in[1]);
    if (st == ST_OK)
        st = finish(pid, err, e);
    if (err != NULL)
        (void)fclose(err);
    (void)sigaction(SIGPIPE, &before, NULL);
    return st;
}
