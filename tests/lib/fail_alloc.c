#include "fail_alloc.h"

#include <stddef.h>

void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

static _Atomic unsigned long count; /* threads allocate at the same time */
static unsigned long fail;

void fail_alloc_at(unsigned long n)
{
    count = 0;
    fail = n;
}

unsigned long fail_alloc_count(void)
{
    return count;
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return ++count == fail ? NULL : __real_aligned_alloc(alignment, size);
}
