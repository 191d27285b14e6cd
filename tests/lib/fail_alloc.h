/* fail_alloc.h -- memory that runs out, in tests that are linked with -Wl,--wrap=F for each F of
 * aligned_alloc, malloc, calloc and strdup that may fail. */
#ifndef TESTS_FAIL_ALLOC_H
#define TESTS_FAIL_ALLOC_H
#include <stddef.h>
#include "status.h"

/* The n-th allocation from now on fails; 0: none.  The counts start again. */
void fail_alloc_at(unsigned long n);
unsigned long fail_alloc_count(void); /* allocations since fail_alloc_at() */
size_t fail_alloc_bytes(void);        /* and what they asked for */

/* fail_alloc_walk(run, arg): run(arg) again and again, with its first, second, ... allocation
 * failing, until it returns ST_OK; before that it must return ST_ENOMEM.  Returns how many
 * allocations failed. */
unsigned long fail_alloc_walk(enum status (*run)(void *arg), void *arg);

#endif
