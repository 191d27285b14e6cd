/* cache.h -- decoded face models by template id, shared by the workers.
 * What is loaded of a template never changes and its id is never used again (store.h), so
 * what is cached cannot be stale, whatever is reprocessed meanwhile; whether the template is
 * still there must be asked of the store first: a deleted template must never match, whoever
 * deleted it. */
#ifndef SERVER_CACHE_H
#define SERVER_CACHE_H
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "status.h"

struct cache;
struct errinfo;
struct store;

/* cache_new(limit): room for models of about limit bytes; what was used longest ago goes
 * first.  0: nothing is kept, every hold loads.  NULL: out of memory. */
struct cache *cache_new(size_t limit);
void cache_free(struct cache *c); /* nothing may be held; NULL is allowed */

/* cache_hold(c, s, id, w, out, e): the model of template id, from the cache or else loaded
 * from s; the caller has seen that the template is there.  Give it back by cache_release().
 * Returns as store_template_load(). */
enum status cache_hold(struct cache *c, struct store *s, const char *id,
                       struct face_work *w, const struct face **out, struct errinfo *e);
void cache_release(struct cache *c, const struct face *f); /* NULL is allowed */

/* cache_load(c, s, id, w): have it in the cache before it is held: a cache_hold() of it
 * waits for this.  Does nothing when it is there or being loaded, or nothing is kept; what
 * fails is for cache_hold() to try again and to tell. */
void cache_load(struct cache *c, struct store *s, const char *id, struct face_work *w);

/* cache_forget(c, id): drop it, its memory too once nobody holds it.  After the store has
 * deleted it: then no load that is under way brings it back. */
void cache_forget(struct cache *c, const char *id);

struct cache_state {
    size_t bytes, limit, entries;
    uint64_t hits, misses;
    uint64_t evictions; /* dropped for want of room, not forgotten */
    uint64_t renewed;   /* of the misses: made by another engine, and anew by this one */
};

void cache_look(struct cache *c, struct cache_state *out);

#endif
