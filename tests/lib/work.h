/* work.h -- the cost of a call, counted in basic blocks: for programs that are linked with
 * libcounted.a, in which each basic block of core calls a function. */
#ifndef TESTS_WORK_H
#define TESTS_WORK_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* work_executed(): Returns the number of basic blocks executed so far. */
uint64_t work_executed(void);

/* work_set_at(flag, blocks): Sets *flag when that many more blocks have been executed. */
void work_set_at(atomic_bool *flag, uint64_t blocks);

#endif
