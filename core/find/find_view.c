#include "find_view.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "frame.h"
#include "mem.h"

/* A view, mm: its cells.  A nose protrudes by OUT, as no ball of a head's size does, from a ring
 * around it, of which RING_SEEN of 16 places must have points.  A surface farther than NEAR before or
 * behind the nose is something else.  The samples of the mean face leave out what hair, a
 * collar or the view hides.  The share SEEN of them must have points; gaps count up to CAP; the slope
 * of the plane is at most STEEP. */
#define FIND_CELL_MM        8.0
#define FIND_RING_MM        32.0
#define FIND_RING_SEEN      10
#define FIND_OUT_MM         8.5
#define FIND_NEAR_MM        60.0
#define FIND_FACE_X_MM      54.0
#define FIND_FACE_BOTTOM_MM (-62.0)
#define FIND_FACE_TOP_MM    50.0
#define FIND_SEEN           0.6
#define FIND_CAP_MM         6.0
#define FIND_STEEP          0.6

/* Factors of the cost of a start with something above it, and of a start that is not upright before a
 * scanner, of agreed axes or a camera's, as most are. */
#define FIND_ABOVE_COST  1.3
#define FIND_ASLANT_COST 1.15

/* mm from the tip of the nose: above LOW the crown has ended, and hair nearly always.  If most of a
 * band from there to HIGH, SIDE to each side, has points no more than BEFORE before the nose and BEHIND
 * behind it, something else is above: the head, above a place on a chest or a shoulder, or the body. */
#define FIND_ABOVE_LOW_MM    210.0
#define FIND_ABOVE_HIGH_MM   270.0
#define FIND_ABOVE_SIDE_MM   45.0
#define FIND_ABOVE_BEFORE_MM 80.0
#define FIND_ABOVE_BEHIND_MM 140.0

/* The cost of a view, in noses (find.c): one for CUBES cubes and one for CELLS cells that have a height. */
#define FIND_SPENT_CUBES 512
#define FIND_SPENT_CELLS 96

#define ROLLS FIND_VIEW_ROLLS
#define NONE  (-1e9f)

/* Cells beside the cloud: as far as a face reaches from its nose. */
#define PAD 12

#define UNIT  FIND_VIEW_MM
#define LANES 4 /* rolls at a time */

typedef float lanes __attribute__((vector_size(4 * LANES)));
typedef int32_t masks __attribute__((vector_size(4 * LANES)));

/* cos and sin of the rolls, each 22.5 degrees from the one before. */
static void turn_of(int roll, double *c, double *s)
{
    static const double table[5] = {1, .92387953251128675613, .70710678118654752440,
                                    .38268343236508977173, 0};
    const int k = roll % 8;

    *c = k <= 4 ? table[k] : -table[8 - k];
    *s = k <= 4 ? table[4 - k] : table[k - 4];
    if (roll >= 8) {
        *c = -*c;
        *s = -*s;
    }
}

void find_view_prepare(const struct frame_mean *mean, struct find_view_face *out)
{
    uint32_t top = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (mean->height[i] > mean->height[top] || isnan(mean->height[top]))
            top = i;
    out->tip = (struct dvec3){0, grid_y(top), (double)mean->height[top]};
    out->n = 0;
    for (uint32_t i = 0; i < GRID_N && out->n < FIND_VIEW_SAMPLES; i++) {
        const double x = grid_x(i), y = grid_y(i) - out->tip.y;

        if (i % GRID_NX % 3 != 0 || i / GRID_NX % 3 != 1 || isnan(mean->height[i]) ||
            fabs(x) > FIND_FACE_X_MM || y < FIND_FACE_BOTTOM_MM || y > FIND_FACE_TOP_MM)
            continue;
        out->z[out->n] = mean->height[i] - (float)out->tip.z;
        for (int r = 0; r < ROLLS; r++) {
            double c, s;

            turn_of(r, &c, &s);
            out->x[out->n][r] = (float)((c * x - s * y) / UNIT);
            out->y[out->n][r] = (float)((s * x + c * y) / UNIT);
        }
        out->n++;
    }
}

/* ---- the map */

struct map {
    int nx, ny;
    float left, bottom; /* mm, of the first cell's corner */
    struct pose to;     /* from the cloud to the view: a rotation */
    float *z, *out;     /* the room's */
    uint32_t *cell, n;  /* those that have a height */
    int32_t at[FIND_VIEW_SAMPLES]
              [ROLLS]; /* where each sample lies, in cells from the nose */
};

/* Cells along the side of a view. */
static int cells(double mm)
{
    return (int)(mm / FIND_CELL_MM) + 2 + 2 * PAD;
}

enum status find_view_open(const struct find_grid *g, struct find_view_room *r)
{
    const double *s = g->size;
    const size_t side = (size_t)cells(sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]));
    const size_t all = side * side, most = 5 * (size_t)g->n; /* and those beside them */

    r->z = mem_array(2 * all, sizeof *r->z);
    r->cell = mem_array(most < all ? most : all, sizeof *r->cell);
    if (r->z == NULL || r->cell == NULL) {
        find_view_close(r);
        return ST_ENOMEM;
    }
    r->out = r->z + all;
    for (size_t i = 0; i < 2 * all; i++)
        r->z[i] = NONE;
    return ST_OK;
}

void find_view_close(struct find_view_room *r)
{
    mem_free(r->z);
    mem_free(r->cell);
}

/* The rotation to a view along an axis. */
static struct pose seen_from(struct dvec3 z)
{
    const struct dvec3 up =
        z.x == 0 && z.z == 0 ? (struct dvec3){0, 0, 1} : (struct dvec3){0, 1, 0};
    const double l = 1 / sqrt(vec_dot(z, z));
    struct dvec3 x = vec_cross(up, z), y;
    const double k = 1 / sqrt(vec_dot(x, x));

    z = (struct dvec3){l * z.x, l * z.y, l * z.z};
    x = (struct dvec3){k * x.x, k * x.y, k * x.z};
    y = vec_cross(z, x);
    return (struct pose){{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}, {0, 0, 0}};
}

/* The box of the cloud in the view. */
static void lay_out(const struct find_grid *g, struct map *m)
{
    double size[2], lo[2];

    for (int i = 0; i < 2; i++) {
        const double *r = &m->to.r[3 * i];

        size[i] = lo[i] = 0;
        for (int k = 0; k < 3; k++) {
            size[i] += fabs(r[k]) * g->size[k];
            lo[i] += fmin(r[k], 0) * g->size[k];
        }
    }
    m->nx = cells(size[0]);
    m->ny = cells(size[1]);
    m->left = (float)(lo[0] - PAD * FIND_CELL_MM);
    m->bottom = (float)(lo[1] - PAD * FIND_CELL_MM);
}

/* Holes of a cell are filled by the highest beside them. */
static void find_view_fill(struct map *m)
{
    const int by[4] = {-1, 1, -m->nx, m->nx};
    const uint32_t seen = m->n;

    for (uint32_t i = 0; i < 4 * seen; i++) {
        const uint32_t hole = m->cell[i / 4] + (uint32_t)by[i % 4];
        float most = NONE;
        int n = 0;

        if (m->z[hole] > NONE || m->out[hole] > NONE)
            continue;
        for (int k = 0; k < 4; k++) {
            const float z = m->z[(int)hole + by[k]];

            n += z > NONE;
            most = z > most ? z : most;
        }
        if (n > 1) {
            m->out[hole] = most;
            m->cell[m->n++] = hole;
        }
    }
    for (uint32_t i = seen; i < m->n; i++) {
        m->z[m->cell[i]] = m->out[m->cell[i]];
        m->out[m->cell[i]] = NONE;
    }
}

static float sum_of(lanes v)
{
    return (v[0] + v[2]) + (v[1] + v[3]);
}

/* Sets how far each cell protrudes from the mean of a ring around it, if as a nose does. */
static void protrude(struct map *m)
{
    const float near = (float)FIND_NEAR_MM;
    int ring[ROLLS];

    for (int r = 0; r < ROLLS; r++) {
        double c, s;

        turn_of(r, &c, &s);
        ring[r] = (int)rint(s * FIND_RING_MM / FIND_CELL_MM) * m->nx +
                  (int)rint(c * FIND_RING_MM / FIND_CELL_MM);
    }
    for (uint32_t i = 0; i < m->n; i++) {
        const float *here = &m->z[m->cell[i]];
        lanes sum = {0.0f}, count = {0.0f};
        float n;

        for (int r = 0; r < ROLLS; r += LANES) {
            const lanes z = {here[ring[r]], here[ring[r + 1]], here[ring[r + 2]],
                             here[ring[r + 3]]};
            const lanes d = *here - z;
            const masks in = (d < near) & (d > -near);

            sum += (lanes)(in & (masks)d);
            count -= __builtin_convertvector(in, lanes);
        }
        n = sum_of(count);
        if (n >= FIND_RING_SEEN && sum_of(sum) > (float)FIND_OUT_MM * n)
            m->out[m->cell[i]] = sum_of(sum) / n;
    }
}

/* In an empty room. */
static void make_map(const struct find_view_face *f, const struct find_grid *g,
                     struct map *m)
{
    const float per = (float)(1 / FIND_CELL_MM);

    lay_out(g, m);
    for (uint32_t v = 0; v < g->n; v++) {
        const struct dvec3 p = pose_apply(&m->to, g->at[v]);
        const int at = (int)(((float)p.y - m->bottom) * per) * m->nx +
                       (int)(((float)p.x - m->left) * per);

        if (!(m->z[at] > NONE))
            m->cell[m->n++] = (uint32_t)at;
        m->z[at] = (float)p.z > m->z[at] ? (float)p.z : m->z[at];
    }
    find_view_fill(m);
    protrude(m);
    for (uint32_t k = 0; k < f->n; k++)
        for (int r = 0; r < ROLLS; r++)
            m->at[k][r] = (int)rintf(f->y[k][r] * (float)UNIT * per) * m->nx +
                          (int)rintf(f->x[k][r] * (float)UNIT * per);
}

/* Returns true if no cell beside it protrudes more. */
static bool highest(const struct map *m, int at)
{
    for (int y = -m->nx; y <= m->nx; y += m->nx)
        for (int x = -1; x <= 1; x++)
            if (m->out[at + y + x] > m->out[at])
                return false;
    return true;
}

/* ---- the mean face at a nose */

/* By roll: the cost, and the plane z + x u + y v of the gap. */
struct laid {
    float cost[ROLLS], z[ROLLS], x[ROLLS], y[ROLLS];
};

/* Of LANES rolls: sums over the samples with a gap of 1, u, v, their products, and those with
 * the gap. */
struct find_view_sums {
    lanes n, x, y, xx, xy, yy, d, dx, dy;
};

/* A sample's gap, where that is one: what is too far, or nothing, is not (in[k]). */
struct find_view_gaps {
    lanes z[FIND_VIEW_SAMPLES];
    masks in[FIND_VIEW_SAMPLES];
};

static void find_view_measure(const struct find_view_face *f, const struct map *m, int at,
                              int roll, struct find_view_gaps *gap,
                              struct find_view_sums *out)
{
    const float far = (float)FIND_NEAR_MM, *here = &m->z[at];
    struct find_view_sums s;

    memset(&s, 0, sizeof s);
    for (uint32_t k = 0; k < f->n; k++) {
        const int32_t *by = &m->at[k][roll];
        const float from = *here + f->z[k];
        lanes z = {here[by[0]], here[by[1]], here[by[2]], here[by[3]]}, x, y;
        masks in;

        z -= from;
        in = (z < far) & (z > -far);
        memcpy(&x, &f->x[k][roll], sizeof x);
        memcpy(&y, &f->y[k][roll], sizeof y);
        z = (lanes)(in & (masks)z);
        x = (lanes)(in & (masks)x);
        y = (lanes)(in & (masks)y);
        gap->z[k] = z;
        gap->in[k] = in;
        s.n -= __builtin_convertvector(in, lanes);
        s.x += x;
        s.y += y;
        s.xx += x * x;
        s.xy += x * y;
        s.yy += y * y;
        s.d += z;
        s.dx += z * x;
        s.dy += z * y;
    }
    *out = s;
}

/* The mean square of what the plane z + x u + y v leaves, capped; more where samples have no
 * gap. */
static void find_view_rate(const struct find_view_face *f,
                           const struct find_view_gaps *gap, int roll,
                           const struct find_view_sums *s, const lanes plane[3],
                           float *cost)
{
    const float cap = (float)(FIND_CAP_MM * FIND_CAP_MM), all = (float)f->n;
    const float steep = (float)(FIND_STEEP * FIND_STEEP * UNIT * UNIT);
    lanes rest = {0.0f};

    for (uint32_t k = 0; k < f->n; k++) {
        lanes x, y, e;

        memcpy(&x, &f->x[k][roll], sizeof x);
        memcpy(&y, &f->y[k][roll], sizeof y);
        e = gap->z[k] - (plane[0] + plane[1] * x + plane[2] * y);
        e = e * e - cap;
        rest += (lanes)((e < 0.0f) & gap->in[k] & (masks)e);
    }
    rest = rest / s->n + cap;
    for (int r = 0; r < LANES; r++) {
        const float x = plane[1][r], y = plane[2][r], n = s->n[r];
        const bool fits = n >= (float)FIND_SEEN * all && x * x + y * y < steep;

        cost[r] = fits ? rest[r] * sqrtf(all / n) : INFINITY;
    }
}

static void lay(const struct find_view_face *f, const struct map *m, int at,
                struct laid *out)
{
    struct find_view_gaps gap;
    struct find_view_sums s;

    for (int roll = 0; roll < ROLLS; roll += LANES) {
        lanes a, b, xx, xy, yy, p, q, plane[3];

        find_view_measure(f, m, at, roll, &gap, &s);
        /* the best plane, by elimination */
        a = s.x / s.n;
        b = s.y / s.n;
        xx = s.xx - a * s.x;
        xy = s.xy - a * s.y;
        yy = s.yy - b * s.y;
        p = s.dx - a * s.d;
        q = s.dy - b * s.d;
        plane[2] = (q - xy / xx * p) / (yy - xy / xx * xy);
        plane[1] = (p - xy * plane[2]) / xx;
        plane[0] = (s.d - s.x * plane[1] - s.y * plane[2]) / s.n;
        find_view_rate(f, &gap, roll, &s, plane, &out->cost[roll]);
        memcpy(&out->z[roll], &plane[0], sizeof plane[0]);
        memcpy(&out->x[roll], &plane[1], sizeof plane[0]);
        memcpy(&out->y[roll], &plane[2], sizeof plane[0]);
    }
}

/* ---- starts */

/* The view turned by the roll, then tilted until the plane is level; the nose at the cell goes to
 * the mean face's tip. */
static struct pose pose_of(const struct find_view_face *f, const struct map *m, int at,
                           int roll, const struct laid *l)
{
    const double *a = m->to.r;
    double c, s, b[9], n[3], tilt[9], along;
    struct pose out;
    struct dvec3 tip = {(double)m->left + (at % m->nx + 0.5) * FIND_CELL_MM,
                        (double)m->bottom + (at / m->nx + 0.5) * FIND_CELL_MM,
                        (double)(m->z[at] + l->z[roll])};

    turn_of(roll, &c, &s);
    for (int k = 0; k < 3; k++) {
        b[k] = c * a[k] + s * a[3 + k];
        b[3 + k] = c * a[3 + k] - s * a[k];
        b[6 + k] = a[6 + k];
    }
    n[0] = -(c * (double)l->x[roll] + s * (double)l->y[roll]) / UNIT;
    n[1] = -(c * (double)l->y[roll] - s * (double)l->x[roll]) / UNIT;
    along = 1 / sqrt(n[0] * n[0] + n[1] * n[1] + 1);
    n[0] *= along;
    n[1] *= along;
    n[2] = along;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++)
            tilt[3 * i + k] = (i == k) - n[i] * n[k] / (1 + n[2]);
        tilt[3 * i + 2] = -n[i];
    }
    memcpy(tilt + 6, n, sizeof n);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out.r[3 * i + k] = tilt[3 * i] * b[k] + tilt[3 * i + 1] * b[3 + k] +
                               tilt[3 * i + 2] * b[6 + k];
    tip = (struct dvec3){a[0] * tip.x + a[3] * tip.y + a[6] * tip.z,
                         a[1] * tip.x + a[4] * tip.y + a[7] * tip.z,
                         a[2] * tip.x + a[5] * tip.y + a[8] * tip.z};
    memset(out.t, 0, sizeof out.t);
    tip = vec_sub(f->tip, pose_apply(&out, tip));
    out.t[0] = tip.x;
    out.t[1] = tip.y;
    out.t[2] = tip.z;
    return out;
}

static bool enters(const struct find_starts *s, float cost)
{
    return s->n < FIND_STARTS || cost < s->start[FIND_STARTS - 1].cost;
}

static void find_view_keep(struct find_starts *s, const struct find_start *start)
{
    uint32_t i = s->n < FIND_STARTS ? s->n++ : FIND_STARTS - 1;

    for (; i > 0 && start->cost < s->start[i - 1].cost; i--)
        s->start[i] = s->start[i - 1];
    s->start[i] = *start;
}

/* Returns true if something is above a head whose nose is in the cell, rotated by the roll. */
static bool above(const struct map *m, int at, int roll)
{
    const double low = FIND_ABOVE_LOW_MM, step = (FIND_ABOVE_HIGH_MM - low) / 2;
    const float before = (float)FIND_ABOVE_BEFORE_MM,
                behind = (float)FIND_ABOVE_BEHIND_MM;
    const int i = at % m->nx, j = at / m->nx;
    double c, s;
    int taken = 0;

    turn_of(roll, &c, &s);
    for (int k = 0; k < 12; k++) {
        const double x = FIND_ABOVE_SIDE_MM * (k % 4 - 1.5) / 1.5,
                     y = low + step * (k / 4);
        const int a = i + (int)rint((c * x - s * y) / FIND_CELL_MM);
        const int b = j + (int)rint((s * x + c * y) / FIND_CELL_MM);
        float d;

        if (a < 0 || a >= m->nx || b < 0 || b >= m->ny)
            continue;
        d = m->z[b * m->nx + a] - m->z[at];
        taken += (d < before) & (d > -behind);
    }
    return taken > 6;
}

/* Returns true if a head is within one roll of upright before a scanner: y up if it looks along -z, down
 * along z (seen_from()). */
static bool upright(const struct map *m, int roll)
{
    const double z = m->to.r[8];
    const int from_up = (roll + (z < 0 ? ROLLS / 2 : 0)) % ROLLS;

    return (from_up <= 1 || from_up == ROLLS - 1) && z != 0;
}

/* The rolls that fit better than those beside them. */
static void find_view_take(const struct find_view_face *f, const struct map *m, int at,
                           struct find_starts *s)
{
    struct laid l;

    lay(f, m, at, &l);
    for (int r = 0; r < ROLLS; r++) {
        float cost = l.cost[r], odds = 1.0f;

        if (!(cost <= l.cost[(r + 1) % ROLLS] &&
              cost < l.cost[(r + ROLLS - 1) % ROLLS]) ||
            !enters(s, cost))
            continue;
        odds *= above(m, at, r) ? (float)FIND_ABOVE_COST : 1.0f;
        odds *= upright(m, r) ? 1.0f : (float)FIND_ASLANT_COST;
        cost *= odds;
        if (enters(s, cost))
            find_view_keep(s, &(struct find_start){cost, odds, pose_of(f, m, at, r, &l)});
    }
}

void find_view_all(const struct find_view_face *f, const struct find_grid *g,
                   struct dvec3 axis, struct find_view_room *r, struct find_starts *s)
{
    struct map m = {.to = seen_from(axis), .z = r->z, .out = r->out, .cell = r->cell};

    make_map(f, g, &m);
    for (uint32_t i = 0; i < m.n && s->left > 0; i++) {
        const int at = (int)m.cell[i];

        if (m.out[at] > NONE && highest(&m, at)) {
            find_view_take(f, &m, at, s);
            s->left--;
        }
    }
    s->left -= g->n / FIND_SPENT_CUBES + m.n / FIND_SPENT_CELLS;
    for (uint32_t i = 0; i < m.n; i++)
        m.z[m.cell[i]] = m.out[m.cell[i]] = NONE;
}
