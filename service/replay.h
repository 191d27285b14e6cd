/* replay.h -- is a probe no new scan, but the cloud of a template of the subject? */
#ifndef SERVICE_REPLAY_H
#define SERVICE_REPLAY_H
#include "session.h"
#include "templates.h"

/* replay_look(s, face, t, index, out, e): Sets *out to the digests of a probe that matched, for the record
 * (struct store_record), which looks for the first frames of templates.
 *   s      the probe's scan, after session_build(); out borrows from it
 *   face   its face
 *   index  template that decides
 * Returns ST_OK; ST_ENOMEM. */
enum status replay_look(const struct session *s, const struct surface_face *face,
                        const struct templates *t, size_t index, struct store_probe *out,
                        struct errinfo *e);

/* replay_is(t, probe): Returns true if one of the probe's frames is among those that a template was fused from. */
bool replay_is(const struct templates *t, const struct store_probe *probe);

/* replay_refused(e): Sets *e to the error of a replayed scan, and returns its status. */
enum status replay_refused(struct errinfo *e);

#endif
