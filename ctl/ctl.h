/* ctl.h -- what every part of surfacectl is given: what the command line said, the output,
 * and the error that it ends with.  From the bottom up:
 *   ctl                        errors, exit codes, output; files that are written
 *   ctl_command, ctl_option    a command and its options
 *   ctl_model                  the model and the database, named and opened; each subject
 *   ctl_face                   a scan as a face, compared
 *   ctl_cross                  many comparisons
 *   the other files            a command each, or a few of one group
 *   ctl_table, main            the list of the commands, their help texts, the command line */
#ifndef CTL_H
#define CTL_H
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "clouddepth.h"
#include "command.h"
#include "errinfo.h"
#include "json.h"
#include "libsurface.h"
#include "newfile.h"

struct crypt_file;    /* crypt_file.h */
struct surface_model; /* model.h */
struct options;       /* options.h */
struct store;         /* store.h */
struct ctl_command;   /* ctl_command.h */

struct ctl_scans {                   /* how scans are read */
    double unit_mm;                  /* --units, millimetres; 0: found */
    bool frontal;                    /* --axes scanner */
    struct clouddepth_camera camera; /* of those that are depth images */
};

struct ctl_expires { /* --expires */
    bool given;
    int64_t end_ms; /* STORE_NEVER, or since 1970 */
};

struct ctl {
    const struct ctl_command *cmd;
    const char *command; /* its name */
    int nargs;
    char **args; /* its arguments */

    const char *actor; /* in the audit log: ctl_actor() */

    /* Options that several commands take (ctl_option.c). */
    const char *db;
    const char *config;      /* the daemon's file; NULL: where it looks for one */
    const char *key;         /* its file; NULL: the database's path and ".key" */
    const char *anchor;      /* NULL: beside the key; "none": it is a copy, only read */
    bool plaintext;          /* --plaintext-database: it has no key */
    bool passphrase;         /* instead of a file, for a new database or key */
    bool short_passphrase;   /* a new one may have few characters */
    const char *archive_key; /* a file with its key or passphrase; NULL: asked for */
    struct ctl_scans scans;
    const char *dir;        /* --out; NULL: the command's own */
    uint32_t threads;       /* 0: one a core */
    const char *public_key; /* --public-key, 64 hexadecimal digits; NULL: not given */
    struct ctl_expires expires;
    const char *model_path; /* --model; NULL: the shipped one */
    bool dry_run, yes, force, json, help, version;

    const struct surface_model *model; /* that model_path names */
    char engine[SURFACE_ENGINE_SIZE];  /* by that model */
    struct options *settings;          /* of the daemon, once read; by ctl_model_free() */
    char usual_key[PATH_MAX];          /* the database's path and ".key" */
    struct crypt_file *asked;          /* a passphrase, once asked for; to be freed */
    struct store *store;               /* the database, once opened (ctl_model.h) */
    struct surface_work *work;         /* NULL if the command takes no --model */
    bool piped; /* --out -: the result is on standard output, what is said of it not */
    int code;   /* EXIT_FINE until a command says otherwise */
    struct json *out; /* NULL without json */
    struct errinfo e; /* why a command did not end with 0, 1 or 2 */
};

/* ctl_usage(c, ...): the command line is wrong, and the text in c->e says how; ST_EINVAL, and
 * the exit code EXIT_USAGE. */
__attribute__((format(printf, 2, 3))) enum status ctl_usage(struct ctl *c,
                                                            const char *fmt, ...);

/* ctl_actor(): "surfacectl:" and the login name of the process's real user, or its number where
 * it has none that an actor's name can hold (STORE_NAME_MAX printable ASCII).  Static. */
const char *ctl_actor(void);

/* ctl_confirm(c, what, word): ST_OK with --yes, or when a person on a terminal types the
 * word after reading what will be done ("This erases ..."); else ST_EDENIED, and the exit
 * code EXIT_USAGE. */
enum status ctl_confirm(struct ctl *c, const char *what, const char *word);

/* A count and what makes a word plural where it is not 1, for "%" PRIu64 " template%s". */
#define CTL_COUNT(n) (uint64_t)(n), (n) == 1 ? "" : "s"

/* Bytes as people read them: "1.5 MB". */
const char *ctl_bytes(uint64_t n, char out[32]);

/* A command's result is JSON, in c->out, or text.
 * ctl_say(c, ...): print text, unless it is JSON; to standard error if c->piped. */
__attribute__((format(printf, 2, 3))) void ctl_say(const struct ctl *c, const char *fmt,
                                                   ...);

/* Files that a command writes, by the rules of outfile.h.  Before anything is computed: may it write
 * there?  Failures are in c->e.
 * ctl_may_write(c, path, nread): a file at path.  It is compared with those that the command
 * reads: its first nread arguments ("-" and what does not exist are none), and the shared
 * options' (the database and what belongs to it, keys, model, configuration).
 * ST_EEXISTS: it is one of them, by whatever name (a link, another path); or it exists, and
 * there is no --force; or it is no regular file.  ST_EINVAL: "-", or a folder.
 * ctl_may_pipe(c, nread): the same of --out, which may be "-", standard output:
 * c->piped is set then; ST_EINVAL with --json. */
enum status ctl_may_write(struct ctl *c, const char *path, int nread);
enum status ctl_may_pipe(struct ctl *c, int nread);

/* ctl_write(c, path, write, arg): outfile_write(), to standard output if c->piped.
 * ctl_write_face(c, path, f): a face there, PLY in millimetres. */
enum status ctl_write(struct ctl *c, const char *path, newfile_writer *write,
                      const void *arg);
enum status ctl_write_face(struct ctl *c, const char *path, const struct surface_face *f);

#endif
