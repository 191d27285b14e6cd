/* ctl.h -- the state of a run of surfacectl: command line, output, error.  From the bottom up:
 *   ctl                        errors, exit codes, output; files that are written
 *   ctl_command, ctl_option    a command and its options
 *   ctl_model                  the model and the database, named and opened; each subject
 *   ctl_face, ctl_session      scans as faces, comparisons as text
 *   ctl_cross, ctl_search      many comparisons, and the pairs that are alike
 *   ctl_table, main            the list of the commands, their help texts, the command line
 * Each other file has a command, or a few of one group. */
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
struct surface_model; /* libsurface.h */
struct options;       /* options.h */
struct store;         /* store.h */
struct ctl_command;   /* ctl_command.h */

struct ctl_scans {                   /* options for reading scans */
    double unit_mm;                  /* --units, millimetres; 0: detected */
    bool frontal;                    /* --axes scanner */
    struct clouddepth_camera camera; /* --camera, for depth images */
};

struct ctl_expires { /* --expires */
    bool given;
    int64_t end_ms; /* ms since 1970, or STORE_NEVER */
};

struct ctl {
    const struct ctl_command *cmd;
    const char *command; /* name of cmd */
    int nargs;
    char **args; /* arguments of cmd */

    const char *actor; /* actor in the audit log: ctl_actor() */

    /* Options that several commands take (ctl_option.c). */
    const char *db;
    const char *config;    /* the daemon's configuration file; NULL: its usual file */
    const char *key;       /* file of the database's key; NULL: db and ".key" */
    const char *anchor;    /* file of the anchor; NULL or "none": no anchor */
    bool plaintext;        /* --plaintext-database: the database has no key */
    bool passphrase;       /* true: a new database or key gets a passphrase */
    bool short_passphrase; /* true: a new passphrase may be short */
    const char
        *archive_key; /* file with the key or passphrase of an archive; NULL: ask */
    struct ctl_scans scans;
    const char *dir;        /* --out; NULL: not given */
    uint32_t threads;       /* number of threads; 0: one a core */
    const char *public_key; /* --public-key, 64 hexadecimal digits; NULL: not given */
    struct ctl_expires expires;
    const char *model_path; /* --model; NULL: the shipped model */
    bool dry_run, yes, force, json, help, version;

    const struct surface_model
        *model; /* model in the file model_path; NULL: the shipped model */
    char engine[SURFACE_ENGINE_SIZE]; /* engine with this model */
    struct options
        *settings; /* the daemon's settings, if read; released by ctl_model_free() */
    char usual_key[PATH_MAX];  /* db and ".key" */
    struct crypt_file *asked;  /* passphrase from the terminal; NULL: not asked for yet */
    struct store *store;       /* the open database; NULL: not open */
    struct surface_work *work; /* NULL if the command takes no --model */
    bool
        piped; /* true for --out -: the file goes to standard output, messages to standard error */
    int code;         /* exit code of a command that does not fail; EXIT_FINE at first */
    struct json *out; /* result; NULL without --json */
    struct errinfo e; /* error of a command that fails */
};

/* ctl_usage(c, ...): Reports a wrong command line: sets c->e, and the exit code EXIT_USAGE.
 * Returns ST_EINVAL. */
__attribute__((format(printf, 2, 3))) enum status ctl_usage(struct ctl *c,
                                                            const char *fmt, ...);

/* ctl_actor(): Returns "surfacectl:" and the login name of the process's real user, or the user's number if
 * the name is missing, is longer than STORE_NAME_MAX allows or is not printable ASCII.  The text is static. */
const char *ctl_actor(void);

/* ctl_confirm(c, what, word): Asks a person on the terminal to type the word after the text "This WHAT.".
 * Returns ST_OK with --yes or after the word; else ST_EDENIED, and sets the exit code EXIT_USAGE. */
enum status ctl_confirm(struct ctl *c, const char *what, const char *word);

/* A count and the plural's "s" of its word, for "%" PRIu64 " template%s". */
#define CTL_COUNT(n) (uint64_t)(n), (n) == 1 ? "" : "s"

/* ctl_bytes(n, out): Prints a number of bytes with a unit, "1.5 MB", and returns out. */
const char *ctl_bytes(uint64_t n, char out[32]);

/* ctl_say(c, ...): Prints text of the result, to standard error if c->piped; nothing with --json. */
__attribute__((format(printf, 2, 3))) void ctl_say(const struct ctl *c, const char *fmt,
                                                   ...);

/* ctl_may_write(c, path, nread): Checks by the rules of outfile.h if the command may write a file at path.  A
 * command calls it before it computes anything.  No file that the command reads may be written: its first
 * nread arguments, the database and the files that belong to it, keys, model, configuration.
 * Returns ST_OK, or an error with c->e set: ST_EEXISTS: the command reads the file, by whatever name; the file
 * exists, and --force is not given; it is no regular file.  ST_EINVAL: path is "-", or a folder. */
enum status ctl_may_write(struct ctl *c, const char *path, int nread);

/* ctl_may_pipe(c, nread): Like ctl_may_write() for the path of --out, but for "-" it sets c->piped.
 * Returns also ST_EINVAL: "-" with --json. */
enum status ctl_may_pipe(struct ctl *c, int nread);

/* ctl_write(c, path, write, arg): Calls outfile_write(), for standard output if c->piped. */
enum status ctl_write(struct ctl *c, const char *path, newfile_writer *write,
                      const void *arg);

/* ctl_write_face(c, path, f): Writes a face like ctl_write(), as PLY in millimetres. */
enum status ctl_write_face(struct ctl *c, const char *path, const struct surface_face *f);

#endif
