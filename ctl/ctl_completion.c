/* What bash and zsh complete command lines by: a function made from the tables. */
#include <stdio.h>
#include <string.h>

#include "ctl_command.h"
#include "ctl_table.h"

enum kind { FLAG, FILES, CHOICES, WORD }; /* what follows an option */

static enum kind kind_of(const struct command_option *o)
{
    if (o->arg == NULL)
        return FLAG;
    if (strstr(o->arg, "FILE") != NULL || strstr(o->arg, "DIR") != NULL ||
        strcmp(o->arg, "PATH") == 0 || strcmp(o->arg, "MANIFEST") == 0)
        return FILES;
    return strchr(o->arg, '|') != NULL ? CHOICES : WORD;
}

/* The options of that kind, every shared one once, and every command's own. */
static void print_kind(enum kind kind)
{
    const struct command_option *o;
    unsigned seen = 0;

    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++) {
        const unsigned shared = ctl_table_options(*k) & ~seen;

        for (size_t i = 0; (o = ctl_option_at(shared, (*k)->options, i)) != NULL; i++) {
            if (kind_of(o) != kind)
                continue;
            (void)printf("|--%s", o->name);
            if (o->letter != 0)
                (void)printf("|-%c", o->letter);
        }
        seen |= shared;
    }
}

static void print_choices(void)
{
    const struct command_option *o;

    for (size_t i = 0; (o = ctl_option_at(~0U, NULL, i)) != NULL; i++) {
        if (kind_of(o) != CHOICES)
            continue;
        (void)printf("    --%s)\n        words='", o->name);
        for (const char *p = o->arg; *p != '\0'; p++)
            (void)putchar(*p == '|' ? ' ' : *p);
        (void)printf("' ;;\n");
    }
}

/* The verbs of each group, for its name alone; the group's first command stands for it. */
static void print_groups(void)
{
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++) {
        const int n = (int)strcspn((*k)->name, " ");
        char group[32];

        (void)snprintf(group, sizeof group, "%.*s", n, (*k)->name);
        if ((*k)->name[n] == '\0' || (k > ctl_table && ctl_table_in(k[-1], group)))
            continue;
        (void)printf("    '%s')\n        words='", group);
        for (const struct ctl_command *const *j = k; *j != NULL; j++)
            if (ctl_table_in(*j, group))
                (void)printf("%s%s", j != k ? " " : "", (*j)->name + n + 1);
        (void)printf("' ;;\n");
    }
}

/* The first words: each group once. */
static void print_first(void)
{
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++) {
        char group[32];

        (void)snprintf(group, sizeof group, "%.*s", (int)strcspn((*k)->name, " "),
                       (*k)->name);
        if (k == ctl_table || !ctl_table_in(k[-1], group))
            (void)printf("%s%s", k != ctl_table ? " " : "", group);
    }
}

static void print_options(void)
{
    const struct command_option *o;

    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++) {
        (void)printf("        '%s'*) words='", (*k)->name);
        for (size_t i = 0;
             (o = ctl_option_at(ctl_table_options(*k), (*k)->options, i)) != NULL; i++)
            (void)printf("--%s ", o->name);
        (void)printf("' ;;\n");
    }
    (void)printf("        *) words='--db --key --json --help --version' ;;\n");
}

static void print_function(void)
{
    (void)printf(
        "_surfacectl() {\n"
        "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
        "    local name='' words='' i=1\n"
        "    COMPREPLY=()\n"
        "    while [ \"$i\" -lt \"$COMP_CWORD\" ]; do\n"
        "        case ${COMP_WORDS[i]} in\n"
        "        ''");
    print_kind(FILES);
    print_kind(CHOICES);
    print_kind(WORD);
    (void)printf(") i=$((i + 1)) ;;\n"
                 "        -*) ;;\n"
                 "        *) name=\"$name${name:+ }${COMP_WORDS[i]}\" ;;\n"
                 "        esac\n"
                 "        i=$((i + 1))\n"
                 "    done\n"
                 "    case $prev in\n"
                 "    ''");
    print_kind(FILES);
    (void)printf(")\n"
                 "        COMPREPLY=($(compgen -f -- \"$cur\"))\n"
                 "        return ;;\n");
    print_choices();
    (void)printf("    ''");
    print_kind(WORD);
    (void)printf(") return ;;\n"
                 "    esac\n"
                 "    if [ -z \"$words\" ] && [[ $cur == -* ]]; then\n"
                 "        case $name in\n");
    print_options();
    (void)printf("        esac\n"
                 "    fi\n"
                 "    [ -n \"$words\" ] || case $name in\n"
                 "    '')\n"
                 "        words='");
    print_first();
    (void)printf("' ;;\n");
    print_groups();
    (void)printf("    *)\n"
                 "        COMPREPLY=($(compgen -f -- \"$cur\"))\n"
                 "        return ;;\n"
                 "    esac\n"
                 "    COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n"
                 "}\n"
                 "complete -o filenames -F _surfacectl surfacectl\n");
}

static enum status ctl_completion_run(struct ctl *c)
{
    const bool zsh = strcmp(c->args[0], "zsh") == 0;

    if (!zsh && strcmp(c->args[0], "bash") != 0)
        return ctl_usage(c, "usage: surfacectl completion bash|zsh");
    if (c->json)
        return ctl_usage(c, "completion prints a shell program, not JSON");
    if (zsh)
        (void)printf("autoload -Uz bashcompinit && bashcompinit\n");
    print_function();
    return ST_OK;
}

const struct ctl_command ctl_completion = {
    .name = "completion",
    .args = "bash|zsh",
    .takes = {1, 1},
    .run = ctl_completion_run,
    .summary = "print completions for bash or zsh",
    .help =
        "For bash, put `source <(surfacectl completion bash)` into ~/.bashrc. For zsh, put the\n"
        "same with zsh into ~/.zshrc, after compinit.",
    .example = "surfacectl completion bash >/etc/bash_completion.d/surfacectl"};
