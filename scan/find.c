#include "find.h"

#include <string.h>

#include "face.h"

enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      const struct face_work *w, struct find *out)
{
    struct dvec3 mean = {0, 0, 0};

    (void)w;
    memset(out, 0, sizeof *out);
    if (n == 0)
        return ST_ENOFACE;
    for (size_t i = 0; i < n; i++)
        mean = vec_along(mean, 1 / (double)n, pts[i]);
    out->n = out->faces = 1;
    out->pose[0] = (struct find_pose){
        .unit_mm = unit_mm != 0 ? unit_mm : 1,
        .pose = {.r = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .t = {-mean.x, -mean.y, -mean.z}}};
    return ST_OK;
}
