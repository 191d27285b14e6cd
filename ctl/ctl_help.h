/* ctl_help.h -- what surfacectl tells of itself. */
#ifndef DB_SURFACECTL_HELP_H
#define DB_SURFACECTL_HELP_H

struct ctl_command; /* ctl_command.h */

/* Of everything, of a group of commands, of one; on standard output. */
void ctl_help_all(void);
void ctl_help_group(const char *group);
void ctl_help_command(const struct ctl_command *cmd);
void ctl_help_version(void);

#endif
