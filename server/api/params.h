/* params.h -- the query parameters.  Each function leaves *out unchanged if its parameter is absent.  It
 * returns false, with r->response set, if the parameter is malformed or needs a scope that the token lacks. */
#ifndef SERVER_PARAMS_H
#define SERVER_PARAMS_H
#include <stdbool.h>
#include <stddef.h>
#include "groups.h"
#include "verify.h"

struct clouddepth_camera; /* clouddepth.h */
struct request;           /* request.h */

/* params_flag(r, name, out): Reads true or false. */
bool params_flag(struct request *r, const char *name, bool *out);

/* params_units(r, mm): Reads units=auto|mm|cm|m|in|um as millimetres per unit; auto is 0. */
bool params_units(struct request *r, double *mm);

/* params_axes(r, axes_given): Reads axes=auto|scanner; scanner is true. */
bool params_axes(struct request *r, bool *axes_given);

/* params_camera(r, c): Reads the camera of a depth image: fx and fy (above 0), cx, cy, and depth_scale (above 0).
 * A raw depth image also needs width and height, both or none. */
bool params_camera(struct request *r, struct clouddepth_camera *c);

/* params_detail(r, scopes, out): Reads detail=measure|heatmap|surface, which needs the scope detail or one of
 * scopes.  Without it sets VERIFY_DECISION if the client prefers a minimal response (headers.h), else
 * VERIFY_BRIEF. */
bool params_detail(struct request *r, unsigned scopes, enum verify_detail *out);

/* params_surface(r, out): Reads detail=surface, the only value allowed. */
bool params_surface(struct request *r, bool *out);

/* params_format(r, ply): Reads format=glb|ply. */
bool params_format(struct request *r, bool *ply);

/* params_text(r, name, out, size): Decodes a text of 1 to size - 1 bytes. */
bool params_text(struct request *r, const char *name, char *out, size_t size);

/* params_group(r, out): Reads group=LABEL (groups.h). */
bool params_group(struct request *r, char out[GROUPS_LABEL + 1]);

/* params_count(r, name, min, max, out): Reads an integer from min to max. */
bool params_count(struct request *r, const char *name, size_t min, size_t max,
                  size_t *out);

#endif
