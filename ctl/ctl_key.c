/* The database's master key: --key, or a passphrase asked for on the terminal. */
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "crypt_file.h"
#include "ctl.h"
#include "ctl_key.h"

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
                           "%.160s asks for a passphrase: give a file with it to %s",
                           c->db, option);
    }
    if ((k = sodium_malloc(sizeof *k)) == NULL) {
        (void)fclose(tty);
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
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
        return errinfo_set(&c->e, ST_EINVAL, "no passphrase was given");
    }
    *out = k;
    return ST_OK;
}

/* A new passphrase, twice, so that a slip of the finger does not lock everybody out. */
enum status ctl_key_new(struct ctl *c, const char *option, struct crypt_file **out)
{
    struct crypt_file *again = NULL;
    enum status st;

    if ((st = ask(c, "New passphrase", option, out)) != ST_OK)
        return st;
    if ((st = ask(c, "The same again", option, &again)) == ST_OK &&
        strcmp((*out)->text, again->text) != 0)
        st = errinfo_set(&c->e, ST_EINVAL, "the two passphrases differ");
    crypt_file_free(again);
    if (st != ST_OK) {
        crypt_file_free(*out);
        *out = NULL;
    }
    return st;
}

enum status ctl_key(struct ctl *c, const char *db, struct store_key *key)
{
    enum crypt_kind kind;
    enum status st;

    if (c->plaintext && c->key != NULL)
        return ctl_usage(c, "--plaintext-database contradicts --key");
    *key = (struct store_key){
        .path = c->key,
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
            st = ctl_key_new(c, "--key", &c->asked);
        else
            st = ST_OK; /* opening the database will report what is wrong with it */
        if (st != ST_OK)
            return st;
    }
    key->given = c->asked;
    return ST_OK;
}

enum status ctl_key_archive(struct ctl *c, bool make, struct crypt_file **out)
{
    static const char option[] = "--archive-key";

    enum status st;

    *out = NULL;
    if (c->archive_key != NULL)
        st = crypt_file_read(c->archive_key, out, &c->e);
    else
        st = make ? ctl_key_new(c, option, out)
                  : ask(c, "Passphrase of the archive", option, out);
    return st == ST_OK && make && !c->short_passphrase ? crypt_file_strong(*out, &c->e)
                                                       : st;
}
