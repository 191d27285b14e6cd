/* model.h -- the model: knowledge of faces in general.  A comparison depends on it and on
 * the two faces, nothing else.
 * One model is shipped (core/face/default.model, compiled in as model_default); `surfacelab train`
 * learns another.  How it is learned: docs/model.md. */
#ifndef CORE_MODEL_H
#define CORE_MODEL_H
#include <stddef.h>
#include <stdint.h>
#include "surface_face.h"
#include "grid.h"
#include "status.h"

#define MODEL_MODES    104 /* at most; a multiple of 8 (fit.c) */
#define MODEL_NAME_MAX 79
#define MODEL_FACE_MIN 200 /* cells that a mean face must have: a sixth of the grid */

/* What varies, per cell (mm): a sum of modes, each with a coefficient of variance 1, and a
 * rest. */
struct model_basis {
    uint32_t n;         /* modes, 0..MODEL_MODES; the others are 0 */
    float rest[GRID_N]; /* standard deviation of the rest, mm; 0: the cell is not used */
    float mode[GRID_N][MODEL_MODES];
};

/* One Gaussian model of faces.  A scan's gap from the mean face, at right angles to it, is
 *     motion + change + identity + noise:
 * the motion is what moving the mean face a little brings, and the modes are free of it. */
struct surface_model {
    char name[MODEL_NAME_MAX + 1]; /* origin of the training data; printable ASCII */
    float mean[GRID_N];            /* height of the mean face, mm; NAN off the face */
    struct model_basis change;     /* variation of gaps between two scans of one person */
    struct model_basis identity;   /* variation of gaps between people; its rest is 0 */
    struct model_basis shape;      /* variation of heights over all faces, identity and
                                    change together (shape.h) */
    double kinship; /* correlation of two people's identities, 0 to below 1: they have
                              in common what the mean face has not */
    double
        noise_floor_mm; /* deviation of a scan's noise per cell, above 0: the root of */
    double
        noise_factor; /* (noise_factor residual)^2 + noise_floor_mm^2, where residual is
                              the root mean square of what the shape leaves of the scan, mm */
    struct surface_calibration calibration; /* its own */
};

extern const struct surface_model model_default;

/* model_parse(text, len, out, line): Parses a model from its text form (docs/model.md), in which
 * every number is an integer: a text is the same model everywhere.
 * out   filled on ST_OK; else unspecified
 * line  the number of the line that failed, from 1; may be NULL
 * Returns ST_OK; ST_EVERSION another version of the text; ST_ECORRUPT. */
enum status model_parse(const char *text, size_t len, struct surface_model *out,
                        uint32_t *line);

#endif
