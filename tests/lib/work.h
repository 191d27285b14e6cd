/* work.h -- what a request costs, counted in basic blocks: for programs that are linked with
 * libcounted.a, in which each basic block of core calls a function. */
#ifndef TESTS_WORK_H
#define TESTS_WORK_H
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

enum work_step {
    WORK_PREPARE, /* both surfaces */
    WORK_ALIGN,
    WORK_MEASURE, /* the gaps, the general triangulation, the volume */
    WORK_MINIMAL,
    WORK_HEATMAP,
    WORK_ASYMMETRY,
    WORK_STEPS
};

const char *work_name(enum work_step step);

/* work_executed(): basic blocks so far. */
uint64_t work_executed(void);

/* work_set_at(flag, blocks): *flag becomes true once so many blocks more are executed. */
void work_set_at(atomic_bool *flag, uint64_t blocks);

/* work_count(a, b, n, blocks): blocks[step] = basic blocks a point executed in comparing the
 * surfaces through n points a and n points b, and in the asymmetry of b, whatever they are
 * like: no gate for faces is in the way. */
void work_count(const struct dvec3 *a, const struct dvec3 *b, size_t n,
                double blocks[WORK_STEPS]);

/* work_ratio(blocks, ordinary): the greater of how many times the work of an ordinary
 * comparison one took, and of an ordinary request for the asymmetry. */
double work_ratio(const double blocks[WORK_STEPS], const double ordinary[WORK_STEPS]);

#endif
