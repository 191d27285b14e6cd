#include "cloudpoints.h"

#include <string.h>

#include "mem.h"

void cloudpoints_free(struct cloudpoints *c)
{
    mem_free(c->at);
    mem_free(c->normal);
    mem_free(c->index);
    *c = (struct cloudpoints){0};
}

/* NULL for NULL, or without memory. */
static void *copy(const void *from, size_t n, size_t size)
{
    void *to = from != NULL ? mem_array(n, size) : NULL;

    if (to != NULL)
        memcpy(to, from, n * size);
    return to;
}

enum status cloudpoints_copy(const struct cloudpoints *c, struct cloudpoints *out)
{
    *out = *c;
    out->at = copy(c->at, c->n, sizeof *c->at);
    out->normal = copy(c->normal, c->n, sizeof *c->normal);
    out->index = copy(c->index, c->n, sizeof *c->index);
    if ((out->at == NULL) == (c->at == NULL) &&
        (out->normal == NULL) == (c->normal == NULL) &&
        (out->index == NULL) == (c->index == NULL))
        return ST_OK;
    cloudpoints_free(out);
    return ST_ENOMEM;
}
