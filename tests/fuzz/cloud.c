/* Scanners' files: what is read is finite and within the limits, and every failure has a
 * message.  The Makefile makes a fuzzer of each format of this file, with FUZZ_CLOUD the format;
 * CLOUDFORMAT_COUNT: the first byte selects it. */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "errinfo.h"

#define MOST 5000

static void check(const struct cloudpoints *p)
{
    if (p->at == NULL || p->n > MOST || p->n > p->read ||
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

static void fuzz(const uint8_t *data, size_t size, enum cloudformat format)
{
    const bool raw = format == CLOUDFORMAT_RAW;
    const struct cloudfile_options o = {.format = format,
                                        .max_points = MOST,
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
        return;
    memcpy(copy, data, size);
    if (cloudfile_weight(data, size, format) < size)
        abort();
    copy[size] = '\0';
    st = cloudfile_read(copy, size, &o, &p, &e);
    if (st == ST_OK)
        check(&p);
    else if (p.at != NULL || p.n != 0 || (st != ST_ENOMEM && e.msg[0] == 0))
        abort();
    cloudpoints_free(&p);
    free(copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (FUZZ_CLOUD != CLOUDFORMAT_COUNT)
        fuzz(data, size, FUZZ_CLOUD);
    else if (size > 0)
        fuzz(data + 1, size - 1, (enum cloudformat)(data[0] % CLOUDFORMAT_COUNT));
    return 0;
}
