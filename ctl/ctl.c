/* surfacectl -- administer a template database from the command line, beside a running
 * daemon or without one. */
#include "ctl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "keyfile.h"
#include "ctl_command.h"
#include "ctl_help.h"
#include "ctl_option.h"

struct line {
    struct ctl c;
    const struct ctl_command *cmd; /* NULL: none, or a group */
    const char *name;              /* as it was typed: its own or the other */
    const char *group;             /* its first word alone was typed, for help */
    bool given[CTL_OPTIONS];
};

static bool wrong(struct errinfo *e, const char *what, const char *which)
{
    (void)errinfo_set(e, ST_EINVAL, "%s %.80s (surfacectl --help)", what, which);
    return false;
}

/* The option at argv[*i], with its value in the same argument or the next; *i moves on. */
static bool read_option(int argc, char **argv, int *i, struct line *l)
{
    const char *text = argv[*i], *value = NULL;
    const size_t n = strcspn(text, "=");
    const struct ctl_option *o = ctl_option_find(text, n);

    if (o == NULL || (o->arg == NULL && text[n] != '\0'))
        return wrong(&l->c.e, "there is no option", text);
    if (o->arg != NULL) {
        if (text[n] == '=')
            value = text + n + 1;
        else if (*i + 1 < argc)
            value = argv[++*i];
        if (value == NULL)
            return wrong(&l->c.e, "a value is missing after", text);
    }
    if (l->given[o - ctl_options])
        return wrong(&l->c.e, "given twice:", text);
    l->given[o - ctl_options] = true;
    return o->set((char *)&l->c + o->field, value) || wrong(&l->c.e, o->wrong, value);
}

/* What one may type after the group's name. */
static bool which_of(struct line *l, const char *group)
{
    char list[200] = "";
    size_t n = 0;

    for (const struct ctl_command *k = ctl_commands; k->name != NULL; k++)
        if (ctl_command_in(k, group) && n < sizeof list)
            n +=
                (size_t)snprintf(list + n, sizeof list - n, "%s%s%s%s", n > 0 ? ", " : "",
                                 k->name, k->args[0] != '\0' ? " " : "", k->args);
    (void)errinfo_set(&l->c.e, ST_EINVAL, "it is: surfacectl %s", list);
    return false;
}

static bool is_group(const char *word)
{
    for (const struct ctl_command *k = ctl_commands; k->name != NULL; k++)
        if (ctl_command_in(k, word))
            return true;
    return false;
}

/* The command that the words name, and whether it takes the rest of them. */
static bool read_words(struct line *l, char **words, int n)
{
    int used;

    if (n == 0)
        return l->c.help || l->c.version || wrong(&l->c.e, "which command?", "");
    if ((l->cmd = ctl_command_find(words, n, &used)) == NULL) {
        if (!is_group(words[0]))
            return wrong(&l->c.e, "there is no command", words[0]);
        l->group = words[0];
        return (l->c.help && n == 1) || l->c.version || which_of(l, words[0]);
    }
    l->name = used == 1 ? words[0] : l->cmd->name;
    l->c.args = words + used;
    l->c.nargs = n - used;
    if (l->c.help || l->c.version)
        return true;
    if (l->c.nargs < l->cmd->min || l->c.nargs > l->cmd->max) {
        (void)ctl_usage(&l->c, "it is: surfacectl %s %s", l->name, l->cmd->args);
        return false;
    }
    for (int k = 0; ctl_options[k].name != NULL; k++)
        if (l->given[k] && !ctl_options[k].common &&
            !ctl_option_in(&ctl_options[k], l->cmd->options)) {
            (void)ctl_usage(
                &l->c, "--%s is an option that %s does not take (surfacectl %s --help)",
                ctl_options[k].name, l->name, l->name);
            return false;
        }
    return true;
}

/* Options may stand anywhere; "--" ends them.  What is no option is moved to the front. */
static bool read_line(int argc, char **argv, struct line *l)
{
    bool options = true;
    int n = 0;

    for (int i = 1; i < argc; i++) {
        if (options && strcmp(argv[i], "--") == 0) {
            options = false;
        } else if (options && argv[i][0] == '-' && argv[i][1] != '\0') {
            if (!read_option(argc, argv, &i, l))
                return false;
        } else {
            argv[n++] = argv[i];
        }
    }
    return read_words(l, argv, n);
}

static void print_error(struct ctl *c, int code)
{
    (void)fflush(stdout);
    (void)fprintf(stderr, "surfacectl: %s\n", c->e.msg);
    ctl_out_object(c->out, "error");
    ctl_out_text(c->out, "detail", c->e.msg);
    ctl_out_number(c->out, "exit", code);
    ctl_out_close(c->out);
}

/* NULL where it is not set, or empty. */
static const char *environment(const char *name)
{
    const char *value = getenv(name);

    return value != NULL && value[0] != '\0' ? value : NULL;
}

static void print_help(const struct line *l)
{
    if (l->c.version)
        ctl_help_version();
    else if (l->cmd != NULL)
        ctl_help_command(l->cmd);
    else if (l->group != NULL)
        ctl_help_group(l->group);
    else
        ctl_help_all();
}

/* What the environment says, or the daemon's configuration, where the command line did not. */
static bool read_environment(struct line *l)
{
    struct ctl *c = &l->c;
    const bool model = ctl_option_in(ctl_option_find("--model", 7), l->cmd->options);

    if (model && c->model_path == NULL)
        c->model_path = environment("SURFACED_MODEL");
    if (c->key == NULL)
        c->key = environment("SURFACED_KEY");
    return !l->cmd->db || ctl_config_database(c, model) == ST_OK;
}

int main(int argc, char **argv)
{
    struct line l = {0};
    struct model *model = NULL;
    bool ok = read_line(argc, argv, &l);
    int code = EXIT_USAGE;

    if (ok && (l.c.help || l.c.version)) {
        print_help(&l);
        return EXIT_FINE;
    }
    ok = ok && read_environment(&l);
    if ((l.c.out = ctl_out_new(l.c.json)) == NULL) {
        (void)fprintf(stderr, "surfacectl: out of memory\n");
        return EXIT_OSERR;
    }
    if (ok) {
        const enum status st = ctl_model_read(&l.c, &model);

        code = st == ST_OK ? l.cmd->run(&l.c) : ctl_fail(&l.c, st);
    }
    free(model);
    ctl_config_free(&l.c);
    keyfile_free(l.c.asked);
    if (code > EXIT_INCONCLUSIVE)
        print_error(&l.c, code);
    if (!ctl_out_end(l.c.out, stdout)) {
        (void)fprintf(stderr, "surfacectl: the output cannot be written\n");
        return code > EXIT_INCONCLUSIVE ? code : EXIT_IOERR;
    }
    return code;
}
