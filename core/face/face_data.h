/* face_data.h -- the parts of a face.  Immutable once built: any number of threads may compare it
 * at the same time. */
#ifndef CORE_FACE_DATA_H
#define CORE_FACE_DATA_H
#include "encode.h"
#include "frame.h"
#include "surface_face.h"
#include "surface.h"

struct surface_face {
    struct surface surface;
    struct surface_quality quality;
    struct frame frame;       /* its canonical frame */
    struct encoding encoding; /* input of comparisons (encode.h) */
    float step_mm; /* distance between neighbouring depths of the sensor; 0: continuous */
};

#endif
