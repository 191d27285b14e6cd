/* ctl_corpus.h -- the scans of a collection, and what of it was not taken. */
#ifndef CTL_CORPUS_H
#define CTL_CORPUS_H
#include <stdbool.h>
#include "status.h"

struct ctl;         /* ctl.h */
struct errinfo;     /* errinfo.h */
struct face;        /* face.h */
struct face_work;   /* face.h */
struct corpus;      /* corpus.h */
struct corpus_scan; /* corpus.h */
struct json;        /* json.h */
struct scan_found;  /* scan.h */

/* ctl_corpus_tell(k): what is left out, on standard error.
 * ctl_corpus_left(j, k): the same, each as an object with file and reason; they end the array
 * that is open. */
void ctl_corpus_tell(const struct corpus *k);
void ctl_corpus_left(struct json *j, const struct corpus *k);

/* ctl_corpus_not_read(c, k, source, path): the file at path, which will be written, is no scan of
 * the collection and no table of it.  ST_EEXISTS, in c->e (ctl_dir.h). */
enum status ctl_corpus_not_read(struct ctl *c, const struct corpus *k, const char *source,
                                const char *path);

/* ctl_corpus_face(c, scan, enrolment, w, out, found, code, refused, e): a scan as a face, read
 * as c->scans says; enrolment: by the strict gate.  On any thread, since c is not changed.  Where
 * it is malformed or no face *refused says why, for free(), *code (NULL is allowed) is the
 * status, and that is no failure.  Returns ST_OK, ST_ENOMEM, ST_EIO, ST_ENOTFOUND. */
enum status ctl_corpus_face(const struct ctl *c, const struct corpus_scan *scan,
                            bool enrolment, struct face_work *w, struct face *out,
                            struct scan_found *found, enum status *code, char **refused,
                            struct errinfo *e);

#endif
