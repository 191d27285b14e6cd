/* Help texts, made from the tables; the command help. */
#include "ctl_help.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "ctl_command.h"
#include "ctl_table.h"

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
#define NEXIT (sizeof exits / sizeof *exits)

/* ---- parts */

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

static void print_options(unsigned shared, const struct ctl_option *own)
{
    const struct ctl_option *o;

    (void)printf("Options (before or after the command):\n");
    for (size_t i = 0; (o = ctl_option_at(shared, own, i)) != NULL; i++) {
        char name[64], letter[] = "-?, ";

        letter[1] = o->letter;
        (void)snprintf(name, sizeof name, "%s--%s%s%s", o->letter != 0 ? letter : "",
                       o->name, o->arg != NULL ? " " : "", o->arg != NULL ? o->arg : "");
        if (strlen(name) > 20)
            (void)printf("  %s\n%23s", name, "");
        else
            (void)printf("  %-20s ", name);
        print_lines(o->help, 23);
    }
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

/* Can the command end with this error? */
static bool can_fail(const struct ctl_command *k, int code)
{
    if (code == EXIT_DATA || code == EXIT_NOINPUT)
        return k->database != CTL_NO_DATABASE || (k->shared & (CTL_UNITS | CTL_CONFIG));
    if (code == EXIT_SOFTWARE || code == EXIT_TEMPFAIL || code == EXIT_NOPERM)
        return k->database != CTL_NO_DATABASE;
    return true;
}

static void print_exits(const struct ctl_command *k)
{
    (void)printf("Exit codes:\n");
    for (int i = 0; i < 3; i++)
        if (i == 0 || k->exits[i] != NULL)
            (void)printf("  %2d  %s\n", i, k->exits[i] != NULL ? k->exits[i] : "done");
    (void)printf("  64");
    for (size_t i = 0; i < NEXIT; i++)
        if (exits[i].code > EXIT_USAGE && can_fail(k, exits[i].code))
            (void)printf(", %d", exits[i].code);
    (void)printf("  an error (surfacectl help exit)\n");
}

/* ---- pages */

static void print_all(void)
{
    (void)printf("Usage: surfacectl [--db PATH] [--json] COMMAND [ARGUMENT...]\n\n");
    print_summaries(NULL);
    print_options(CTL_DATABASE | CTL_COMMON, NULL);
    (void)printf("Example:\n  surfacectl --db faces.db init\n"
                 "  surfacectl --db faces.db enroll alice alice.ply\n"
                 "  surfacectl --db faces.db verify alice probe.ply\n\n"
                 "Exit codes: surfacectl help exit\n");
}

static void print_group(const char *group)
{
    (void)printf("Usage: surfacectl %s COMMAND [ARGUMENT...]\n\n", group);
    print_summaries(group);
    (void)printf("Example:\n");
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        if (ctl_table_in(*k, group))
            (void)printf("  %s\n", (*k)->example);
    (void)printf("\nExit codes: surfacectl help exit\n");
}

static void print_command(const struct ctl_command *k)
{
    (void)printf("Usage: surfacectl%s %s%s%s\n\n%c%s.\n%s\n\n",
                 k->database >= CTL_NEEDS_DATABASE   ? " --db PATH"
                 : k->database == CTL_TAKES_DATABASE ? " [--db PATH]"
                                                     : "",
                 k->name, k->args != NULL ? " " : "", k->args != NULL ? k->args : "",
                 toupper((unsigned char)k->summary[0]), k->summary + 1, k->help);
    print_options(ctl_table_options(k) & ~(unsigned)CTL_VERSION, k->options);
    (void)printf("Example:\n  %s\n\n", k->example);
    print_exits(k);
}

static void print_exit_codes(void)
{
    (void)printf("Exit codes of surfacectl:\n");
    for (size_t i = 0; i < NEXIT; i++)
        (void)printf("  %2d  %s\n", exits[i].code, exits[i].meaning);
}

static void print_version(void)
{
    const char *version = strchr(FACE_ENGINE, '/') + 1;

    (void)printf("surfacectl %.*s (%s)\n", (int)strcspn(version, " "), version,
                 FACE_ENGINE);
}

void ctl_help_print(bool version, const struct ctl_command *cmd, const char *group)
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

bool ctl_help_is_group(const char *word)
{
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        if (ctl_table_in(*k, word))
            return true;
    return false;
}

/* ---- the command */

static enum status run(struct ctl *c)
{
    const struct ctl_command *cmd = NULL;
    const char *word = c->nargs > 0 ? c->args[0] : NULL;
    int used = 0;

    if (c->json)
        return ctl_usage(c, "help is text, not JSON");
    if (word != NULL && strcmp(word, "exit") == 0) {
        print_exit_codes();
        return ST_OK;
    }
    if (word != NULL && (cmd = ctl_table_find(c->args, c->nargs, &used)) == NULL &&
        !ctl_help_is_group(word))
        return ctl_usage(c, "there is no command %.80s (surfacectl help)", word);
    ctl_help_print(false, cmd, word);
    return ST_OK;
}

const struct ctl_command ctl_help = {
    .name = "help",
    .args = "[COMMAND | exit]",
    .takes = {0, 2},
    .run = run,
    .summary = "print a help text",
    .help = "Of surfacectl, of a command or a group of commands, or of all exit codes.",
    .example = "surfacectl help token create"};
