#include "weight.h"

#include "align_pose.h"
#include "lattice.h"
#include "measure.h"
#include "mesh.h"
#include "predicates.h"

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

double weight_total(const struct measure_surface *tmpl, const struct disparity_weight *u)
{
    const struct mesh *m = tmpl->mesh;
    double sum = 0.0;

    for (uint32_t t = 0; t < m->nt; t++) {
        struct ivec2 a, b, c;

        if (tmpl->bridge[t])
            continue;
        a = m->xy[m->org[3 * t]];
        b = m->xy[m->org[3 * t + 1]];
        c = m->xy[m->org[3 * t + 2]];
        sum += (double)orient2d(a, b, c) * u->at(u->arg, ((double)a.x + b.x + c.x) / 3.0,
                                                 ((double)a.y + b.y + c.y) / 3.0);
    }
    return 0.5 * sum / (LATTICE_PER_MM * LATTICE_PER_MM);
}
