/* mem.h -- memory of core, which is overwritten before it is freed.
 * Sizes are checked for overflow; a failed call returns NULL and changes nothing. */
#ifndef CORE_MEM_H
#define CORE_MEM_H
#include <stddef.h>

/* mem_array(n, size): Returns n objects of size bytes, uninitialised, 64-byte aligned, to be released by
 * mem_free(); NULL: out of memory, or overflow.  n == 0 gives a valid pointer. */
void *mem_array(size_t n, size_t size);

/* mem_free(p): Wipes, then frees the block p, of mem_array() or malloc(); NULL is allowed.  Cost: some
 * 5 us for 100 KB. */
void mem_free(void *p);

/* mem_grow(p, used, bytes): Returns a block of bytes, aligned for any type, that begins with the first
 * used bytes of p.  Wipes and frees p: unlike realloc() it leaves no copy behind.  A block of MEM_MAPPED
 * bytes or more is moved by realloc(), page by page and without a copy, if such a block is a mapping of
 * its own (as in the daemon: mallopt() in server/main.c).  NULL: out of memory, p is unchanged. */
#define MEM_MAPPED ((size_t)1 << 20)
void *mem_grow(void *p, size_t used, size_t bytes);

/* A block that a worker owns and reuses, so that in the long run nothing is allocated.  Empty if all
 * zero. */
struct scratch {
    unsigned char *block;
    size_t size, used; /* bytes; bytes used since the last wipe */
};

/* scratch_need(s, bytes): Returns a 64-byte aligned block of at least bytes, owned by s and valid
 * until the next scratch_need() or scratch_free(); its former content is lost.  NULL: out of memory, s is
 * unchanged. */
void *scratch_need(struct scratch *s, size_t bytes);
void scratch_free(struct scratch *s); /* resets s to the empty state */

/* scratch_wipe(s, keep): Wipes the used part of s, and frees the block if it has more than keep
 * bytes. */
void scratch_wipe(struct scratch *s, size_t keep);

/* scratch_exchange(a, b): Exchanges two blocks with their owners. */
static inline void scratch_exchange(struct scratch *a, struct scratch *b)
{
    const struct scratch block = *a;

    *a = *b;
    *b = block;
}

/* mem_round(bytes): Returns bytes rounded up so that the next array begins on a cache line. */
static inline size_t mem_round(size_t bytes)
{
    return (bytes + 63) & ~(size_t)63;
}

/* mem_take(block, at, n, size): Returns the place for n objects of size bytes at *at in block, which
 * begins on a cache line, and moves *at behind it.  With block NULL only *at moves: a layout
 * is run once for the size and once with the block. */
static inline void *mem_take(unsigned char *block, size_t *at, size_t n, size_t size)
{
    unsigned char *p = block == NULL ? NULL : block + *at;

    *at += mem_round(n * size);
    return p;
}

#endif
