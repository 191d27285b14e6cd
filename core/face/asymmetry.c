#include "asymmetry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "align.h"
#include "align_field.h"
#include "pose.h"
#include "series.h"
#include "solve.h"
#include "lattice.h"
#include "measure.h"
#include "surface.h"

/* The surface is turned upright by the start, then by the corrected plane: after two rounds
 * the side it was scanned from does not matter. */
#define ASYMMETRY_ROUNDS 2

/* Points of the mirror image in a robust sum, at most; steps, and the length of the last. */
#define ASYMMETRY_POINTS  4000
#define ASYMMETRY_STEPS   40
#define ASYMMETRY_LAST_MM 2e-3

/* As in alignment; the start is nearer, and a sphere's plane stays where it is. */
#define ASYMMETRY_MAX_TURN_RAD 0.2
#define ASYMMETRY_MAX_SHIFT_MM 10.0
#define ASYMMETRY_DAMPING      1e-9

/* Bands across the surface, in halves, inner and outer: each is left out in turn. */
#define ASYMMETRY_BANDS 6

/* Least overlap of a surface with its mirror image that says something.  Of faces turned by
 * 35 degrees, or with 40 % missing in blobs, half of the surface lies over its image; of one
 * half of a face, which some other plane fits as well, less than a third. */
#define ASYMMETRY_MIN_OVERLAP 0.45

/* The surface in parts, each left out in turn: bands across, inner and outer halves. */
#define BLOCKS   (2 * ASYMMETRY_BANDS)
#define NO_BLOCK BLOCKS

/* normal . p = offset. */
struct plane {
    struct dvec3 normal;
    double offset;
};

/* A search in progress, on the surface turned upright. */
struct asymmetry_search {
    struct align_field field;
    struct align_point *pts; /* sorted by block */
    uint32_t begin[BLOCKS + 1];
    uint32_t stride;
    struct dvec3 middle; /* of the points */
    uint32_t evaluations;
};

static struct dvec3 unit(struct dvec3 a)
{
    return vec_along((struct dvec3){0, 0, 0}, 1 / sqrt(vec_dot(a, a)), a);
}

/* The point of the plane nearest to p. */
static struct dvec3 onto(const struct plane *p, struct dvec3 q)
{
    return vec_along(q, p->offset - vec_dot(p->normal, q), p->normal);
}

/* The reflection in the plane, as the pose that it is but for its handedness. */
static struct pose mirror(const struct plane *p)
{
    const double n[3] = {p->normal.x, p->normal.y, p->normal.z};
    struct pose out;

    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++)
            out.r[3 * i + k] = (i == k) - 2 * n[i] * n[k];
        out.t[i] = 2 * p->offset * n[i];
    }
    return out;
}

/* Which block a point is in, of a surface that extends from low to high about x = 0. */
static uint32_t block_of(struct ivec2 p, struct ivec2 low, struct ivec2 high)
{
    const double up = ((double)p.y - low.y) / ((double)high.y - low.y + 1);
    const int64_t wide = high.x > -(int64_t)low.x ? high.x : -(int64_t)low.x;

    return 2 * (uint32_t)(up * ASYMMETRY_BANDS) + (2 * llabs(p.x) > wide);
}

/* The vertices that a measured triangle has, sorted by block, in the order of the mesh. */
static void asymmetry_load(const struct surface *s, uint32_t *block,
                           struct asymmetry_search *out)
{
    const struct mesh *m = &s->mesh;
    struct ivec2 low = m->xy[0], high = low;
    struct dvec3 sum = {0, 0, 0};
    uint32_t fill[BLOCKS], n = 0;

    for (uint32_t v = 0; v < m->nv; v++) {
        low.x = m->xy[v].x < low.x ? m->xy[v].x : low.x;
        low.y = m->xy[v].y < low.y ? m->xy[v].y : low.y;
        high.x = m->xy[v].x > high.x ? m->xy[v].x : high.x;
        high.y = m->xy[v].y > high.y ? m->xy[v].y : high.y;
        block[v] = NO_BLOCK;
    }
    for (uint32_t h = 0; h < 3 * m->nt; h++) /* (Ghosts bridge.) */
        if (!s->bridge[h / 3])
            block[m->org[h]] = block_of(m->xy[m->org[h]], low, high);
    memset(out->begin, 0, sizeof out->begin);
    for (uint32_t v = 0; v < m->nv; v++)
        if (block[v] != NO_BLOCK)
            out->begin[block[v] + 1]++;
    for (uint32_t b = 0; b < BLOCKS; b++)
        out->begin[b + 1] += out->begin[b];
    memcpy(fill, out->begin, sizeof fill);
    for (uint32_t v = 0; v < m->nv; v++) {
        const struct dvec3 p = lattice_to_mm(m->xy[v], m->z[v]);

        if (block[v] == NO_BLOCK)
            continue;
        out->pts[fill[block[v]]++] = (struct align_point){p, 1.0f, ALIGN_FIELD_NONE};
        sum = vec_along(sum, 1, p);
        n++;
    }
    out->middle = vec_along((struct dvec3){0, 0, 0}, 1.0 / (n != 0 ? n : 1), sum);
    out->stride = 1 + n / ASYMMETRY_POINTS;
}

/* The robust sum over all blocks but one. */
static struct solve_sum sum_at(struct asymmetry_search *s, const struct plane *p,
                               uint32_t without)
{
    const struct pose pose = mirror(p);
    const struct dvec3 c = onto(p, s->middle);
    struct solve_sum all = {0};
    double points = 0;

    for (uint32_t b = 0; b < BLOCKS; b++) {
        const uint32_t n = s->begin[b + 1] - s->begin[b];
        struct solve_sum sum;

        if (b == without || n == 0)
            continue;
        align_field_sum(&s->field, s->pts + s->begin[b], n, s->stride, &pose, c,
                        SOLVE_LOSS_L1, &sum);
        for (int i = 0; i < 21; i++)
            all.normal.h[i] += sum.normal.h[i];
        for (int i = 0; i < 6; i++)
            all.normal.g[i] += sum.normal.g[i];
        all.cost += n * sum.cost;
        all.within += n * sum.within;
        points += n;
    }
    s->evaluations++;
    all.cost /= points > 0 ? points : 1;
    all.within /= points > 0 ? points : 1;
    return all;
}

/* The normal equations of a pose, in the three motions of the mirror image that a plane
 * has: two turns, in the places 0 and 1, and a shift, in the place 3. */
static struct solve_normal reduce(const struct solve_normal *a, const double to[3][6])
{
    static const int place[3] = {0, 1, 3};
    static const int at[3][3] = {{0, 1, 3}, {1, 6, 8}, {3, 8, 15}}; /* in h */
    struct solve_normal out = {.h = {[11] = 1, [18] = 1, [20] = 1}};
    double full[6][6];
    const double *h = a->h;

    for (int i = 0; i < 6; i++)
        for (int k = i; k < 6; k++)
            full[i][k] = full[k][i] = *h++;
    for (int p = 0; p < 3; p++) {
        for (int q = p; q < 3; q++)
            for (int i = 0; i < 6; i++)
                for (int k = 0; k < 6; k++)
                    out.h[at[p][q]] += to[p][i] * full[i][k] * to[q][k];
        for (int i = 0; i < 6; i++)
            out.g[place[p]] += to[p][i] * a->g[i];
    }
    return out;
}

/* One Gauss-Newton step.  Returns its length in mm, or 0 where it is undetermined. */
static double asymmetry_step(const struct asymmetry_search *s,
                             const struct solve_sum *sum, struct plane *p)
{
    const struct dvec3 n = p->normal, c = onto(p, s->middle);
    const struct dvec3 a = unit(vec_cross((struct dvec3){0, 0, 1}, n)),
                       b = vec_cross(n, a);
    const double to[3][6] = {{2 * a.x, 2 * a.y, 2 * a.z, 0, 0, 0},
                             {2 * b.x, 2 * b.y, 2 * b.z, 0, 0, 0},
                             {0, 0, 0, 2 * n.x, 2 * n.y, 2 * n.z}};
    const struct solve_normal normal = reduce(&sum->normal, to);
    double x[6], turn, scale = 1;

    if (!solve_equations(&normal, ASYMMETRY_DAMPING, x))
        return 0;
    turn = sqrt(x[0] * x[0] + x[1] * x[1]);
    if (turn > ASYMMETRY_MAX_TURN_RAD)
        scale = ASYMMETRY_MAX_TURN_RAD / turn;
    if (fabs(x[3]) * scale > ASYMMETRY_MAX_SHIFT_MM)
        scale = ASYMMETRY_MAX_SHIFT_MM / fabs(x[3]);
    /* a x n = -b and b x n = a */
    p->normal = unit(vec_along(vec_along(n, -scale * x[0], b), scale * x[1], a));
    p->offset = vec_dot(p->normal, c) + scale * x[3];
    return scale * (turn * POSE_LEVER_MM + fabs(x[3]));
}

/* descend(s, without, p, within): steps from *p, which becomes the cheapest plane met.
 * Returns whether a short step ended them. */
static bool descend(struct asymmetry_search *s, uint32_t without, struct plane *p,
                    double *within)
{
    struct plane at = *p;
    double cost = INFINITY;
    bool ended = false;

    for (int i = 0; i <= ASYMMETRY_STEPS; i++) {
        const struct solve_sum sum = sum_at(s, &at, without);

        if (sum.cost < cost) {
            cost = sum.cost;
            *within = sum.within;
            *p = at;
        }
        if (ended || i == ASYMMETRY_STEPS)
            break;
        ended = asymmetry_step(s, &sum, &at) < ASYMMETRY_LAST_MM;
    }
    return ended;
}

/* How much the plane depends on each part of the surface. */
static void jackknife(struct asymmetry_search *s, const struct plane *best,
                      struct surface_asymmetry *out)
{
    const struct dvec3 c = onto(best, s->middle);
    struct dvec3 sum = {0, 0, 0};
    double squares = 0, shift = 0, shifts = 0, n = 0;

    for (uint32_t b = 0; b < BLOCKS; b++) {
        struct plane p = *best;
        struct dvec3 turn;
        double within, off;

        if (s->begin[b] == s->begin[b + 1])
            continue;
        (void)descend(s, b, &p, &within);
        turn = vec_along(p.normal, -1, best->normal);
        off = p.offset - vec_dot(p.normal, c);
        sum = vec_along(sum, 1, turn);
        squares += vec_dot(turn, turn);
        shift += off;
        shifts += off * off;
        n++;
    }
    if (n < 2)
        return;
    out->turn_deg =
        VEC_DEGREES * sqrt((n - 1) / n * fmax(squares - vec_dot(sum, sum) / n, 0));
    out->shift_mm = sqrt((n - 1) / n * fmax(shifts - shift * shift / n, 0));
}

/* The motion that brings the plane to x = 0 by the smallest turn, after pose. */
static void straighten(const struct plane *p, struct dvec3 middle, struct pose *pose)
{
    const struct dvec3 c = onto(p, middle), n = p->normal;
    /* The quaternion (1, x / 2) of the turn from n to the x axis. */
    const double half = 2 / (1 + n.x);
    const double x[6] = {0, half * n.z, -half * n.y, -c.x, 0, 0};

    pose_move(pose, c, x);
}

/* search(s, w, last, out): the plane in s, which is upright. */
static enum status search_plane(const struct surface *s, struct measure_work *m,
                                bool last, struct plane *p, struct dvec3 *middle,
                                enum align_stop *stop, struct surface_asymmetry *out)
{
    const size_t pts = mem_round(s->mesh.nv * sizeof(struct align_point));
    struct asymmetry_search search = {.evaluations = out->evaluations};
    unsigned char *block = scratch_need(&m->scratch, pts + s->mesh.nv * sizeof(uint32_t));
    double within = 0;

    if (block == NULL)
        return ST_ENOMEM;
    align_field_make(s, NULL, &search.field);
    search.pts = (struct align_point *)(void *)block;
    asymmetry_load(s, (uint32_t *)(void *)(block + pts), &search);
    *stop = descend(&search, NO_BLOCK, p, &within) ? ALIGN_CONVERGED : ALIGN_STEPS;
    if (within < ALIGN_APART_WITHIN)
        *stop = ALIGN_APART;
    else if (last)
        jackknife(&search, p, out);
    out->evaluations = search.evaluations;
    *middle = search.middle;
    return ST_OK;
}

/* The plane x = 0 of the frame, in the surface's own coordinates. */
static struct plane plane_of(const struct pose *frame)
{
    /* x of r p + t is 0. */
    return (struct plane){{frame->r[0], frame->r[1], frame->r[2]}, -frame->t[0]};
}

static void asymmetry_tell(const struct pose *start, const struct pose *frame,
                           const struct surface *s, struct surface_asymmetry *out)
{
    const struct plane from = plane_of(start), to = plane_of(frame);
    const struct dvec3 turn = vec_cross(from.normal, to.normal);
    const struct dvec3 c = onto(&from, pose_centre(&s->mesh));

    out->normal[0] = to.normal.x;
    out->normal[1] = to.normal.y;
    out->normal[2] = to.normal.z;
    out->offset_mm = to.offset;
    out->moved_deg =
        series_degrees(sqrt(vec_dot(turn, turn)), vec_dot(from.normal, to.normal));
    out->moved_mm = fabs(to.offset - vec_dot(to.normal, c));
}

enum status asymmetry_find(const struct surface *s, const struct pose *start,
                           const struct disparity_weight *u, struct measure_work *m,
                           struct surface *upright, struct surface_asymmetry *out)
{
    static const double flip[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct pose frame = *start;
    struct disparity first = {0}, last = {0};
    enum align_stop stop = ALIGN_APART;
    double transform[16];
    enum status st = ST_OK;

    memset(out, 0, sizeof *out);
    out->turn_deg = out->shift_mm = INFINITY;
    for (int round = 0; round <= ASYMMETRY_ROUNDS; round++) {
        struct plane p = {{1, 0, 0}, 0};
        struct dvec3 middle;

        pose_to_matrix(&frame, transform);
        st = surface_move(s, transform, &m->points, &m->scratch, upright);
        if (st != ST_OK)
            break;
        if (round == 0 &&
            (st = measure_at(upright, upright, flip, NULL, m, &first)) != ST_OK)
            break;
        if (round == ASYMMETRY_ROUNDS) {
            st = measure_at(upright, upright, flip, u, m, &last);
            break;
        }
        st = search_plane(upright, m, round + 1 == ASYMMETRY_ROUNDS, &p, &middle, &stop,
                          out);
        if (st != ST_OK)
            break;
        straighten(&p, middle, &frame);
    }
    asymmetry_tell(start, &frame, s, out);
    out->conclusive = stop != ALIGN_APART && last.overlap >= ASYMMETRY_MIN_OVERLAP;
    out->disparity_mm = last.plain_mm;
    out->first_mm = first.plain_mm;
    out->weighted_mm = last.weighted_mm;
    out->volume_mm3 = last.volume_mm3;
    out->area_mm2 = last.area_mm2;
    out->overlap = last.overlap;
    out->stop = align_stop_name(stop);
    return st == ST_ENOMEM ? st : ST_OK;
}
