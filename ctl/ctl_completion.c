/* What bash and zsh complete command lines by: a function made from the tables. */
#include <stdio.h>
#include <string.h>

#include "ctl.h"
#include "ctl_command.h"
#include "ctl_option.h"

static bool takes_path(const struct ctl_option *o)
{
    return strstr(o->arg, "FILE") != NULL || strstr(o->arg, "DIR") != NULL ||
           strcmp(o->arg, "PATH") == 0 || strcmp(o->arg, "MANIFEST") == 0;
}

/* "|--db|--key": the options whose values are paths, or are not. */
static void print_valued(bool path)
{
    const char *between = "";

    for (const struct ctl_option *o = ctl_options; o->name != NULL; o++)
        if (o->arg != NULL && takes_path(o) == path) {
            (void)printf("%s--%s", between, o->name);
            if (o->also != NULL)
                (void)printf("|-%s", o->also);
            between = "|";
        }
}

/* The values of options that have but a few: "mm|cm|m". */
static void print_choices(void)
{
    for (const struct ctl_option *o = ctl_options; o->name != NULL; o++)
        if (o->arg != NULL && !takes_path(o) && strchr(o->arg, '|') != NULL) {
            (void)printf("    --%s)\n        words='", o->name);
            for (const char *p = o->arg; *p != '\0'; p++)
                (void)putchar(*p == '|' ? ' ' : *p);
            (void)printf("' ;;\n");
        }
}

/* The verbs of each group, for its name alone. */
static void print_groups(void)
{
    const struct ctl_command *k, *j;

    for (k = ctl_commands; k->name != NULL; k++) {
        const int n = (int)strcspn(k->name, " ");

        /* a group's first command stands for it */
        if (k->name[n] == '\0' ||
            (k > ctl_commands && strncmp(k[-1].name, k->name, (size_t)n + 1) == 0))
            continue;
        (void)printf("    '%.*s')\n        words='", n, k->name);
        for (j = k; j->name != NULL; j++)
            if (strncmp(j->name, k->name, (size_t)n + 1) == 0)
                (void)printf("%s%s", j != k ? " " : "", j->name + n + 1);
        (void)printf("' ;;\n");
    }
}

/* The first words: each group once. */
static void print_first(void)
{
    const struct ctl_command *k;

    for (k = ctl_commands; k->name != NULL; k++) {
        const size_t n = strcspn(k->name, " ");

        if (!k->old && (k == ctl_commands || strncmp(k[-1].name, k->name, n) != 0 ||
                        k[-1].name[n] != ' ' || k->name[n] == '\0'))
            (void)printf("%s%.*s", k != ctl_commands ? " " : "", (int)n, k->name);
    }
}

static void print_options(void)
{
    for (const struct ctl_command *k = ctl_commands; k->name != NULL; k++) {
        (void)printf("        '%s'*) words='", k->name);
        for (const struct ctl_option *o = ctl_options; o->name != NULL; o++)
            if (o->common || ctl_option_in(o, k->options))
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
        "        ");
    print_valued(true);
    (void)printf("|");
    print_valued(false);
    (void)printf(") i=$((i + 1)) ;;\n"
                 "        -*) ;;\n"
                 "        *) name=\"$name${name:+ }${COMP_WORDS[i]}\" ;;\n"
                 "        esac\n"
                 "        i=$((i + 1))\n"
                 "    done\n"
                 "    case $prev in\n"
                 "    ");
    print_valued(true);
    (void)printf(")\n"
                 "        COMPREPLY=($(compgen -f -- \"$cur\"))\n"
                 "        return ;;\n");
    print_choices();
    (void)printf("    ");
    print_valued(false);
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

int ctl_completion(struct ctl *c)
{
    const bool zsh = strcmp(c->args[0], "zsh") == 0;

    if (!zsh && strcmp(c->args[0], "bash") != 0)
        return ctl_usage(c, "it is: surfacectl completion bash|zsh");
    if (c->json)
        return ctl_usage(c, "completion is a shell's program, not JSON");
    if (zsh)
        (void)printf("autoload -Uz bashcompinit && bashcompinit\n");
    print_function();
    return EXIT_FINE;
}
