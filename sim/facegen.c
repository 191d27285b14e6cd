#include "facegen.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "draw.h"
#include "vec.h"

enum purpose {
    P_SHAPE = 1,
    P_OWN,
    P_POSE,
    P_OUTLINE,
    P_SAMPLE,
    P_NOISE,
    P_WARP,
    P_HOLES,
    P_SPIKES
};

/* ---- the face */

static void facegen_add(struct facegen_face *f, double x, double y, double sx, double sy,
                        double h)
{
    f->bump[f->nbumps++] = (struct facegen_bump){x, y, sx, sy, h};
}

/* The same on both sides of the face. */
static void add_pair(struct facegen_face *f, double x, double y, double sx, double sy,
                     double h)
{
    facegen_add(f, x, y, sx, sy, h);
    facegen_add(f, -x, y, sx, sy, h);
}

/* What people have in common, each measure with its spread; p: standard normal numbers. */
static void add_features(struct facegen_face *f, const double p[FACEGEN_PARAMS],
                         double smile)
{
    const double eye_x = 31 + 2.2 * p[9], eye_y = 33 + 2.2 * p[10];
    const double mouth_y = -26 + 2.2 * p[11], mouth = 17 + 1.6 * p[12] + 3.5 * smile;
    const double lips = 3 + 1.2 * p[13] - 1.8 * smile, chin_y = -69 + 2.5 * p[14];

    add_pair(f, f->side, -2.2, 3.9 + 0.4 * p[8], 5.8, 3.6 + p[8]); /* wings of the nose */
    add_pair(f, eye_x - 8, eye_y + 6, 14.7, 12, -15.2 - 2.4 * p[15]); /* orbits */
    add_pair(f, eye_x + 1, eye_y - 2.3, 9.4, 9.1, 11 + 0.8 * p[16]);  /* eyeballs, lids */
    add_pair(f, 29, eye_y + 14, 27.2, 9.3, 10 + 1.5 * p[17]);         /* brow */
    facegen_add(f, 0, eye_y + 17, 8.6, 11, -4 + 1.2 * p[17]); /* between the brows */
    add_pair(f, 50 + 1.5 * p[18], 7 + 2 * p[18], 25.6, 12.5,
             7 + 1.6 * p[19] + 1.2 * smile);            /* cheekbones */
    add_pair(f, 44, -25, 13.5, 27.9, -1.3 + 2 * p[20]); /* cheeks */
    add_pair(f, 33, -8, 11, 9, 3.2 * smile);            /* and their apples */
    add_pair(f, mouth + 7, -23, 6.8, 19.2, -4.2 - 0.4 * p[20] - 2 * smile); /* folds */
    facegen_add(f, 0, mouth_y + 5, mouth * 0.8, 3.6, lips + 1.3);           /* lips */
    facegen_add(f, 0, mouth_y - 5, mouth * 1.04, 4.2, lips + 1.5 + 0.6 * p[21]);
    facegen_add(f, 0, mouth_y, mouth - 1, 2.4, 2.8);
    add_pair(f, mouth + 8, mouth_y - 1 + 3 * smile, 6.4, 6.4,
             2.7 - 2.2 * smile);                           /* corners */
    facegen_add(f, 0, mouth_y + 14.4, 4.2, 4, 4.8);        /* philtrum */
    facegen_add(f, 0, chin_y + 14, 18.5, 8, -2.4 - p[22]); /* below the lips */
    facegen_add(f, 0, chin_y, 20.8 + 1.5 * p[22], 16, 12.7 + 1.8 * p[23]); /* chin */
    facegen_add(f, 0, 68, 51, 17, f->forehead);
    add_pair(f, 31, 19.5, 16, 16.5, -10); /* beside the nose */
    facegen_add(f, 0, -17, 35, 9, 5);     /* the jaws stand forward */
    facegen_add(f, 0, -42, 21, 10, 9.7);
}

void facegen_face(uint64_t subject, double smile, struct facegen_face *out)
{
    struct draw shape = draw_stream(subject, 0, P_SHAPE),
                own = draw_stream(subject, 0, P_OWN);
    double p[FACEGEN_PARAMS];

    memset(out, 0, sizeof *out);
    for (int i = 0; i < FACEGEN_PARAMS; i++)
        p[i] = draw_normal(&shape);
    out->width = 69 + 2.5 * p[0];
    out->depth = 45 + 3 * p[1];
    out->jaw = 0.12 + 0.03 * p[2];
    out->forehead = 8.2 + 1.6 * p[3];
    out->nose = 23.2 + 2.4 * p[4];
    out->bridge = 0.2 + 1.8 * p[5];
    out->hump = 1.5 + 1.4 * p[6];
    out->length = 46 + 3 * p[7];
    out->nose_width = 7 + 0.9 * p[8];
    out->side = 12.5 + 1.2 * p[8];
    add_features(out, p, smile);
    while (out->nbumps < FACEGEN_BUMPS - 20) {
        const double x = draw_uniform(&own, -60, 60), y = draw_uniform(&own, -75, 80);
        const double s = draw_uniform(&own, 9, 22);

        facegen_add(out, x, y, s, s, 1.2 * draw_normal(&own));
    }
    while (out->nbumps < FACEGEN_BUMPS - 8) { /* no two noses are alike */
        const double x = draw_uniform(&own, -16, 16), y = draw_uniform(&own, -2, 48);
        const double s = draw_uniform(&own, 5, 9);

        facegen_add(out, x, y, s, s, 2.1 * draw_normal(&own));
    }
}

static double skull(const struct facegen_face *f, double x, double y)
{
    const double below = y < -20 ? -20 - y : 0; /* the jaw is narrower */
    const double w = f->width - f->jaw * vec_square(below) / 20;
    const double u = fabs(x) / (w > 30 ? w : 30), v = fabs(y - 8.4) / 93.4;

    return -22.5 - f->depth * pow(u, 2.76) - 16.4 * pow(v, 2.2);
}

static double nose(const struct facegen_face *f, double x, double y)
{
    const double soft = sqrt(y * y + 9) - 3; /* round the tip */
    const double u = y > 0 ? soft / f->length : 0;
    const double width = f->nose_width * (1.35 - 0.45 * (u < 1 ? u : 1));
    double h;

    if (y <= 0)
        h = f->nose * exp(-vec_square(y / 7) / 2);
    else if (u < 1)
        h = f->nose + (f->bridge - f->nose) * u +
            f->hump * exp(-vec_square((u - 0.55) / 0.2));
    else
        h = f->bridge * exp(-vec_square((u - 1) / 0.3)) +
            f->hump * exp(-vec_square(0.45 / 0.2));
    return h * exp(-vec_square(x / width) / 2);
}

static double drawn(const struct facegen_face *f, double x, double y)
{
    double z = skull(f, x, y) + nose(f, x, y);

    for (uint32_t i = 0; i < f->nbumps; i++) {
        const struct facegen_bump *b = &f->bump[i];
        double e;

        if (fabs(x - b->x) > 6.5 * b->sx || fabs(y - b->y) > 6.5 * b->sy)
            continue; /* as below, but without dividing */
        e = vec_square((x - b->x) / b->sx) + vec_square((y - b->y) / b->sy);
        if (e < 40)
            z += b->h * exp(-e / 2);
    }
    return z;
}

double facegen_height(const struct facegen_face *f, double x, double y)
{
    const double z = drawn(f, x, y);

    return f->symmetry == 0 ? z : z + f->symmetry / 2 * (drawn(f, -x, y) - z);
}

/* ---- the scan */

/* The face's height on a grid, for what needs it often: slopes and what hides what.  Worked
 * out where it is asked for, which is about half of it. */
#define GRID_STEP 1.5
#define GRID_NX   112
#define GRID_NY   136

struct grid {
    const struct facegen_face *face;
    double z[GRID_NY][GRID_NX]; /* NAN: not yet */
};

static void grid_make(const struct facegen_face *f, struct grid *g)
{
    g->face = f;
    for (int j = 0; j < GRID_NY; j++)
        for (int i = 0; i < GRID_NX; i++)
            g->z[j][i] = (double)NAN;
}

static double grid_at(struct grid *g, int i, int j)
{
    double *z = &g->z[j][i];

    if (isnan(*z))
        *z = facegen_height(g->face, (i - GRID_NX / 2) * GRID_STEP,
                            (j - GRID_NY / 2) * GRID_STEP);
    return *z;
}

/* Bilinear; far below the face outside the grid. */
static double grid_height(struct grid *g, double x, double y, double slope[2])
{
    const double u = x / GRID_STEP + GRID_NX / 2, v = y / GRID_STEP + GRID_NY / 2;
    double z[2][2], a, b, s, t;
    int i, j;

    if (!(u >= 0 && v >= 0 && u < GRID_NX - 1 && v < GRID_NY - 1))
        return -1e3;
    i = (int)u;
    j = (int)v;
    s = u - i;
    t = v - j;
    for (int k = 0; k < 4; k++)
        z[k / 2][k % 2] = grid_at(g, i + k % 2, j + k / 2);
    a = z[0][0] + s * (z[0][1] - z[0][0]);
    b = z[1][0] + s * (z[1][1] - z[1][0]);
    if (slope != NULL) {
        slope[0] = ((1 - t) * (z[0][1] - z[0][0]) + t * (z[1][1] - z[1][0])) / GRID_STEP;
        slope[1] = (b - a) / GRID_STEP;
    }
    return a + t * (b - a);
}

struct pose {
    double r[9]; /* facegen_turn() */
    double t[3];
};

#define PIVOT (-80.0) /* z of the centre of rotation */

void facegen_turn(const struct facegen_scan *s, double r[9])
{
    const double rad = acos(-1.0) / 180;
    const double cy = cos(s->yaw * rad), sy = sin(s->yaw * rad);
    const double cx = cos(s->pitch * rad), sx = sin(s->pitch * rad);
    const double cz = cos(s->roll * rad), sz = sin(s->roll * rad);
    const double xy[3][3] = {
        {cy, 0, sy}, {sx * sy, cx, -sx * cy}, {-cx * sy, sx, cx * cy}};

    for (int i = 0; i < 3; i++) {
        r[i] = cz * xy[0][i] - sz * xy[1][i];
        r[3 + i] = sz * xy[0][i] + cz * xy[1][i];
        r[6 + i] = xy[2][i];
    }
}

static void pose_make(const struct facegen_scan *s, struct pose *p)
{
    facegen_turn(s, p->r);
    p->t[0] = s->tx;
    p->t[1] = s->ty;
    p->t[2] = s->tz;
}

static struct dvec3 pose_apply(const struct pose *p, struct dvec3 q)
{
    const double z = q.z - PIVOT;

    return (struct dvec3){
        p->r[0] * q.x + p->r[1] * q.y + p->r[2] * z + p->t[0],
        p->r[3] * q.x + p->r[4] * q.y + p->r[5] * z + p->t[1],
        p->r[6] * q.x + p->r[7] * q.y + p->r[8] * z + p->t[2] + PIVOT,
    };
}

/* From the point towards the scanner: does the way lead through the face? */
static bool hidden(struct grid *g, const struct pose *p, struct dvec3 q)
{
    const double dx = p->r[6], dy = p->r[7], dz = p->r[8];

    for (double t = 2.5; q.z + t * dz < 12 && t < 120; t += 1.5)
        if (grid_height(g, q.x + t * dx, q.y + t * dy, NULL) > q.z + t * dz + 0.3)
            return true;
    return false;
}

struct outline {
    double a, up, down, wave[5], phase[5];
    double inner, outer; /* radii that it surely lies between */
};

static void outline_make(const struct facegen_scan *s, struct outline *o)
{
    struct draw r = draw_stream(s->subject, s->scan, P_OUTLINE);

    o->a = draw_uniform(&r, 61, 66);
    o->up = draw_uniform(&r, 70, 82);
    o->down = draw_uniform(&r, 78, 84);
    for (int k = 0; k < 5; k++) {
        o->wave[k] = 0.016 * draw_normal(&r);
        o->phase[k] = draw_uniform(&r, 0, 6.28);
    }
    o->outer = 1.001;
    for (int k = 0; k < 5; k++)
        o->outer += fabs(o->wave[k]);
    o->inner = o->outer < 2 ? 2 - o->outer : 0;
}

static bool outline_holds(const struct outline *o, double x, double y)
{
    const double u = x / o->a, v = (y - 2) / (y > 2 ? o->up : o->down);
    double angle, radius = 1;

    if (u * u + v * v < vec_square(o->inner) || u * u + v * v > vec_square(o->outer))
        return u * u + v * v < 1;
    angle = atan2(v, u);
    for (int k = 0; k < 5; k++)
        radius += o->wave[k] * cos((k + 2) * angle + o->phase[k]);
    return u * u + v * v < radius * radius;
}

/* A smooth error over the face: a sum of waves, of the given root mean square. */
static double warp_at(struct draw r, double rms, double x, double y)
{
    double sum = 0;

    for (int k = 0; k < 8; k++) {
        const double fx = draw_uniform(&r, -0.09, 0.09),
                     fy = draw_uniform(&r, -0.09, 0.09);

        sum += cos(fx * x + fy * y + draw_uniform(&r, 0, 6.28));
    }
    return rms * sum / 2; /* 8 waves of mean square 1/2 */
}

/* Cut blobs out until the share is reached.  Returns the points left. */
static size_t cut_holes(const struct facegen_scan *s, struct dvec3 *p, size_t n)
{
    struct draw r = draw_stream(s->subject, s->scan, P_HOLES);
    const size_t keep = (size_t)((double)n * (1 - s->holes));

    while (n > keep && n > 1) {
        const struct dvec3 c = p[draw_next(&r) % n];
        const double radius = draw_uniform(&r, 6, 15), phase = draw_uniform(&r, 0, 6.28);
        size_t left = 0;

        for (size_t i = 0; i < n; i++) {
            const double dx = p[i].x - c.x, dy = p[i].y - c.y;
            const double edge = radius * (1 + 0.25 * cos(3 * atan2(dy, dx) + phase));

            if (dx * dx + dy * dy >= edge * edge)
                p[left++] = p[i];
        }
        n = left;
    }
    return n;
}

static void throw_spikes(const struct facegen_scan *s, struct dvec3 *p, size_t n)
{
    struct draw r = draw_stream(s->subject, s->scan, P_SPIKES);
    const size_t spikes = (size_t)(s->spikes * (double)n + 0.5);

    for (size_t i = 0; i < spikes; i++) {
        const double off = draw_uniform(&r, 4, 40);

        p[draw_next(&r) % n].z += draw_next(&r) & 1 ? off : -off;
    }
}

void facegen_default(struct facegen_scan *s)
{
    memset(s, 0, sizeof *s);
    s->points = 3000;
    s->noise = 0.12;
    s->warp = 0.15;
}

void facegen_pose(struct facegen_scan *s, double degrees, double mm)
{
    struct draw r = draw_stream(s->subject, s->scan, P_POSE);

    s->yaw = draw_uniform(&r, -degrees, degrees);
    s->pitch = draw_uniform(&r, -degrees, degrees);
    s->roll = draw_uniform(&r, -degrees, degrees);
    s->tx = draw_uniform(&r, -mm, mm);
    s->ty = draw_uniform(&r, -mm, mm);
    s->tz = draw_uniform(&r, -mm, mm);
}

/* One point of the face as scanned, or not: outside the outline, turned away, hidden, or
 * lost in an eye or brow. */
static bool sample_point(const struct facegen_face *f, struct grid *g,
                         const struct pose *pose, const struct outline *o, struct draw *r,
                         struct dvec3 *q, double *facing)
{
    double slope[2], towards;

    q->x = draw_uniform(r, -72, 72);
    q->y = draw_uniform(r, -88, 90);
    towards = draw_uniform(r, 0, 1);
    if (!outline_holds(o, q->x, q->y))
        return false;
    (void)grid_height(g, q->x, q->y, slope);
    /* The area seen of a piece of surface over dx dy is its normal's part towards the
     * scanner; points are even in what the scanner sees. */
    *facing = pose->r[8] - pose->r[6] * slope[0] - pose->r[7] * slope[1];
    if (towards * 2.5 > *facing)
        return false;
    *facing /= sqrt(1 + vec_square(slope[0]) + vec_square(slope[1]));
    if (*facing < 0.25)
        return false;
    if (fabs(fabs(q->x) - 30) < 14 && fabs(q->y - 38) < 9 && draw_next(r) % 10 < 3)
        return false;
    q->z = facegen_height(f, q->x, q->y);
    return !hidden(g, pose, *q);
}

size_t facegen_sample(const struct facegen_scan *s, struct dvec3 *out)
{
    struct draw r = draw_stream(s->subject, s->scan, P_SAMPLE);
    struct draw noise = draw_stream(s->subject, s->scan, P_NOISE);
    const struct draw warp = draw_stream(s->subject, s->scan, P_WARP);
    struct facegen_face face;
    struct grid grid;
    struct pose pose;
    struct outline outline;
    size_t n = 0;

    facegen_face(s->subject, s->smile, &face);
    face.symmetry = s->symmetry;
    grid_make(&face, &grid);
    pose_make(s, &pose);
    outline_make(s, &outline);
    for (uint64_t tries = 0; n < s->points && tries < 100 * (uint64_t)s->points;
         tries++) {
        struct dvec3 q;
        double facing;

        if (!sample_point(&face, &grid, &pose, &outline, &r, &q, &facing))
            continue;
        q.z += warp_at(warp, s->warp, q.x, q.y);
        out[n] = pose_apply(&pose, q);
        out[n].z += s->noise * draw_normal(&noise) * (1 + (1 - facing) * 2);
        n++;
    }
    if (n < s->points)
        return 0;
    n = cut_holes(s, out, n);
    throw_spikes(s, out, n);
    return n;
}
