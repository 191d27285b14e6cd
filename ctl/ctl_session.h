/* ctl_session.h -- the files that a command names for one capture session. */
#ifndef CTL_SESSION_H
#define CTL_SESSION_H
#include <stddef.h>
#include "session.h"

struct ctl; /* ctl.h */

struct ctl_session {
    size_t n; /* number of files */
    char *path[SURFACE_FRAMES_MAX];
    struct session session;
};

/* ctl_session_list(c, first, s): Lists the files that the arguments from index first on name, and, of a folder,
 * the scans in it, by name.
 *   s  in: all zero; to be released by ctl_session_free(), also after a failure
 * Returns ST_OK, or an error with c->e set: more than SURFACE_FRAMES_MAX files; a folder without a scan. */
enum status ctl_session_list(struct ctl *c, int first, struct ctl_session *s);

/* ctl_session_read(c, s): Reads the points of the files into s->session.  One of several files that cannot be read
 * is left out, with the reason.
 * Returns ST_OK, or an error with c->e set: the only file cannot be read; ST_ENOMEM. */
enum status ctl_session_read(struct ctl *c, struct ctl_session *s);

/* ctl_session_free(s): Frees the paths and the points. */
void ctl_session_free(struct ctl_session *s);

/* ctl_session_tell(c, s): Says what each frame of a fused face adds, and writes a line to standard error for each
 * frame that was left out. */
void ctl_session_tell(const struct ctl *c, const struct session *s);

#endif
