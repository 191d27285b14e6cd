/* surfacectl -- administer a template database from the command line, beside a running
 * daemon or without one. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crypt_file.h"
#include "nodump.h"
#include "ctl_command.h"
#include "ctl_model.h"
#include "ctl_table.h"
#include "outfile.h"

struct line {
    struct ctl c;
    const struct ctl_command *cmd; /* NULL: none, or a group */
    const char *group;             /* its first word alone was typed, for help */
    struct command_line typed;
};

/* ---- options */

static void list_options(struct line *l, unsigned shared,
                         const struct command_option *own)
{
    const struct command_option *o;

    for (size_t i = 0; (o = ctl_option_at(shared, own, i)) != NULL; i++)
        command_line_add(&l->typed, o);
}

static bool read_options(int argc, char **argv, struct line *l)
{
    list_options(l, CTL_COMMON, NULL);
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        list_options(l, ctl_table_options(*k), (*k)->options);
    return command_line_read(&l->typed, argc, argv, &l->c.e);
}

/* Reads the values into the variables of the command's options. */
static bool ctl_read_values(struct line *l)
{
    const unsigned shared = ctl_table_options(l->cmd);
    const struct command_option *own = l->cmd != NULL ? l->cmd->options : NULL;

    for (int k = 0; k < l->typed.noption; k++)
        if (l->typed.given[k] &&
            !command_line_take(&l->typed, k,
                               ctl_option_find(shared, own, l->typed.option[k].name),
                               l->cmd != NULL ? l->cmd->name : "", &l->c, &l->c.e))
            return false;
    return true;
}

/* ---- the command */

/* Reports that the words name no command, and lists the verbs if they name a group. */
static bool no_command(struct line *l, const char *word)
{
    char list[160] = "";
    size_t at = 0;

    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        if (ctl_table_in(*k, word) && at < sizeof list)
            at += (size_t)snprintf(list + at, sizeof list - at, "%s%s",
                                   at > 0 ? ", " : "", strchr((*k)->name, ' ') + 1);
    if (at > 0)
        (void)ctl_usage(&l->c, "usage: surfacectl %s COMMAND, which is one of %s", word,
                        list);
    else
        (void)ctl_usage(&l->c, "there is no command %.80s (surfacectl --help)", word);
    return false;
}

/* The command that the words name; only a group, or none, where help is wanted. */
static bool read_words(struct line *l, char **words, int n)
{
    const bool help = command_line_given(&l->typed, "help");
    int used;

    if (n == 0)
        return true;
    if ((l->cmd = ctl_table_find(words, n, &used)) == NULL) {
        l->group = words[0];
        return (help && n == 1 && ctl_table_is_group(words[0])) ||
               no_command(l, words[0]);
    }
    l->c.cmd = l->cmd;
    l->c.command = l->cmd->name;
    l->c.args = words + used;
    l->c.nargs = n - used;
    if (!help && (l->c.nargs < l->cmd->takes[0] || l->c.nargs > l->cmd->takes[1])) {
        (void)ctl_usage(&l->c, "usage: surfacectl %s%s%s", l->cmd->name,
                        l->cmd->args != NULL ? " " : "",
                        l->cmd->args != NULL ? l->cmd->args : "");
        return false;
    }
    return true;
}

static bool ctl_read_line(int argc, char **argv, struct line *l)
{
    const bool ok = read_options(argc, argv, l) &&
                    read_words(l, argv + optind, argc - optind) && ctl_read_values(l);

    if (ok && l->cmd == NULL && !l->c.help && !l->c.version)
        (void)ctl_usage(&l->c, "a command is missing (surfacectl --help)");
    if (l->c.e.code != ST_OK)
        l->c.code = EXIT_USAGE;
    return l->c.e.code == ST_OK;
}

static enum status ctl_run(struct ctl *c, struct surface_model **model)
{
    const enum ctl_database database = c->cmd->database;
    enum status st = ctl_model_read(c, model);

    c->actor = ctl_actor();
    if (sodium_init() < 0)
        return errinfo_set(&c->e, ST_EINTERNAL,
                           "the cryptographic library does not start");
    if (st == ST_OK && (c->cmd->shared & CTL_MODEL) != 0 &&
        (c->work = surface_work_new(c->model)) == NULL)
        st = errinfo_memory(&c->e);
    if (st == ST_OK && database >= CTL_READS_DATABASE)
        st = ctl_model_open(
            c, database == CTL_WRITES_DATABASE && !c->dry_run ? STORE_WRITE : STORE_READ);
    return st == ST_OK ? c->cmd->run(c) : st;
}

int main(int argc, char **argv)
{
    struct line l = {.typed = {.program = "surfacectl"}};
    struct ctl *c = &l.c;
    struct surface_model *model = NULL;
    bool ok = ctl_read_line(argc, argv, &l);
    int code = EXIT_USAGE;

    nodump_begin();
    outfile_wait();
    if (ok && (c->help || c->version)) {
        ctl_table_print(c->version, l.cmd, l.group);
        return command_end("surfacectl", NULL, false, &c->e, EXIT_FINE);
    }
    ok = ok && ctl_model_find(c) == ST_OK;
    c->json =
        command_line_given(&l.typed, "json"); /* also if the command line is wrong */
    if (c->json && (c->out = json_new()) == NULL) {
        (void)fprintf(stderr, "surfacectl: out of memory\n");
        return EXIT_OSERR;
    }
    if (ok) {
        c->e.code = ctl_run(c, &model);
        code = c->e.code == ST_OK || c->code == EXIT_USAGE ? c->code
                                                           : command_exit(c->e.code);
    }
    store_close(c->store);
    surface_work_free(c->work);
    surface_model_free(model);
    ctl_model_free(c);
    crypt_file_free(c->asked);
    return command_end("surfacectl", c->out, c->code == EXIT_USAGE, &c->e, code);
}
