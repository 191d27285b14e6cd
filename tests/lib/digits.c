#include "digits.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "face.h"
#include "facegen.h"
#include "minimal.h"
#include "toy.h"

#define POINTS 3000
#define ROOM   (1 << 14)

struct text {
    char *buf;
    size_t at;
};

static void put(struct text *t, const char *what, const double *x, size_t n)
{
    t->at += (size_t)snprintf(t->buf + t->at, ROOM - t->at, "%s", what);
    for (size_t i = 0; i < n; i++)
        if (isnan(x[i])) /* printf() may print a sign */
            t->at += (size_t)snprintf(t->buf + t->at, ROOM - t->at, " none");
        else
            t->at += (size_t)snprintf(t->buf + t->at, ROOM - t->at, " %.17g", x[i]);
    t->at += (size_t)snprintf(t->buf + t->at, ROOM - t->at, "\n");
}

static void make(const struct facegen_scan *s, struct surface_work *w,
                 struct surface_face *out)
{
    static struct dvec3 pts[POINTS];

    if (face_build(pts, facegen_sample(s, pts), w, out, NULL) != ST_OK)
        abort();
}

static void compare(struct text *t, const char *what, const struct surface_face *a,
                    const struct surface_face *b, struct surface_work *w)
{
    struct surface_comparison r;
    struct surface_disparity m;
    struct surface_parts parts;

    if (surface_compare(w, a, b, &r) != SURFACE_OK ||
        surface_disparity(w, a, b, &m) != SURFACE_OK ||
        surface_parts(w, a, b, &parts) != SURFACE_OK)
        abort();
    t->at += (size_t)snprintf(t->buf + t->at, ROOM - t->at, "# %s\n", what);
    put(t, "score", &r.score, 1);
    put(t, "disparity_mm", &m.disparity_mm, 1);
    put(t, "overlap", &r.overlap, 1);
    put(t, "region", parts.region, SURFACE_REGIONS);
    put(t, "turn_deg", &m.turn_deg, 1);
    put(t, "shift_mm", &m.shift_mm, 1);
    put(t, "transform", m.align_transform, 16);
    put(t, "minimal_transform", m.transform, 16);
}

char *digits_text(size_t *size)
{
    static struct surface_model model;
    static struct surface_face face[4];
    struct surface_work *w;
    struct facegen_scan s;
    struct text t = {malloc(ROOM), 0};

    toy_model(&model);
    if ((w = surface_work_new(&model)) == NULL || t.buf == NULL)
        abort();
    for (uint64_t i = 0; i < 4; i++) {
        facegen_default(&s);
        s.subject = i < 3 ? 1 : 2;
        s.scan = i;
        s.points = i == 2 ? 1500 : POINTS;
        if (i > 0)
            facegen_pose(&s, 12, 40);
        s.holes = i == 2 ? 0.1 : 0;
        s.spikes = i == 2 ? 0.01 : 0;
        s.smile = i == 2 ? 1 : 0;
        make(&s, w, &face[i]);
    }
    put(&t, "frame", face[0].frame.pose.r, 9);
    put(&t, "at", face[0].frame.pose.t, 3);
    compare(&t, "the same person", &face[0], &face[1], w);
    compare(&t, "smiling, with holes and spikes", &face[0], &face[2], w);
    compare(&t, "somebody else", &face[0], &face[3], w);
    compare(&t, "itself", &face[0], &face[0], w);
    for (int i = 0; i < 4; i++)
        face_free(&face[i]);
    surface_work_free(w);
    *size = t.at;
    return t.buf;
}
