/* The database that the command line, the environment or the daemon's settings name (options.h). */
#include "ctl_config.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "options.h"
#include "ctl.h"

/* Reads the daemon's settings into c->settings, to be released by ctl_config_free().  Returns ST_EINVAL with
 * the first problem in c->e. */
static enum status ctl_config_load(struct ctl *c)
{
    static const char program[] = "surfaced: ";
    char *problems = NULL;
    size_t len;
    FILE *errors = open_memstream(&problems, &len);
    bool read = false;
    enum status st = ST_OK;

    c->settings = calloc(1, sizeof *c->settings);
    if (c->settings != NULL && errors != NULL &&
        (read = options_new(errors, c->settings)))
        options_load(c->settings, c->config, NULL);
    if (errors != NULL)
        read = fclose(errors) == 0 && read;
    if (!read)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    else if (settings_problems(c->settings->settings) > 0)
        st = ctl_usage(c, "%.*s", (int)strcspn(problems, "\n") - (int)strlen(program),
                       problems + strlen(program));
    free(problems);
    return st;
}

void ctl_config_free(struct ctl *c)
{
    if (c->settings != NULL)
        options_free(c->settings);
    free(c->settings);
    c->settings = NULL;
}

enum status ctl_config_database(struct ctl *c, bool model)
{
    const char *db = getenv("SURFACED_DB");
    enum status st;

    if (c->db == NULL && c->config == NULL && db != NULL && db[0] != '\0')
        c->db = db;
    if (c->db != NULL && c->config == NULL)
        return ST_OK;
    if ((st = ctl_config_load(c)) != ST_OK)
        return st;
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
