/* Any points as faces: the first byte is the scale, then six bytes a point.  A face of all
 * points is compared with one that lacks every third: every number of the result is finite and
 * within its limits, and a second comparison gives the same. */
#define FUZZ_ROUNDS 200 /* slower than most */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "minimal.h"

#define MAX_POINTS 400

static double coordinate(const uint8_t *p, unsigned scale)
{
    return (double)(int16_t)(p[0] | p[1] << 8) * 0.01 * (double)(1 + scale % 4);
}

static void check_minimal(const struct surface_face *a, const struct surface_face *b,
                          struct surface_disparity *m, struct surface_work *w)
{
    require(surface_disparity(w, a, b, m) == SURFACE_OK);
    require(isfinite(m->volume_mm3) && m->volume_mm3 >= 0);
    require(isfinite(m->area_mm2) && m->area_mm2 >= 0);
    require(isfinite(m->disparity_mm) && m->disparity_mm >= 0);
    for (int i = 0; i < 16; i++)
        require(isfinite(m->align_transform[i]));
}

static void check_result(const struct surface_comparison *r)
{
    require(r->decision == SURFACE_MATCH || r->decision == SURFACE_NO_MATCH ||
            r->decision == SURFACE_INCONCLUSIVE);
    require(isfinite(r->score));
    require(r->overlap >= 0 && r->overlap <= 1);
    require(r->false_match_rate >= 0 && r->false_match_rate <= 1);
}

static void compare(const struct surface_face *a, const struct surface_face *b,
                    struct surface_work *w)
{
    struct surface_comparison first, again;
    struct surface_disparity least, same;

    memset(&first, 0, sizeof first);
    memset(&again, 0, sizeof again);
    require(surface_compare(w, a, b, &first) == SURFACE_OK);
    check_result(&first);
    check_minimal(a, b, &least, w);
    require(surface_compare(w, a, b, &again) == SURFACE_OK);
    check_minimal(a, b, &same, w);
    require(memcmp(&first.score, &again.score, sizeof(double)) == 0);
    require(memcmp(&least, &same, sizeof least) == 0);
    require(first.decision == again.decision);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct surface_work *w; /* kept: making it takes longer than all the rest */
    struct dvec3 all[MAX_POINTS], some[MAX_POINTS];
    struct surface_face a = {0}, b = {0};
    size_t n = 0, m = 0;

    require(w != NULL || (w = surface_work_new(NULL)) != NULL);
    for (size_t at = 1; n < MAX_POINTS && at + 6 <= size; at += 6, n++) {
        all[n] = (struct dvec3){coordinate(data + at, data[0]),
                                coordinate(data + at + 2, data[0]),
                                coordinate(data + at + 4, data[0])};
        if (n % 3 != 2)
            some[m++] = all[n];
    }
    if (face_build(all, n, w, &a, NULL) == ST_OK) {
        compare(&a, &a, w);
        if (face_build(some, m, w, &b, NULL) == ST_OK) {
            compare(&a, &b, w);
            compare(&b, &a, w);
        }
    }
    face_free(&a);
    face_free(&b);
    return 0;
}
