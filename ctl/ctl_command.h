/* ctl_command.h -- a command of surfacectl: its row and its options.  To add a command, write a file with
 * such a row at its end, and add its name to the list in ctl_table.c. */
#ifndef CTL_COMMAND_H
#define CTL_COMMAND_H
#include "ctl.h"
#include "store.h"

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
    CTL_OUT = 1 << 9,
    CTL_THREADS = 1 << 10,
    CTL_PASSPHRASE = 1 << 11,
    CTL_SHORT = 1 << 12,
    CTL_ARCHIVE_KEY = 1 << 13,
    CTL_EXPIRES = 1 << 14,
    CTL_DRY_RUN = 1 << 15,
    CTL_YES = 1 << 16,
    CTL_FORCE = 1 << 17,
    CTL_JSON = 1 << 18,
    CTL_HELP = 1 << 19,
    CTL_VERSION = 1 << 20
};

#define CTL_SCANS                                                                        \
    (CTL_UNITS | CTL_AXES | CTL_CAMERA) /* options of commands that read scans */
#define CTL_DATABASE (CTL_DB | CTL_CONFIG | CTL_KEY | CTL_ANCHOR | CTL_PLAINTEXT)
#define CTL_COMMON   (CTL_JSON | CTL_HELP | CTL_VERSION) /* options of every command */

/* A row of an option that one command takes. */
#define CTL_OPTION(name, arg, read, value, help)                                         \
    {                                                                                    \
        name, arg, read, value, help, 0, 0                                               \
    }

/* What is done with the database before run(). */
enum ctl_database {
    CTL_NO_DATABASE,
    CTL_NEEDS_DATABASE,  /* c->db is set; run() opens it */
    CTL_READS_DATABASE,  /* it is opened as c->store */
    CTL_WRITES_DATABASE, /* it is opened for writing; for reading with --dry-run */
};

#define CTL_MANY (1 << 30) /* number of arguments without a limit */

struct ctl_command {
    const char *name;    /* one word, or a group and a verb: "token create" */
    const char *args;    /* arguments as in the usage; NULL: none */
    int takes[2];        /* least and greatest number of arguments */
    const char *summary; /* one line that begins with a small letter */
    const char *help;    /* lines of up to 88 characters */
    const char *example;
    const char *
        exits[3]; /* meanings of the exit codes 0 to 2; NULL: 0 is "done", others never */
    enum ctl_database database;
    unsigned shared; /* bits of the shared options, besides CTL_DATABASE and CTL_COMMON */
    struct command_option options[8]; /* its own options; the last has no name */

    /* Executes the command.  On failure the reason is in c->e; else c->code is the exit code. */
    enum status (*run)(struct ctl *c);
};

/* Meaning of EXIT_INCONCLUSIVE (docs/decision.md). */
#define CTL_INCONCLUSIVE                                                                 \
    "inconclusive: too little in common, or a part hidden and the score not far above"

/* ctl_option_at(shared, own, i): Returns option i of the shared ones with these bits, followed by the list
 * own (NULL: no list); NULL if there are no more. */
const struct command_option *ctl_option_at(unsigned shared,
                                           const struct command_option *own, size_t i);

/* ctl_option_find(shared, own, name): Returns the option of that name among these; NULL: none. */
const struct command_option *
ctl_option_find(unsigned shared, const struct command_option *own, const char *name);

/* ctl_option_duration(text, value): Reads "90d", "12h", "30m" or "10s" into the int64_t at value, in seconds. */
const char *ctl_option_duration(const char *text, void *value);

/* ctl_option_scopes(text, value): Reads a list of scopes into the unsigned at value, as bits. */
const char *ctl_option_scopes(const char *text, void *value);

#endif
