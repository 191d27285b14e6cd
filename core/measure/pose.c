#include "pose.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "lattice.h"
#include "mesh.h"
#include "surface.h"

/* Axes and nose are those of this many points, at most twice as many: only starts of a search
 * come from them. */
#define POSE_AXES_POINTS 1000

/* The nose: the mean of this share of the points, those that protrude most; what lies d to
 * the side protrudes d^2 / RADIUS less, so that a chin or a forehead turned forward is no
 * nose.  BINS of protrusion, each about 1 mm.  By hand. */
#define POSE_NOSE_SHARE     0.02
#define POSE_NOSE_RADIUS_MM 250.0
#define POSE_NOSE_BINS      128

static struct dvec3 vertex_mm(const struct mesh *m, uint32_t v)
{
    return lattice_to_mm(m->xy[v], m->z[v]);
}

/* turn(q, r): the rotation of the quaternion (q[0]; q[1..3]), which need not have length
 * one. */
static void pose_turn(const double q[4], double r[9])
{
    const double s = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double wx = s * q[0] * q[1], wy = s * q[0] * q[2], wz = s * q[0] * q[3];
    const double xx = s * q[1] * q[1], xy = s * q[1] * q[2], xz = s * q[1] * q[3];
    const double yy = s * q[2] * q[2], yz = s * q[2] * q[3], zz = s * q[3] * q[3];
    const double m[9] = {1.0 - yy - zz, xy - wz, xz + wy, xy + wz,      1.0 - xx - zz,
                         yz - wx,       xz - wy, yz + wx, 1.0 - xx - yy};

    memcpy(r, m, sizeof m);
}

/* orthonormal(r): remove the rounding that products of rotations pile up. */
static void orthonormal(double r[9])
{
    struct dvec3 x = {r[0], r[1], r[2]}, y = {r[3], r[4], r[5]}, z;
    const double lx = 1.0 / sqrt(vec_dot(x, x));
    double ly, xy;

    x = (struct dvec3){x.x * lx, x.y * lx, x.z * lx};
    xy = vec_dot(x, y);
    y = (struct dvec3){y.x - xy * x.x, y.y - xy * x.y, y.z - xy * x.z};
    ly = 1.0 / sqrt(vec_dot(y, y));
    y = (struct dvec3){y.x * ly, y.y * ly, y.z * ly};
    z = vec_cross(x, y);
    memcpy(r, (const double[9]){x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z},
           9 * sizeof *r);
}

/* turn_about(a, c, q, shift): follow a by the rotation q about c, then by shift. */
static void turn_about(struct pose *a, struct dvec3 c, const double q[4],
                       const double shift[3])
{
    const double from[3] = {c.x, c.y, c.z};
    double r[9], m[9], t[3];

    pose_turn(q, r);
    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++)
            m[3 * i + k] = r[3 * i] * a->r[k] + r[3 * i + 1] * a->r[3 + k] +
                           r[3 * i + 2] * a->r[6 + k];
        t[i] = r[3 * i] * (a->t[0] - c.x) + r[3 * i + 1] * (a->t[1] - c.y) +
               r[3 * i + 2] * (a->t[2] - c.z) + from[i] + shift[i];
    }
    orthonormal(m);
    memcpy(a->r, m, sizeof m);
    memcpy(a->t, t, sizeof t);
}

void pose_move(struct pose *a, struct dvec3 c, const double x[6])
{
    turn_about(a, c, (const double[4]){1.0, 0.5 * x[0], 0.5 * x[1], 0.5 * x[2]}, x + 3);
}

void pose_tilt(struct pose *a, struct dvec3 c, double yaw, double pitch)
{
    static const double still[3] = {0.0, 0.0, 0.0};

    turn_about(a, c, (const double[4]){1.0, 0.0, yaw, 0.0}, still);
    turn_about(a, c, (const double[4]){1.0, pitch, 0.0, 0.0}, still);
}

void pose_to_matrix(const struct pose *a, double m[16])
{
    for (size_t i = 0; i < 3; i++) {
        memcpy(m + 4 * i, a->r + 3 * i, 3 * sizeof *m);
        m[4 * i + 3] = a->t[i];
    }
    memcpy(m + 12, (const double[4]){0.0, 0.0, 0.0, 1.0}, 4 * sizeof *m);
}

void pose_from_matrix(const double m[16], struct pose *a)
{
    for (size_t i = 0; i < 3; i++) {
        memcpy(a->r + 3 * i, m + 4 * i, 3 * sizeof *m);
        a->t[i] = m[4 * i + 3];
    }
}

struct pose pose_after(const struct pose *a, const struct pose *b)
{
    struct pose out;

    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++)
            out.r[3 * i + k] =
                a->r[i] * b->r[k] + a->r[3 + i] * b->r[3 + k] + a->r[6 + i] * b->r[6 + k];
        out.t[i] = a->r[i] * (b->t[0] - a->t[0]) + a->r[3 + i] * (b->t[1] - a->t[1]) +
                   a->r[6 + i] * (b->t[2] - a->t[2]);
    }
    return out;
}

struct pose pose_follow(const struct pose *a, const struct pose *b)
{
    struct pose out;

    for (int i = 0; i < 3; i++) {
        out.t[i] = a->t[i];
        for (int k = 0; k < 3; k++) {
            out.t[i] += a->r[3 * i + k] * b->t[k];
            out.r[3 * i + k] = a->r[3 * i] * b->r[k] + a->r[3 * i + 1] * b->r[3 + k] +
                               a->r[3 * i + 2] * b->r[6 + k];
        }
    }
    return out;
}

struct pose pose_scale(const struct pose *a, double by)
{
    struct pose out;

    for (size_t i = 0; i < 9; i++)
        out.r[i] = by * a->r[i];
    for (size_t i = 0; i < 3; i++)
        out.t[i] = by * a->t[i];
    return out;
}

struct pose pose_unscaled(const struct pose *a)
{
    const double *r = a->r;
    const double size = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);

    return fabs(size - 1) < 1e-6 ? *a : pose_scale(a, 1 / size);
}

struct dvec3 pose_origin(const struct pose *a)
{
    const double *r = a->r, *t = a->t;

    return (struct dvec3){-(r[0] * t[0] + r[3] * t[1] + r[6] * t[2]),
                          -(r[1] * t[0] + r[4] * t[1] + r[7] * t[2]),
                          -(r[2] * t[0] + r[5] * t[1] + r[8] * t[2])};
}

bool pose_rigid(const struct pose *a)
{
    const double *r = a->r;
    const struct dvec3 x = {r[0], r[1], r[2]}, y = {r[3], r[4], r[5]};
    const struct dvec3 z = vec_cross(x, y);
    bool good = fabs(vec_dot(x, x) - 1) < 1e-6 && fabs(vec_dot(y, y) - 1) < 1e-6 &&
                fabs(vec_dot(x, y)) < 1e-6;

    good = good && fabs(z.x - r[6]) < 1e-5 && fabs(z.y - r[7]) < 1e-5 &&
           fabs(z.z - r[8]) < 1e-5;
    for (int i = 0; i < 3; i++)
        good = good && fabs(a->t[i]) < 1e5;
    return good;
}

/* rotate(a, v, p, q): one Jacobi rotation that makes a[p][q] zero; v collects the
 * eigenvectors in its columns. */
static void pose_rotate(double a[3][3], double v[3][3], size_t p, size_t q)
{
    const size_t o = 3 - p - q;
    double theta, t, c, s, h;

    if (a[p][q] == 0.0)
        return;
    theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    t = (theta < 0.0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
    c = 1.0 / sqrt(t * t + 1.0);
    s = t * c;
    a[p][p] -= t * a[p][q];
    a[q][q] += t * a[p][q];
    a[p][q] = a[q][p] = 0.0;
    h = a[o][p];
    a[o][p] = a[p][o] = c * h - s * a[o][q];
    a[o][q] = a[q][o] = s * h + c * a[o][q];
    for (size_t i = 0; i < 3; i++) {
        h = v[i][p];
        v[i][p] = c * h - s * v[i][q];
        v[i][q] = s * h + c * v[i][q];
    }
}

/* principal(a, axis): the eigenvectors of the symmetric matrix a, by falling eigenvalue.
 * Eight sweeps leave nothing off the diagonal of a 3 x 3 matrix in double precision. */
static void principal(double a[3][3], struct dvec3 axis[3])
{
    double v[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    size_t order[3] = {0, 1, 2};

    for (int sweep = 0; sweep < 8; sweep++) {
        pose_rotate(a, v, 0, 1);
        pose_rotate(a, v, 0, 2);
        pose_rotate(a, v, 1, 2);
    }
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = i + 1; k < 3; k++) {
            if (a[order[k]][order[k]] > a[order[i]][order[i]]) {
                const size_t swap = order[i];

                order[i] = order[k];
                order[k] = swap;
            }
        }
    }
    for (size_t i = 0; i < 3; i++)
        axis[i] = (struct dvec3){v[0][order[i]], v[1][order[i]], v[2][order[i]]};
}

/* protrusion(p, f): how far p sticks out along f->axis[2], less the more it lies to the
 * side: a chin or a forehead turned forward is no nose. */
static double protrusion(struct dvec3 p, const struct pose_axes *f)
{
    const struct dvec3 d = vec_sub(p, f->centre);
    const double out = vec_dot(d, f->axis[2]);

    return out - (vec_dot(d, d) - out * out) * (1.0 / POSE_NOSE_RADIUS_MM);
}

/* nose_of(m, step, f): the mean of the POSE_NOSE_SHARE of every step-th point that protrude
 * most. */
static struct dvec3 nose_of(const struct mesh *m, uint32_t step,
                            const struct pose_axes *f)
{
    double h[2 * POSE_AXES_POINTS] = {0}, lo = INFINITY, hi = -INFINITY, scale;
    uint32_t count[POSE_NOSE_BINS] = {0}, n = 0, above = 0;
    struct dvec3 sum = {0.0, 0.0, 0.0};
    int bin = POSE_NOSE_BINS;

    for (uint32_t v = 0; v < m->nv; v += step, n++) {
        h[n] = protrusion(vertex_mm(m, v), f);
        lo = h[n] < lo ? h[n] : lo;
        hi = h[n] > hi ? h[n] : hi;
    }
    scale = hi > lo ? (POSE_NOSE_BINS - 1) / (hi - lo) : 0.0;
    for (uint32_t i = 0; i < n; i++)
        count[(int)((h[i] - lo) * scale)]++;
    while (above < 1 + (uint32_t)(POSE_NOSE_SHARE * n) && bin > 0)
        above += count[--bin];
    for (uint32_t i = 0; i < n; i++) {
        const struct dvec3 p = vertex_mm(m, i * step);

        if ((int)((h[i] - lo) * scale) >= bin)
            sum = (struct dvec3){sum.x + p.x, sum.y + p.y, sum.z + p.z};
    }
    return (struct dvec3){sum.x / above, sum.y / above, sum.z / above};
}

struct dvec3 pose_centre(const struct mesh *m)
{
    int64_t x = 0, y = 0, z = 0;
    const double unit = 1.0 / (LATTICE_PER_MM * m->nv);

    for (uint32_t v = 0; v < m->nv; v++) {
        x += m->xy[v].x;
        y += m->xy[v].y;
        z += m->z[v];
    }
    return (struct dvec3){(double)x * unit, (double)y * unit, (double)z * unit};
}

void pose_find_axes(const struct surface *s, struct pose_axes *f)
{
    const struct mesh *m = &s->mesh;
    const uint32_t step = m->nv > POSE_AXES_POINTS ? m->nv / POSE_AXES_POINTS : 1;
    struct dvec3 axis[3];
    double c[3][3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};

    f->centre = pose_centre(m);
    for (uint32_t v = 0; v < m->nv; v += step) {
        const struct dvec3 d = vec_sub(vertex_mm(m, v), f->centre);

        c[0][0] += d.x * d.x;
        c[0][1] += d.x * d.y;
        c[0][2] += d.x * d.z;
        c[1][1] += d.y * d.y;
        c[1][2] += d.y * d.z;
        c[2][2] += d.z * d.z;
    }
    c[1][0] = c[0][1];
    c[2][0] = c[0][2];
    c[2][1] = c[1][2];
    principal(c, axis);
    for (size_t i = 0; i < 3; i++) {
        if ((i == 0 && axis[0].y < 0.0) || (i == 2 && axis[2].z < 0.0))
            axis[i] = (struct dvec3){-axis[i].x, -axis[i].y, -axis[i].z};
    }
    f->axis[1] = axis[0];
    f->axis[2] = axis[2];
    f->axis[0] = vec_cross(axis[0], axis[2]);
    f->nose = nose_of(m, step, f);
}
