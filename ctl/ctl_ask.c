/* What a person has to confirm, and sizes as people read them. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "ctl.h"

bool ctl_confirmed(struct ctl *c, const char *what, const char *word)
{
    char line[STORE_SUBJECT_MAX + 8] = "";
    const bool terminal = isatty(STDIN_FILENO) == 1;

    if (c->yes)
        return true;
    if (terminal) {
        (void)fprintf(stderr, "This %s for good.\nType %s to go on: ", what, word);
        if (fgets(line, sizeof line, stdin) != NULL) {
            line[strcspn(line, "\r\n")] = '\0';
            if (strcmp(line, word) == 0)
                return true;
        }
    }
    (void)errinfo_set(&c->e, ST_EDENIED,
                      "nothing was changed: what %.120s needs --yes, or %.40s typed on a "
                      "terminal",
                      what, word);
    return false;
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
