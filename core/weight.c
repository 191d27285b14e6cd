#include "weight.h"

#include "align_pose.h"
#include "lattice.h"

#define FLOOR    0.05
#define BELOW_MM 10.0 /* this far beneath the nose tip the weight has halved */
#define SIDE_MM  30.0 /* and this far to the side */

static double at(const void *arg, double x, double y)
{
    const struct weight_face *w = (const struct weight_face *)arg;
    const double side = (x - w->nose_x) * (1.0 / (SIDE_MM * LATTICE_PER_MM));
    const double down = (w->nose_y - y) * (1.0 / (BELOW_MM * LATTICE_PER_MM));
    const double s = side * side, d = down > 0.0 ? down * down : 0.0;

    return FLOOR + (1.0 - FLOOR) / ((1.0 + s * s) * (1.0 + d * d));
}

struct disparity_weight weight_of(const struct measure_surface *tmpl,
                                  struct weight_face *w)
{
    struct align_frame frame;

    align_pose_frame(tmpl, &frame);
    w->nose_x = frame.nose.x * LATTICE_PER_MM;
    w->nose_y = frame.nose.y * LATTICE_PER_MM;
    return (struct disparity_weight){at, w};
}
