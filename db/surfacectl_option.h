/* surfacectl_option.h -- the options of surfacectl: one table, by which they are read, told
 * of in help texts and completed. */
#ifndef DB_SURFACECTL_OPTION_H
#define DB_SURFACECTL_OPTION_H
#include <stdbool.h>
#include <stddef.h>

struct surfacectl; /* surfacectl.h */

struct surfacectl_option {
    const char *name; /* without the two hyphens */
    const char *also; /* a letter, or NULL */
    const char *arg;  /* what its value is called; NULL: it has none.  "mm|cm|m": one of
                         these; FILE, DIR, PATH: of the file system */
    size_t field;     /* of struct surfacectl, what it sets */
    bool (*set)(void *field, const char *value); /* false: no such value can be */
    const char *wrong; /* then; the value follows.  NULL: any value can be */
    const char *help;  /* lines of up to 68 characters */
    bool common;       /* every command takes it */
};

#define SURFACECTL_OPTIONS 64 /* at most */

extern const struct surfacectl_option surfacectl_options[]; /* ends with a NULL name */

/* surfacectl_option_find(text, n): by "--name" or "-letter", n bytes; NULL: there is none. */
const struct surfacectl_option *surfacectl_option_find(const char *text, size_t n);

/* Is the option's name one of the words in the list? */
bool surfacectl_option_in(const struct surfacectl_option *o, const char *list);

#endif
