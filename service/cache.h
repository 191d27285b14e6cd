/* cache.h -- decoded face models by template id, shared by the workers.
 * The model of a template never changes and its id is never reused (store.h), so no entry can be
 * outdated, even if the template is re-encoded.  The caller must first check in the store that the
 * template still exists: a deleted template must never match, whichever process deleted it.  A NULL
 * cache is empty and keeps nothing: cache_release() then frees the face.  Any thread. */
#ifndef SERVICE_CACHE_H
#define SERVICE_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"
#include "rows_types.h"

struct cache;

struct cache_held { /* a reference to a model */
    const struct surface_face *face;
};

/* cache_new(limit): Creates a cache for models of about limit bytes; it evicts the least recently used ones
 * first.
 *   limit  0: nothing is kept
 * Returns NULL: out of memory. */
struct cache *cache_new(size_t limit);

/* cache_free(c): Frees c; NULL is allowed.  No model may be held. */
void cache_free(struct cache *c);

/* cache_find(c, id): Returns the model of a template that the caller has seen in the store, to be released by
 * cache_release().  NULL: it is not in the cache, and the caller loads it. */
const struct cache_held *cache_find(struct cache *c, const char *id);

/* cache_mark(c): Returns a mark of the present moment, for cache_keep(). */
uint64_t cache_mark(struct cache *c);

/* cache_keep(c, mark, id, reencoded, f): Adds the model f to the cache, and returns it as cache_find() would.
 * The cache does not keep f if f exceeds the limit, if another thread has cached this template, or if
 * cache_forget() was called after the mark (it may have named this template).  The caller can use the
 * returned model in any case.
 *   mark       taken before f was read
 *   reencoded  the template was stored by another engine
 *   f          takes ownership, unless NULL is returned
 * Returns NULL: out of memory. */
const struct cache_held *cache_keep(struct cache *c, uint64_t mark, const char *id,
                                    bool reencoded, struct surface_face *f);

/* cache_release(c, held): Releases a reference; NULL is allowed. */
void cache_release(struct cache *c, const struct cache_held *held);

/* cache_forget(c, id): Removes the model from the cache; its memory is freed when no thread holds it.  Call it
 * after the store has deleted the template.  A thread that is reading the template at this moment
 * cannot cache it again. */
void cache_forget(struct cache *c, const char *id);

/* cache_list(c, n): Returns the ids of all *n entries, to be released by free(); NULL: out of
 * memory.  The caller finds out which of these templates other processes have deleted, and calls
 * cache_forget() for them.  The cache does not keep a model that is being read at this moment. */
char (*cache_list(struct cache *c, size_t *n))[STORE_ID_LEN + 1];

struct cache_state {
    size_t bytes, limit, entries; /* bytes of the models, their limit, number of models */
    uint64_t hits, misses;        /* calls of cache_find() with and without success */
    uint64_t evictions; /* models evicted because of the limit, without cache_forget() */
    uint64_t reencoded; /* misses whose template was re-encoded from another engine's */
};

/* cache_look(c, out): Copies a snapshot of the counters to *out. */
void cache_look(struct cache *c, struct cache_state *out);

#endif
