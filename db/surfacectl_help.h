/* surfacectl_help.h -- what surfacectl tells of itself. */
#ifndef DB_SURFACECTL_HELP_H
#define DB_SURFACECTL_HELP_H

struct surfacectl_command; /* surfacectl_command.h */

/* Of everything, of a group of commands, of one; on standard output. */
void surfacectl_help_all(void);
void surfacectl_help_group(const char *group);
void surfacectl_help_command(const struct surfacectl_command *cmd);
void surfacectl_help_version(void);

#endif
