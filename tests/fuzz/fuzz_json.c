/* Clouds as JSON.  The first byte selects whether one cloud is read or two. */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "parse.h"
#include "mem.h"

#define LIMIT 2000

static void check(const struct parse_cloud *c, enum status st)
{
    if (st != ST_OK) {
        if (c->pts != NULL || c->n != 0)
            abort();
        return;
    }
    if (c->n > LIMIT || !(c->mm > 0))
        abort();
    for (size_t i = 0; i < c->n; i++)
        if (!isfinite(c->pts[i].x) || !isfinite(c->pts[i].y) || !isfinite(c->pts[i].z))
            abort();
    mem_free(c->pts);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct parse_cloud a = {0}, b = {0};
    struct errinfo e = {ST_OK, ""};
    enum status st;
    char *text;

    if (size == 0)
        return 0;
    if ((text = malloc(size)) == NULL)
        abort();
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    if (data[0] % 2 == 0) {
        st = parse_cloud(text, size - 1, LIMIT, &a, &e);
        check(&a, st);
    } else {
        st = parse_clouds(text, size - 1, LIMIT, &a, &b, &e);
        check(&a, st);
        check(&b, st);
    }
    if (st != ST_OK && e.msg[0] == 0)
        abort();
    free(text);
    return 0;
}
