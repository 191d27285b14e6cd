#include "sculpt.h"

#include <math.h>
#include <stdio.h>

#include "toy.h"

#define STEP_MM 5.0

static double hill(double x, double y, double x0, double y0, double size)
{
    const double u = (x - x0) / size, v = (y - y0) / size, w = 1 + (u * u + v * v) / 2;

    return 1 / (w * w);
}

/* How mode k of identity changes the height: the nose, the brows, the cheeks, the chin. */
static double identity(int k, double x, double y)
{
    static const double at[SCULPT_IDENTITIES][4] = {
        {0, 6, 12, 2.5}, {26, 46, 14, 2}, {40, -10, 20, 3}, {0, -62, 20, 3}};
    const double *a = at[k];

    return a[3] * (hill(x, y, a[0], a[1], a[2]) + hill(x, y, -a[0], a[1], a[2]));
}

static double expression(int k, double x, double y)
{
    static const double at[SCULPT_EXPRESSIONS][4] = {{28, -24, 14, 5},
                                                     {-28, -24, 14, 5},
                                                     {20, 50, 10, -3},
                                                     {-20, 50, 10, -3},
                                                     {0, -66, 22, -8}};
    const double *a = at[k];

    return a[3] * hill(x, y, a[0], a[1], a[2]);
}

struct shape {
    double unit_mm, pitch;
    int identity, expression; /* -1: none */
};

static double height(const struct shape *s, double x, double y)
{
    double z = toy_height(x, y);

    if (s->identity >= 0)
        z += identity(s->identity, x, y);
    if (s->expression >= 0)
        z += expression(s->expression, x, y);
    return z;
}

static void vertices(FILE *to, const struct shape *s, double front)
{
    const double over = 1 / sqrt(1 + s->pitch * s->pitch);

    for (int j = 0; j < SCULPT_NY; j++)
        for (int i = 0; i < SCULPT_NX; i++) {
            const double x = STEP_MM * (i - (SCULPT_NX - 1) / 2);
            const double y = STEP_MM * (j - 17), z = height(s, x, y) + front;

            (void)fprintf(to, "v %.9g %.9g %.9g\n", x / s->unit_mm,
                          (over * (y - s->pitch * z) + 31) / s->unit_mm,
                          (over * (z + s->pitch * y) - 17) / s->unit_mm);
        }
}

static int vertex(int i, int j)
{
    return j * SCULPT_NX + i + 1;
}

static void write_shape(FILE *to, const struct shape *s)
{
    const int behind = SCULPT_NX * SCULPT_NY;

    (void)fprintf(to, "# a made-up face\nmtllib none.mtl\n");
    vertices(to, s, 0);
    vertices(to, s, 3);
    (void)fprintf(to, "vt 0 0\nusemtl M_Skin\n");
    for (int j = 0; j + 1 < SCULPT_NY; j++)
        for (int i = 0; i + 1 < SCULPT_NX; i++)
            (void)fprintf(to, "f %d/1 %d/1 %d/1 %d/1\n", vertex(i, j), vertex(i + 1, j),
                          vertex(i + 1, j + 1), vertex(i, j + 1));
    (void)fprintf(to, "usemtl M_Lash\n");
    for (int i = 0; i + 1 < SCULPT_NX; i++)
        (void)fprintf(to, "f %d %d %d\n", behind + vertex(i, 25),
                      behind + vertex(i + 1, 25), behind + vertex(i, 26));
}

static bool write_file(const char *dir, const char *name, const struct shape *s)
{
    char path[512];
    FILE *to;

    (void)snprintf(path, sizeof path, "%s/%s.obj", dir, name);
    if ((to = fopen(path, "w")) == NULL)
        return false;
    write_shape(to, s);
    return fclose(to) == 0;
}

bool sculpt_write(const char *dir, double unit_mm, double pitch)
{
    static const char *const names[SCULPT_EXPRESSIONS] = {
        "mouthSmile_L", "mouthSmile_R", "browUp_L", "browUp_R", "jawOpen"};
    struct shape s = {unit_mm, pitch, -1, -1};
    bool done = write_file(dir, "neutral", &s);

    for (s.identity = 0; done && s.identity < SCULPT_IDENTITIES; s.identity++) {
        char name[32];

        (void)snprintf(name, sizeof name, "identity%02d", s.identity);
        done = write_file(dir, name, &s);
    }
    s.identity = -1;
    for (s.expression = 0; done && s.expression < SCULPT_EXPRESSIONS; s.expression++)
        done = write_file(dir, names[s.expression], &s);
    return done;
}
