/* lab.h -- the values of the command line that each command of surfacelab reads, and the functions that the
 * commands share: files, errors, scans as faces. */
#ifndef LAB_LAB_H
#define LAB_LAB_H
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include "clouddepth.h"
#include "cloudpoints.h"
#include "command.h"
#include "errinfo.h"
#include "face.h"
#include "json.h"
#include "newfile.h"
#include "scan.h"

struct corpus;        /* corpus.h */
struct corpus_scan;   /* corpus.h */
struct mesh;          /* mesh.h */
struct surface_model; /* model.h */

struct lab {
    const char *command;
    int nargs;
    char **args;
    /* options (main.c): first those that several commands have */
    double unit_mm; /* 0: to be found */
    bool frontal;   /* --axes scanner */
    struct clouddepth_camera camera;
    const char *model_path, *out;
    double threshold; /* NAN: the model's */
    uint32_t threads; /* 0: one a core */
    bool force, json, help, version;
    const char *pairs, *enroll_kind, *scores; /* evaluate */
    uint32_t non_mated, burst; /* burst: frames of a session; 0: each scan by itself */
    bool minimal, regions, matrix;
    const char *name, *calibrate; /* train */
    double weight;                /* below 0: by the number of subjects */
    double tolerance_mm;          /* simplify */
    bool mean;
    uint64_t seed; /* study */
    bool reduced;

    const struct surface_model *model;
    char engine[SURFACE_ENGINE_SIZE]; /* name of the engine with this model */
    struct surface_work *work;
    struct json *report; /* NULL without --json */
    bool piped;       /* the result goes to standard output, the text to standard error */
    int code;         /* EXIT_FINE until the command sets another */
    struct errinfo e; /* why the command failed */
};

/* ---- the commands; each fills c->e on failure */

enum status lab_asymmetry(struct lab *c);
enum status lab_evaluate(struct lab *c);
enum status lab_explain(struct lab *c);
enum status lab_fill(struct lab *c);
enum status lab_simplify(struct lab *c);
enum status lab_study(struct lab *c);
enum status lab_train(struct lab *c);

/* ---- shared (lab.c) */

/* lab_usage(c, ...): Fills c->e with a fault of the command line, and sets the exit code EXIT_USAGE.  Returns
 * ST_EINVAL. */
__attribute__((format(printf, 2, 3))) enum status lab_usage(struct lab *c,
                                                            const char *fmt, ...);

/* lab_say(c, ...): Prints text, unless the result is printed as JSON. */
__attribute__((format(printf, 2, 3))) void lab_say(const struct lab *c, const char *fmt,
                                                   ...);

/* lab_decision(d): Returns "match", "no_match" or "inconclusive". */
const char *lab_decision(enum surface_decision d);

/* lab_may_write(c, path): Returns ST_OK if the command may write the file: it is none of its arguments and not
 * the model, and outfile_may() allows it. */
enum status lab_may_write(struct lab *c, const char *path);

/* lab_may_pipe(c): Like lab_may_write() for --out, which may also be "-"; then sets c->piped. */
enum status lab_may_pipe(struct lab *c);

/* lab_write(c, path, write, arg): Writes the file, or to standard output if c->piped. */
enum status lab_write(struct lab *c, const char *path, newfile_writer *write,
                      const void *arg);

/* ---- scans (lab_scan.c) */

/* lab_scan_parse(c, path, out, e): Reads the points of a file ("-": standard input). */
enum status lab_scan_parse(const struct lab *c, const char *path, struct cloudpoints *out,
                           struct errinfo *e);

/* lab_scan_build(c, path, p, enrolment, w, out, found, e): Builds the face in points, by scan_build().  Any
 * thread may call it.
 *   path  for messages */
enum status lab_scan_build(const struct lab *c, const char *path, struct cloudpoints *p,
                           bool enrolment, struct surface_work *w,
                           struct surface_face *out, struct surface_found *found,
                           struct errinfo *e);

/* lab_scan_read(c, path, out, found): Reads and builds a face that is compared, not enrolled. */
enum status lab_scan_read(struct lab *c, const char *path, struct surface_face *out,
                          struct surface_found *found);

/* lab_scan_of(c, scan, enrolment, w, out, found, code, refused, e): Builds the face of a collection's scan.  A
 * malformed scan and one without a face are no failure.  Any thread may call it.
 *   code     receives the scan's status; NULL is allowed
 *   refused  receives the reason, to be released by free(), unless that status is ST_OK
 * Returns ST_OK; ST_ENOMEM; ST_EIO; ST_ENOTFOUND. */
enum status lab_scan_of(const struct lab *c, const struct corpus_scan *scan,
                        bool enrolment, struct surface_work *w, struct surface_face *out,
                        struct surface_found *found, enum status *code, char **refused,
                        struct errinfo *e);

/* lab_scan_not_read(c, k, source, path): Returns ST_OK if path is no scan and no table of the collection k;
 * ST_EEXISTS. */
enum status lab_scan_not_read(struct lab *c, const struct corpus *k, const char *source,
                              const char *path);

#endif
