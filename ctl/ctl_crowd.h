/* ctl_crowd.h -- enrolling a collection of scans (corpus.h): on all cores, resumable. */
#ifndef DB_SURFACECTL_CROWD_H
#define DB_SURFACECTL_CROWD_H
#include <stdbool.h>
#include "errinfo.h"

struct face;           /* face.h */
struct face_work;      /* face.h */
struct store;          /* store.h */
struct store_template; /* store.h */
struct ctl;            /* ctl.h */

/* ctl_crowd_enroll(c): the collection c->args[0]; an exit code. */
int ctl_crowd_enroll(struct ctl *c);

/* ctl_enroll_face(c, s, subject, label, path, w, f, t, created): one scan that is read
 * already, if it fits the subject's others; path: for messages.  ST_EMISMATCH. */
enum status ctl_enroll_face(struct ctl *c, struct store *s, const char *subject,
                            const char *label, const char *path, struct face_work *w,
                            const struct face *f, struct store_template *t,
                            bool *created);

#endif
