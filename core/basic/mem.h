/* mem.h -- the only place where core asks for memory, and where what holds a face is freed.
 * Sizes are checked for overflow; a failed call returns NULL and changes nothing. */
#ifndef CORE_MEM_H
#define CORE_MEM_H
#include <stddef.h>

/* mem_array(n, size): n objects of size bytes, uninitialised, 64-byte aligned; NULL when
 * out of memory or on overflow.  n == 0 gives a valid pointer.  Release with mem_free(). */
void *mem_array(size_t n, size_t size);

/* mem_free(p): wiped, then freed; p is of mem_array() or of malloc(), or NULL.  Some 5 us for
 * 100 KB. */
void mem_free(void *p);

/* mem_grow(p, used, bytes): Returns a block of bytes, aligned for any type, that begins with the first
 * used bytes of p.  Wipes and frees p: unlike realloc() it leaves no copy behind.  A block of MEM_MAPPED
 * bytes or more is moved by realloc(), page by page and without a copy, if such a block is a mapping of
 * its own (as in the daemon: mallopt() in server/main.c).  NULL: out of memory, p is unchanged. */
#define MEM_MAPPED ((size_t)1 << 20)
void *mem_grow(void *p, size_t used, size_t bytes);

/* A block that a worker owns and reuses, so that in the long run nothing is allocated.  All
 * zero is an empty one. */
struct scratch {
    unsigned char *block;
    size_t size, used; /* used: of size, since the last wipe */
};

/* scratch_need(s, bytes): a 64-byte aligned block of at least bytes, owned by s, valid
 * until the next scratch_need() or scratch_free(); its former content is lost.  NULL when
 * out of memory: then s is as before. */
void *scratch_need(struct scratch *s, size_t bytes);
void scratch_free(struct scratch *s); /* s is empty again */

/* scratch_wipe(s, keep): its content is wiped, as far as it was used, and the block freed if
 * it is of more than keep bytes. */
void scratch_wipe(struct scratch *s, size_t keep);

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
