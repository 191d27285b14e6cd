#include "scan.h"

#include <math.h>

#include "cloudpoints.h"
#include "face.h"
#include "vec.h"

static void measure_extent(const struct cloudpoints *c, double extent[3])
{
    struct dvec3 lo = {INFINITY, INFINITY, INFINITY};
    struct dvec3 hi = {-INFINITY, -INFINITY, -INFINITY};

    for (size_t i = 0; i < c->n; i++) {
        lo = (struct dvec3){fmin(lo.x, c->at[i].x), fmin(lo.y, c->at[i].y),
                            fmin(lo.z, c->at[i].z)};
        hi = (struct dvec3){fmax(hi.x, c->at[i].x), fmax(hi.y, c->at[i].y),
                            fmax(hi.z, c->at[i].z)};
    }
    extent[0] = c->n > 0 ? hi.x - lo.x : 0;
    extent[1] = c->n > 0 ? hi.y - lo.y : 0;
    extent[2] = c->n > 0 ? hi.z - lo.z : 0;
}

static void to_mm(struct cloudpoints *c, double mm)
{
    for (size_t i = 0; mm != 1 && i < c->n; i++)
        c->at[i] = (struct dvec3){c->at[i].x * mm, c->at[i].y * mm, c->at[i].z * mm};
}

enum status scan_build(struct cloudpoints *c, const struct scan_options *o,
                       struct face_work *w, struct face *out, size_t *bad,
                       struct scan_found *found)
{
    enum status st;

    (void)o;
    *found = (struct scan_found){.format = c->format,
                                 .points_read = c->read,
                                 .points_dropped = c->read - c->n,
                                 .unit_mm = c->unit_mm != 0 ? c->unit_mm : 1,
                                 .unit_found = c->unit_mm == 0,
                                 .yaw_deg = (double)NAN,
                                 .pitch_deg = (double)NAN,
                                 .roll_deg = (double)NAN};
    measure_extent(c, found->extent);
    for (int i = 0; i < 4; i++)
        found->view[5 * i] = i < 3 ? found->unit_mm : 1;
    to_mm(c, found->unit_mm);
    if ((st = face_build(c->at, c->n, w, out, bad)) != ST_OK)
        return st;
    found->faces = 1;
    found->points_used = c->n;
    return ST_OK;
}

const char *scan_warning_name(enum scan_warning k)
{
    static const char *const name[SCAN_WARNINGS] = {
        [SCAN_SEVERAL] = "several_faces",   [SCAN_MIRRORED] = "mirrored",
        [SCAN_BEHIND] = "points_elsewhere", [SCAN_TURNED] = "turned",
        [SCAN_OCCLUDED] = "occluded",       [SCAN_THINNED] = "thinned"};

    return name[k];
}
