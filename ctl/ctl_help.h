/* ctl_help.h -- the help texts of surfacectl, on standard output. */
#ifndef CTL_HELP_H
#define CTL_HELP_H
#include <stdbool.h>

struct ctl_command; /* ctl_command.h */

/* ctl_help_print(version, cmd, group): the version, or help: of a command, else of a group of
 * them, else of everything (both NULL).
 * ctl_help_is_group(word): do commands begin with it? */
void ctl_help_print(bool version, const struct ctl_command *cmd, const char *group);
bool ctl_help_is_group(const char *word);

#endif
