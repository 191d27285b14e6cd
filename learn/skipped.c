#include "skipped.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void skipped_add(struct skipped *s, const char *name, bool folder)
{
    const char *dot = strrchr(name, '.');

    if (folder) {
        s->folders++;
        return;
    }
    s->files++;
    if (dot == NULL || strlen(dot) >= sizeof s->ending[0])
        return;
    for (int i = 0; i < SKIPPED_ENDINGS; i++) {
        if (s->n[i] == 0)
            memcpy(s->ending[i], dot, strlen(dot) + 1);
        if (strcmp(s->ending[i], dot) == 0) {
            s->n[i]++;
            return;
        }
    }
}

/* What is printed at its end, as far as there is room. */
__attribute__((format(printf, 3, 4))) static void add(char *out, size_t size,
                                                      const char *fmt, ...)
{
    const size_t n = strlen(out);
    va_list args;

    va_start(args, fmt);
    (void)vsnprintf(out + n, size - n, fmt, args);
    va_end(args);
}

void skipped_text(const struct skipped *s, char *out, size_t size)
{
    const char *between = " (";

    out[0] = '\0';
    if (s->files > 0)
        add(out, size, "%u file%s", s->files, s->files == 1 ? "" : "s");
    for (int i = 0; i < SKIPPED_ENDINGS && s->n[i] > 0; i++) {
        add(out, size, "%s%s %u", between, s->ending[i], s->n[i]);
        between = ", ";
    }
    if (s->n[0] > 0)
        add(out, size, ")");
    if (s->folders > 0)
        add(out, size, "%s%u folder%s", s->files > 0 ? ", " : "", s->folders,
            s->folders == 1 ? "" : "s");
}
