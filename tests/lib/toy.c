#include "toy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lattice.h"
#include "mem.h"

static void require(bool holds)
{
    if (holds)
        return;
    (void)fputs("toy: cannot be made\n", stderr);
    abort();
}

/* 1 at (x0, y0), falling off within sx, sy. */
static double hill(double x, double y, double x0, double y0, double sx, double sy)
{
    const double u = (x - x0) / sx, v = (y - y0) / sy, w = 1 + 0.5 * (u * u + v * v);

    return 1 / (w * w);
}

double toy_height(double x, double y)
{
    const double nose = y > 0 ? 1 - y / 44 : 1 + y / 12;
    const double ridge = nose > 0 ? nose * nose * (3 - 2 * nose) : 0;

    return -22 - 0.0085 * x * x - 0.0022 * y * y + 22 * ridge * hill(x, 0, 0, 0, 9, 1) -
           8 * (hill(x, y, 30, 33, 12, 9) + hill(x, y, -30, 33, 12, 9)) +
           5 * hill(x, y, 0, -30, 18, 8) + 4 * hill(x, y, 0, -62, 14, 9);
}

/* The k-th mode of change of the model. */
static double change(uint32_t k, double x, double y)
{
    static const double at[6][5] = {{30, -20, 16, 1, 1.2}, {30, -20, 16, -1, 0.7},
                                    {0, -40, 20, 0, 1.5},  {26, 48, 14, 1, 0.6},
                                    {48, 5, 15, 1, 0.5},   {48, 5, 15, -1, 0.5}};
    const double *a = at[k];

    return a[4] * (hill(x, y, a[0], a[1], a[2], a[2]) +
                   a[3] * hill(x, y, -a[0], a[1], a[2], a[2]));
}

char *toy_text(const struct model *m, size_t *len)
{
    char *text;

    *len = model_write(m, NULL, 0);
    require((text = malloc(*len + 1)) != NULL);
    require(model_write(m, text, *len + 1) == *len);
    return text;
}

void toy_model(struct model *m)
{
    char *text;
    size_t len;

    memset(m, 0, sizeof *m);
    strcpy(m->name, "a toy");
    m->cap_mm = 1.0f;
    m->motion.n = 4;
    m->change.n = 6;
    m->shape.n = 6;
    m->decision = (struct decision){0.2, 0.01, 3, {{0.2, 0.001}, {0.3, 0.1}, {0.6, 1.0}}};
    for (uint32_t c = 0; c < GRID_N; c++) {
        const double x = grid_x(c), y = grid_y(c);
        const double u = x / 60, v = (y + 3) / 78;

        m->mean[c] = (float)NAN;
        if (u * u + v * v > 1)
            continue;
        m->mean[c] = (float)toy_height(x, y);
        m->weight[c] = (float)(0.5 + 2.5 * hill(x, y, 0, 18, 16, 22));
        m->motion.rest[c] = (float)(0.2 + 0.3 * hill(x, y, 0, -45, 40, 20));
        m->change.rest[c] = 0.15f;
        m->shape.rest[c] = (float)(0.4 + 0.2 * hill(x, y, 0, -45, 40, 20));
        for (uint32_t k = 0; k < 4; k++)
            m->motion.mode[c][k] = (float)change(k, x, y);
        for (uint32_t k = 0; k < 6; k++) {
            m->change.mode[c][k] = (float)change(k, x, y);
            m->shape.mode[c][k] = (float)(3 * change(k, x, y));
        }
    }
    text = toy_text(m, &len);
    require(model_parse(text, len, m, NULL) == ST_OK);
    free(text);
}

void toy_surface(const struct dvec3 *pts, size_t n, struct surface *out)
{
    struct ivec3 *lattice = mem_array(n, sizeof *lattice);
    struct scratch scratch = {0};

    require(lattice != NULL);
    require(lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, NULL) == ST_OK);
    require(surface_prepare(lattice, n, false, &scratch, out) == ST_OK);
    mem_free(lattice);
    scratch_free(&scratch);
}

void toy_scan(toy_heights *z, const void *arg, uint32_t n, const struct align_pose *pose,
              struct brute_rng *rng, struct surface *out)
{
    const double step = sqrt(3.14159265358979 * 55 * 70 / n);
    struct dvec3 *pts = mem_array(2 * (size_t)n + 1000, sizeof *pts);
    size_t count = 0;

    require(pts != NULL);
    for (double y = -70; y < 70; y += step)
        for (double x = -55; x < 55; x += step) {
            const double u = x + step * (0.1 + 0.8 * brute_real(rng));
            const double v = y + step * (0.1 + 0.8 * brute_real(rng));

            if (u * u / (55 * 55) + v * v / (70 * 70) >= 1)
                continue;
            pts[count] = (struct dvec3){u, v, z(arg, u, v)};
            if (pose != NULL)
                pts[count] = align_pose_apply(pose, pts[count]);
            count++;
        }
    toy_surface(pts, count, out);
    mem_free(pts);
}

void toy_pose(double yaw, double pitch, double roll, struct dvec3 shift,
              struct align_pose *p)
{
    const double half = 3.14159265358979323846 / 360;
    const struct dvec3 centre = {0, 0, -80};
    const double turn[6] = {0, 0, 2 * tan(roll * half), shift.x, shift.y, shift.z};

    *p = (struct align_pose){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    align_pose_tilt(p, centre, tan(yaw * half), tan(pitch * half));
    align_pose_move(p, centre, turn);
}
