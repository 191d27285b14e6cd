#include "ctl_table.h"

#include <string.h>

#include "ctl_command.h"

/* Each is at the end of the file whose name its own begins with. */
extern const struct ctl_command ctl_init, ctl_enroll, ctl_verify, ctl_verify_compare,
    ctl_explain, ctl_scan, ctl_subject_list, ctl_subject_show, ctl_subject_set,
    ctl_subject_rename, ctl_subject_disable, ctl_subject_enable, ctl_subject_hold,
    ctl_subject_release, ctl_erase, ctl_erase_purge, ctl_template_list, ctl_template_show,
    ctl_template_export, ctl_reencode, ctl_erase_template, ctl_dedup, ctl_config_show,
    ctl_config_check, ctl_check, ctl_calibrate, ctl_backup, ctl_backup_restore,
    ctl_accept, ctl_archive_export, ctl_archive_import, ctl_rekey, ctl_doctor, ctl_stats,
    ctl_stats_vacuum, ctl_token_create, ctl_token_list, ctl_token_rotate,
    ctl_token_revoke, ctl_device_add, ctl_device_list, ctl_device_remove,
    ctl_attempts_list, ctl_attempts_reset, ctl_audit_show, ctl_audit_verify,
    ctl_audit_export, ctl_audit_checkpoint, ctl_receipt, ctl_audit_trim, ctl_audit_erased,
    ctl_completion, ctl_help;

/* clang-format off */
const struct ctl_command *const ctl_table[] = {
    &ctl_init, &ctl_enroll, &ctl_verify, &ctl_verify_compare,
    &ctl_explain, &ctl_scan,
    &ctl_subject_list, &ctl_subject_show, &ctl_subject_set, &ctl_subject_rename,
    &ctl_subject_disable, &ctl_subject_enable, &ctl_subject_hold, &ctl_subject_release,
    &ctl_erase, &ctl_erase_purge,
    &ctl_template_list, &ctl_template_show, &ctl_template_export, &ctl_reencode,
    &ctl_erase_template,
    &ctl_dedup, &ctl_config_show, &ctl_config_check, &ctl_check, &ctl_calibrate,
    &ctl_backup, &ctl_backup_restore, &ctl_accept, &ctl_archive_export, &ctl_archive_import,
    &ctl_rekey, &ctl_doctor, &ctl_stats, &ctl_stats_vacuum,
    &ctl_token_create, &ctl_token_list, &ctl_token_rotate, &ctl_token_revoke,
    &ctl_device_add, &ctl_device_list, &ctl_device_remove,
    &ctl_attempts_list, &ctl_attempts_reset,
    &ctl_audit_show, &ctl_audit_verify, &ctl_audit_export, &ctl_audit_checkpoint,
    &ctl_receipt, &ctl_audit_trim, &ctl_audit_erased,
    &ctl_completion, &ctl_help, NULL,
};
/* clang-format on */

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
