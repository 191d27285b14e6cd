/* Any points as a cloud to find a face in: the first byte is the scale, the second how often
 * the points are repeated, shifted; then six bytes a point.  What is found is finite and of
 * the points' unit, and the same the second time. */
#define FUZZ_ROUNDS 100 /* slower than most */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "find.h"

#define MAX_POINTS 1000
#define MAX_COPIES 8

static double coordinate(const uint8_t *p, unsigned scale)
{
    static const double of[4] = {0.01, 0.1, 1e-4, 1e3};

    return (double)(int16_t)(p[0] | p[1] << 8) * of[scale % 4];
}

static void check(const struct find_result *f)
{
    require(f->n >= 1 && f->n <= FIND_POSES && f->faces >= 1);
    for (uint32_t i = 0; i < f->n; i++) {
        const struct find_pose *p = &f->pose[i];

        require(isfinite(p->worth) && p->unit_mm == f->pose[0].unit_mm);
        for (int k = 0; k < 9; k++)
            require(isfinite(p->pose.r[k]));
        for (int k = 0; k < 3; k++)
            require(isfinite(p->pose.t[k]));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct surface_work *w; /* kept: making it takes longer than all the rest */
    static struct dvec3 pts[MAX_POINTS * MAX_COPIES];
    struct find_result first, again;
    size_t n = 0, one;
    enum status st;

    require(w != NULL || (w = surface_work_new(NULL)) != NULL);
    if (size < 2)
        return 0;
    for (size_t at = 2; n < MAX_POINTS && at + 6 <= size; at += 6, n++)
        pts[n] = (struct dvec3){coordinate(data + at, data[0]),
                                coordinate(data + at + 2, data[0]),
                                coordinate(data + at + 4, data[0])};
    one = n;
    for (unsigned k = 1; k < data[1] % MAX_COPIES; k++)
        for (size_t i = 0; i < one; i++, n++)
            pts[n] = (struct dvec3){pts[i].x + 3 * k, pts[i].y + k, pts[i].z + k % 3};
    st = find_face(pts, n, data[0] & 4 ? 1 : 0, w, NULL, &first);
    require(st == ST_OK || st == ST_ENOFACE);
    if (st == ST_OK)
        check(&first);
    require(find_face(pts, n, data[0] & 4 ? 1 : 0, w, NULL, &again) == st);
    require(memcmp(&first, &again, sizeof first) == 0);
    return 0;
}
