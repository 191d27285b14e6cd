#include "ctl_table.h"

#include <string.h>

#include "ctl_command.h"

/* ctl_NAME is at the end of the file whose name it begins with. */
#define COMMANDS(X)                                                                      \
    X(init)                                                                              \
    X(init_migrate)                                                                      \
    X(enroll)                                                                            \
    X(verify)                                                                            \
    X(verify_compare)                                                                    \
    X(explain)                                                                           \
    X(asymmetry)                                                                         \
    X(simplify)                                                                          \
    X(evaluate)                                                                          \
    X(train)                                                                             \
    X(subject_list)                                                                      \
    X(subject_show)                                                                      \
    X(subject_set)                                                                       \
    X(subject_rename)                                                                    \
    X(subject_disable)                                                                   \
    X(subject_enable)                                                                    \
    X(subject_hold)                                                                      \
    X(subject_release)                                                                   \
    X(erase)                                                                             \
    X(erase_purge)                                                                       \
    X(template_list)                                                                     \
    X(template_show)                                                                     \
    X(template_export)                                                                   \
    X(reencode)                                                                          \
    X(template_delete)                                                                   \
    X(dedup)                                                                             \
    X(config_show)                                                                       \
    X(config_check)                                                                      \
    X(check)                                                                             \
    X(calibrate)                                                                         \
    X(backup)                                                                            \
    X(backup_restore)                                                                    \
    X(archive_export)                                                                    \
    X(archive_import)                                                                    \
    X(rekey)                                                                             \
    X(doctor)                                                                            \
    X(stats)                                                                             \
    X(stats_vacuum)                                                                      \
    X(token_create)                                                                      \
    X(token_list)                                                                        \
    X(token_rotate)                                                                      \
    X(token_revoke)                                                                      \
    X(attempts_list)                                                                     \
    X(attempts_reset)                                                                    \
    X(audit_show)                                                                        \
    X(audit_verify)                                                                      \
    X(audit_export)                                                                      \
    X(audit_checkpoint)                                                                  \
    X(receipt)                                                                           \
    X(audit_erased)                                                                      \
    X(completion)                                                                        \
    X(help)

#define DECLARE(command) extern const struct ctl_command ctl_##command;
#define ROW(command)     &ctl_##command,

COMMANDS(DECLARE)

const struct ctl_command *const ctl_table[] = {COMMANDS(ROW) NULL};

bool ctl_table_in(const struct ctl_command *cmd, const char *group)
{
    const size_t n = strlen(group);

    return strncmp(cmd->name, group, n) == 0 && cmd->name[n] == ' ';
}

const struct ctl_command *ctl_table_find(char *const *words, int n, int *used)
{
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++) {
        const char *verb = strchr((*k)->name, ' ');

        *used = verb != NULL ? 2 : 1;
        if (verb == NULL
                ? strcmp((*k)->name, words[0]) == 0
                : n > 1 && ctl_table_in(*k, words[0]) && strcmp(verb + 1, words[1]) == 0)
            return *k;
    }
    return NULL;
}

unsigned ctl_table_options(const struct ctl_command *cmd)
{
    if (cmd == NULL)
        return CTL_COMMON;
    return CTL_COMMON | cmd->shared |
           (cmd->database != CTL_NO_DATABASE ? CTL_DATABASE : 0U);
}
