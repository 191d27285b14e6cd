/* fail_alloc.h -- makes core's n-th allocation fail.  For programs linked with
 * -Wl,--wrap=aligned_alloc: core/mesh/mem.c allocates by aligned_alloc() alone. */
#ifndef TESTS_FAIL_ALLOC_H
#define TESTS_FAIL_ALLOC_H

/* fail_alloc_at(n): the n-th allocation from now on (1 is the next) fails, once; 0: none. */
void fail_alloc_at(unsigned long n);

/* fail_alloc_count(): allocations since fail_alloc_at(), including the failed one. */
unsigned long fail_alloc_count(void);

#endif
