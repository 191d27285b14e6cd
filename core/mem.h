/* mem.h -- the only place where core asks for memory.
 * Sizes are checked for overflow; a failed call returns NULL and changes nothing. */
#ifndef CORE_MEM_H
#define CORE_MEM_H
#include <stddef.h>

/* mem_array(n, size): n objects of size bytes, uninitialised, 64-byte aligned; NULL when
 * out of memory or on overflow.  n == 0 gives a valid pointer.  Release with mem_free(). */
void *mem_array(size_t n, size_t size);
void mem_free(void *p); /* NULL is allowed */

/* A block that a worker owns and reuses, so that in the long run nothing is allocated.  All
 * zero is an empty one. */
struct scratch {
    unsigned char *block;
    size_t size;
};

/* scratch_need(s, bytes): a 64-byte aligned block of at least bytes, owned by s, valid
 * until the next scratch_need() or scratch_free(); its former content is lost.  NULL when
 * out of memory: then s is as before. */
void *scratch_need(struct scratch *s, size_t bytes);
void scratch_free(struct scratch *s); /* s is empty again */

/* mem_round(bytes): bytes rounded up so that the next array begins on a cache line. */
static inline size_t mem_round(size_t bytes)
{
    return (bytes + 63) & ~(size_t)63;
}

/* mem_take(block, at, n, size): room for n objects of size bytes at *at in block, which
 * begins on a cache line; *at moves behind it.  With block NULL only *at moves: a layout
 * is run once for the size and once with the block. */
static inline void *mem_take(unsigned char *block, size_t *at, size_t n, size_t size)
{
    unsigned char *p = block == NULL ? NULL : block + *at;

    *at += mem_round(n * size);
    return p;
}

#endif
