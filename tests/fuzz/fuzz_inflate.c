/* Compressed bodies.  The first byte selects the coding; the output is within the limit. */
#include "fuzz.h"

#include <stdlib.h>

#include "errinfo.h"
#include "inflate.h"

#define LIMIT 200000

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    unsigned char *out = NULL;
    struct errinfo e = {ST_OK, ""};
    size_t n = 0;
    enum status st;

    if (size == 0)
        return 0;
    st = inflate_body(data[0] % 2 == 0 ? INFLATE_GZIP : INFLATE_ZSTD, data + 1, size - 1,
                      LIMIT, &out, &n, &e);
    if (st == ST_OK ? out == NULL || n > LIMIT || out[n] != 0
                    : out != NULL || n != 0 || e.msg[0] == 0)
        abort();
    free(out);
    return 0;
}
