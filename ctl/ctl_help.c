#include "ctl_help.h"

#include <stdio.h>
#include <string.h>

#include "ctl.h"
#include "ctl_command.h"
#include "ctl_option.h"

static const char exit_help[] =
    "Exit codes:\n"
    "   0  done; verify, compare, explain: match\n"
    "   1  verify, compare, explain: no match; check, doctor, config check,\n"
    "      audit verify, audit receipt: problems found\n"
    "   2  verify, compare, explain, asymmetry: inconclusive (too little in common)\n"
    "  64  the command line is wrong, or what has to be confirmed was not\n"
    "  65  a scan, a model or the database is malformed or cannot be used\n"
    "  66  no such file, model, subject, template, token or database\n"
    "  70  a defect of this program or an error of the database engine\n"
    "  71  out of memory\n"
    "  74  reading or writing failed, disk full\n"
    "  75  the database is locked by another process; try again\n"
    "  77  not permitted; the subject is disabled, or on hold\n";

/* Lines, the further ones under the first. */
static void print_lines(const char *text, int indent)
{
    for (;;) {
        const size_t n = strcspn(text, "\n");

        (void)printf("%.*s\n", (int)n, text);
        if (text[n] == '\0')
            return;
        text += n + 1;
        (void)printf("%*s", indent, "");
    }
}

static void print_option(const struct ctl_option *o)
{
    char name[64];

    (void)snprintf(name, sizeof name, "--%s%s%s", o->name, o->arg != NULL ? " " : "",
                   o->arg != NULL ? o->arg : "");
    (void)printf("  %-19s ", name);
    print_lines(o->help, 22);
}

/* Those of a command; NULL: all. */
static void print_options(const struct ctl_command *cmd)
{
    (void)printf("Options (before or after the command):\n");
    for (const struct ctl_option *o = ctl_options; o->name != NULL; o++) {
        const bool database = strcmp(o->name, "db") == 0 ||
                              strcmp(o->name, "config") == 0 ||
                              strcmp(o->name, "key") == 0;

        if (cmd == NULL || ctl_option_in(o, cmd->options) ||
            (o->common && (!database || cmd->db)))
            print_option(o);
    }
    (void)printf("\n");
}

void ctl_help_all(void)
{
    (void)printf("Usage: surfacectl [--db PATH] [--json] COMMAND [ARGUMENT...]\n\n"
                 "Commands (surfacectl COMMAND --help says more):\n");
    for (const struct ctl_command *k = ctl_commands; k->name != NULL; k++)
        if (!k->old)
            (void)printf("  %-19s %s\n", k->name, k->summary);
    (void)printf("\n");
    print_options(NULL);
    (void)printf("Example:\n  surfacectl --db faces.db init\n"
                 "  surfacectl --db faces.db enroll alice alice.ply\n"
                 "  surfacectl --db faces.db verify alice probe.ply\n\n%s",
                 exit_help);
}

void ctl_help_group(const char *group)
{
    const struct ctl_command *k;

    (void)printf("Usage: surfacectl %s COMMAND [ARGUMENT...]\n\n"
                 "Commands (surfacectl %s COMMAND --help says more):\n",
                 group, group);
    for (k = ctl_commands; k->name != NULL; k++)
        if (ctl_command_in(k, group))
            (void)printf("  %-19s %s\n", k->name, k->summary);
    (void)printf("\nExample:\n");
    for (k = ctl_commands; k->name != NULL; k++)
        if (ctl_command_in(k, group))
            (void)printf("  %s\n", k->example);
    (void)printf("\n%s", exit_help);
}

void ctl_help_command(const struct ctl_command *k)
{
    (void)printf("Usage: surfacectl%s %s%s%s\n\n%c%s.\n%s\n\n", k->db ? " --db PATH" : "",
                 k->name, k->args[0] != '\0' ? " " : "", k->args,
                 k->summary[0] >= 'a' && k->summary[0] <= 'z' ? k->summary[0] - 'a' + 'A'
                                                              : k->summary[0],
                 k->summary + 1, k->help);
    print_options(k);
    (void)printf("Example:\n  %s\n\n%s", k->example, exit_help);
}

void ctl_help_version(void)
{
    const char *version = strchr(FACE_ENGINE, '/') + 1;

    (void)printf("surfacectl %.*s (%s)\n", (int)strcspn(version, " "), version,
                 FACE_ENGINE);
}
