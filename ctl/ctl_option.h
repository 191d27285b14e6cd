/* ctl_option.h -- the options of surfacectl: what a row of them is, what their values are
 * read by, and those that several commands take. */
#ifndef CTL_OPTION_H
#define CTL_OPTION_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "command.h"

struct ctl; /* ctl.h */

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
    CTL_LABEL = 1 << 9,
    CTL_OUT = 1 << 10,
    CTL_THREADS = 1 << 11,
    CTL_PASSPHRASE = 1 << 12,
    CTL_SHORT = 1 << 13,
    CTL_ARCHIVE_KEY = 1 << 14,
    CTL_PUBLIC_KEY = 1 << 15,
    CTL_EXPIRES = 1 << 16,
    CTL_DRY_RUN = 1 << 17,
    CTL_YES = 1 << 18,
    CTL_FORCE = 1 << 19,
    CTL_JSON = 1 << 20,
    CTL_HELP = 1 << 21,
    CTL_VERSION = 1 << 22
};

/* Of commands that read scans. */
#define CTL_SCANS    (CTL_UNITS | CTL_AXES | CTL_CAMERA)
#define CTL_DATABASE (CTL_DB | CTL_CONFIG | CTL_KEY | CTL_ANCHOR | CTL_PLAINTEXT)
#define CTL_COMMON   (CTL_JSON | CTL_HELP | CTL_VERSION) /* every command takes them */

/* ctl_option_at(shared, own, i): option i of those shared ones and of the list own, which
 * may be NULL; NULL: there are no more.
 * ctl_option_find(shared, own, name): the one of that name, or NULL. */
const struct command_option *ctl_option_at(unsigned shared,
                                           const struct command_option *own, size_t i);
const struct command_option *
ctl_option_find(unsigned shared, const struct command_option *own, const char *name);

/* Values: int64_t seconds ("90d", "12h"); unsigned: scopes of a token. */
const char *ctl_option_duration(const char *text, void *value);
const char *ctl_option_scopes(const char *text, void *value);

#endif
