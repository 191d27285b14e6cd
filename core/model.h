/* model.h -- what was learned from many faces: everything a comparison knows about people
 * that is not in the two scans.  Shipped as a table (core/default.model, compiled in as
 * model_default), relearned from an owner's scans by `surfacectl train`.  How it is learned:
 * train.h and docs/accuracy.md. */
#ifndef CORE_MODEL_H
#define CORE_MODEL_H
#include <stddef.h>
#include <stdint.h>
#include "decision.h"
#include "grid.h"
#include "status.h"

#define MODEL_MODES    72 /* room; a multiple of 4 */
#define MODEL_NAME_MAX 79

/* What a face does between two scans of one person: the signed gap per cell (mm) is a sum
 * of modes, each with a coefficient of variance 1, and of what they leave. */
struct model_basis {
    uint32_t n;         /* modes, 0..MODEL_MODES; the rest is 0 */
    float rest[GRID_N]; /* standard deviation of what is left, mm; 0: no such cell */
    float mode[GRID_N][MODEL_MODES];
};

struct model {
    char name[MODEL_NAME_MAX + 1]; /* what it was learned from; printable ASCII */
    float mean[GRID_N];            /* height of the mean face, mm; NAN off the face */
    float weight[GRID_N];      /* u(x, y), 0 or more; the mean of those above 0 is 1 */
    float cap_mm;              /* what one cell can add to the disparity at most */
    struct model_basis motion; /* of the gap at the true pose: registers */
    struct model_basis change; /* of the gap at the pose found: is taken out */
    struct decision decision;  /* the calibration that belongs to it */
};

extern const struct model model_default;

/* model_parse(text, len, out, line): from the text form (docs/model.md).  Every number is
 * an integer there, so that the same text is the same model everywhere.
 * out   filled on ST_OK; else unspecified
 * line  may be NULL; on failure where (from 1)
 * Returns ST_OK; ST_EVERSION another version; ST_ECORRUPT. */
enum status model_parse(const char *text, size_t len, struct model *out, uint32_t *line);

/* model_write(m, buf, size): m as text, NUL-terminated, into buf; returns its length, or
 * one that is >= size when it did not fit (then buf is unspecified).  Numbers are rounded
 * to the text's units: model_parse() of it gives what will be used. */
size_t model_write(const struct model *m, char *buf, size_t size);

#endif
