#include "ctl.h"

#include <pwd.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

bool ctl_print(FILE *to, char *text)
{
    const bool ok = text != NULL && fprintf(to, "%s\n", text) >= 0;

    free(text);
    return ok;
}
