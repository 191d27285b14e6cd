/* face_work.h -- struct surface_work of the library: a worker's reusable memory.  One thread at a
 * time. */
#ifndef CORE_FACE_WORK_H
#define CORE_FACE_WORK_H
#include "align.h"
#include "encode.h"
#include "fit.h"
#include "frame.h"
#include "grid.h"
#include "surface_face.h"
#include "measure.h"
#include "mem.h"
#include "shape_work.h"
#include "surface.h"

struct search_basis;  /* search.h */
struct surface_model; /* model.h */

struct surface_work {
    struct measure_work
        measure; /* its scratch serves the builders too, and is exchanged with the
                                    blocks of searches (align.field) and of fits (shape.points)
                                    while these work on a surface */
    struct align_work align;
    struct surface upright; /* asymmetry_find()'s */
    struct scratch normal;  /* memory of encodings and ratios */
    const struct surface_model *model;
    struct frame_mean mean;  /* the model's */
    struct fit_basis change; /* the model's, for alignment */
    struct encode_basis encode;
    struct search_basis *search; /* of the model; NULL: not needed so far */
    float weight[GRID_N]; /* how well each place separates people (surface_weigh()) */
    struct shape_work shape;
    struct surface_calibration calibration;
    double (*clock_ms)(void); /* NULL: none */
};

#endif
