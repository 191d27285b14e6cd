/* encode.h -- a face as the evidence that its scan gives of who it is.
 * One Gaussian model of faces (model.h) says how the heights of a scan come about: the gap h
 * between scan and mean face, per cell and at right angles to the mean face, is
 *     h = J motion + F change + V identity + noise,
 * the motion of deviation ENCODE_MOTION_MM, the coefficients of change and identity of
 * deviation 1, and the noise independent per cell with the variance
 *     s^2 = floor^2 + (factor * residual)^2,
 * of the model's floor and factor and the scan's own residual: what the shape of a face leaves of
 * it (shape.h), and what steps of its depths add (encode_noise()).  A cell without a height is a missing observation; other rules for holes, covers
 * and noisy sensors are not needed.
 * With S the covariance of all but the identity, over the cells that are there, the scan enters
 * any comparison only by
 *     A = V' S^-1 V  and  b = V' S^-1 h.
 * Two scans are then compared without looking at either again (ratio.h).
 * The same idea with other features: probabilistic linear discriminant analysis (Prince and
 * Elder, "Probabilistic Linear Discriminant Analysis for Inferences About Identity", ICCV 2007),
 * i-vectors with their uncertainty (Kenny et al., "PLDA for Speaker Verification with Utterances
 * of Arbitrary Duration", ICASSP 2013).
 * Sums of products are floats in a fixed order, solutions doubles, by + - * / and sqrt:
 * the same digits on every machine with IEEE 754 numbers, compiler and number of threads. */
#ifndef CORE_ENCODE_H
#define CORE_ENCODE_H
#include <stdint.h>
#include "grid.h"
#include "mem.h"
#include "model.h"
#include "lsq.h"
#include "status.h"

#define ENCODE_MOTION_MM 2.0
#define ENCODE_PAIRS     (MODEL_MODES * (MODEL_MODES + 1) / 2)

/* The part of a stored face beside its surface: 22 KB. */
struct encoding {
    float a[ENCODE_PAIRS]; /* A's lower triangle, row by row */
    float b[MODEL_MODES];
    float residual_mm;         /* residual of the scan, by encode_noise() */
    uint32_t cells;            /* number of cells with a height */
    uint8_t there[GRID_N / 8]; /* a bit for each cell: 1: it has a height */
    uint32_t
        n; /* number of identity's modes: rows of A; 0: nothing is known of the face */
};

/* The part that does not depend on the scan, for many encodings. */
struct encode_basis {
    const struct surface_model *m;
    uint32_t change,
        identity;   /* where each begins among the columns; the motion is first */
    uint32_t width; /* columns in use */
    uint32_t cells; /* number of cells that the model uses */
    float
        normal_z[GRID_N]; /* factor of heights to gaps, from the mean face; 0: not used */
    float motion[GRID_N][NORMAL_LANES];     /* J, 6 columns */
    float gram[NORMAL_WIDTH][NORMAL_WIDTH]; /* the products' sum over all cells */
};

/* encode_prepare(m, out): Prepares encodings by m, which is borrowed.  Cost: about 5 ms. */
void encode_prepare(const struct surface_model *m, struct encode_basis *out);

/* encode_noise(residual_mm, step_mm): Returns the residual, in mm, that a scan's own residual and the
 * steps of its depths count as together.  Neighbouring cells share the error of a step, and the noise
 * of the model is independent per cell, so that a step counts by more than its deviation,
 * step / sqrt(12): by ENCODE_STEP. */
double encode_noise(double residual_mm, double step_mm);

/* encode_heights(e, z, residual_mm, s, out): Encodes the heights z (heights.h, at the face's
 * canonical frame; NAN: none), whose fit by the shape of a face has this residual.
 * Cells more than ENCODE_FAR_MM from the mean face do not count, as no face is there; those
 * more than ENCODE_HUBER deviations from the prediction by all others count less.
 * With fewer than ENCODE_LEAST cells out->n is 0.  About 1 ms.  Returns ST_OK, ST_ENOMEM. */
enum status encode_heights(const struct encode_basis *e, const float z[GRID_N],
                           double residual_mm, struct scratch *s, struct encoding *out);

/* encode_parts(e, z, residual_mm, slope, s, part): part[i] grows by half of what cell i adds to
 * slope' b, of the encoding of the same heights: the sum over the cells is slope' b / 2.
 * Cost as encode_heights().  Returns ST_OK, ST_ENOMEM. */
enum status encode_parts(const struct encode_basis *e, const float z[GRID_N],
                         double residual_mm, const double slope[MODEL_MODES],
                         struct scratch *s, double part[GRID_N]);

/* encode_rest(e, tmpl, probe, residual_mm, s, rest): Computes the gaps of one scan above another, from the
 * heights of both, less the motion and the change that explain most of them (a scan's residual_mm
 * each): what would be left if both were of one person.  NAN where either has no height, and
 * in all cells where fewer than ENCODE_LEAST are common.  Cost as encode_heights().
 * Returns ST_OK, ST_ENOMEM. */
enum status encode_rest(const struct encode_basis *e, const float tmpl[GRID_N],
                        const float probe[GRID_N], const double residual_mm[2],
                        struct scratch *s, float rest[GRID_N]);

#endif
