#include "ctl.h"

#include <pwd.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cloudwrite.h"
#include "outfile.h"
#include "store.h"

enum status ctl_usage(struct ctl *c, const char *fmt, ...)
{
    va_list args;

    c->code = EXIT_USAGE;
    c->e.code = ST_EINVAL;
    va_start(args, fmt);
    (void)vsnprintf(c->e.msg, sizeof c->e.msg, fmt, args);
    va_end(args);
    return ST_EINVAL;
}

const char *ctl_actor(void)
{
    static char actor[STORE_NAME_MAX + 1];
    const struct passwd *const user = getpwuid(getuid());
    const char *name = user != NULL ? user->pw_name : "";
    const size_t len = strlen(name), room = sizeof actor - sizeof "surfacectl:";
    size_t plain = 0;

    while (name[plain] >= ' ' && name[plain] <= '~')
        plain++;
    if (len > 0 && len <= room && plain == len)
        (void)snprintf(actor, sizeof actor, "surfacectl:%s", name);
    else
        (void)snprintf(actor, sizeof actor, "surfacectl:%u", (unsigned)getuid());
    return actor;
}

enum status ctl_confirm(struct ctl *c, const char *what, const char *word)
{
    char line[STORE_SUBJECT_MAX + 8] = "";
    const bool terminal = isatty(STDIN_FILENO) == 1;

    if (c->yes)
        return ST_OK;
    if (terminal) {
        (void)fprintf(stderr, "This %s.\nType %s to continue: ", what, word);
        if (fgets(line, sizeof line, stdin) != NULL) {
            line[strcspn(line, "\r\n")] = '\0';
            if (strcmp(line, word) == 0)
                return ST_OK;
        }
    }
    c->code = EXIT_USAGE;
    return errinfo_set(
        &c->e, ST_EDENIED,
        "not done: this %.160s. Use --yes, or type \"%.40s\" on a terminal", what, word);
}

const char *ctl_bytes(uint64_t n, char out[32])
{
    static const char *const unit[] = {"bytes", "kB", "MB", "GB", "TB"};
    double v = (double)n;
    int i = 0;

    for (; v >= 1000 && i < 4; i++)
        v /= 1000;
    (void)snprintf(out, 32, "%.*f %s", i == 0 ? 0 : 1, v, unit[i]);
    return out;
}

void ctl_say(const struct ctl *c, const char *fmt, ...)
{
    va_list args;

    if (c->json)
        return;
    va_start(args, fmt);
    (void)vfprintf(c->piped ? stderr : stdout, fmt, args);
    va_end(args);
}

/* ---- files */

/* None of the shared options' files, nor what belongs to the database. */
static enum status not_shared(struct ctl *c, const char *path)
{
    static const char *const beside[] = {"-wal", "-shm", ".key", ".key.anchor",
                                         ".anchor"};
    const char *const given[] = {c->db,     c->config,     c->key,
                                 c->anchor, c->model_path, c->archive_key};
    char name[PATH_MAX];
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && i < sizeof given / sizeof *given; i++)
        st = outfile_not_read(path, given[i], &c->e);
    for (size_t i = 0; st == ST_OK && i < 2 * sizeof beside / sizeof *beside; i++) {
        const char *const of = i % 2 == 0 ? c->db : c->key;

        (void)snprintf(name, sizeof name, "%s%s", of != NULL ? of : "", beside[i / 2]);
        st = outfile_not_read(path, of != NULL ? name : NULL, &c->e);
    }
    return st;
}

static bool is_standard(const char *path)
{
    return strcmp(path, "-") == 0;
}

enum status ctl_may_write(struct ctl *c, const char *path, int nread)
{
    enum status st = ST_OK;

    if (is_standard(path))
        return ctl_usage(c,
                         "%s cannot write to standard output: name a file (./- is one)",
                         c->command);
    for (int i = 0; st == ST_OK && i < nread; i++)
        st = outfile_not_read(path, c->args[i], &c->e);
    if (st == ST_OK)
        st = not_shared(c, path);
    return st == ST_OK ? outfile_may(path, c->force, &c->e) : st;
}

enum status ctl_may_pipe(struct ctl *c, int nread)
{
    if (!is_standard(c->dir))
        return ctl_may_write(c, c->dir, nread);
    if (c->json)
        return ctl_usage(c,
                         "--out - and --json both write to standard output: name a file");
    c->piped = true;
    return ST_OK;
}

enum status ctl_write(struct ctl *c, const char *path, newfile_writer *write,
                      const void *arg)
{
    return outfile_write(c->piped ? NULL : path, c->force, write, arg, &c->e);
}

enum status ctl_write_face(struct ctl *c, const char *path, const struct surface_face *f)
{
    return ctl_write(c, path, cloudwrite_ply, f);
}
