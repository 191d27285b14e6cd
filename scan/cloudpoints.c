#include "cloudpoints.h"

#include "mem.h"

void cloudpoints_free(struct cloudpoints *c)
{
    mem_free(c->at);
    mem_free(c->normal);
    mem_free(c->index);
    *c = (struct cloudpoints){0};
}
