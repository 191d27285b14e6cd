/* fail_alloc.h -- memory that runs out, in tests that are linked with -Wl,--wrap=F for each F of
 * aligned_alloc, malloc, calloc and strdup that may fail. */
#ifndef TESTS_FAIL_ALLOC_H
#define TESTS_FAIL_ALLOC_H
#include <stddef.h>
#include "status.h"

/* fail_alloc_at(n): Lets the n-th allocation from now on fail; 0: no allocation.  The counts restart. */
void fail_alloc_at(unsigned long n);

/* fail_alloc_count(): Returns the number of allocations since fail_alloc_at(). */
unsigned long fail_alloc_count(void);

/* fail_alloc_bytes(): Returns the sum of their sizes. */
size_t fail_alloc_bytes(void);

/* fail_alloc_walk(run, arg): Calls run(arg) with its first, second, ... allocation failing, until it
 * returns ST_OK; before that it must return ST_ENOMEM.  Returns the number of failed allocations. */
unsigned long fail_alloc_walk(enum status (*run)(void *arg), void *arg);

#endif
