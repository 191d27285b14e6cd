#include "mem.h"

#include <stdint.h>
#include <stdlib.h>

void *mem_array(size_t n, size_t size)
{
    size_t bytes;

    if (size != 0 && n > (SIZE_MAX - 64) / size)
        return NULL;
    bytes = mem_round(n * size);
    return aligned_alloc(64, bytes != 0 ? bytes : 64);
}

void mem_free(void *p)
{
    free(p);
}

void *scratch_need(struct scratch *s, size_t bytes)
{
    unsigned char *block;

    if (bytes <= s->size && s->block != NULL)
        return s->block;
    if ((block = mem_array(bytes, 1)) == NULL)
        return NULL;
    free(s->block);
    s->block = block;
    s->size = bytes;
    return block;
}

void scratch_free(struct scratch *s)
{
    free(s->block);
    s->block = NULL;
    s->size = 0;
}
