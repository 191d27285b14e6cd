/* vec.h -- points.  ivec*: lattice units (lattice.h), exact.  dvec3: millimetres. */
#ifndef CORE_VEC_H
#define CORE_VEC_H
#include <stdint.h>

struct ivec2 {
    int32_t x, y;
};

struct ivec3 {
    int32_t x, y, z;
};

struct dvec3 {
    double x, y, z;
};

#endif
