/* surfacectl.h -- the admin command's parts, among themselves.
 *   surfacectl.c        the command line
 *   surfacectl_command.c  the commands, a row each: who adds one begins there
 *   surfacectl_option.c the options, a row each
 *   surfacectl_help.c   help texts
 *   surfacectl_completion.c  the same for the shell
 *   surfacectl_enroll.c enroll: files of a subject; surfacectl_crowd.h whole collections
 *   surfacectl_face.c   verify, compare
 *   surfacectl_shape.c  asymmetry, simplify: one scan by itself
 *   surfacectl_explain.c  explain; its parts are in surfacectl_explain.h
 *   surfacectl_evaluate.c  evaluate: the rates; surfacectl_trials.h the comparisons,
 *                       surfacectl_report.h what is written
 *   surfacectl_train.c  train
 *   surfacectl_model.c  --model, and the database opened for it
 *   surfacectl_dir.c    files that are there whole or not at all
 *   surfacectl_config.c config, and the database that the daemon's settings name
 *   surfacectl_key.c    --key, and the database opened by it
 *   surfacectl_admin.c  init, migrate, show, delete, check, stats, vacuum
 *   surfacectl_rekey.c  rekey
 *   surfacectl_doctor.c  doctor
 *   surfacectl_backup.c  backup, restore
 *   surfacectl_subject.c  subject; purge
 *   surfacectl_template.c  template
 *   surfacectl_reprocess.c  template reprocess
 *   surfacectl_dedup.c  dedup
 *   surfacectl_archive.c  export, import
 *   surfacectl_token.c  token
 *   surfacectl_audit.c  audit
 *   surfacectl_receipt.c  audit receipt
 *   surfacectl_attempts.c  attempts
 *   surfacectl_calibrate.c  calibrate; everybody against everybody: surfacectl_people.h
 *   surfacectl_scan.c   a scan's file to a face model
 *   surfacectl_ask.c    what a person has to confirm
 *   surfacectl_fail.c   a status to an exit code
 *   surfacectl_out.c    JSON */
#ifndef DB_SURFACECTL_H
#define DB_SURFACECTL_H
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "errinfo.h"
#include "face.h"
#include "store.h"
#include "surfacectl_out.h"

struct keyfile; /* keyfile.h */
struct model;   /* model.h */

#define SURFACECTL_ACTOR "surfacectl" /* in the events table */

enum surfacectl_exit {                /* as in <sysexits.h> where that has one */
                       EXIT_FINE = 0, /* done; verify, compare, explain: match */
                       EXIT_NO = 1,   /* verify, compare: no match; check: problems found;
                                       dedup: pairs found */
                       EXIT_INCONCLUSIVE =
                           2, /* verify, compare: too little in common to say */
                       EXIT_USAGE = 64,
                       EXIT_DATA =
                           65, /* the scan or the database is malformed or unusable */
                       EXIT_NOINPUT =
                           66, /* no such file, subject, template, token or database */
                       EXIT_SOFTWARE =
                           70,          /* a defect, or an error of the database engine */
                       EXIT_OSERR = 71, /* out of memory */
                       EXIT_IOERR = 74, /* reading or writing failed; disk full */
                       EXIT_TEMPFAIL = 75, /* the database is locked; try again */
                       EXIT_NOPERM = 77
};

struct surfacectl_expires { /* --expires */
    bool given;
    int64_t life_s; /* from now on; 0: never.  Not above 0 where at_s is: in the past */
    int64_t at_s;   /* since 1970; 0: never */
};

struct surfacectl { /* what the command line said */
    const char *db;
    const char *config;         /* the daemon's file; NULL: where it looks for one */
    char *settings;             /* that the daemon told; to be freed */
    char credential[PATH_MAX];  /* the key's file, where they name it as a credential */
    const char *key;            /* its file; NULL: the database's path and ".key" */
    bool plaintext, passphrase; /* instead of a file, for a new database */
    const char *new_key;        /* --new-key, or NULL */
    const char *archive_key;    /* a file with its key or passphrase; NULL: asked for */
    struct keyfile *asked;      /* a passphrase, once asked for; to be freed */
    const char *units;          /* NULL: millimetres */
    const char *label;
    const char *kind;    /* of the scans of a collection, of events; NULL: all */
    const char *dir;     /* --out; NULL: the command's own */
    double tolerance_mm; /* --tolerance; 0: not given */
    double threshold_mm; /* 0: the default */
    uint32_t impostors;  /* of each probe; 0: as many as are of use */
    uint32_t threads;    /* 0: one a core */
    double fmr;          /* that is wanted; 0: the default */
    const char *genuine; /* a manifest, or NULL */
    unsigned scopes;     /* --scope; 0: not given */
    struct surfacectl_expires expires;
    int64_t grace_s;                 /* --grace */
    const char *reference, *purpose; /* of a consent; NULL: not given */
    const char *subject, *since;     /* of events, subject of dedup too; NULL: any */
    uint32_t limit;                  /* --limit; 0: not given */
    const char *public_key;          /* 64 hexadecimal digits, or NULL */
    bool json, yes, force, all, dry_run, list, reset, mean, due, keep_old;
    bool help, version;
    int nargs;
    char **args;                      /* the command's own */
    const char *model_path;           /* --model; NULL: the shipped one */
    const struct model *model;        /* that it names */
    char engine[FACE_ENGINE_MAX + 1]; /* by that model */
    struct surfacectl_out *out;
    struct errinfo e; /* why a command did not end with 0, 1 or 2 */
};

/* surfacectl_fail(c, st): the exit code for a status; c->e has the text. */
int surfacectl_fail(struct surfacectl *c, enum status st);

/* The commands: each returns an exit code, and fills c->e where that is above 2. */
int surfacectl_enroll(struct surfacectl *c);
int surfacectl_face_verify(struct surfacectl *c);
int surfacectl_face_compare(struct surfacectl *c);
int surfacectl_shape_asymmetry(struct surfacectl *c);
int surfacectl_shape_simplify(struct surfacectl *c);
int surfacectl_explain(struct surfacectl *c);
int surfacectl_evaluate(struct surfacectl *c);
int surfacectl_calibrate(struct surfacectl *c);
int surfacectl_train(struct surfacectl *c);
int surfacectl_admin_init(struct surfacectl *c);
int surfacectl_admin_migrate(struct surfacectl *c);
int surfacectl_rekey(struct surfacectl *c);
int surfacectl_doctor(struct surfacectl *c);
int surfacectl_config_show(struct surfacectl *c);
int surfacectl_config_check(struct surfacectl *c);
int surfacectl_archive_export(struct surfacectl *c);
int surfacectl_archive_import(struct surfacectl *c);
int surfacectl_backup(struct surfacectl *c);
int surfacectl_backup_restore(struct surfacectl *c);
int surfacectl_admin_show(struct surfacectl *c);
int surfacectl_admin_delete(struct surfacectl *c);
int surfacectl_admin_check(struct surfacectl *c);
int surfacectl_admin_stats(struct surfacectl *c);
int surfacectl_admin_vacuum(struct surfacectl *c);
int surfacectl_subject_list(struct surfacectl *c);
int surfacectl_subject_show(struct surfacectl *c);
int surfacectl_subject_set(struct surfacectl *c);
int surfacectl_subject_rename(struct surfacectl *c);
int surfacectl_subject_disable(struct surfacectl *c);
int surfacectl_subject_enable(struct surfacectl *c);
int surfacectl_subject_hold(struct surfacectl *c);
int surfacectl_subject_release(struct surfacectl *c);
int surfacectl_subject_erase(struct surfacectl *c);
int surfacectl_purge(struct surfacectl *c);
int surfacectl_template_list(struct surfacectl *c);
int surfacectl_template_show(struct surfacectl *c);
int surfacectl_template_export(struct surfacectl *c);
int surfacectl_template_delete(struct surfacectl *c);
int surfacectl_reprocess(struct surfacectl *c);
int surfacectl_dedup(struct surfacectl *c);
int surfacectl_token_create(struct surfacectl *c);
int surfacectl_token_list(struct surfacectl *c);
int surfacectl_token_rotate(struct surfacectl *c);
int surfacectl_token_revoke(struct surfacectl *c);
int surfacectl_attempts_list(struct surfacectl *c);
int surfacectl_attempts_reset(struct surfacectl *c);
int surfacectl_audit_show(struct surfacectl *c);
int surfacectl_audit_verify(struct surfacectl *c);
int surfacectl_audit_export(struct surfacectl *c);
int surfacectl_audit_checkpoint(struct surfacectl *c);
int surfacectl_audit_erased(struct surfacectl *c);
int surfacectl_receipt(struct surfacectl *c);
int surfacectl_completion(struct surfacectl *c);

/* surfacectl_usage(c, ...): EXIT_USAGE, with the text in c->e. */
__attribute__((format(printf, 2, 3))) int surfacectl_usage(struct surfacectl *c,
                                                           const char *fmt, ...);

/* surfacectl_confirmed(c, what, word): --yes, or a person on a terminal types the word after
 * being told what will be done ("This erases ..."); else EXIT_USAGE is due, and c->e says
 * so. */
bool surfacectl_confirmed(struct surfacectl *c, const char *what, const char *word);

/* Bytes as people read them: "1.5 MB". */
const char *surfacectl_bytes(uint64_t n, char out[32]);

/* A subject or a template, as JSON and text. */
enum status surfacectl_subject_tell(struct surfacectl *c, struct store *s,
                                    const struct store_subject *one);
void surfacectl_template_tell(struct surfacectl *c, const struct store_template *t);

/* surfacectl_subject_remove(c, s, one), surfacectl_template_remove(c, s, t): for good, once
 * that is confirmed; an exit code.
 * surfacectl_subject_would(c, one, templates, what): the same for --dry-run: so many
 * templates of it would go, or may not.  what: "deletes ...". */
int surfacectl_subject_would(struct surfacectl *c, const struct store_subject *one,
                             uint32_t templates, const char *what);
int surfacectl_subject_remove(struct surfacectl *c, struct store *s,
                              const struct store_subject *one);
int surfacectl_template_remove(struct surfacectl *c, struct store *s,
                               const struct store_template *t);

/* surfacectl_key(c, db, key): the key that the command line names for the database; a
 * passphrase is asked for on the terminal, once.
 * surfacectl_key_new(c, option, out): a new passphrase, typed twice there; for
 * keyfile_free().  option: what names a file with it instead.
 * surfacectl_open(c, mode, s): store_open() by the key for c->db. */
enum status surfacectl_key_new(struct surfacectl *c, const char *option,
                               struct keyfile **out);
enum status surfacectl_key(struct surfacectl *c, const char *db, struct store_key *key);
enum status surfacectl_open(struct surfacectl *c, enum store_mode mode, struct store **s);

/* surfacectl_config_database(c, model): c->db where it is NULL by SURFACED_DB; where that is
 * not set, or --config is given, by the daemon's configuration, as c->key and, if model,
 * c->model_path then too.  ST_EINVAL: nobody names one, and why. */
enum status surfacectl_config_database(struct surfacectl *c, bool model);

/* surfacectl_key_archive(c, make, out): what an archive is sealed with; asked for twice for
 * one that is made.  Released by keyfile_free(). */
enum status surfacectl_key_archive(struct surfacectl *c, bool make, struct keyfile **out);

/* surfacectl_model_read(c, owned): c->model and c->engine by c->model_path; *owned is for
 * the caller to free() when c is done.  c->e is filled on failure.
 * surfacectl_model_store(c, mode, s): store_open() for that model; says on standard error
 * where the database's calibration is of no use with it. */
enum status surfacectl_model_read(struct surfacectl *c, struct model **owned);
enum status surfacectl_model_store(struct surfacectl *c, enum store_mode mode,
                                   struct store **s);

/* surfacectl_face_nearest(c, s, subject, probe, w, best): the probe compared with all of a
 * subject's templates, by the database's calibration; ST_ENOTFOUND without any. */
struct surfacectl_nearest {
    struct face_result result;
    struct store_template tmpl;
    unsigned compared;
    char newest[STORE_ID_LEN + 1]; /* the subject's last one; "" without any */
};
enum status surfacectl_face_nearest(struct surfacectl *c, struct store *s,
                                    const char *subject, const struct face *probe,
                                    struct face_work *w, struct surfacectl_nearest *best);

const char *surfacectl_face_decision(enum face_decision d);
int surfacectl_face_exit(enum face_decision d);

/* What every JSON answer to a comparison has. */
void surfacectl_face_verdict(struct surfacectl_out *o, const char *engine,
                             const struct face_result *r, const struct face *probe);
/* frame: NULL where it is not known (quality_reasons()). */
void surfacectl_face_quality(struct surfacectl_out *o, const char *key,
                             const struct face_quality *q, const struct frame *frame);

/* Parts of it as text: lines; of the reasons the rest of one, "" or " (noisy, turned)". */
void surfacectl_face_regions(FILE *to, const struct face_result *r);
void surfacectl_face_alignment(FILE *to, const struct align_result *a);
void surfacectl_face_reasons(FILE *to, const struct face *f);

/* surfacectl_scan_read(c, path, w, out): the scan in a file ("-": standard input), in
 * c->units, as a model.  Every failure is in c->e, with the path. */
enum status surfacectl_scan_read(struct surfacectl *c, const char *path,
                                 struct face_work *w, struct face *out);

/* The same in two steps, for who needs the points too: in millimetres, in the file's order,
 * a new array released by mem_free() (NULL on failure). */
enum status surfacectl_scan_points(struct surfacectl *c, const char *path,
                                   struct dvec3 **pts, size_t *n);
enum status surfacectl_scan_build(struct surfacectl *c, const char *path,
                                  const struct dvec3 *pts, size_t n, struct face_work *w,
                                  struct face *out);

#endif
