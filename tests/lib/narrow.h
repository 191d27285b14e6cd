/* narrow.h -- core/face/lsq.c compiled for any processor, also if the build has wider vectors. */
#ifndef TESTS_NARROW_H
#define TESTS_NARROW_H
#include <stdbool.h>
#include <stdint.h>

struct lsq_rows; /* lsq.h */

void narrow_add(struct lsq_rows *r, uint32_t from, uint32_t to, float *sum,
                uint32_t stride);
void narrow_times(const float *row, uint32_t stride, uint32_t n, const float *by,
                  uint32_t width, float *out);
void narrow_dot(const float *row, uint32_t stride, uint32_t n, const float *by,
                uint32_t width, float *out);
void narrow_add_rows(const double *row, uint32_t stride, uint32_t n, const double *by,
                     uint32_t width, double *out);
bool narrow_factor(double *h, uint32_t stride, uint32_t to, uint32_t n);

#endif
