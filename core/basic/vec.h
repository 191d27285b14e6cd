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

#define VEC_DEGREES 57.29577951308232 /* in a radian */

static inline double vec_square(double x)
{
    return x * x;
}

static inline double vec_dot(struct dvec3 a, struct dvec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct dvec3 vec_cross(struct dvec3 a, struct dvec3 b)
{
    return (struct dvec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                          a.x * b.y - a.y * b.x};
}

static inline struct dvec3 vec_sub(struct dvec3 a, struct dvec3 b)
{
    return (struct dvec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* vec_along(a, s, b): Returns a + s b. */
static inline struct dvec3 vec_along(struct dvec3 a, double s, struct dvec3 b)
{
    return (struct dvec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

/* vec_transform(t, p): Returns p moved by t, a row-major 4 x 4 matrix. */
static inline struct dvec3 vec_transform(const double t[16], struct dvec3 p)
{
    return (struct dvec3){t[0] * p.x + t[1] * p.y + t[2] * p.z + t[3],
                          t[4] * p.x + t[5] * p.y + t[6] * p.z + t[7],
                          t[8] * p.x + t[9] * p.y + t[10] * p.z + t[11]};
}

/* vec_after(t, first, out): Writes the matrix that moves a point by first, and then by t. */
static inline void vec_after(const double t[16], const double first[16], double out[16])
{
    for (int i = 0; i < 16; i++) {
        out[i] = 0;
        for (int k = 0; k < 4; k++)
            out[i] += t[i / 4 * 4 + k] * first[4 * k + i % 4];
    }
}

#endif
