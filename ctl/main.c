/* surfacectl -- administer a template database from the command line, beside a running
 * daemon or without one. */
#include <getopt.h>
#include <sodium.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crypt_file.h"
#include "nodump.h"
#include "ctl_command.h"
#include "ctl_config.h"
#include "ctl_model.h"
#include "ctl_table.h"

#define OPTIONS 64  /* of different names, at most */
#define LONG    256 /* what getopt_long() returns for the first of them */

struct line {
    struct ctl c;
    const struct ctl_command *cmd; /* NULL: none, or a group */
    const char *group;             /* its first word alone was typed, for help */
    struct option option[OPTIONS + 1];
    int noption;
    bool given[OPTIONS];
    const char *value[OPTIONS];
};

static bool wrong(struct line *l, const char *what, const char *which)
{
    (void)ctl_usage(&l->c, "%s %.80s (surfacectl --help)", what, which);
    return false;
}

/* "; did you mean --json?", where one of the names is near the word that was typed; or "". */
static const char *meant(const struct ctl_near *near, char out[80])
{
    out[0] = '\0';
    if (near->name[0] != '\0')
        (void)snprintf(out, 80, "; did you mean %s?", near->name);
    return out;
}

/* ---- options: every name once, since they may stand before the command */

static void list_options(struct line *l, unsigned shared, const struct ctl_option *own)
{
    const struct ctl_option *o;

    for (size_t i = 0; (o = ctl_option_at(shared, own, i)) != NULL; i++) {
        int k = 0;

        while (k < l->noption && strcmp(l->option[k].name, o->name) != 0)
            k++;
        if (k == l->noption && k < OPTIONS)
            l->option[l->noption++] =
                (struct option){o->name, o->arg != NULL ? required_argument : no_argument,
                                NULL, o->letter != 0 ? o->letter : LONG + k};
    }
}

static int index_of(const struct line *l, int returned)
{
    int k = 0;

    while (l->option[k].val != returned)
        k++;
    return k;
}

static bool no_option(struct line *l, const char *word)
{
    struct ctl_near near = {.name = ""};
    char text[80];

    for (int k = 0; strncmp(word, "--", 2) == 0 && k < l->noption; k++)
        ctl_near(&near, word, "--", l->option[k].name);
    (void)ctl_usage(
        &l->c,
        "there is no option %.60s%s (surfacectl --help; an argument that begins "
        "with a hyphen stands after --)",
        word, meant(&near, text));
    return false;
}

static bool read_options(int argc, char **argv, struct line *l)
{
    int got;

    list_options(l, CTL_COMMON, NULL);
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++)
        list_options(l, ctl_table_options(*k), (*k)->options);
    opterr = 0;
    while ((got = getopt_long(argc, argv, ":ho:", l->option, NULL)) != -1) {
        int k;

        if (got == '?')
            return no_option(l, argv[optind - 1]);
        if (got == ':')
            return wrong(l, "a value is missing after", argv[optind - 1]);
        k = index_of(l, got);
        if (l->given[k])
            return wrong(l, "given twice:", l->option[k].name);
        l->given[k] = true;
        l->value[k] = optarg;
    }
    return true;
}

/* What was given, into the places that the command's options have. */
static bool read_values(struct line *l)
{
    const char *name = l->cmd != NULL ? l->cmd->name : "";

    for (int k = 0; k < l->noption; k++) {
        const struct ctl_option *o;
        const char *wanted;

        if (!l->given[k])
            continue;
        o = ctl_option_find(ctl_table_options(l->cmd),
                            l->cmd != NULL ? l->cmd->options : NULL, l->option[k].name);
        if (o == NULL)
            (void)ctl_usage(
                &l->c, "--%s is an option that %s does not take (surfacectl %s --help)",
                l->option[k].name, name, name);
        else if ((wanted = o->read(l->value[k], o->value != NULL
                                                    ? o->value
                                                    : (char *)&l->c + o->at)) != NULL)
            (void)ctl_usage(&l->c, "--%s takes %s, not '%.80s'", o->name, wanted,
                            l->value[k]);
        if (l->c.e.code != ST_OK)
            return false;
    }
    return true;
}

/* ---- the command */

/* No command: of a group the verbs are listed, else the nearest name is. */
static bool no_command(struct line *l, char **words, int n)
{
    struct ctl_near near = {.name = ""};
    char list[160] = "", typed[160], text[80];
    size_t at = 0;

    (void)snprintf(typed, sizeof typed, "%.70s%s%.70s", words[0], n > 1 ? " " : "",
                   n > 1 ? words[1] : "");
    for (const struct ctl_command *const *k = ctl_table; *k != NULL; k++) {
        if (ctl_table_in(*k, words[0]) && at < sizeof list)
            at += (size_t)snprintf(list + at, sizeof list - at, "%s%s",
                                   at > 0 ? ", " : "", strchr((*k)->name, ' ') + 1);
        ctl_near(&near, strchr((*k)->name, ' ') != NULL ? typed : words[0], "",
                 (*k)->name);
    }
    if (at > 0 && n == 1)
        (void)ctl_usage(&l->c, "usage: surfacectl %s COMMAND, which is one of %s",
                        words[0], list);
    else
        (void)ctl_usage(&l->c, "there is no command %s%s (surfacectl %s%s--help)",
                        at > 0 ? typed : words[0], meant(&near, text),
                        at > 0 ? words[0] : "", at > 0 ? " " : "");
    return false;
}

/* The command that the words name; only a group, or none, where help is wanted. */
static bool read_words(struct line *l, char **words, int n)
{
    const bool help = l->given[index_of(l, 'h')];
    int used;

    if (n == 0)
        return true;
    if ((l->cmd = ctl_table_find(words, n, &used)) == NULL) {
        l->group = words[0];
        return (help && n == 1 && ctl_table_is_group(words[0])) ||
               no_command(l, words, n);
    }
    l->c.cmd = l->cmd;
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

static bool read_line(int argc, char **argv, struct line *l)
{
    if (!read_options(argc, argv, l) || !read_words(l, argv + optind, argc - optind))
        return false;
    if (!read_values(l))
        return false;
    return l->cmd != NULL || l->c.help || l->c.version ||
           wrong(l, "a command is", "missing");
}

static bool is_given(const struct line *l, const char *name)
{
    for (int k = 0; k < l->noption; k++)
        if (l->given[k] && strcmp(l->option[k].name, name) == 0)
            return true;
    return false;
}

/* NULL where it is not set, or empty. */
static const char *environment(const char *name)
{
    const char *value = getenv(name);

    return value != NULL && value[0] != '\0' ? value : NULL;
}

/* What the environment says, or the daemon's configuration, where the command line did not. */
static bool read_environment(struct line *l)
{
    struct ctl *c = &l->c;
    const bool model = (l->cmd->shared & CTL_MODEL) != 0;

    if (model && c->model_path == NULL)
        c->model_path = environment("SURFACED_MODEL");
    if (c->key == NULL)
        c->key = environment("SURFACED_KEY");
    if (c->anchor == NULL)
        c->anchor = environment("SURFACED_ANCHOR");
    if (environment("SURFACED_PLAINTEXT_DATABASE") != NULL)
        c->plaintext = strcmp(environment("SURFACED_PLAINTEXT_DATABASE"), "1") == 0;
    if (l->cmd->database == CTL_TAKES_DATABASE && c->config == NULL) {
        if (c->db == NULL)
            c->db = environment("SURFACED_DB");
        return true;
    }
    return l->cmd->database == CTL_NO_DATABASE || ctl_config_database(c, model) == ST_OK;
}

static enum status run(struct ctl *c, struct surface_model **model)
{
    const enum ctl_database database = c->cmd->database;
    enum status st = ctl_model_read(c, model);

    c->actor = ctl_actor();
    if (sodium_init() < 0)
        return errinfo_set(&c->e, ST_EINTERNAL,
                           "the cryptographic library does not start");
    if (st == ST_OK && (c->cmd->shared & CTL_UNITS) != 0 &&
        (c->work = surface_work_new(c->model)) == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if (st == ST_OK && database >= CTL_READS_DATABASE)
        st = ctl_model_open(
            c, database == CTL_WRITES_DATABASE && !c->dry_run ? STORE_WRITE : STORE_READ);
    return st == ST_OK ? c->cmd->run(c) : st;
}

static void print_error(struct ctl *c, int code)
{
    (void)fflush(stdout);
    (void)fprintf(stderr, "surfacectl: %s\n", c->e.msg);
    json_object(c->out, "error");
    json_text(c->out, "code", ctl_error_code(c));
    json_text(c->out, "detail", c->e.msg);
    json_number(c->out, "exit", code);
    json_close(c->out);
}

int main(int argc, char **argv)
{
    struct line l = {.c = {.threshold = (double)NAN}};
    struct ctl *c = &l.c;
    struct surface_model *model = NULL;
    bool ok = read_line(argc, argv, &l);
    int code = EXIT_USAGE;

    nodump_begin();
    if (ok && (c->help || c->version)) {
        ctl_table_print(c->version, l.cmd, l.group);
        return EXIT_FINE;
    }
    ok = ok && read_environment(&l);
    c->json = is_given(&l, "json"); /* of a wrong command line too */
    if (c->json && (c->out = json_new()) == NULL) {
        (void)fprintf(stderr, "surfacectl: out of memory\n");
        return EXIT_OSERR;
    }
    if (ok) {
        const enum status st = run(c, &model);

        c->e.code = st;
        code = ctl_exit(c, st);
    }
    store_close(c->store);
    surface_work_free(c->work);
    surface_model_free(model);
    ctl_config_free(c);
    crypt_file_free(c->asked);
    if (code > EXIT_INCONCLUSIVE)
        print_error(c, code);
    if ((c->json && !ctl_print(stdout, json_pretty(c->out))) || fflush(stdout) != 0) {
        (void)fprintf(stderr, "surfacectl: the output cannot be written\n");
        return code > EXIT_INCONCLUSIVE ? code : EXIT_IOERR;
    }
    return code;
}
