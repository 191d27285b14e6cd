/* ---- surface_search.h: who of many people a scan may show */
#ifndef CORE_SURFACE_SEARCH_H
#define CORE_SURFACE_SEARCH_H
#include "surface_face.h"

/* A first stage for identification: finds, among millions of templates, those that may have a high score.
 * Compare these with surface_compare(); the score of the search only orders them. */

/* What is searched of a template.  It is biometric data: the surface of the face can be rebuilt from it. */
#define SURFACE_DESCRIPTOR 101

#define SURFACE_UNDESCRIBED 255 /* first byte of what is no descriptor */

/* Describes a template for searches by the same model.
 * Cost: about 0.5 ms, and once 15 ms and 650 KB in the memory of work.
 * Returns SURFACE_OK; SURFACE_EINVAL: too little of the face is known to find it; SURFACE_ENOMEM.  out[0] is
 * then SURFACE_UNDESCRIBED: surface_index_add() refuses it. */
SURFACE_API enum surface_status surface_describe(struct surface_work *work,
                                                 const struct surface_face *face,
                                                 unsigned char out[SURFACE_DESCRIPTOR]);

/* Descriptors in memory, 103 bytes each.  One thread that changes it, or any number of threads that search, at
 * a time. */
struct surface_index;

#define SURFACE_NOWHERE UINT32_MAX

/* Returns a new, empty index, or NULL if out of memory. */
SURFACE_API struct surface_index *surface_index_new(void);

/* Wipes and frees an index; NULL is allowed. */
SURFACE_API void surface_index_free(struct surface_index *x);

/* Adds a descriptor, and returns its slot, a small number; or SURFACE_NOWHERE if out of memory, or if the bytes
 * are no descriptor. */
SURFACE_API uint32_t surface_index_add(struct surface_index *x,
                                       const unsigned char d[SURFACE_DESCRIPTOR]);

/* Wipes the descriptor in a slot, which becomes free. */
SURFACE_API void surface_index_remove(struct surface_index *x, uint32_t slot);

/* Returns the memory that an index takes, in bytes. */
SURFACE_API size_t surface_index_bytes(const struct surface_index *x);

struct surface_hit {
    float score; /* about that of surface_compare(), too low for partial templates */
    uint32_t slot;
};

/* Finds the templates with the highest scores.
 *   allowed  bit slot % 16 of word slot / 16 is set for the slots to be searched; NULL: all
 *   floor    least score that is wanted
 *   most     capacity of hit, at least 1
 *   n        receives the number of hits
 *   hit      [*n], by falling score
 * Exact: no descriptor is left out.  The same digits on every machine.
 * Cost: about 0.4 ms for each class of descriptors in x, of which there are 8, and 70 ns a descriptor; twice that
 * if the head is of another size; and once as surface_describe().
 * Returns SURFACE_OK; SURFACE_EINVAL: too little of the probe is known, or its head is of another size and it
 * has no surface (surface_decode()); SURFACE_ENOMEM. */
SURFACE_API enum surface_status
surface_search(struct surface_work *work, const struct surface_index *x,
               const struct surface_face *probe, const uint16_t *allowed, double floor,
               size_t most, struct surface_hit *hit, size_t *n);

#endif /* CORE_SURFACE_SEARCH_H */
