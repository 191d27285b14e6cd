/* ctl_command.h -- what a command of surfacectl says of itself.  To add a command, write a
 * file with such a row at its end, and its name into the list in ctl_table.c. */
#ifndef CTL_COMMAND_H
#define CTL_COMMAND_H
#include "ctl.h"
#include "ctl_option.h"
#include "store.h"

enum ctl_database {
    CTL_NO_DATABASE,
    CTL_TAKES_DATABASE,  /* --db or SURFACED_DB, where there is one: c->db may be NULL */
    CTL_NEEDS_DATABASE,  /* c->db; run() opens it */
    CTL_READS_DATABASE,  /* it is open, in c->store */
    CTL_WRITES_DATABASE, /* for writing, unless with --dry-run */
};

struct ctl_command {
    const char *name;    /* one word, or a group and a verb: "token create" */
    const char *args;    /* as in its usage; NULL: it takes none */
    int takes[2];        /* the least and greatest number of arguments */
    const char *summary; /* begins with a small letter */
    const char *help;    /* lines of up to 88 characters */
    const char *example;
    /* what the exit codes 0 to 2 mean; NULL: 0 is done, others never */
    const char *exits[3];
    enum ctl_database database;
    unsigned shared; /* options, besides those of a database and of all */
    struct command_option options[8]; /* of its own; ends with one that has no name */

    /* Do it.  Where that failed c->e says why; else c->code is the exit code. */
    enum status (*run)(struct ctl *c);
};

#define CTL_MANY (1 << 30) /* arguments */

/* What EXIT_INCONCLUSIVE means (docs/decision.md). */
#define CTL_INCONCLUSIVE                                                                 \
    "inconclusive: too little in common, or a part hidden and the score not far above"

#endif
