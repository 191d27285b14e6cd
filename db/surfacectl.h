/* surfacectl.h -- the admin command's parts, among themselves.
 *   surfacectl.c        options, help
 *   surfacectl_face.c   enroll, verify, compare
 *   surfacectl_admin.c  init, list, show, delete, check, stats, token
 *   surfacectl_scan.c   a scan's file to a face model
 *   surfacectl_fail.c   a status to an exit code
 *   surfacectl_out.c    JSON */
#ifndef DB_SURFACECTL_H
#define DB_SURFACECTL_H
#include <stdbool.h>
#include "errinfo.h"
#include "face.h"
#include "store.h"
#include "surfacectl_out.h"

#define SURFACECTL_ACTOR "surfacectl" /* in the events table */

enum surfacectl_exit {                /* as in <sysexits.h> where that has one */
                       EXIT_FINE = 0, /* done; verify, compare: match */
                       EXIT_NO = 1, /* verify, compare: no match; check: problems found */
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

struct surfacectl { /* what the command line said */
    const char *db;
    const char *units; /* NULL: millimetres */
    const char *label;
    double threshold_mm; /* 0: the default */
    bool json, yes, force;
    int nargs;
    char **args; /* the command's own */
    struct surfacectl_out *out;
    struct errinfo e; /* why a command did not end with 0, 1 or 2 */
};

/* surfacectl_fail(c, st): the exit code for a status; c->e has the text. */
int surfacectl_fail(struct surfacectl *c, enum status st);

/* The commands: each returns an exit code, and fills c->e where that is above 2. */
int surfacectl_face_enroll(struct surfacectl *c);
int surfacectl_face_verify(struct surfacectl *c);
int surfacectl_face_compare(struct surfacectl *c);
int surfacectl_admin_init(struct surfacectl *c);
int surfacectl_admin_list(struct surfacectl *c);
int surfacectl_admin_show(struct surfacectl *c);
int surfacectl_admin_delete(struct surfacectl *c);
int surfacectl_admin_check(struct surfacectl *c);
int surfacectl_admin_stats(struct surfacectl *c);
int surfacectl_admin_token(struct surfacectl *c);

/* surfacectl_scan_read(c, path, w, out): the scan in a file ("-": standard input), in
 * c->units, as a model.  Every failure is in c->e, with the path. */
enum status surfacectl_scan_read(struct surfacectl *c, const char *path,
                                 struct face_work *w, struct face *out);

#endif
