/* Scanner files: the first byte selects the format. */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>

#include "cloudfile.h"
#include "mem.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct clouderror err = {0, 0, ""};
    struct dvec3 *points;
    enum status st;
    size_t n;

    if (size == 0)
        return 0;
    st = cloudfile_parse(data + 1, size - 1, (enum cloudfile_format)(data[0] % 4), 5000,
                         &points, &n, &err);
    if (st != ST_OK) {
        if (points != NULL || n != 0 || (st != ST_ENOMEM && err.what[0] == 0))
            abort();
        return 0;
    }
    if (points == NULL || n > 5000)
        abort();
    for (size_t i = 0; i < n; i++)
        if (!isfinite(points[i].x) || !isfinite(points[i].y) || !isfinite(points[i].z))
            abort();
    mem_free(points);
    return 0;
}
