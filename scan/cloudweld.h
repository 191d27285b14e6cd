/* cloudweld.h -- makes one point of vertices that are equal, for formats that repeat a
 * vertex in each triangle. */
#ifndef SCAN_CLOUDWELD_H
#define SCAN_CLOUDWELD_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

struct cloudlist; /* cloudlist.h */

struct cloudweld {
    struct cloudlist *list;
    /* [mask + 1] a hash table: indices of list->out.at plus 1, 0: empty */
    uint32_t *slot;
    size_t mask;
};

/* cloudweld_open(w, list, most): for at most so many vertices.  Returns ST_OK, ST_ENOMEM.
 * cloudweld_add(w, p, place): p is added to the list, unless an equal point is there; *place
 * is its number in the file (cloudlist_face()).  As cloudlist_add().  O(1) for every input:
 * in a table filled on purpose an equal point may be overlooked. */
enum status cloudweld_open(struct cloudweld *w, struct cloudlist *list, size_t most);
enum status cloudweld_add(struct cloudweld *w, struct dvec3 p, uint64_t *place);
void cloudweld_close(struct cloudweld *w);

#endif
