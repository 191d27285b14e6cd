/* cloud.h -- reads an input as a scanner's file, for the fuzzers of its formats: what is read
 * is finite and within the limits, and every failure has a message. */
#ifndef TESTS_FUZZ_CLOUD_H
#define TESTS_FUZZ_CLOUD_H
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "errinfo.h"

#define CLOUD_MAX 5000

static inline void cloud_check(const struct cloudpoints *p)
{
    if (p->at == NULL || p->n > CLOUD_MAX || p->n > p->read ||
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

static inline int cloud_fuzz(const void *data, size_t size, enum cloudformat format)
{
    const bool raw = format == CLOUDFORMAT_RAW;
    const struct cloudfile_options o = {.format = format,
                                        .max_points = CLOUD_MAX,
                                        .max_bytes = 1 << 20,
                                        .camera = {.fx = 500,
                                                   .fy = 500,
                                                   .cx = 20,
                                                   .cy = 10,
                                                   .width = raw ? 4 : 0,
                                                   .height = raw ? 3 : 0}};
    struct cloudpoints p;
    struct errinfo e = {0};
    char *copy = malloc(size + 1);
    enum status st;

    if (copy == NULL)
        return 0;
    memcpy(copy, data, size);
    copy[size] = '\0';
    st = cloudfile_read(copy, size, &o, &p, &e);
    if (st == ST_OK)
        cloud_check(&p);
    else if (p.at != NULL || p.n != 0 || (st != ST_ENOMEM && e.msg[0] == 0))
        abort();
    cloudpoints_free(&p);
    free(copy);
    return 0;
}

#endif
