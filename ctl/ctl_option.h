/* ctl_option.h -- the options of surfacectl: what a row of them is, what their values are
 * read by, and those that several commands take. */
#ifndef CTL_OPTION_H
#define CTL_OPTION_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct ctl; /* ctl.h */

struct ctl_option {
    const char *name; /* without the two hyphens; NULL ends a list */
    const char *arg;  /* what its value is called; NULL: it has none.  "mm|cm|m": one of
                         these; FILE, DIR, PATH: of the file system */
    const char *(*read)(const char *text, void *value); /* sets *value; NULL: done, else
                                                           what the option takes */
    void *value;      /* what it sets; NULL: in struct ctl */
    const char *help; /* lines of up to 66 characters */
    size_t at;        /* there */
    char letter;      /* a short form, or 0 */
};

/* An option that one command takes. */
#define CTL_OPTION(name, arg, read, value, help)                                         \
    {                                                                                    \
        name, arg, read, value, help, 0, 0                                               \
    }

/* The shared options, a bit each, in the order of help texts. */
enum ctl_shared {
    CTL_DB = 1 << 0,
    CTL_CONFIG = 1 << 1,
    CTL_KEY = 1 << 2,
    CTL_ANCHOR = 1 << 3,
    CTL_PLAINTEXT = 1 << 4,
    CTL_UNITS = 1 << 5,
    CTL_AXES = 1 << 6,
    CTL_CAMERA = 1 << 7,
    CTL_MODEL = 1 << 8,
    CTL_THRESHOLD = 1 << 9,
    CTL_FMR = 1 << 10,
    CTL_LABEL = 1 << 11,
    CTL_OUT = 1 << 12,
    CTL_THREADS = 1 << 13,
    CTL_PASSPHRASE = 1 << 14,
    CTL_SHORT = 1 << 15,
    CTL_ARCHIVE_KEY = 1 << 16,
    CTL_PUBLIC_KEY = 1 << 17,
    CTL_EXPIRES = 1 << 18,
    CTL_DRY_RUN = 1 << 19,
    CTL_YES = 1 << 20,
    CTL_FORCE = 1 << 21,
    CTL_JSON = 1 << 22,
    CTL_HELP = 1 << 23,
    CTL_VERSION = 1 << 24
};

/* Of commands that read scans. */
#define CTL_SCANS    (CTL_UNITS | CTL_AXES | CTL_CAMERA)
#define CTL_DATABASE (CTL_DB | CTL_CONFIG | CTL_KEY | CTL_ANCHOR | CTL_PLAINTEXT)
#define CTL_COMMON   (CTL_JSON | CTL_HELP | CTL_VERSION) /* every command takes them */

/* ctl_option_at(shared, own, i): option i of those shared ones and of the list own, which
 * may be NULL; NULL: there are no more.
 * ctl_option_find(shared, own, name): the one of that name, or NULL. */
const struct ctl_option *ctl_option_at(unsigned shared, const struct ctl_option *own,
                                       size_t i);
const struct ctl_option *ctl_option_find(unsigned shared, const struct ctl_option *own,
                                         const char *name);

/* The name that is nearest to a mistyped word; "" before, and where none is near.
 * ctl_near(near, word, before, name): is `before` and name together nearer? */
struct ctl_near {
    char name[40];
    size_t edits;
};
void ctl_near(struct ctl_near *near, const char *word, const char *before,
              const char *name);

/* Values: bool; const char *; uint32_t from 1 to 1,000,000; double: a score, a rate above 0 up to
 * 0.5; int64_t seconds ("90d", "12h"); unsigned: scopes of a token. */
const char *ctl_option_flag(const char *text, void *value);
const char *ctl_option_text(const char *text, void *value);
const char *ctl_option_whole(const char *text, void *value);
const char *ctl_option_score(const char *text, void *value);
const char *ctl_option_rate(const char *text, void *value);
const char *ctl_option_duration(const char *text, void *value);
const char *ctl_option_scopes(const char *text, void *value);

#endif
