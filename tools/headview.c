#include "headview.h"

#include <math.h>
#include <stdlib.h>

/* Squares of the z-buffer.  A point of the skin fills those within SPLAT spacings, so that even
 * points at random leave no gap; it hides what lies DEEP spacings and more behind it, because
 * on steep places neighbours differ in height.  What covers the skin is dense, and hides all
 * behind it. */
#define SQUARE 1.5
#define SPLAT  1.5
#define DEEP   3.5

struct buffer {
    double x0, y0;
    int nx, ny;
    float *skin, *cover;
};

static int column(const struct buffer *b, double x)
{
    return (int)((x - b->x0) / SQUARE);
}

static int row(const struct buffer *b, double y)
{
    return (int)((y - b->y0) / SQUARE);
}

static void splat(struct buffer *b, struct dvec3 p, float *top, double radius)
{
    for (int j = row(b, p.y - radius); j <= row(b, p.y + radius); j++)
        for (int i = column(b, p.x - radius); i <= column(b, p.x + radius); i++) {
            float *z = &top[j * b->nx + i];

            *z = fmaxf(*z, (float)p.z);
        }
}

static void fill(const struct head *h, const struct headview *v, struct buffer *b)
{
    const double most = fmax(SPLAT * h->spacing, HEAD_COVER_MM) + SQUARE;

    b->x0 = v->x0 - most;
    b->y0 = v->y0 - most;
    b->nx = column(b, v->x1 + most) + 1;
    b->ny = row(b, v->y1 + most) + 1;
    b->skin = head_alloc((size_t)b->nx * (size_t)b->ny, sizeof *b->skin);
    b->cover = head_alloc((size_t)b->nx * (size_t)b->ny, sizeof *b->cover);
    for (int i = 0; i < b->nx * b->ny; i++)
        b->skin[i] = b->cover[i] = -INFINITY;
    for (size_t i = 0; i < h->n; i++)
        if (h->part[i] == HEAD_SKIN)
            splat(b, h->at[i], b->skin, SPLAT * h->spacing);
        else
            splat(b, h->at[i], b->cover, HEAD_COVER_MM * 0.6);
}

static void look(const struct head *h, bool one_layer, struct headview *v)
{
    const double deep = DEEP * h->spacing;
    struct buffer b;

    fill(h, v, &b);
    for (size_t i = 0; i < h->n; i++) {
        const struct dvec3 p = h->at[i];
        const int at = row(&b, p.y) * b.nx + column(&b, p.x);

        if (h->part[i] == HEAD_SKIN)
            v->seen[i] = p.z > b.cover[at] && (one_layer || p.z > b.skin[at] - deep);
        else
            v->seen[i] = p.z > b.cover[at] - 2 && p.z > b.skin[at] - deep;
    }
    free(b.skin);
    free(b.cover);
}

/* ---- the points seen, by squares of the view */

static double reach(const struct head *h)
{
    return fmax(1.6 * h->spacing, 1.6 * HEAD_COVER_MM);
}

static uint32_t square_of(const struct headview *v, double x, double y)
{
    const double size = reach(v->head);
    const double i = (x - v->x0) / size, j = (y - v->y0) / size;

    return i < 0 || j < 0 || i >= v->nx || j >= v->ny ? UINT32_MAX
                                                      : (uint32_t)j * v->nx + (uint32_t)i;
}

/* Count, then place. */
static void sort(struct headview *v)
{
    const struct head *h = v->head;

    for (size_t i = 0; i < h->n; i++)
        if (v->seen[i])
            v->first[square_of(v, h->at[i].x, h->at[i].y) + 2]++;
    for (uint32_t k = 2; k < v->nx * v->ny + 2; k++)
        v->first[k] += v->first[k - 1];
    for (size_t i = 0; i < h->n; i++)
        if (v->seen[i])
            v->item[v->first[square_of(v, h->at[i].x, h->at[i].y) + 1]++] = (uint32_t)i;
}

void headview_make(const struct head *h, bool one_layer, struct headview *v)
{
    *v = (struct headview){
        .head = h, .x0 = INFINITY, .y0 = INFINITY, .x1 = -INFINITY, .y1 = -INFINITY};
    for (size_t i = 0; i < h->n; i++) {
        v->x0 = fmin(v->x0, h->at[i].x);
        v->y0 = fmin(v->y0, h->at[i].y);
        v->x1 = fmax(v->x1, h->at[i].x);
        v->y1 = fmax(v->y1, h->at[i].y);
    }
    v->nx = (uint32_t)((v->x1 - v->x0) / reach(h)) + 1;
    v->ny = (uint32_t)((v->y1 - v->y0) / reach(h)) + 1;
    v->seen = head_alloc(h->n, 1);
    v->first = head_alloc((size_t)v->nx * v->ny + 2, sizeof *v->first);
    v->item = head_alloc(h->n, sizeof *v->item);
    look(h, one_layer, v);
    sort(v);
}

void headview_free(struct headview *v)
{
    free(v->seen);
    free(v->first);
    free(v->item);
}

/* Calls `each` with the index of every point seen in the squares round (x, y). */
static void near(const struct headview *v, double x, double y,
                 void (*each)(void *to, uint32_t i), void *to)
{
    const double size = reach(v->head);

    for (int k = 0; k < 9; k++) {
        const uint32_t s =
            square_of(v, x + size * (k % 3 - 1), y + size * (double)(k / 3 - 1));

        for (uint32_t i = s != UINT32_MAX ? v->first[s] : 1;
             s != UINT32_MAX && i < v->first[s + 1]; i++)
            each(to, v->item[i]);
    }
}

struct query {
    const struct head *h;
    double x, y, least; /* the square of the distance to the nearest */
    uint32_t nearest;
    double m[3][4]; /* normal equations of the plane */
};

static void keep_nearest(void *to, uint32_t i)
{
    struct query *q = to;
    const double dx = q->h->at[i].x - q->x, dy = q->h->at[i].y - q->y;

    if (dx * dx + dy * dy < q->least) {
        q->least = dx * dx + dy * dy;
        q->nearest = i;
    }
}

/* Only points of the nearest one's surface: no step between them, and the same part. */
static void add_to_plane(void *to, uint32_t i)
{
    struct query *q = to;
    const struct dvec3 p = q->h->at[i], o = q->h->at[q->nearest];
    const double dx = p.x - q->x, dy = p.y - q->y, r2 = dx * dx + dy * dy;
    const double size = q->h->part[i] == HEAD_SKIN ? q->h->spacing : HEAD_COVER_MM;
    const double w = exp(-r2 / (size * size)), v[4] = {1, dx, dy, p.z - o.z};

    if (q->h->part[i] != q->h->part[q->nearest] ||
        fabs(p.z - o.z) > 1 + 2.5 * hypot(p.x - o.x, p.y - o.y))
        return;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 4; b++)
            q->m[a][b] += w * v[a] * v[b];
}

enum head_part headview_at(const struct headview *v, double x, double y, double *z)
{
    struct query q = {.h = v->head, .x = x, .y = y, .least = INFINITY};
    double most;

    near(v, x, y, keep_nearest, &q);
    *z = isfinite(q.least) ? (double)NAN : -INFINITY;
    if (!isfinite(q.least) || v->head->part[q.nearest] == HEAD_VOID)
        return HEAD_VOID;
    most = v->head->part[q.nearest] == HEAD_SKIN ? 1.4 * v->head->spacing
                                                 : 1.6 * HEAD_COVER_MM;
    if (q.least > most * most)
        return HEAD_VOID;
    for (int a = 1; a < 3; a++) /* few points: rather flat than steep */
        q.m[a][a] = 0.05;
    near(v, x, y, add_to_plane, &q);
    for (int i = 2; i > 0; i--) /* to a lower triangle */
        for (int a = 0; a < i; a++) {
            const double k = q.m[a][i] / q.m[i][i];

            for (int b = 0; b < 4; b++)
                q.m[a][b] -= k * q.m[i][b];
        }
    *z = v->head->at[q.nearest].z + q.m[0][3] / q.m[0][0];
    return v->head->part[q.nearest];
}
