/* config: the daemon's settings.  They are the daemon's to read: it is asked, so that what is
 * said here is what it would do. */
#include <errno.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ctl.h"

#define ANSWER_MAX (1 << 16) /* bytes; it has a line or two for each setting */

/* Where systemd keeps what LoadCredential= gives to the service: for who is not it. */
#define CREDENTIALS       "CREDENTIALS_DIRECTORY"
#define CREDENTIALS_USUAL "/run/credentials/surfaced.service"
#define CREDENTIAL        "credential:"

extern char **environ;

/* The daemon that was installed or built with this program. */
static bool find_daemon(char path[PATH_MAX])
{
    static const char *const places[] = {"/surfaced", "/../sbin/surfaced"};
    char dir[PATH_MAX];
    const ssize_t n = readlink("/proc/self/exe", dir, sizeof dir - 1);

    if (n <= 0)
        return false;
    dir[n] = '\0';
    *strrchr(dir, '/') = '\0';
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        if (snprintf(path, PATH_MAX, "%s%s", dir, places[i]) < PATH_MAX &&
            access(path, X_OK) == 0)
            return true;
    return false;
}

/* All that comes until it is closed, as a text. */
static enum status read_all(int fd, char **out, struct errinfo *e)
{
    char *text = malloc(ANSWER_MAX);
    size_t n = 0;
    ssize_t got;

    if (text == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    while (n < ANSWER_MAX - 1 && ((got = read(fd, text + n, ANSWER_MAX - 1 - n)) > 0 ||
                                  (got < 0 && errno == EINTR)))
        n += got > 0 ? (size_t)got : 0;
    text[n] = '\0';
    *out = text;
    return ST_OK;
}

/* What the daemon answers to an option, on either stream, to be freed; *good: it is content
 * with its settings. */
static enum status ask(struct ctl *c, const char *option, char **text, bool *good)
{
    char path[PATH_MAX], name[] = "surfaced", config[] = "--config", what[32];
    char *argv[] = {name, what, c->config != NULL ? config : NULL, NULL, NULL};
    posix_spawn_file_actions_t actions;
    enum status st = ST_OK;
    int fd[2], rc, how = 0;
    pid_t pid;

    *text = NULL;
    if (!find_daemon(path))
        return errinfo_set(&c->e, ST_ENOTFOUND,
                           "there is no surfaced beside surfacectl, to say its settings");
    (void)setenv(CREDENTIALS, CREDENTIALS_USUAL, 0);
    (void)snprintf(what, sizeof what, "%s", option);
    if (c->config != NULL && (argv[3] = strdup(c->config)) == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if (pipe(fd) != 0 || posix_spawn_file_actions_init(&actions) != 0) {
        free(argv[3]);
        return errinfo_set(&c->e, ST_EIO, "cannot ask surfaced: %s", strerror(errno));
    }
    (void)posix_spawn_file_actions_adddup2(&actions, fd[1], STDOUT_FILENO);
    (void)posix_spawn_file_actions_adddup2(&actions, fd[1], STDERR_FILENO);
    (void)posix_spawn_file_actions_addclose(&actions, fd[0]);
    (void)posix_spawn_file_actions_addclose(&actions, fd[1]);
    rc = posix_spawn(&pid, path, &actions, NULL, argv, environ);
    (void)close(fd[1]);
    if (rc == 0) {
        st = read_all(fd[0], text, &c->e);
        (void)close(fd[0]);
        while (waitpid(pid, &how, 0) < 0 && errno == EINTR)
            continue;
    } else {
        (void)close(fd[0]);
        st = errinfo_set(&c->e, ST_EIO, "cannot run %.160s: %s", path, strerror(rc));
    }
    *good = WIFEXITED(how) && WEXITSTATUS(how) == 0;
    (void)posix_spawn_file_actions_destroy(&actions);
    free(argv[3]);
    return st;
}

/* A problem as the daemon says it, without its name. */
static const char *problem(const char *line)
{
    static const char name[] = "surfaced: ";

    return strncmp(line, name, strlen(name)) == 0 ? line + strlen(name) : line;
}

/* The setting of a line "name = value", where it has one: name and value, cut in place. */
static bool read_setting(char *line, char **name, char **value)
{
    char *equals = strstr(line, " = ");

    if (line[0] == '#' || equals == NULL)
        return false;
    *equals = '\0';
    *name = line;
    *value = equals + 3;
    return true;
}

/* The file of the key, which may be named as a credential. */
static const char *key_file(struct ctl *c, const char *value)
{
    const char *name = value + strlen(CREDENTIAL);

    if (strncmp(value, CREDENTIAL, strlen(CREDENTIAL)) != 0)
        return value;
    (void)snprintf(c->credential, sizeof c->credential, "%s/%s", getenv(CREDENTIALS),
                   name);
    return c->credential;
}

static enum status ask_all(struct ctl *c, bool model)
{
    char *name, *value, *rest = NULL;
    bool good = false;
    enum status st = ask(c, "--print-config", &c->settings, &good);

    if (st != ST_OK)
        return st;
    rest = c->settings;
    if (!good)
        return errinfo_set(&c->e, ST_EINVAL, "%.200s",
                           problem(strtok_r(rest, "\n", &rest)));
    for (char *line; (line = strtok_r(rest, "\n", &rest)) != NULL;) {
        if (!read_setting(line, &name, &value))
            continue;
        if (strcmp(name, "db") == 0 && c->db == NULL)
            c->db = value;
        else if (strcmp(name, "key") == 0 && c->key == NULL)
            c->key = key_file(c, value);
        else if (strcmp(name, "model") == 0 && c->model_path == NULL && model)
            c->model_path = value;
    }
    return ST_OK;
}

enum status ctl_config_database(struct ctl *c, bool model)
{
    const char *db = getenv("SURFACED_DB");
    char why[sizeof c->e.msg];

    if (c->db == NULL && c->config == NULL && db != NULL && db[0] != '\0')
        c->db = db;
    if ((c->db != NULL && c->config == NULL) || ask_all(c, model) == ST_OK)
        return ST_OK;
    memcpy(why, c->e.msg, sizeof why);
    return errinfo_set(&c->e, ST_EINVAL, "which database?  %.200s", why);
}

/* Before each setting stands in a comment where its value is from. */
static void out_settings(struct ctl *c, char *text)
{
    const char *from = "";
    char *name, *value, *rest = text;

    ctl_out_object(c->out, "settings");
    for (char *line; (line = strtok_r(rest, "\n", &rest)) != NULL;) {
        if (strncmp(line, "# ", 2) == 0)
            from = line + 2;
        if (!read_setting(line, &name, &value))
            continue;
        ctl_out_object(c->out, name);
        ctl_out_text(c->out, "value", value);
        ctl_out_text(c->out, "from", from);
        ctl_out_close(c->out);
    }
    ctl_out_close(c->out);
}

int ctl_config_show(struct ctl *c)
{
    char *text, *rest;
    bool good = false;
    enum status st = ask(c, "--print-config", &text, &good);

    if (st == ST_OK && !good) {
        rest = text;
        st = errinfo_set(&c->e, ST_ECORRUPT, "%.200s (surfacectl config check)",
                         problem(strtok_r(rest, "\n", &rest)));
    }
    if (st == ST_OK && !c->json)
        (void)fputs(text, stdout);
    if (st == ST_OK)
        out_settings(c, text);
    free(text);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_config_check(struct ctl *c)
{
    char *text, *rest;
    bool good = false;
    enum status st = ask(c, "--check-config", &text, &good);

    if (st != ST_OK) {
        free(text);
        return ctl_fail(c, st);
    }
    if (!c->json)
        (void)fputs(text, stdout);
    ctl_out_array(c->out, "problems");
    rest = text;
    for (char *line; !good && (line = strtok_r(rest, "\n", &rest)) != NULL;)
        ctl_out_text(c->out, NULL, problem(line));
    ctl_out_close(c->out);
    ctl_out_flag(c->out, "ok", good);
    free(text);
    return good ? EXIT_FINE : EXIT_NO;
}
