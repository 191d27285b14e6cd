#include "solid.h"

#include <math.h>
#include <string.h>

static double length3(double x, double y, double z)
{
    return sqrt(x * x + y * y + z * z);
}

/* Near the surface about the distance; of any point the right sign. */
static double ball(const double *a, struct dvec3 p)
{
    const double x = p.x / a[0], y = p.y / a[1], z = p.z / a[2];
    const double slope = length3(x / a[0], y / a[1], z / a[2]), k = length3(x, y, z);

    return slope > 0 ? k * (k - 1) / slope : -fmin(a[0], fmin(a[1], a[2]));
}

static double box(const double *a, struct dvec3 p)
{
    const double x = fabs(p.x) - a[0], y = fabs(p.y) - a[1], z = fabs(p.z) - a[2];

    return length3(fmax(x, 0), fmax(y, 0), fmax(z, 0)) + fmin(fmax(x, fmax(y, z)), 0);
}

static double cone(const double *a, struct dvec3 p)
{
    const double q = hypot(p.x, p.z), slant = a[2] - a[0], high = 2 * a[1];
    const double end = p.y < 0 ? a[0] : a[2];
    const double ax = q - fmin(q, end), ay = fabs(p.y) - a[1];
    const double t =
        ((a[2] - q) * slant + (a[1] - p.y) * high) / (slant * slant + high * high);
    const double k = fmin(fmax(t, 0), 1);
    const double bx = q - a[2] + slant * k, by = p.y - a[1] + high * k;
    const double d = sqrt(fmin(ax * ax + ay * ay, bx * bx + by * by));

    return bx < 0 && ay < 0 ? -d : d;
}

static double part_distance(const struct solid_part *s, struct dvec3 p)
{
    const struct dvec3 d = vec_sub(p, s->at);
    const double *t = s->turn;
    const struct dvec3 q = {t[0] * d.x + t[3] * d.y + t[6] * d.z,
                            t[1] * d.x + t[4] * d.y + t[7] * d.z,
                            t[2] * d.x + t[5] * d.y + t[8] * d.z};

    switch (s->form) {
    case SOLID_BALL:
        return ball(s->size, q);
    case SOLID_BOX:
        return box(s->size, q);
    case SOLID_CONE:
        return cone(s->size, q);
    default:
        return hypot(hypot(q.x, q.z) - s->size[0], q.y) - s->size[1];
    }
}

/* The lesser of the two, rounded off where they differ by less than k. */
static double blend(double a, double b, double k)
{
    const double h = k - fabs(a - b);

    return fmin(a, b) - (h > 0 ? h * h / (4 * k) : 0);
}

static double distance(const struct solid *s, struct dvec3 p)
{
    double d = 1e3;

    for (uint32_t i = 0; i < s->n; i++) {
        const double e = part_distance(&s->part[i], p);

        d = s->part[i].carved ? -blend(-d, e, s->part[i].blend)
                              : blend(d, e, s->part[i].blend);
    }
    for (uint32_t i = 0; i < s->waves && d < 30; i++)
        d -= s->wave[i].h * cos(s->wave[i].k[0] * p.x + s->wave[i].k[1] * p.y +
                                s->wave[i].k[2] * p.z + s->wave[i].phase);
    return d;
}

struct solid_part *solid_add(struct solid *s, enum solid_form form, double x, double y,
                             double z, double a, double b, double c, double blend_mm)
{
    struct solid_part *p = &s->part[s->n++];

    *p = (struct solid_part){.form = form,
                             .at = {x, y, z},
                             .size = {a, b, c},
                             .turn = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                             .blend = fmax(blend_mm, 0.1)};
    return p;
}

void solid_turn(double yaw, double pitch, double roll, double out[9])
{
    const double y = yaw / VEC_DEGREES, x = pitch / VEC_DEGREES, z = roll / VEC_DEGREES;
    const double cy = cos(y), sy = sin(y), cx = cos(x), sx = sin(x);
    const double m[3][3] = {
        {cy, 0, sy}, {sx * sy, cx, -sx * cy}, {-cx * sy, sx, cx * cy}};

    for (int i = 0; i < 3; i++) {
        out[i] = cos(z) * m[0][i] - sin(z) * m[1][i];
        out[3 + i] = sin(z) * m[0][i] + cos(z) * m[1][i];
        out[6 + i] = m[2][i];
    }
}

void solid_roughen(struct solid *s, int n, double low, double high, double slope,
                   struct draw *r)
{
    for (int i = 0; i < n; i++) {
        const double mm = low * pow(high / low, draw_uniform(r, 0, 1));
        double k[3], sum = 0;

        for (int a = 0; a < 3; a++) {
            k[a] = draw_normal(r);
            sum += k[a] * k[a];
        }
        for (int a = 0; a < 3; a++)
            s->wave[s->waves].k[a] = k[a] / sqrt(sum) * 6.283185307179586 / mm;
        s->wave[s->waves].phase = draw_uniform(r, 0, 6.283185307179586);
        s->wave[s->waves++].h = slope * mm * draw_uniform(r, 0.5, 1);
    }
}

size_t solid_scan(const struct solid *s, const struct solid_view *v, struct draw *r,
                  struct dvec3 *out)
{
    const double far = 3 * v->wide, *t = v->turn;
    const struct dvec3 to = {t[6], t[7], t[8]}; /* the scanner, in the solid's axes */
    size_t n = 0;

    for (uint64_t tries = 0; n < v->points && tries < 12 * (uint64_t)v->points; tries++) {
        const double x = draw_uniform(r, -v->wide, v->wide);
        const double y = draw_uniform(r, -v->wide, v->wide);
        const struct dvec3 from = {t[0] * x + t[3] * y, t[1] * x + t[4] * y,
                                   t[2] * x + t[5] * y};
        double z = far, d = 1, slope;

        for (int i = 0; i < 160 && z > -far && fabs(d) > 0.02; i++) {
            d = distance(s, vec_along(from, z, to));
            z -= fmin(0.7 * d, 40);
        }
        if (fabs(d) > 0.2)
            continue;
        /* As seen from the scanner; what is steeper than 75 degrees it does not see. */
        slope = (distance(s, vec_along(from, z + 0.5, to)) -
                 distance(s, vec_along(from, z - 0.5, to)));
        if (slope < 0.25)
            continue;
        z += v->noise * draw_normal(r) * (1 + (1 - fmin(slope, 1)) * 2);
        out[n++] = (struct dvec3){x, y, z};
    }
    return n;
}
