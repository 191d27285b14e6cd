#include "descent.h"

#include <math.h>
#include <string.h>

#define DIM DESCENT_DIM

/* r = the rotation of descent_pose(). */
static void turn_of(const double x[DIM], double r[3][3])
{
    memcpy(r, (const double[3][3]){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 9 * sizeof(double));
    for (int k = 0; k < 3; k++) { /* round axis k: rows i and j change */
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double a = x[k] / DESCENT_LEVER, c = cos(a), s = sin(a);

        for (int m = 0; m < 3; m++) {
            const double u = r[i][m], v = r[j][m];

            r[i][m] = c * u - s * v;
            r[j][m] = s * u + c * v;
        }
    }
}

void descent_pose(const double base[16], struct dvec3 c, const double x[DIM],
                  double out[16])
{
    const double centre[3] = {c.x, c.y, c.z};
    double r[3][3];

    turn_of(x, r);
    memcpy(out, (const double[16]){[15] = 1}, 16 * sizeof *out);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++)
                out[4 * i + j] += r[i][k] * (base[4 * k + j] - (j == 3 ? centre[k] : 0));
        out[4 * i + 3] += centre[i] + x[3 + i];
    }
}

void descent_between(const double base[16], struct dvec3 c, const double pose[16],
                     double x[DIM])
{
    const double from[3] = {c.x - base[3], c.y - base[7], c.z - base[11]};
    double r[3][3] = {{0}}, back[3] = {0, 0, 0};

    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            back[i] += base[4 * k + i] * from[k];
            for (int j = 0; j < 3; j++)
                r[i][j] += pose[4 * i + k] * base[4 * j + k];
        }
    x[0] = atan2(r[2][1], r[2][2]) * DESCENT_LEVER;
    x[1] = -asin(r[2][0]) * DESCENT_LEVER;
    x[2] = atan2(r[1][0], r[0][0]) * DESCENT_LEVER;
    for (int i = 0; i < 3; i++)
        x[3 + i] = pose[4 * i] * back[0] + pose[4 * i + 1] * back[1] +
                   pose[4 * i + 2] * back[2] + pose[4 * i + 3] -
                   (i == 0   ? c.x
                    : i == 1 ? c.y
                             : c.z);
}

double descent_angle(const double x[DIM])
{
    double r[3][3];

    turn_of(x, r);
    return acos(fmin(1, (r[0][0] + r[1][1] + r[2][2] - 1) / 2)) * 180 / acos(-1.0);
}

static double value(struct descent *d, const double x[DIM])
{
    d->calls++;
    return d->value(d->arg, x);
}

/* One step along each axis, either way; returns the value there, x moves. */
static double explore(struct descent *d, double x[DIM], double f, double step)
{
    for (int k = 0; k < DIM; k++) {
        const double at = x[k];

        for (int sign = 1; sign >= -1; sign -= 2) {
            double g;

            x[k] = at + sign * step;
            g = value(d, x);
            if (g < f) {
                f = g;
                break;
            }
            x[k] = at;
        }
    }
    return f;
}

double descent_pattern(struct descent *d, double x[DIM], double from, double to)
{
    double f = value(d, x);

    for (double step = from; step >= to;) {
        double was[DIM], ahead[DIM], g;

        memcpy(was, x, sizeof was);
        g = explore(d, x, f, step);
        if (!(g < f)) {
            step /= 2;
            continue;
        }
        f = g;
        for (;;) { /* as far again in the same direction, and explore there */
            for (int k = 0; k < DIM; k++)
                ahead[k] = 2 * x[k] - was[k];
            g = explore(d, ahead, value(d, ahead), step);
            if (!(g < f))
                break;
            memcpy(was, x, sizeof was);
            memcpy(x, ahead, sizeof ahead);
            f = g;
        }
    }
    return f;
}

struct simplex {
    double x[DIM + 1][DIM], f[DIM + 1];
};

/* The best vertex comes first, the worst last. */
static void sort(struct simplex *s)
{
    for (int i = 1; i <= DIM; i++)
        for (int j = i; j > 0 && s->f[j] < s->f[j - 1]; j--) {
            double x[DIM];
            const double f = s->f[j];

            memcpy(x, s->x[j], sizeof x);
            memcpy(s->x[j], s->x[j - 1], sizeof x);
            memcpy(s->x[j - 1], x, sizeof x);
            s->f[j] = s->f[j - 1];
            s->f[j - 1] = f;
        }
}

/* The worst vertex moved to `far` times its distance beyond the middle of the others. */
static double beyond(struct descent *d, const struct simplex *s, double far,
                     double out[DIM])
{
    for (int k = 0; k < DIM; k++) {
        double middle = 0;

        for (int i = 0; i < DIM; i++)
            middle += s->x[i][k] / DIM;
        out[k] = middle + far * (middle - s->x[DIM][k]);
    }
    return value(d, out);
}

static void replace(struct simplex *s, const double x[DIM], double f)
{
    memcpy(s->x[DIM], x, sizeof s->x[DIM]);
    s->f[DIM] = f;
}

static double width(const struct simplex *s)
{
    double most = 0;

    for (int i = 1; i <= DIM; i++)
        for (int k = 0; k < DIM; k++)
            most = fmax(most, fabs(s->x[i][k] - s->x[0][k]));
    return most;
}

static void shrink(struct descent *d, struct simplex *s)
{
    for (int i = 1; i <= DIM; i++) {
        for (int k = 0; k < DIM; k++)
            s->x[i][k] = (s->x[i][k] + s->x[0][k]) / 2;
        s->f[i] = value(d, s->x[i]);
    }
}

double descent_simplex(struct descent *d, double x[DIM], double step, double least,
                       unsigned most)
{
    const unsigned start = d->calls;
    struct simplex s = {.f = {0}};

    for (int i = 0; i <= DIM; i++) {
        memcpy(s.x[i], x, sizeof s.x[i]);
        if (i > 0)
            s.x[i][i - 1] += step;
        s.f[i] = value(d, s.x[i]);
    }
    for (sort(&s); width(&s) > least && d->calls - start < most; sort(&s)) {
        double at[DIM], further[DIM], f = beyond(d, &s, 1, at), g;

        if (f < s.f[0]) {
            g = beyond(d, &s, 2, further);
            replace(&s, g < f ? further : at, g < f ? g : f);
        } else if (f < s.f[DIM - 1]) {
            replace(&s, at, f);
        } else {
            g = beyond(d, &s, f < s.f[DIM] ? 0.5 : -0.5, further);
            if (g < fmin(f, s.f[DIM]))
                replace(&s, further, g);
            else
                shrink(d, &s);
        }
    }
    memcpy(x, s.x[0], sizeof s.x[0]);
    return s.f[0];
}
