/* ctl_session.h -- the files that a command names for one capture session. */
#ifndef CTL_SESSION_H
#define CTL_SESSION_H
#include <stddef.h>
#include "session.h"

struct ctl; /* ctl.h */

struct ctl_session {
    size_t n; /* files */
    char *path[SURFACE_FRAMES_MAX];
    struct session session;
};

/* ctl_session_list(c, s): the files that the arguments behind the first name; of a folder the scans
 * in it, by name.  At most SURFACE_FRAMES_MAX.
 * ctl_session_read(c, s): their points into s->session; why a file is none of a scan is its frame's
 * reason, but for ST_ENOMEM.
 * Failures are in c->e.  *s is all zero before; ctl_session_free(), also on failure. */
enum status ctl_session_list(struct ctl *c, struct ctl_session *s);
enum status ctl_session_read(struct ctl *c, struct ctl_session *s);
void ctl_session_free(struct ctl_session *s);

/* ctl_session_tell(s): a line to standard error for each frame that was left out. */
void ctl_session_tell(const struct session *s);

#endif
