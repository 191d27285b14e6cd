/* ctl_table.h -- the commands of surfacectl: they are found, described in help texts and
 * completed by this table. */
#ifndef CTL_TABLE_H
#define CTL_TABLE_H
#include <stdbool.h>

struct ctl_command; /* ctl_command.h */

extern const struct ctl_command *const ctl_table[]; /* ends with NULL */

/* ctl_table_find(words, n, used): the command that the words begin with; *used is how many
 * of them name it.  NULL: none.
 * ctl_table_in(cmd, group): is that the first of the two words of its name?
 * ctl_table_options(cmd): the shared options that it takes, in bits; NULL: of surfacectl
 * without a command. */
const struct ctl_command *ctl_table_find(char *const *words, int n, int *used);
bool ctl_table_in(const struct ctl_command *cmd, const char *group);
unsigned ctl_table_options(const struct ctl_command *cmd);

/* ctl_table_print(version, cmd, group): the version, or help: of a command, else of a group of
 * them, else of everything (both NULL).
 * ctl_table_is_group(word): is it the first of two words of a command? */
void ctl_table_print(bool version, const struct ctl_command *cmd, const char *group);
bool ctl_table_is_group(const char *word);

#endif
