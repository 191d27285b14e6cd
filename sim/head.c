#include "head.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draw.h"
#include "facegen.h"

void *head_alloc(size_t n, size_t size)
{
    void *p = calloc(n > 0 ? n : 1, size);

    if (p == NULL) {
        (void)fputs("out of memory\n", stderr);
        exit(1);
    }
    return p;
}

void head_add(struct head *h, struct dvec3 p, enum head_part part)
{
    if (h->n == h->cap) {
        struct head more = {.cap = h->cap > 0 ? 2 * h->cap : 4096};

        more.at = head_alloc(more.cap, sizeof *more.at);
        more.part = head_alloc(more.cap, 1);
        if (h->n > 0) {
            memcpy(more.at, h->at, h->n * sizeof *more.at);
            memcpy(more.part, h->part, h->n);
        }
        free(h->at);
        free(h->part);
        h->at = more.at;
        h->part = more.part;
        h->cap = more.cap;
    }
    h->at[h->n] = p;
    h->part[h->n++] = (uint8_t)part;
}

static int by_count(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* A surface has pi r^2 mm2 within a ball about its point. */
void head_measure(struct head *h)
{
    enum { LOOKS = 301, RADIUS = 8 };
    int count[LOOKS] = {0};

    for (size_t k = 0; k < LOOKS; k++)
        for (size_t i = k * h->n / LOOKS, j = 0; j < h->n; j++) {
            const struct dvec3 d = vec_sub(h->at[j], h->at[i]);

            count[k] += vec_dot(d, d) < RADIUS * RADIUS;
        }
    qsort(count, LOOKS, sizeof *count, by_count);
    h->spacing = RADIUS * sqrt(3.14159 / count[LOOKS / 2]);
}

void head_move(struct head *h, const double t[16])
{
    for (size_t i = 0; i < h->n; i++)
        h->at[i] = vec_transform(t, h->at[i]);
}

struct head head_copy(const struct head *h)
{
    struct head c = {.n = h->n, .cap = h->n, .spacing = h->spacing};

    c.at = head_alloc(c.n, sizeof *c.at);
    c.part = head_alloc(c.n, 1);
    memcpy(c.at, h->at, c.n * sizeof *c.at);
    memcpy(c.part, h->part, c.n);
    return c;
}

void head_free(struct head *h)
{
    free(h->at);
    free(h->part);
    *h = (struct head){0};
}

/* ---- made up */

#define MADE_UP_MM 1.8

/* Within the outline of the made-up face, which is in front of the skull there. */
static bool on_face(double x, double y)
{
    const double u = x / 68, v = (y - 4) / (y > 4 ? 84 : 92);

    return u * u + v * v < 1;
}

/* Points of an upright tube whose cross-sections are ellipses about (0, z): about every
 * MADE_UP_MM; none where the face is. */
static void add_tube(struct head *h, struct draw *r, double bottom, double top,
                     void (*section)(double y, double half[2], double *z))
{
    for (double y = bottom; y < top; y += MADE_UP_MM) {
        double half[2], z;

        section(y, half, &z);
        for (double a = 0, step; a < 6.2832; a += step) {
            const double at = y + draw_uniform(r, -0.9, 0.9);
            const struct dvec3 p = {half[0] * sin(a), at, z + half[1] * cos(a)};

            step = MADE_UP_MM / fmax(hypot(half[0] * cos(a), half[1] * sin(a)), 1);
            step *= draw_uniform(r, 0.6, 1.4);
            if (p.z < z || !on_face(p.x, p.y))
                head_add(h, p, HEAD_SKIN);
        }
    }
}

static void skull_section(double y, double half[2], double *z)
{
    const double v = (y - 25) / 105, s = sqrt(fmax(1 - v * v, 0));

    half[0] = 76 * s;
    half[1] = 92 * s;
    *z = -110;
}

static void neck_section(double y, double half[2], double *z)
{
    half[0] = 58 + 0.004 * (y + 110) * (y + 110);
    half[1] = 58;
    *z = -105;
}

static void shoulder_section(double y, double half[2], double *z)
{
    const double down = fmin((-165 - y) / 90, 1), slope = down * down * (3 - 2 * down);

    half[0] = 62 + 140 * slope;
    half[1] = 58 + 45 * slope;
    *z = -110 - 35 * slope;
}

void head_make_up(uint64_t subject, struct head *out)
{
    struct draw r = draw_stream(subject, 0, 1);
    struct facegen_face face;

    *out = (struct head){.spacing = MADE_UP_MM};
    facegen_face(subject, 0, &face);
    for (double y = -90; y < 90; y += MADE_UP_MM)
        for (double x = -70; x < 70; x += MADE_UP_MM) {
            const double px = x + draw_uniform(&r, -0.8, 0.8);
            const double py = y + draw_uniform(&r, -0.8, 0.8);
            const double z = facegen_height(&face, px, py);
            const double steep =
                fmin(facegen_height(&face, px * 0.97, py) - z, 12) / MADE_UP_MM;

            if (!on_face(px, py))
                continue;
            head_add(out, (struct dvec3){px, py, z}, HEAD_SKIN);
            for (int k = 1; k < steep; k++) /* between this point and the next */
                head_add(
                    out,
                    (struct dvec3){px * (1 - 0.03 * k / steep), py, z + k * MADE_UP_MM},
                    HEAD_SKIN);
        }
    add_tube(out, &r, -80, 130, skull_section);
    add_tube(out, &r, -185, -70, neck_section);
    for (size_t i = out->n; i-- > 1;) { /* in random order, as of a scanner */
        const size_t j = draw_next(&r) % (i + 1);
        const struct dvec3 swap = out->at[i];

        out->at[i] = out->at[j];
        out->at[j] = swap;
    }
}

void head_add_shoulders(struct head *h)
{
    struct draw r = draw_stream(h->n, 0, 2);

    add_tube(h, &r, -330, -165, shoulder_section);
}
