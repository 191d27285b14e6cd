/* The model and the database of a command: named, and opened. */
#include "ctl_model.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "crypt_file.h"
#include "ctl_command.h"
#include "store.h"
#include "modelfile.h"
#include "options.h"

#define PAGE 1000 /* subjects read at a time */

/* ---- keys */

/* One line from the terminal, which does not show it. */
static enum status ask(struct ctl *c, const char *what, const char *option,
                       struct crypt_file **out)
{
    struct termios was, hidden;
    struct crypt_file *k;
    FILE *tty = fopen("/dev/tty", "r+");
    char *end;

    *out = NULL;
    if (tty == NULL || tcgetattr(fileno(tty), &was) != 0) {
        if (tty != NULL)
            (void)fclose(tty);
        return errinfo_set(&c->e, ST_EINVAL,
                           "no passphrase: type it on a terminal, or name a file that "
                           "contains it with %s",
                           option);
    }
    if ((k = sodium_malloc(sizeof *k)) == NULL) {
        (void)fclose(tty);
        return errinfo_memory(&c->e);
    }
    (void)setvbuf(tty, NULL, _IONBF, 0); /* no copy of it is left in a buffer */
    hidden = was;
    hidden.c_lflag &= ~(tcflag_t)ECHO;
    (void)fprintf(tty, "%s: ", what);
    (void)tcsetattr(fileno(tty), TCSAFLUSH, &hidden);
    if (fgets(k->text, sizeof k->text, tty) == NULL)
        k->text[0] = '\0';
    (void)tcsetattr(fileno(tty), TCSAFLUSH, &was);
    (void)fprintf(tty, "\n");
    (void)fclose(tty);
    if ((end = strchr(k->text, '\n')) != NULL)
        *end = '\0';
    if ((k->len = strlen(k->text)) == 0) {
        crypt_file_free(k);
        return errinfo_set(&c->e, ST_EINVAL, "the passphrase is empty");
    }
    *out = k;
    return ST_OK;
}

/* A new passphrase, twice, so that a slip of the finger does not lock everybody out. */
enum status ctl_model_new_key(struct ctl *c, const char *option, struct crypt_file **out)
{
    struct crypt_file *again = NULL;
    enum status st;

    if ((st = ask(c, "New passphrase", option, out)) != ST_OK)
        return st;
    if ((st = ask(c, "Repeat the passphrase", option, &again)) == ST_OK &&
        strcmp((*out)->text, again->text) != 0)
        st = errinfo_set(&c->e, ST_EINVAL, "the two passphrases differ");
    crypt_file_free(again);
    if (st != ST_OK) {
        crypt_file_free(*out);
        *out = NULL;
    }
    return st;
}

enum status ctl_model_key(struct ctl *c, const char *db, struct store_key *key)
{
    enum crypt_kind kind;
    enum status st;

    if (c->plaintext && c->key != NULL)
        return ctl_usage(c, "--plaintext-database contradicts --key");
    (void)snprintf(c->usual_key, sizeof c->usual_key, "%s.key", db);
    *key = (struct store_key){
        .path = c->key != NULL ? c->key : c->usual_key,
        .make = CRYPT_FILE,
        .plaintext = c->plaintext,
        .anchor = c->anchor != NULL && strcmp(c->anchor, "none") != 0 ? c->anchor : NULL,
        .weak = c->short_passphrase,
    };
    if (c->plaintext)
        key->make = CRYPT_PLAINTEXT;
    else if (c->passphrase)
        key->make = CRYPT_PASSPHRASE;
    if (c->key == NULL && c->asked == NULL) {
        st = store_kind(db, &kind, NULL);
        if (st == ST_OK && kind == CRYPT_PASSPHRASE)
            st = ask(c, "Passphrase", "--key", &c->asked);
        else if (st != ST_OK && c->passphrase)
            st = ctl_model_new_key(c, "--key", &c->asked);
        else
            st = ST_OK; /* opening the database will report the problem */
        if (st != ST_OK)
            return st;
    }
    if (c->key == NULL && c->asked == NULL && !c->plaintext && store_on_server(db))
        return ctl_usage(c, "a database on a server needs --key FILE");
    key->given = c->asked;
    return ST_OK;
}

enum status ctl_model_archive_key(struct ctl *c, bool make, struct crypt_file **out)
{
    static const char option[] = "--archive-key";

    enum status st;

    *out = NULL;
    if (c->archive_key != NULL)
        st = crypt_file_read(c->archive_key, out, &c->e);
    else
        st = make ? ctl_model_new_key(c, option, out)
                  : ask(c, "Passphrase of the archive", option, out);
    return st == ST_OK && make && !c->short_passphrase ? crypt_file_strong(*out, &c->e)
                                                       : st;
}

/* ---- the database that is named */

/* Reads the daemon's settings into c->settings, to be released by ctl_model_free().  Returns ST_EINVAL with
 * the first problem in c->e. */
static enum status read_settings(struct ctl *c)
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
        st = errinfo_memory(&c->e);
    else if (settings_problems(c->settings->settings) > 0)
        st = ctl_usage(c, "%.*s", (int)strcspn(problems, "\n") - (int)strlen(program),
                       problems + strlen(program));
    free(problems);
    return st;
}

void ctl_model_free(struct ctl *c)
{
    if (c->settings != NULL)
        options_free(c->settings);
    free(c->settings);
    c->settings = NULL;
}

/* Returns NULL if the variable is not set, or empty. */
static const char *environment(const char *name)
{
    const char *value = getenv(name);

    return value != NULL && value[0] != '\0' ? value : NULL;
}

/* What the daemon's configuration says if neither command line nor environment does. */
static void take_settings(struct ctl *c)
{
    if (c->db == NULL)
        c->db = c->settings->db;
    if (c->key == NULL)
        c->key = c->settings->key;
    if (c->anchor == NULL)
        c->anchor = c->settings->anchor;
    c->plaintext = c->plaintext || c->settings->plaintext_database;
    if (c->model_path == NULL && (c->cmd->shared & CTL_MODEL) != 0)
        c->model_path = c->settings->model;
}

enum status ctl_model_find(struct ctl *c)
{
    enum status st = ST_OK;

    if (c->model_path == NULL && (c->cmd->shared & CTL_MODEL) != 0)
        c->model_path = environment("SURFACED_MODEL");
    if (c->cmd->database == CTL_NO_DATABASE)
        return ST_OK;
    if (c->db == NULL && c->config == NULL)
        c->db = environment("SURFACED_DB");
    if (c->key == NULL)
        c->key = environment("SURFACED_KEY");
    if (c->anchor == NULL)
        c->anchor = environment("SURFACED_ANCHOR");
    if (environment("SURFACED_PLAINTEXT_DATABASE") != NULL)
        c->plaintext = strcmp(environment("SURFACED_PLAINTEXT_DATABASE"), "1") == 0;
    if (c->config != NULL || (c->db == NULL && c->public_key == NULL)) {
        st = read_settings(c);
        if (st == ST_OK)
            take_settings(c);
    }
    return st;
}

/* ---- the model, the database opened */

enum status ctl_model_read(struct ctl *c, struct surface_model **owned)
{
    const char *path = c->model_path;
    enum status st = ST_OK;

    *owned = NULL;
    if (path != NULL)
        st = modelfile_read(path, owned, &c->e);
    c->model = *owned;
    if (st == ST_OK)
        surface_engine(c->model, c->engine);
    return st;
}

enum status ctl_model_open(struct ctl *c, enum store_mode mode)
{
    struct store_calibration k;
    struct store_key key;
    enum status st = ctl_model_key(c, c->db, &key);

    if (st != ST_OK || (st = store_open(c->db, mode, &key, &c->store, &c->e)) != ST_OK)
        return st;
    store_use_model(c->store, c->model);
    if ((c->cmd->shared & CTL_MODEL) != 0 &&
        store_calibration_current(c->store, &k, NULL) == ST_OK && k.ignored)
        (void)fprintf(
            stderr,
            "surfacectl: calibration %" PRId64
            " is not used: it was made by %s, not by %s; the model's own calibration decides\n",
            k.version, k.engine, c->engine);
    return ST_OK;
}

enum status ctl_model_each(struct store *s,
                           enum status (*visit)(void *arg,
                                                const struct store_subject *one,
                                                struct errinfo *e),
                           void *arg, struct errinfo *e)
{
    struct store_subject *page;
    int64_t after = 0;
    size_t n = 1;
    enum status st = ST_OK;

    while (st == ST_OK && n > 0) {
        if ((st = store_subject_list(s, after, PAGE, &page, &n, e)) != ST_OK)
            break;
        for (size_t i = 0; i < n && st == ST_OK; i++) {
            after = page[i].key;
            if ((st = visit(arg, &page[i], e)) == ST_ENOTFOUND)
                st = ST_OK;
        }
        free(page);
    }
    return st;
}
