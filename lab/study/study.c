#include "study.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "delaunay.h"
#include "mst.h"
#include "rates.h"
#include "locate.h"
#include "select.h"
#include "vec.h"

void study_must(enum status st)
{
    if (st == ST_OK)
        return;
    fprintf(stderr, "study: %s\n", status_message(st));
    exit(1);
}

void *study_alloc(size_t n, size_t size)
{
    void *p = calloc(n > 0 ? n : 1, size);

    if (p == NULL)
        study_must(ST_ENOMEM);
    return p;
}

FILE *study_open(const struct study *study, const char *name)
{
    char path[4096];
    FILE *f;

    (void)snprintf(path, sizeof path, "%s/%s", study->dir, name);
    f = fopen(path, "w");
    if (f == NULL) {
        fprintf(stderr, "study: %s: %s\n", path, strerror(errno));
        exit(1);
    }
    return f;
}

void study_close(FILE *f)
{
    const int bad = ferror(f);

    if (fclose(f) != 0 || bad)
        study_must(ST_EIO);
}

static double quantile(const double *v, size_t n, double share)
{
    const double at = share * (double)(n - 1);
    const size_t i = (size_t)at, j = i + 1 < n ? i + 1 : i;

    return v[i] + (at - (double)i) * (v[j] - v[i]);
}

double study_real(struct study_random *r)
{
    return (double)(rates_random(&r->state) >> 11) * 0x1p-53;
}

int32_t study_int(struct study_random *r, int32_t lo, int32_t hi)
{
    const uint64_t span = (uint64_t)((int64_t)hi - lo) + 1;

    return (int32_t)(lo + (int64_t)(rates_random(&r->state) % span));
}

struct study_spread study_spread(double *v, size_t n)
{
    double sum = 0;

    select_sort(v, n);
    for (size_t i = 0; i < n; i++)
        sum += v[i];
    return (struct study_spread){sum / (double)n, quantile(v, n, 0.5),
                                 quantile(v, n, 0.05), quantile(v, n, 0.95)};
}

/* The 97.5 % point of Student's t with k degrees of freedom: the table to 10, then an
 * expansion about the normal's (Abramowitz and Stegun 26.7.5), right to 0.001. */
static double student(size_t k)
{
    static const double table[] = {12.706, 4.303, 3.182, 2.776, 2.571,
                                   2.447,  2.365, 2.306, 2.262, 2.228};
    const double z = 1.959964, d = (double)k;

    return k <= 10 ? table[k - 1]
                   : z + (z * z * z + z) / (4 * d) +
                         (5 * pow(z, 5) + 16 * pow(z, 3) + 3 * z) / (96 * d * d);
}

struct study_fit study_fit(const double *x, const double *y, size_t n)
{
    double mx = 0, my = 0, xx = 0, xy = 0, yy = 0, rest, slope;

    for (size_t i = 0; i < n; i++) {
        mx += log(x[i]) / (double)n;
        my += log(y[i]) / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        const double u = log(x[i]) - mx, v = log(y[i]) - my;

        xx += u * u;
        xy += u * v;
        yy += v * v;
    }
    slope = xy / xx;
    rest = yy - slope * xy > 0 ? yy - slope * xy : 0;
    return (struct study_fit){slope, student(n - 2) * sqrt(rest / (double)(n - 2) / xx)};
}

double study_function(unsigned f, double x, double y)
{
    const double r2 = vec_square(x - 0.5) + vec_square(y - 0.5);

    switch (f) {
    case 0:
        return 0.75 * exp(-(vec_square(9 * x - 2) + vec_square(9 * y - 2)) / 4) +
               0.75 * exp(-(vec_square(9 * x + 1) + 9 * y + 1) / 49) +
               0.5 * exp(-(vec_square(9 * x - 7) + vec_square(9 * y - 3)) / 4) -
               0.2 * exp(-(vec_square(9 * x - 4) + vec_square(9 * y - 7)));
    case 1:
        return (tanh(9 * y - 9 * x) + 1) / 9;
    case 2:
        return (1.25 + cos(4.5 * y)) / (6 + 6 * vec_square(3 * x - 1));
    case 3:
        return exp(-81.0 / 16 * r2) / 3;
    case 4:
        return exp(-81.0 / 4 * r2) / 3;
    default:
        return sqrt(64 - 81 * r2) / 9 - 0.5;
    }
}

const char *study_function_name(unsigned f)
{
    static const char *const name[STUDY_FUNCTIONS] = {
        "F1 exponential", "F2 cliff", "F3 saddle", "F4 gentle", "F5 steep", "F6 sphere"};

    return name[f];
}

struct ivec3 study_lattice(unsigned f, double x, double y)
{
    return (struct ivec3){(int32_t)lround(x * STUDY_UNIT),
                          (int32_t)lround(y * STUDY_UNIT),
                          (int32_t)lround(study_function(f, x, y) * STUDY_UNIT)};
}

enum status study_triangulate(struct study_surface *s, const struct ivec3 *pts, size_t n)
{
    const enum status st = surface_prepare(pts, n, false, &s->scratch, &s->surface);

    if (st == ST_EDEGENERATE)
        return st;
    study_must(st);
    s->last.he = s->surface.mesh.out[0];
    while (mesh_is_ghost(&s->surface.mesh, s->last.he / 3))
        s->last.he = mesh_turn(&s->surface.mesh, s->last.he);
    return ST_OK;
}

void study_surface_free(struct study_surface *s)
{
    surface_free(&s->surface);
    scratch_free(&s->scratch);
}

/* The height at the point of the hull that is nearest to q, which is outside. */
static double beyond_hull(const struct mesh *m, struct ivec2 q)
{
    const uint32_t first = m->out[m->nv];
    double nearest = INFINITY, height = 0;
    uint32_t h = first;

    do { /* the edge of the hull across each ghost triangle */
        const uint32_t a = mesh_dest(m, h), b = m->org[mesh_prev(h)];
        const double dx = (double)m->xy[b].x - m->xy[a].x;
        const double dy = (double)m->xy[b].y - m->xy[a].y;
        const double qx = (double)q.x - m->xy[a].x, qy = (double)q.y - m->xy[a].y;
        const double s = fmin(fmax((dx * qx + dy * qy) / (dx * dx + dy * dy), 0), 1);
        const double off = hypot(qx - s * dx, qy - s * dy);

        if (off < nearest) {
            nearest = off;
            height = m->z[a] + s * ((double)m->z[b] - m->z[a]);
        }
        h = mesh_turn(m, h);
    } while (h != first);
    return height;
}

double study_height(struct study_surface *s, struct ivec2 q, bool *inside)
{
    /* Every walk starts at a corner of the triangle where the last one ended. */
    const struct ivec2 from = s->surface.mesh.xy[s->surface.mesh.org[s->last.he]];

    s->last = locate_point(&s->surface.mesh, s->last.he, from, q, NULL);
    *inside = s->last.where != LOCATE_OUTSIDE;
    return *inside ? locate_height(&s->surface.mesh, s->last, q)
                   : beyond_hull(&s->surface.mesh, q);
}

void study_edges(const struct mesh *m, double per, const char *tag, FILE *f)
{
    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t u = m->org[h], v = mesh_dest(m, h);

        if (u < v && v < m->nv)
            fprintf(f, "%s,%g,%g,%g,%g\n", tag, m->xy[u].x / per, m->xy[u].y / per,
                    m->xy[v].x / per, m->xy[v].y / per);
    }
}

/* How bright a triangle is, 0 to 1, in light from the upper left and above. */
static double brightness(const struct dvec3 p[3])
{
    const struct dvec3 n = vec_cross(vec_sub(p[1], p[0]), vec_sub(p[2], p[0]));
    const double facing = (-0.35 * n.x + 0.45 * n.y + 0.82 * n.z) / sqrt(vec_dot(n, n));

    return 0.35 + 0.63 * fmax(facing, 0);
}

void study_triangles(const struct study *study, const char *name, const struct mesh *m,
                     double per)
{
    static const int corner[4] = {0, 1, 2, 2};
    FILE *f = study_open(study, name);

    for (uint32_t t = 0; t < m->nt; t++) {
        struct dvec3 p[3];

        if (mesh_is_ghost(m, t))
            continue;
        for (uint32_t i = 0; i < 3; i++) {
            const uint32_t v = m->org[3 * t + i];

            p[i] = (struct dvec3){m->xy[v].x / per, m->xy[v].y / per, m->z[v] / per};
        }
        for (int i = 0; i < 4; i++)
            fprintf(f, "%g %g %g %.3f\n%s", p[corner[i]].x, p[corner[i]].y,
                    p[corner[i]].z, brightness(p),
                    i == 1   ? "\n"
                    : i == 3 ? "\n\n"
                             : "");
    }
    study_close(f);
}
