/* Scanner files: the first byte selects the format. */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "errinfo.h"

static void check(const struct cloudpoints *p)
{
    if (p->at == NULL || p->n > 5000 || p->n > p->read ||
        (p->index == NULL && p->n != p->read))
        abort();
    for (size_t i = 0; i < p->n; i++) {
        if (!isfinite(p->at[i].x) || !isfinite(p->at[i].y) || !isfinite(p->at[i].z))
            abort();
        if (p->index != NULL &&
            (p->index[i] >= p->read || (i > 0 && p->index[i] <= p->index[i - 1])))
            abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct cloudfile_options o = {.max_points = 5000, .max_bytes = 1 << 20};
    struct cloudpoints p;
    struct errinfo e = {0};
    char *copy;
    enum status st;

    if (size == 0 || (copy = malloc(size)) == NULL)
        return 0;
    memcpy(copy, data + 1, size - 1);
    copy[size - 1] = '\0';
    o.format = (enum cloudformat)(data[0] % CLOUDFORMAT_COUNT);
    st = cloudfile_read(copy, size - 1, &o, &p, &e);
    if (st == ST_OK)
        check(&p);
    else if (p.at != NULL || p.n != 0 || (st != ST_ENOMEM && e.msg[0] == 0))
        abort();
    cloudpoints_free(&p);
    free(copy);
    return 0;
}
