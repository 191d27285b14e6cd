#include "headscan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "draw.h"
#include "facegen.h"
#include "head.h"
#include "headview.h"

/* A depth camera that measures by triangulation: a pixel's error and its
 * steps grow with the square of the distance; edges smear, and the shadow beside them is
 * empty. */

#define HEADCAMERA_WIDTH  640
#define HEADCAMERA_HEIGHT 480
#define HEADCAMERA_FOCAL  600.0 /* pixels; the centre is the middle of the image */

#define BASE    50.0  /* mm between the two cameras */
#define STEPS   16.0  /* of disparity to a pixel */
#define NOISE   0.04  /* of disparity, pixels */
#define LOST    0.005 /* share of the pixels without a value */
#define STEP_MM 12.0  /* more is an edge */
#define EDGE    6     /* pixels */
#define W       HEADCAMERA_WIDTH
#define H       HEADCAMERA_HEIGHT
#define FB      (HEADCAMERA_FOCAL * BASE)
#define TO_X(i) (((i) - (W - 1) / 2.0) / HEADCAMERA_FOCAL)
#define TO_Y(j) (((H - 1) / 2.0 - (j)) / HEADCAMERA_FOCAL)

/* The distance along the axis, mm, of each pixel: the head's, or the wall's. */
static void headscan_look(struct head *s, const struct headscan_options *o,
                          struct draw *r, double *depth)
{
    const double wall = o->distance + draw_uniform(r, 350, 1500);
    const double lean_x = draw_uniform(r, -0.3, 0.3), lean_y = draw_uniform(r, -0.1, 0.1);
    struct headview v;

    /* Perspective becomes a parallel view: each point moved across the axis to where its ray
     * meets the plane at o->distance. */
    for (size_t i = 0; i < s->n; i++) {
        struct dvec3 *p = &s->at[i];
        const double k = o->distance / (o->distance - p->z);

        *p = (struct dvec3){p->x * k, p->y * k, p->z};
    }
    headview_make(s, false, &v);
    for (int j = 0; j < H; j++)
        for (int i = 0; i < W; i++) {
            const double x = TO_X(i), y = TO_Y(j);
            double *d = &depth[j * W + i], z;

            (void)headview_at(&v, x * o->distance, y * o->distance, &z);
            *d = o->distance - z; /* NAN: nothing comes back */
            if (isinf(z))
                *d = wall / (1 + lean_x * x + lean_y * y);
        }
    headview_free(&v);
}

/* At a step in depth, EDGE pixels wide at most: the far side's pixels beside it lie in the
 * shadow of the second camera, or mix both sides. */
static void smear(struct draw *r, const double *depth, double *out)
{
    for (int k = 0; k < W * H; k++)
        out[k] = depth[k];
    for (int j = 0; j < H; j++)
        for (int i = 1, last = 0; i < W; i++) {
            const double a = depth[j * W + last], b = depth[j * W + i];
            const int from = last;

            if (isnan(b))
                continue;
            last = i;
            if (!(fabs(a - b) >= STEP_MM) || i - from > EDGE)
                continue;
            /* Where the near side is on the left its shadow lies to the right. */
            for (int k = i; b > a && k < W && k < i + FB / a - FB / b; k++) {
                if (depth[j * W + k] < b - STEP_MM)
                    break;
                out[j * W + k] = (double)NAN;
            }
            if (draw_uniform(r, 0, 1) < 0.5)
                out[j * W + (b > a ? from + 1 : i - 1)] =
                    a + draw_uniform(r, 0.1, 0.9) * (b - a);
        }
}

/* see_by_camera(s, o, out): the scene s, moved o->distance away from the camera, which is
 * the origin and looks along -z; a wall behind. */
static void see_by_camera(struct head *s, const struct headscan_options *o,
                          struct headscan *out)
{
    struct draw r = draw_stream(o->seed, 0, 4);
    double *clean = head_alloc((size_t)W * H, sizeof *clean);
    double *depth = head_alloc((size_t)W * H, sizeof *depth);

    headscan_look(s, o, &r, clean);
    smear(&r, clean, depth);
    out->n = (size_t)W * H;
    out->width = W;
    out->height = H;
    out->at = head_alloc(out->n, sizeof *out->at);
    for (int j = 0; j < H; j++)
        for (int i = 0; i < W; i++) {
            const double disparity = FB / depth[j * W + i] + NOISE * draw_normal(&r);
            const double d = FB * STEPS / nearbyint(disparity * STEPS);
            struct dvec3 *p = &out->at[j * W + i];

            *p = (struct dvec3){TO_X(i) * d, TO_Y(j) * d, -d};
            if (draw_uniform(&r, 0, 1) < LOST)
                *p = (struct dvec3){(double)NAN, (double)NAN, (double)NAN};
        }
    free(clean);
    free(depth);
}

#define PIVOT    (-90.0) /* z of the centre that a head turns about */
#define PURPOSES 16

enum purpose { P_KIND, P_RAYS, P_NOISE, P_BEHIND };

static struct draw stream(const struct headscan_options *o, enum purpose purpose)
{
    return draw_stream(o->seed, PURPOSES, purpose);
}

/* ---- kinds */

static const struct {
    const char *name;
    enum headscan_view view;
    enum headcover cover;
    size_t points;
} kinds[] = {
    {"head", HEADSCAN_VIEW, HEADCOVER_NONE, 20000},
    {"bust", HEADSCAN_VIEW, HEADCOVER_NONE, 30000},
    {"half", HEADSCAN_VIEW, HEADCOVER_NONE, 15000},
    {"depth", HEADSCAN_CAMERA, HEADCOVER_NONE, 0},
    {"grid", HEADSCAN_GRID, HEADCOVER_NONE, 0},
    {"behind", HEADSCAN_VIEW, HEADCOVER_NONE, 20000},
    {"glasses", HEADSCAN_VIEW, HEADCOVER_GLASSES, 20000},
    {"mask", HEADSCAN_VIEW, HEADCOVER_MASK, 20000},
    {"scarf", HEADSCAN_VIEW, HEADCOVER_SCARF, 20000},
    {"hand", HEADSCAN_VIEW, HEADCOVER_HAND, 20000},
    {"fringe", HEADSCAN_VIEW, HEADCOVER_FRINGE, 20000},
    {"beard", HEADSCAN_VIEW, HEADCOVER_BEARD, 20000},
    {"cap", HEADSCAN_VIEW, HEADCOVER_CAP, 20000},
};

bool headscan_kind(const char *name, uint64_t seed, bool crop, struct headscan_options *o)
{
    const size_t count = sizeof kinds / sizeof *kinds;
    size_t kind = 0;
    struct draw r;

    while (kind < count && strcmp(kinds[kind].name, name) != 0)
        kind++;
    if (kind == count)
        return false;
    *o = (struct headscan_options){.seed = seed,
                                   .view = kinds[kind].view,
                                   .cover = kinds[kind].cover,
                                   .crop = crop,
                                   .points = kinds[kind].points,
                                   .step = 2,
                                   .noise = 0.15,
                                   .unit_mm = 1};
    r = stream(o, P_KIND);
    /* A crop is turned already. */
    o->yaw = crop ? 0 : draw_uniform(&r, -15, 15);
    o->pitch = crop ? 0 : draw_uniform(&r, -15, 15);
    o->roll = crop ? 0 : draw_uniform(&r, -8, 8);
    if (strcmp(name, "half") == 0) {
        o->yaw = draw_uniform(&r, 35, 55) * (o->yaw < 0 ? -1 : 1);
    } else if (strcmp(name, "bust") == 0) {
        o->shoulders = true;
        o->down = true;
        o->unit_mm = 1000;
        o->distance = draw_uniform(&r, 500, 1200);
    } else if (strcmp(name, "depth") == 0) {
        o->shoulders = true;
        o->down = true;
        o->unit_mm = draw_uniform(&r, 0, 1) < 0.5 ? 1 : 1000;
        o->distance = draw_uniform(&r, 450, 800);
    } else if (strcmp(name, "grid") == 0) {
        o->noise = draw_uniform(&r, 0.5, 0.8);
        o->round = 0.1;
        o->spikes = 0.005;
    } else if (strcmp(name, "behind") == 0) {
        o->behind = 0.1;
    }
    return true;
}

/* ---- where the head is */

/* The rotation about (0, 0, PIVOT); a positive pitch turns the face upwards. */
static void pose(const struct headscan_options *o, double t[16])
{
    const struct facegen_scan turn = {.yaw = o->yaw, .pitch = -o->pitch, .roll = o->roll};
    double r[9];

    facegen_turn(&turn, r);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            t[4 * i + k] = r[3 * i + k];
        t[4 * i + 3] = PIVOT * ((i == 2) - r[3 * i + 2]);
        t[12 + i] = 0;
    }
    t[15] = 1;
}

/* What stands before the scanner, seen along -z. */
static struct head scene(const struct head *h, const struct headscan_options *o)
{
    struct head s = head_copy(h);
    double t[16];

    headcover_add(&s, o->cover, o->seed, o->crop);
    if (o->shoulders)
        head_add_shoulders(&s);
    pose(o, t);
    head_move(&s, t);
    return s;
}

/* ---- what the scanner sees of it */

static void headscan_add(struct headscan *s, struct dvec3 p)
{
    if (s->n == s->cap) {
        const size_t cap = s->cap > 0 ? 2 * s->cap : 4096;
        struct dvec3 *more = head_alloc(cap, sizeof *more);

        if (s->n > 0)
            memcpy(more, s->at, s->n * sizeof *more);
        free(s->at);
        s->at = more;
        s->cap = cap;
    }
    s->at[s->n++] = p;
}

static void see_rays(struct headview *v, const struct headscan_options *o,
                     struct headscan *out)
{
    struct draw r = stream(o, P_RAYS);
    double z;

    for (size_t k = 0; k < 50 * o->points && out->n < o->points; k++) {
        const double x = draw_uniform(&r, v->x0, v->x1);
        const double y = draw_uniform(&r, v->y0, v->y1);

        if (headview_at(v, x, y, &z) != HEAD_VOID)
            headscan_add(out, (struct dvec3){x, y, z});
    }
}

static void see_grid(struct headview *v, const struct headscan_options *o,
                     struct headscan *out)
{
    double z;

    for (double y = floor(v->y0); y < v->y1; y += o->step)
        for (double x = floor(v->x0); x < v->x1; x += o->step)
            if (headview_at(v, x, y, &z) != HEAD_VOID)
                headscan_add(out, (struct dvec3){x, y, z});
}

/* The crop's own points, and of the cover as many as of the skin. */
static void see_crop(const struct headview *v, const struct headscan_options *o,
                     struct headscan *out)
{
    struct draw r = stream(o, P_RAYS);
    const double share = pow(HEAD_COVER_MM / v->head->spacing, 2);

    for (size_t i = 0; i < v->head->n; i++)
        if (v->seen[i] && v->head->part[i] != HEAD_VOID &&
            (v->head->part[i] == HEAD_SKIN || draw_uniform(&r, 0, 1) < share))
            headscan_add(out, v->head->at[i]);
}

static void add_behind(const struct headview *v, const struct headscan_options *o,
                       struct headscan *out)
{
    struct draw r = stream(o, P_BEHIND);
    /* Of a crop nothing is hidden. */
    const size_t all = o->crop ? 0 : (size_t)((double)out->n / (1 - o->behind) + 0.5);

    while (out->n < all) {
        const size_t i = draw_next(&r) % v->head->n;

        if (!v->seen[i] && v->head->part[i] == HEAD_SKIN)
            headscan_add(out, v->head->at[i]);
    }
}

static void add_errors(const struct headscan_options *o, struct headscan *s)
{
    struct draw r = stream(o, P_NOISE);

    for (size_t i = 0; i < s->n; i++) {
        struct dvec3 *p = &s->at[i];

        p->z += o->noise * draw_normal(&r);
        if (draw_uniform(&r, 0, 1) < o->spikes)
            p->z += draw_uniform(&r, 4, 40) * (draw_next(&r) & 1 ? 1 : -1);
        if (o->round > 0)
            *p = (struct dvec3){o->round * nearbyint(p->x / o->round),
                                o->round * nearbyint(p->y / o->round),
                                o->round * nearbyint(p->z / o->round)};
    }
}

/* ---- the file's axes and unit */

static void deliver(const struct headscan_options *o, struct headscan *s)
{
    const double x = (o->mirrored ? -1 : 1) / o->unit_mm;
    const double yz = (o->down ? -1 : 1) / o->unit_mm;
    const double back = o->view == HEADSCAN_CAMERA ? 0 : o->distance; /* there already */

    for (size_t i = 0; i < s->n; i++) {
        const struct dvec3 p = s->at[i];

        s->at[i] = (struct dvec3){x * p.x, yz * p.y, yz * (p.z - back)};
    }
}

void headscan_render(const struct head *h, const struct headscan_options *o,
                     struct headscan *out)
{
    struct head s = scene(h, o);
    struct headview v;

    *out = (struct headscan){0};
    if (o->view == HEADSCAN_CAMERA) {
        see_by_camera(&s, o, out);
    } else {
        headview_make(&s, o->crop, &v);
        if (o->view == HEADSCAN_GRID)
            see_grid(&v, o, out);
        else if (o->crop)
            see_crop(&v, o, out);
        else
            see_rays(&v, o, out);
        add_behind(&v, o, out);
        add_errors(o, out);
        headview_free(&v);
    }
    deliver(o, out);
    head_free(&s);
}

void headscan_free(struct headscan *s)
{
    free(s->at);
    *s = (struct headscan){0};
}
