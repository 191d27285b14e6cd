/* config: the daemon's settings, read as the daemon reads them (options.h). */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "options.h"
#include "ctl_command.h"
#include "ctl_config.h"

/* Where systemd keeps the credentials of the service, for processes outside of it. */
#define CREDENTIALS       "CREDENTIALS_DIRECTORY"
#define CREDENTIALS_USUAL "/run/credentials/surfaced.service"

/* Reads the settings into c->settings; *problems, to be freed, has a line for each. */
static enum status ctl_config_load(struct ctl *c, bool files, char **problems)
{
    size_t len;
    FILE *errors;
    bool good = false;

    ctl_config_free(c);
    (void)setenv(CREDENTIALS, CREDENTIALS_USUAL, 0);
    *problems = NULL;
    c->settings = calloc(1, sizeof *c->settings);
    if (c->settings != NULL && (errors = open_memstream(problems, &len)) != NULL) {
        if (options_new(errors, c->settings)) {
            options_load(c->settings, c->config, NULL);
            if (files)
                options_check_files(c->settings);
            good = true;
        }
        good = fclose(errors) == 0 && good;
    }
    return good ? ST_OK : errinfo_set(&c->e, ST_ENOMEM, "out of memory");
}

void ctl_config_free(struct ctl *c)
{
    if (c->settings != NULL)
        options_free(c->settings);
    free(c->settings);
    c->settings = NULL;
}

static bool is_good(const struct ctl *c)
{
    return settings_problems(c->settings->settings) == 0;
}

/* The next of the problems, without the name of the daemon; NULL: there is none. */
static const char *next_problem(char **rest)
{
    static const char name[] = "surfaced: ";
    const char *line = strtok_r(*rest, "\n", rest);

    return line != NULL && strncmp(line, name, strlen(name)) == 0 ? line + strlen(name)
                                                                  : line;
}

enum status ctl_config_database(struct ctl *c, bool model)
{
    const char *db = getenv("SURFACED_DB");
    char *problems, *rest;
    enum status st;

    if (c->db == NULL && c->config == NULL && db != NULL && db[0] != '\0')
        c->db = db;
    if (c->db != NULL && c->config == NULL)
        return ST_OK;
    if ((st = ctl_config_load(c, false, &problems)) == ST_OK && !is_good(c)) {
        rest = problems;
        st = errinfo_set(&c->e, ST_EINVAL, "%.200s", next_problem(&rest));
    }
    free(problems);
    if (st != ST_OK) {
        c->code = EXIT_USAGE;
        return st;
    }
    if (c->db == NULL)
        c->db = c->settings->db;
    if (c->key == NULL)
        c->key = c->settings->key;
    if (c->anchor == NULL)
        c->anchor = c->settings->anchor;
    c->plaintext = c->plaintext || c->settings->plaintext_database;
    if (c->model_path == NULL && model)
        c->model_path = c->settings->model;
    return ST_OK;
}

static void out_settings(struct ctl *c)
{
    const struct settings *s = c->settings->settings;
    char from[PATH_MAX + 32];

    json_object(c->out, "settings");
    for (size_t i = 0; i < OPTIONS_ROWS; i++) {
        const char *value = settings_value(s, i, from, sizeof from);

        if (value == NULL)
            continue;
        json_object(c->out, options_table[i].name);
        json_text(c->out, "value", value);
        json_text(c->out, "from", from);
        json_close(c->out);
    }
    json_close(c->out);
}

static enum status ctl_run_config_show(struct ctl *c)
{
    char *problems, *rest;
    enum status st = ctl_config_load(c, false, &problems);

    rest = problems;
    if (st == ST_OK && !is_good(c))
        st = errinfo_set(&c->e, ST_ECORRUPT, "%.200s (surfacectl config check)",
                         next_problem(&rest));
    free(problems);
    if (st != ST_OK)
        return st;
    if (!c->json)
        settings_print(c->settings->settings, stdout);
    out_settings(c);
    return ST_OK;
}

static enum status ctl_run_config_check(struct ctl *c)
{
    char *problems, *rest;
    const char *line;

    if (ctl_config_load(c, true, &problems) != ST_OK) {
        free(problems);
        return ST_ENOMEM;
    }
    if (!c->json)
        (void)fputs(is_good(c) ? "the configuration is good\n" : problems, stdout);
    json_array(c->out, "problems");
    rest = problems;
    while ((line = next_problem(&rest)) != NULL)
        json_text(c->out, NULL, line);
    json_close(c->out);
    json_flag(c->out, "ok", is_good(c));
    free(problems);
    c->code = is_good(c) ? EXIT_FINE : EXIT_NO;
    return ST_OK;
}

const struct ctl_command ctl_config_show = {
    .name = "config show",
    .shared = CTL_CONFIG,
    .run = ctl_run_config_show,
    .summary = "print the daemon's settings and their sources",
    .help =
        "The settings that surfaced would use if it were started now: from the file --config,\n"
        "SURFACED_CONFIG or /etc/surfaced.conf, from the environment, and defaults.",
    .example = "surfacectl config show --json"};

const struct ctl_command ctl_config_check = {
    .name = "config check",
    .shared = CTL_CONFIG,
    .exits = {"surfaced would start", "it would not: each problem is printed"},
    .run = ctl_run_config_check,
    .summary = "find what is wrong with the daemon's settings",
    .help =
        "Each problem is printed with its place. Nothing is written; a running daemon is not\n"
        "affected. surfaced itself also checks the contents of certificates.",
    .example = "surfacectl config check --config new.conf"};
