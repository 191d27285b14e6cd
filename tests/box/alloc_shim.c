/* alloc_shim -- loaded into a program (LD_PRELOAD): the FAIL_ALLOC-th calloc() or malloc() of the
 * program itself finds no memory.  Those of shared libraries do not count.  At the end the number of
 * all is written to the file FAIL_ALLOC_COUNT. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/auxv.h>

extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_malloc(size_t size);

static atomic_ulong count;
static unsigned long fail;  /* 0: none */
static const void *program; /* its first byte; NULL: the shim is not ready */

static const void *base_of(const void *address)
{
    Dl_info at;

    return dladdr(address, &at) != 0 ? at.dli_fbase : NULL;
}

__attribute__((constructor)) static void begin(void)
{
    const char *n = getenv("FAIL_ALLOC");

    fail = n != NULL ? strtoul(n, NULL, 10) : 0;
    program = base_of((const void *)(uintptr_t)getauxval(AT_PHDR));
}

__attribute__((destructor)) static void end(void)
{
    const char *path = getenv("FAIL_ALLOC_COUNT");
    FILE *f = path != NULL ? fopen(path, "w") : NULL;

    if (f == NULL)
        return;
    (void)fprintf(f, "%lu\n", (unsigned long)count);
    (void)fclose(f);
}

static int fails(const void *caller)
{
    return program != NULL && base_of(caller) == program &&
           atomic_fetch_add(&count, 1) + 1 == fail;
}

void *calloc(size_t n, size_t size)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_calloc(n, size);
}

void *malloc(size_t size)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}
