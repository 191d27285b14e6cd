/* params.h -- the query parameters.  Each returns false when the parameter is malformed, or
 * needs a scope that the token lacks: then r->response says so.  One that is absent leaves *out as
 * it was. */
#ifndef SERVER_PARAMS_H
#define SERVER_PARAMS_H
#include <stdbool.h>
#include <stddef.h>
#include "verify.h"

struct clouddepth_camera; /* clouddepth.h */
struct request;

bool params_flag(struct request *r, const char *name, bool *out); /* true, false */

/* params_units(r, mm): units=auto|mm|cm|m|in|um as millimetres per unit, 0 for auto.
 * params_axes(r, axes_given): axes=auto|scanner. */
bool params_units(struct request *r, double *mm);
bool params_axes(struct request *r, bool *axes_given);

/* params_camera(r, c): fx, fy (above 0), cx, cy and depth_scale (above 0), of a depth image,
 * and width and height, both or none, of one that has nothing but its values. */
bool params_camera(struct request *r, struct clouddepth_camera *c);

/* params_detail(r, scopes, out): detail=measure|heatmap|surface, which also takes one of the scopes;
 * without it VERIFY_DECISION for a client that prefers the minimum (headers.h), else VERIFY_BRIEF. */
bool params_detail(struct request *r, unsigned scopes, enum verify_detail *out);

/* params_surface(r, out): detail=surface, or nothing. */
bool params_surface(struct request *r, bool *out);

/* params_format(r, ply): format=glb|ply. */
bool params_format(struct request *r, bool *ply);

/* params_text(r, name, out, size): 1 to size - 1 bytes, decoded. */
bool params_text(struct request *r, const char *name, char *out, size_t size);

/* params_count(r, name, max, out): an integer from 1 to max. */
bool params_count(struct request *r, const char *name, size_t max, size_t *out);

#endif
