/* ctl_table.h -- the list of the commands of surfacectl: lookup and help texts. */
#ifndef CTL_TABLE_H
#define CTL_TABLE_H
#include <stdbool.h>

struct ctl_command; /* ctl_command.h */

extern const struct ctl_command *const ctl_table[]; /* ends with NULL */

/* ctl_table_find(words, n, used): Returns the command that the words begin with; NULL if there is none.
 *   used    receives the number of words in the command's name */
const struct ctl_command *ctl_table_find(char *const *words, int n, int *used);

/* ctl_table_in(cmd, group): Returns true if group is the first of the two words of cmd's name. */
bool ctl_table_in(const struct ctl_command *cmd, const char *group);

/* ctl_table_is_group(word): Returns true if word is the first of the two words of a command's name. */
bool ctl_table_is_group(const char *word);

/* ctl_table_options(cmd): Returns the bits of the shared options that cmd takes; for NULL those of surfacectl
 * without a command. */
unsigned ctl_table_options(const struct ctl_command *cmd);

/* ctl_table_print(version, cmd, group): Prints the version, or the help text of the command, of the group, or,
 * if both are NULL, of surfacectl. */
void ctl_table_print(bool version, const struct ctl_command *cmd, const char *group);

#endif
