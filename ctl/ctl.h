/* ctl.h -- the admin command's parts, among themselves.
 *   ctl.c        the command line
 *   ctl_command.c  the commands, a row each: who adds one begins there
 *   ctl_option.c the options, a row each
 *   ctl_help.c   help texts
 *   ctl_completion.c  the same for the shell
 *   ctl_enroll.c enroll: files of a subject; ctl_crowd.h whole collections
 *   ctl_face.c   verify, compare
 *   ctl_shape.c  asymmetry, simplify: one scan by itself
 *   ctl_explain.c  explain; explain.h has its figures, explain_*.h its files
 *   ctl_evaluate.c  evaluate; ctl_trials.h the comparisons, report.h the rates,
 *                       report_*.h what is written
 *   ctl_train.c  train
 *   ctl_model.c  --model, and the database opened for it
 *   ctl_dir.c    files that are there whole or not at all
 *   ctl_config.c config, and the database that the daemon's settings name
 *   ctl_key.c    --key, and the database opened by it
 *   ctl_admin.c  init, migrate, show, delete, check, stats, vacuum
 *   ctl_rekey.c  rekey
 *   ctl_doctor.c  doctor
 *   ctl_backup.c  backup, restore
 *   ctl_subject.c  subject; purge
 *   ctl_template.c  template
 *   ctl_reprocess.c  template reprocess
 *   ctl_dedup.c  dedup
 *   ctl_archive.c  export, import
 *   ctl_token.c  token
 *   ctl_audit.c  audit
 *   ctl_receipt.c  audit receipt
 *   ctl_attempts.c  attempts
 *   ctl_calibrate.c  calibrate; everybody against everybody: ctl_people.h
 *   ctl_scan.c   a scan's file to a face model
 *   ctl_ask.c    what a person has to confirm
 *   ctl_fail.c   a status to an exit code
 *   ctl_out.c    JSON */
#ifndef DB_SURFACECTL_H
#define DB_SURFACECTL_H
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "enrolment.h"
#include "errinfo.h"
#include "face.h"
#include "nearest.h"
#include "store.h"
#include "ctl_out.h"

struct keyfile; /* keyfile.h */
struct model;   /* model.h */
struct options; /* options.h */

#define CTL_ACTOR "surfacectl" /* in the events table */

enum ctl_exit {                /* as in <sysexits.h> where that has one */
                EXIT_FINE = 0, /* done; verify, compare, explain: match */
                EXIT_NO = 1,   /* verify, compare: no match; check: problems found;
                                       dedup: pairs found */
                EXIT_INCONCLUSIVE = 2, /* verify, compare: too little in common to say */
                EXIT_USAGE = 64,
                EXIT_DATA = 65, /* the scan or the database is malformed or unusable */
                EXIT_NOINPUT =
                    66, /* no such file, subject, template, token or database */
                EXIT_SOFTWARE = 70, /* a defect, or an error of the database engine */
                EXIT_OSERR = 71,    /* out of memory */
                EXIT_IOERR = 74,    /* reading or writing failed; disk full */
                EXIT_TEMPFAIL = 75, /* the database is locked; try again */
                EXIT_NOPERM = 77
};

struct ctl_expires { /* --expires */
    bool given;
    int64_t life_s; /* from now on; 0: never.  Not above 0 where at_s is: in the past */
    int64_t at_s;   /* since 1970; 0: never */
};

struct ctl { /* what the command line said */
    const char *db;
    const char *config;         /* the daemon's file; NULL: where it looks for one */
    struct options *settings;   /* of the daemon, once read; by ctl_config_free() */
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
    struct ctl_expires expires;
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
    struct ctl_out *out;
    struct errinfo e; /* why a command did not end with 0, 1 or 2 */
};

/* ctl_fail(c, st): the exit code for a status; c->e has the text. */
int ctl_fail(struct ctl *c, enum status st);

/* The commands: each returns an exit code, and fills c->e where that is above 2. */
int ctl_enroll(struct ctl *c);
int ctl_face_verify(struct ctl *c);
int ctl_face_compare(struct ctl *c);
int ctl_shape_asymmetry(struct ctl *c);
int ctl_shape_simplify(struct ctl *c);
int ctl_explain(struct ctl *c);
int ctl_evaluate(struct ctl *c);
int ctl_calibrate(struct ctl *c);
int ctl_train(struct ctl *c);
int ctl_admin_init(struct ctl *c);
int ctl_admin_migrate(struct ctl *c);
int ctl_rekey(struct ctl *c);
int ctl_doctor(struct ctl *c);
int ctl_config_show(struct ctl *c);
int ctl_config_check(struct ctl *c);
int ctl_archive_export(struct ctl *c);
int ctl_archive_import(struct ctl *c);
int ctl_backup(struct ctl *c);
int ctl_backup_restore(struct ctl *c);
int ctl_admin_show(struct ctl *c);
int ctl_admin_delete(struct ctl *c);
int ctl_admin_check(struct ctl *c);
int ctl_admin_stats(struct ctl *c);
int ctl_admin_vacuum(struct ctl *c);
int ctl_subject_list(struct ctl *c);
int ctl_subject_show(struct ctl *c);
int ctl_subject_set(struct ctl *c);
int ctl_subject_rename(struct ctl *c);
int ctl_subject_disable(struct ctl *c);
int ctl_subject_enable(struct ctl *c);
int ctl_subject_hold(struct ctl *c);
int ctl_subject_release(struct ctl *c);
int ctl_subject_erase(struct ctl *c);
int ctl_purge(struct ctl *c);
int ctl_template_list(struct ctl *c);
int ctl_template_show(struct ctl *c);
int ctl_template_export(struct ctl *c);
int ctl_template_delete(struct ctl *c);
int ctl_reprocess(struct ctl *c);
int ctl_dedup(struct ctl *c);
int ctl_token_create(struct ctl *c);
int ctl_token_list(struct ctl *c);
int ctl_token_rotate(struct ctl *c);
int ctl_token_revoke(struct ctl *c);
int ctl_attempts_list(struct ctl *c);
int ctl_attempts_reset(struct ctl *c);
int ctl_audit_show(struct ctl *c);
int ctl_audit_verify(struct ctl *c);
int ctl_audit_export(struct ctl *c);
int ctl_audit_checkpoint(struct ctl *c);
int ctl_audit_erased(struct ctl *c);
int ctl_receipt(struct ctl *c);
int ctl_completion(struct ctl *c);

/* ctl_usage(c, ...): EXIT_USAGE, with the text in c->e. */
__attribute__((format(printf, 2, 3))) int ctl_usage(struct ctl *c, const char *fmt, ...);

/* ctl_confirmed(c, what, word): --yes, or a person on a terminal types the word after
 * being told what will be done ("This erases ..."); else EXIT_USAGE is due, and c->e says
 * so. */
bool ctl_confirmed(struct ctl *c, const char *what, const char *word);

/* Bytes as people read them: "1.5 MB". */
const char *ctl_bytes(uint64_t n, char out[32]);

/* A subject or a template, as JSON and text. */
enum status ctl_subject_tell(struct ctl *c, struct store *s,
                             const struct store_subject *one);
void ctl_template_tell(struct ctl *c, const struct store_template *t);

/* ctl_subject_remove(c, s, one), ctl_template_remove(c, s, t): for good, once
 * that is confirmed; an exit code.
 * ctl_subject_would(c, one, templates, what): the same for --dry-run: so many
 * templates of it would go, or may not.  what: "deletes ...". */
int ctl_subject_would(struct ctl *c, const struct store_subject *one, uint32_t templates,
                      const char *what);
int ctl_subject_remove(struct ctl *c, struct store *s, const struct store_subject *one);
int ctl_template_remove(struct ctl *c, struct store *s, const struct store_template *t);

/* ctl_key(c, db, key): the key that the command line names for the database; a
 * passphrase is asked for on the terminal, once.
 * ctl_key_new(c, option, out): a new passphrase, typed twice there; for
 * keyfile_free().  option: what names a file with it instead.
 * ctl_open(c, mode, s): store_open() by the key for c->db. */
enum status ctl_key_new(struct ctl *c, const char *option, struct keyfile **out);
enum status ctl_key(struct ctl *c, const char *db, struct store_key *key);
enum status ctl_open(struct ctl *c, enum store_mode mode, struct store **s);

/* ctl_config_database(c, model): c->db where it is NULL by SURFACED_DB; where that is
 * not set, or --config is given, by the daemon's configuration, as c->key and, if model,
 * c->model_path then too.  ST_EINVAL: nobody names one, and why. */
enum status ctl_config_database(struct ctl *c, bool model);
void ctl_config_free(struct ctl *c); /* the settings, to which the paths belong */

/* ctl_key_archive(c, make, out): what an archive is sealed with; asked for twice for
 * one that is made.  Released by keyfile_free(). */
enum status ctl_key_archive(struct ctl *c, bool make, struct keyfile **out);

/* ctl_model_read(c, owned): c->model and c->engine by c->model_path; *owned is for
 * the caller to free() when c is done.  c->e is filled on failure.
 * ctl_model_store(c, mode, s): store_open() for that model; says on standard error
 * where the database's calibration is of no use with it. */
enum status ctl_model_read(struct ctl *c, struct model **owned);
enum status ctl_model_store(struct ctl *c, enum store_mode mode, struct store **s);

/* ctl_face_nearest(c, s, subject, probe, w, best): the probe compared with a subject's
 * templates, by the database's calibration (nearest_find()); who may not be verified is
 * ST_EDENIED.  ctl_face_template(): with one template of it. */
struct ctl_nearest {
    struct nearest nearest;
    struct store_template tmpl; /* that decides */
    struct store_subject subject;
};
enum status ctl_face_nearest(struct ctl *c, struct store *s, const char *subject,
                             const struct face *probe, struct face_work *w,
                             struct ctl_nearest *best);
enum status ctl_face_template(struct ctl *c, struct store *s, const char *id,
                              const struct face *probe, struct face_work *w,
                              struct ctl_nearest *best);

/* ctl_face_enroll(c, s, x, w, out): enrolment_add(). */
enum status ctl_face_enroll(struct ctl *c, struct store *s, const struct enrolment *x,
                            struct face_work *w, struct enrolment_outcome *out);

int ctl_face_exit(enum face_decision d);

/* Parts of a comparison as text: lines; of the reasons the rest of one, "" or " (noisy, turned)". */
void ctl_face_regions(FILE *to, const struct face_result *r);
void ctl_face_alignment(FILE *to, const struct align_result *a);
void ctl_face_reasons(FILE *to, const struct face *f);

/* ctl_scan_read(c, path, w, out): the scan in a file ("-": standard input), in
 * c->units, as a model.  Every failure is in c->e, with the path. */
enum status ctl_scan_read(struct ctl *c, const char *path, struct face_work *w,
                          struct face *out);

/* The same in two steps, for who needs the points too: in millimetres, in the file's order,
 * a new array released by mem_free() (NULL on failure). */
enum status ctl_scan_points(struct ctl *c, const char *path, struct dvec3 **pts,
                            size_t *n);
enum status ctl_scan_build(struct ctl *c, const char *path, const struct dvec3 *pts,
                           size_t n, struct face_work *w, struct face *out);

#endif
