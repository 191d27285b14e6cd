#include "ctl.h"

#include <pwd.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "store.h"
#include "dry_run.h"

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

int ctl_exit(const struct ctl *c, enum status st)
{
    static const int code[ST_COUNT] = {
        [ST_ENOMEM] = EXIT_OSERR,       [ST_ENOTFOUND] = EXIT_NOINPUT,
        [ST_EDENIED] = EXIT_NOPERM,     [ST_EREFUSED] = EXIT_NOPERM,
        [ST_EHELD] = EXIT_NOPERM,       [ST_EBUSY] = EXIT_TEMPFAIL,
        [ST_EIO] = EXIT_IOERR,          [ST_EDB] = EXIT_SOFTWARE,
        [ST_EINTERNAL] = EXIT_SOFTWARE,
    };

    return st == ST_OK || c->code == EXIT_USAGE ? c->code
           : code[st] != 0                      ? code[st]
                                                : EXIT_DATA;
}

const char *ctl_error_code(const struct ctl *c)
{
    static const char *const word[ST_COUNT] = {[ST_ENOMEM] = "out_of_memory",
                                               [ST_ESIZE] = "file_too_large",
                                               [ST_ECORRUPT] = "damaged",
                                               [ST_EVERSION] = "other_version",
                                               [ST_ENOTFOUND] = "not_found",
                                               [ST_EEXISTS] = "exists",
                                               [ST_EMISMATCH] = "sample_mismatch",
                                               [ST_EREPLAYED] = "replayed",
                                               [ST_EDENIED] = "forbidden",
                                               [ST_EREFUSED] = "database_refused",
                                               [ST_EHELD] = "on_hold",
                                               [ST_EBUSY] = "busy",
                                               [ST_EIO] = "storage",
                                               [ST_EDB] = "internal",
                                               [ST_EINTERNAL] = "internal"};

    return c->code == EXIT_USAGE     ? "usage"
           : word[c->e.code] != NULL ? word[c->e.code]
                                     : status_refusal(c->e.code);
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
        (void)fprintf(stderr, "This %s.\nType %s to go on: ", what, word);
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

bool ctl_print(FILE *to, char *text)
{
    const bool ok = text != NULL && fprintf(to, "%s\n", text) >= 0;

    free(text);
    return ok;
}

void *ctl_grow(void *list, size_t n, size_t size)
{
    return (n & (n - 1)) != 0 ? list : realloc(list, (n > 0 ? 2 * n : 1) * size);
}

double ctl_clock_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}
