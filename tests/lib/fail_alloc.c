#include "fail_alloc.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The linker knows those of them that the test wraps. */
__attribute__((weak)) void *__real_aligned_alloc(size_t alignment, size_t size);
__attribute__((weak)) void *__real_malloc(size_t size);
__attribute__((weak)) void *__real_calloc(size_t n, size_t size);
__attribute__((weak)) char *__real_strdup(const char *s);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
char *__wrap_strdup(const char *s);

static _Atomic unsigned long count; /* threads allocate at the same time */
static _Atomic size_t bytes;
static unsigned long fail;

void fail_alloc_at(unsigned long n)
{
    count = 0;
    bytes = 0;
    fail = n;
}

unsigned long fail_alloc_count(void)
{
    return count;
}

size_t fail_alloc_bytes(void)
{
    return bytes;
}

unsigned long fail_alloc_walk(enum status (*run)(void *arg), void *arg)
{
    for (unsigned long k = 1;; k++) {
        enum status st;

        fail_alloc_at(k);
        st = run(arg);
        fail_alloc_at(0);
        if (st == ST_OK)
            return k - 1;
        if (st == ST_ENOMEM)
            continue;
        (void)fprintf(stderr, "allocation %lu fails: %s\n", k, status_message(st));
        abort();
    }
}

static bool fails(size_t size)
{
    bytes += size;
    return ++count == fail;
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return fails(size) ? NULL : __real_aligned_alloc(alignment, size);
}

void *__wrap_malloc(size_t size)
{
    return fails(size) ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return fails(n * size) ? NULL : __real_calloc(n, size);
}

char *__wrap_strdup(const char *s)
{
    return fails(strlen(s) + 1) ? NULL : __real_strdup(s);
}
