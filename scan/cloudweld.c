#include "cloudweld.h"

#include <string.h>

#include "cloudlist.h"
#include "errinfo.h"
#include "mem.h"

#define PROBES 32 /* the table is at most half full, and chains in it are short */

enum status cloudweld_open(struct cloudweld *w, struct cloudlist *list, size_t most)
{
    size_t n = 1024;

    /* Of a closed mesh a vertex is in six triangles, of a mesh with a border in fewer. */
    while (n < most && n < 2 * list->max)
        n *= 2;
    *w = (struct cloudweld){.list = list, .mask = n - 1};
    if ((w->slot = mem_array(n, sizeof *w->slot)) == NULL)
        return errinfo_set(list->e, ST_ENOMEM, "no memory for the vertices");
    memset(w->slot, 0, n * sizeof *w->slot);
    return ST_OK;
}

void cloudweld_close(struct cloudweld *w)
{
    mem_free(w->slot);
    w->slot = NULL;
}

static uint64_t mix(uint64_t h, double v)
{
    uint64_t bits;

    v += 0.0; /* one zero */
    memcpy(&bits, &v, sizeof bits);
    bits ^= bits >> 32; /* of a float's value the lower bits are all zero */
    h = (h ^ bits) * UINT64_C(0xBF58476D1CE4E5B9); /* of splitmix64 */
    return h ^ (h >> 32);
}

enum status cloudweld_add(struct cloudweld *w, struct dvec3 p, uint64_t *place)
{
    const struct cloudpoints *out = &w->list->out;
    const uint64_t h = mix(mix(mix(0, p.x), p.y), p.z);
    uint32_t *slot = NULL;
    enum status st;

    for (size_t i = 0; i < PROBES; i++) {
        slot = &w->slot[(h + i) & w->mask];
        if (*slot == 0)
            break;
        if (out->at[*slot - 1].x == p.x && out->at[*slot - 1].y == p.y &&
            out->at[*slot - 1].z == p.z) {
            *place = out->index != NULL ? out->index[*slot - 1] : *slot - 1;
            return ST_OK;
        }
    }
    if ((st = cloudlist_add(w->list, p)) != ST_OK)
        return st;
    *place = out->read - 1;
    if (*slot == 0 && w->list->kept)
        *slot = (uint32_t)out->n;
    return ST_OK;
}
