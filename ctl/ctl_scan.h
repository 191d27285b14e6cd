/* ctl_scan.h -- a scan's file as a face. */
#ifndef CTL_SCAN_H
#define CTL_SCAN_H
#include <stddef.h>
#include "status.h"

struct cloudpoints; /* cloudpoints.h */
struct ctl;         /* ctl.h */
struct errinfo;     /* errinfo.h */
struct face;        /* face.h */
struct face_work;   /* face.h */

/* ctl_scan_read(c, path, w, out): the scan in a file ("-": standard input), in c->unit_mm if
 * the file has no unit of its own.  Every failure is in c->e, with the path.
 * ctl_scan_points(), ctl_scan_build(): the same in two steps, for callers that need the points
 * too: in millimetres, released by cloudpoints_free() (empty on failure).
 * ctl_scan_parse(): the points in the file's own unit, out->unit_mm. */
enum status ctl_scan_read(struct ctl *c, const char *path, struct face_work *w,
                          struct face *out);
enum status ctl_scan_parse(struct ctl *c, const char *path, struct cloudpoints *out);
enum status ctl_scan_points(struct ctl *c, const char *path, struct cloudpoints *out);
enum status ctl_scan_build(struct ctl *c, const char *path, const struct cloudpoints *p,
                           struct face_work *w, struct face *out);

/* ctl_scan_file(path, most, bytes, len, e): all of a file of up to that many bytes ("-":
 * standard input), with a zero byte behind it; *bytes is released by free(), also on
 * failure. */
enum status ctl_scan_file(const char *path, size_t most, unsigned char **bytes,
                          size_t *len, struct errinfo *e);

#endif
