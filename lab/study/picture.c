#include "picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "study.h"

void picture_begin(struct picture *r)
{
    const size_t n = (size_t)r->wide * (size_t)r->high;

    r->rgb = study_alloc(n, 3);
    r->depth = study_alloc(n, sizeof *r->depth);
    memset(r->rgb, 255, 3 * n);
    for (size_t i = 0; i < n; i++)
        r->depth[i] = -INFINITY;
}

/* To the eye's coordinates: pixels across and up, and towards it. */
static struct dvec3 seen(const struct picture *r, double x, double y, double z)
{
    const double cx = x - r->x, cy = y - r->y, cz = z - r->z;
    const double ax = cos(r->turn) * cx + sin(r->turn) * cz;
    const double az = cos(r->turn) * cz - sin(r->turn) * cx;
    const double ay = cos(r->tilt) * cy + sin(r->tilt) * az;

    return (struct dvec3){r->wide / 2.0 + r->per * ax, r->high / 2.0 + r->per * ay,
                          r->per * (cos(r->tilt) * az - sin(r->tilt) * cy)};
}

static void fill(struct picture *r, const struct dvec3 p[3], unsigned colour)
{
    const double ux = p[1].x - p[0].x, uy = p[1].y - p[0].y, uz = p[1].z - p[0].z;
    const double vx = p[2].x - p[0].x, vy = p[2].y - p[0].y, vz = p[2].z - p[0].z;
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const double size = sqrt(nx * nx + ny * ny + nz * nz);
    /* Light from above the eye's left; what is seen from behind is lit as well, darker. */
    const double facing = (-0.35 * nx + 0.45 * ny + 0.82 * nz) / size;
    const double light = 0.22 + 0.78 * (facing > 0 ? facing : -0.4 * facing);
    const double lo_x = fmin(p[0].x, fmin(p[1].x, p[2].x));
    const double hi_x = fmax(p[0].x, fmax(p[1].x, p[2].x));
    const double lo_y = fmin(p[0].y, fmin(p[1].y, p[2].y));
    const double hi_y = fmax(p[0].y, fmax(p[1].y, p[2].y));

    if (fabs(nz) < 1e-12)
        return;
    for (int y = (int)fmax(lo_y, 0); y <= (int)hi_y && y < r->high; y++)
        for (int x = (int)fmax(lo_x, 0); x <= (int)hi_x && x < r->wide; x++) {
            const double dx = x + 0.5 - p[0].x, dy = y + 0.5 - p[0].y;
            const double b = (dx * vy - dy * vx) / nz, c = (ux * dy - uy * dx) / nz;
            const size_t i = (size_t)y * (size_t)r->wide + (size_t)x;
            const float z = (float)(p[0].z + b * uz + c * vz);

            if (b < 0 || c < 0 || b + c > 1 || z <= r->depth[i])
                continue;
            r->depth[i] = z;
            for (int k = 0; k < 3; k++)
                r->rgb[3 * i + (size_t)k] =
                    (unsigned char)(light * (colour >> (16 - 8 * k) & 255));
        }
}

void picture_mesh(struct picture *r, const struct mesh *m, const uint8_t *bridge,
                  double unit, double up, double lift, unsigned colour)
{
    for (uint32_t t = 0; t < m->nt; t++) {
        struct dvec3 p[3];

        if (mesh_is_ghost(m, t) || (bridge != NULL && bridge[t] != 0))
            continue;
        for (int i = 0; i < 3; i++) {
            const uint32_t v = m->org[3 * t + (uint32_t)i];

            p[i] =
                seen(r, m->xy[v].x / unit, m->xy[v].y / unit, m->z[v] / unit * up + lift);
        }
        fill(r, p, colour);
    }
}

void picture_end(struct picture *r, FILE *f)
{
    for (int y = 0; y < r->high; y++)
        for (int x = 0; x < r->wide; x++) {
            const unsigned char *c =
                &r->rgb[3 * ((size_t)y * (size_t)r->wide + (size_t)x)];

            fprintf(f, "%.4g %.4g %d %d %d\n", (x + 0.5 - r->wide / 2.0) / r->per,
                    (y + 0.5 - r->high / 2.0) / r->per, c[0], c[1], c[2]);
        }
    free(r->rgb);
    free(r->depth);
}
