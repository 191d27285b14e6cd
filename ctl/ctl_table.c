/* The commands, by name; their help texts, made from the table. */
#include "ctl_table.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "ctl_command.h"

/* clang-format off */
/* Each is at the end of the file whose name its own begins with. */
#define COMMANDS(X) \
    X(ctl_database_init) X(ctl_enroll) X(ctl_verify) X(ctl_identify) X(ctl_verify_compare) \
    X(ctl_explain) X(ctl_scan) \
    X(ctl_subject_list) X(ctl_subject_show) \
    X(ctl_subject_set) X(ctl_subject_rename) X(ctl_subject_disable) \
    X(ctl_subject_enable) X(ctl_subject_hold) X(ctl_subject_release) X(ctl_erase) \
    X(ctl_erase_purge) X(ctl_template_list) X(ctl_template_show) \
    X(ctl_template_export) X(ctl_template_reencode) X(ctl_erase_template) X(ctl_dedup) \
    X(ctl_database_check) X(ctl_calibrate) \
    X(ctl_backup) X(ctl_backup_copy) X(ctl_backup_restore) X(ctl_backup_reapply) X(ctl_database_accept) X(ctl_database_join) X(ctl_archive_export) \
    X(ctl_archive_import) X(ctl_backup_rekey) X(ctl_doctor) X(ctl_database_stats) \
    X(ctl_database_vacuum) X(ctl_token_create) X(ctl_token_list) X(ctl_token_rotate) \
    X(ctl_token_revoke) X(ctl_device_add) X(ctl_device_list) X(ctl_device_remove) \
    X(ctl_subject_attempts_list) X(ctl_subject_attempts_reset) X(ctl_audit_show) \
    X(ctl_review_verify) X(ctl_audit_export) X(ctl_audit_checkpoint) X(ctl_audit_compare) \
    X(ctl_audit_trim)
/* clang-format on */

#define EXTERN(name)  extern const struct ctl_command name;
#define POINTER(name) &name,
COMMANDS(EXTERN)

const struct ctl_command *const ctl_table[] = {COMMANDS(POINTER) NULL};

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

bool ctl_table_is_group(const char *word)
{
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        if (ctl_table_in(*k, word))
            return true;
    return false;
}

/* ---- exit codes */

static const struct {
    int code;
    const char *meaning;
} exits[] = {
    {EXIT_FINE, "done; a match"},
    {EXIT_NO, "no match; problems, or duplicates, were found; a scan is refused"},
    {EXIT_INCONCLUSIVE, CTL_INCONCLUSIVE},
    {EXIT_USAGE, "the command line is wrong, or a confirmation is missing"},
    {EXIT_DATA, "a scan, a model or the database is malformed or cannot be used"},
    {EXIT_NOINPUT, "no such file, model, subject, template, token, device or database"},
    {EXIT_SOFTWARE, "a defect of this program, or an error of the database engine"},
    {EXIT_OSERR, "out of memory"},
    {EXIT_IOERR, "reading or writing failed, or the disk is full"},
    {EXIT_TEMPFAIL, "another process has locked the database; try again"},
    {EXIT_NOPERM, "not permitted; the subject is disabled, expired or on hold"},
};

/* ---- parts */

static void print_options(unsigned shared, const struct command_option *own)
{
    const struct command_option *o;

    (void)printf("Options (before or after the command):\n");
    for (size_t i = 0; (o = ctl_option_at(shared, own, i)) != NULL; i++)
        command_print_option(o);
    (void)printf("\n");
}

static void print_summaries(const char *group)
{
    (void)printf("Commands (surfacectl %s%sCOMMAND --help says more):\n",
                 group != NULL ? group : "", group != NULL ? " " : "");
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        if (group == NULL || ctl_table_in(*k, group))
            (void)printf("  %-19s %s\n", (*k)->name, (*k)->summary);
    (void)printf("\n");
}

static void print_exits(const struct ctl_command *k)
{
    (void)printf("Exit codes:\n");
    for (int i = 0; i < 3; i++)
        if (i == 0 || k->exits[i] != NULL)
            (void)printf("  %2d  %s\n", i, k->exits[i] != NULL ? k->exits[i] : "done");
    (void)printf("  64 to 77  an error (surfacectl --help)\n");
}

/* ---- pages */

static void print_all(void)
{
    (void)printf("Usage: surfacectl [--db PATH] [--json] COMMAND [ARGUMENT...]\n\n");
    print_summaries(NULL);
    print_options(CTL_DATABASE | CTL_COMMON, NULL);
    (void)printf("Example:\n  surfacectl --db faces.db init\n"
                 "  surfacectl --db faces.db enroll alice alice.ply\n"
                 "  surfacectl --db faces.db verify alice probe.ply\n"
                 "\n"
                 "Exit codes:\n");
    for (size_t i = 0; i < sizeof exits / sizeof *exits; i++)
        (void)printf("  %2d  %s\n", exits[i].code, exits[i].meaning);
}

static void print_group(const char *group)
{
    (void)printf("Usage: surfacectl %s COMMAND [ARGUMENT...]\n\n", group);
    print_summaries(group);
    (void)printf("Example:\n");
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        if (ctl_table_in(*k, group))
            (void)printf("  %s\n", (*k)->example);
    (void)printf("\nExit codes: surfacectl --help\n");
}

static void print_command(const struct ctl_command *k)
{
    (void)printf("Usage: surfacectl%s %s%s%s\n\n%c%s.\n%s\n\n",
                 k->database != CTL_NO_DATABASE ? " --db PATH" : "", k->name,
                 k->args != NULL ? " " : "", k->args != NULL ? k->args : "",
                 toupper((unsigned char)k->summary[0]), k->summary + 1, k->help);
    print_options(ctl_table_options(k) & ~(unsigned)CTL_VERSION, k->options);
    (void)printf("Example:\n  %s\n\n", k->example);
    print_exits(k);
}

static void print_version(void)
{
    const char *version = strchr(SURFACE_ENGINE, '/') + 1;

    (void)printf("surfacectl %.*s (%s)\n", (int)strcspn(version, " "), version,
                 SURFACE_ENGINE);
}

void ctl_table_print(bool version, const struct ctl_command *cmd, const char *group)
{
    if (version)
        print_version();
    else if (cmd != NULL)
        print_command(cmd);
    else if (group != NULL)
        print_group(group);
    else
        print_all();
}
