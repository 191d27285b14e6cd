#define _DEFAULT_SOURCE /* explicit_bzero */
#include "mem.h"

#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *mem_array(size_t n, size_t size)
{
    size_t bytes;

    if (size != 0 && n > (SIZE_MAX - 64) / size)
        return NULL;
    bytes = mem_round(n * size);
    return aligned_alloc(64, bytes != 0 ? bytes : 64);
}

/* The size is the allocator's: so no length has to be carried along, and none can be wrong. */
void mem_free(void *p)
{
    if (p != NULL)
        explicit_bzero(p, malloc_usable_size(p));
    free(p);
}

void *mem_grow(void *p, size_t used, size_t bytes)
{
    void *to;

    if (p != NULL && malloc_usable_size(p) >= MEM_MAPPED)
        return realloc(p, bytes);
    to = mem_array(bytes, 1);
    if (to != NULL && p != NULL) {
        memcpy(to, p, used);
        mem_free(p);
    }
    return to;
}

void *scratch_need(struct scratch *s, size_t bytes)
{
    unsigned char *block;

    if (bytes <= s->size && s->block != NULL) {
        s->used = bytes > s->used ? bytes : s->used;
        return s->block;
    }
    if ((block = mem_array(bytes, 1)) == NULL)
        return NULL;
    mem_free(s->block);
    *s = (struct scratch){block, bytes, bytes};
    return block;
}

void scratch_free(struct scratch *s)
{
    mem_free(s->block);
    *s = (struct scratch){0};
}

void scratch_wipe(struct scratch *s, size_t keep)
{
    if (s->size > keep) {
        scratch_free(s);
    } else if (s->used > 0) {
        explicit_bzero(s->block, s->used);
        s->used = 0;
    }
}
