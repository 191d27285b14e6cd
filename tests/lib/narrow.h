/* narrow.h -- core/face/normal.c compiled for any processor, where the build has wider vectors too. */
#ifndef TESTS_NARROW_H
#define TESTS_NARROW_H
#include <stdbool.h>
#include <stdint.h>

struct normal_rows; /* normal.h */

void narrow_add(struct normal_rows *r, uint32_t from, uint32_t to, float *sum,
                uint32_t stride);
bool narrow_factor(double *h, uint32_t stride, uint32_t from, uint32_t to, uint32_t n);

#endif
