/* replay.h -- is a probe a new scan?  Whoever has a scan of a subject, from a scanner, a log or a
 * stolen copy, must not be verified by it: the cloud of a template is refused.  This tells only the
 * same points; who moves them by some tenths of a millimetre, or has another scan, is stopped by
 * signed captures alone (docs/threat-model.md). */
#ifndef VERIFY_REPLAY_H
#define VERIFY_REPLAY_H
#include "status.h"

struct cloudpoints; /* cloudpoints.h */
struct errinfo;     /* errinfo.h */
struct face;        /* face.h */
struct scan_found;  /* scan.h */
struct store_probe; /* store.h */
struct store_template;

/* replay_digest(c, hex): of the points as they were read, whatever their order, how often each
 * comes, the format and the unit: 64 hexadecimal digits of a hash of the REPLAY_SAMPLE points
 * whose own hash is least (a sample that depends on the set alone: Broder 1997, section 3), on a
 * lattice of 1/500 of the cloud's greatest coordinate.  That is coarse, some 0.2 mm, so that few
 * points move on it where a format keeps fewer decimals; two scans by a scanner share many such
 * points at best, never all of the sample.  O(n). */
#define REPLAY_SAMPLE 32
void replay_digest(const struct cloudpoints *c, char hex[65]);

/* replay_probe(t, found, probe, out, e): what store_settle() is to ask of a probe that
 * matched the template t; *found is borrowed.  Returns ST_OK, ST_ENOMEM. */
enum status replay_probe(const struct store_template *t, const struct scan_found *found,
                         const struct face *probe, struct store_probe *out,
                         struct errinfo *e);

/* replay_refuse(e): ST_EREPLAYED, and *e for the user. */
enum status replay_refuse(struct errinfo *e);

#endif
