/* ctl_option.h -- the options of surfacectl: one table, by which they are read, told
 * of in help texts and completed. */
#ifndef DB_SURFACECTL_OPTION_H
#define DB_SURFACECTL_OPTION_H
#include <stdbool.h>
#include <stddef.h>

struct ctl; /* ctl.h */

struct ctl_option {
    const char *name; /* without the two hyphens */
    const char *also; /* a letter, or NULL */
    const char *arg;  /* what its value is called; NULL: it has none.  "mm|cm|m": one of
                         these; FILE, DIR, PATH: of the file system */
    size_t field;     /* of struct ctl, what it sets */
    bool (*set)(void *field, const char *value); /* false: no such value can be */
    const char *wrong; /* then; the value follows.  NULL: any value can be */
    const char *help;  /* lines of up to 68 characters */
    bool common;       /* every command takes it */
};

#define CTL_OPTIONS 64 /* at most */

extern const struct ctl_option ctl_options[]; /* ends with a NULL name */

/* ctl_option_find(text, n): by "--name" or "-letter", n bytes; NULL: there is none. */
const struct ctl_option *ctl_option_find(const char *text, size_t n);

/* Is the option's name one of the words in the list? */
bool ctl_option_in(const struct ctl_option *o, const char *list);

#endif
