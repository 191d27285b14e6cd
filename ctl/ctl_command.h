/* ctl_command.h -- the commands of surfacectl: one table, by which they are found, told
 * of in help texts and completed. */
#ifndef DB_SURFACECTL_COMMAND_H
#define DB_SURFACECTL_COMMAND_H
#include <stdbool.h>

struct ctl; /* ctl.h */

struct ctl_command {
    const char *name; /* one word, or a group and a verb: "token create" */
    const char *was; /* a name it is found by too, of before there were groups; or NULL */
    const char *args;    /* as told, "" for none */
    const char *summary; /* begins with a small letter */
    const char *help;    /* lines of up to 88 characters */
    const char *example;
    int min, max;        /* arguments */
    bool db;             /* it works on a database */
    bool old;            /* not listed: others do the same */
    const char *options; /* their names (ctl_option.h), but of those for all */
    int (*run)(struct ctl *c);
};

#define CTL_MANY (1 << 30) /* arguments */

extern const struct ctl_command ctl_commands[]; /* ends with a NULL name */

/* ctl_command_find(words, n, used): the command that the words begin with; *used is
 * how many of them name it.  NULL: none. */
const struct ctl_command *ctl_command_find(char *const *words, int n, int *used);

/* ctl_command_in(cmd, group): is its first of two words this? */
bool ctl_command_in(const struct ctl_command *cmd, const char *group);

#endif
