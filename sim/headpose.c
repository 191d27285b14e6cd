#include "headpose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "head.h"
#include "headview.h"
#include "lattice.h"
#include "mem.h"

#define BALL                                                                             \
    45.0 /* within it the points' mean lies behind a nose's tip by a third of it */
#define NOSES 24
#define ROLLS 12
#define TILTS 3    /* down, not, up */
#define LOOK  4000 /* points of the head in which noses are looked for */

struct nose {
    struct dvec3 tip, axis; /* axis: outwards, of length `sharp` */
    double sharp;
};

/* Each point's distance from the mean of those round it; the sharpest are tips of noses, or
 * ears, or chins.  n points in random order; returns how many were found. */
static size_t find_noses(const struct dvec3 *p, size_t n, struct nose *best)
{
    struct nose *all = head_alloc(n, sizeof *all);
    size_t found = 0;

    for (size_t i = 0; i < n; i++) {
        struct dvec3 sum = {0, 0, 0};
        double k = 0;

        for (size_t j = 0; j < n; j++) {
            const struct dvec3 d = vec_sub(p[j], p[i]);

            if (vec_dot(d, d) < BALL * BALL) {
                sum = vec_along(sum, 1, d);
                k++;
            }
        }
        all[i].tip = p[i];
        all[i].axis = (struct dvec3){-sum.x / k, -sum.y / k, -sum.z / k};
        all[i].sharp = sqrt(vec_dot(all[i].axis, all[i].axis));
    }
    while (found < NOSES) {
        size_t top = 0;

        for (size_t i = 1; i < n; i++)
            if (all[i].sharp > all[top].sharp)
                top = i;
        if (all[top].sharp <= 0)
            break;
        best[found++] = all[top];
        for (size_t i = 0; i < n; i++) { /* one of a place */
            const struct dvec3 d = vec_sub(all[i].tip, best[found - 1].tip);

            if (vec_dot(d, d) < 12 * 12)
                all[i].sharp = 0;
        }
    }
    free(all);
    return found;
}

/* A frame whose z is this axis, tilted about its x by `tilt`, then turned about z by `roll`;
 * the tip becomes the origin. */
static void stand(const struct nose *o, double tilt, double roll, double to[16])
{
    const struct dvec3 a = {o->axis.x / o->sharp, o->axis.y / o->sharp,
                            o->axis.z / o->sharp};
    const struct dvec3 any =
        fabs(a.x) < 0.7 ? (struct dvec3){1, 0, 0} : (struct dvec3){0, 1, 0};
    struct dvec3 u = vec_cross(any, a), v, row[3];
    const double size = sqrt(vec_dot(u, u));

    u = (struct dvec3){u.x / size, u.y / size, u.z / size};
    v = vec_cross(a, u);
    row[0] = vec_along((struct dvec3){cos(roll) * u.x, cos(roll) * u.y, cos(roll) * u.z},
                       sin(roll), v);
    row[1] = vec_cross(a, row[0]);
    row[2] = vec_along((struct dvec3){cos(tilt) * a.x, cos(tilt) * a.y, cos(tilt) * a.z},
                       sin(tilt), row[1]);
    row[1] = vec_cross(row[2], row[0]);
    for (int i = 0; i < 3; i++) {
        to[4 * i] = row[i].x;
        to[4 * i + 1] = row[i].y;
        to[4 * i + 2] = row[i].z;
        to[4 * i + 3] = -vec_dot(row[i], o->tip);
    }
    to[12] = to[13] = to[14] = 0;
    to[15] = 1;
}

/* What a scanner in front of that pose sees of a face; out: room for the head's points. */
static size_t crop(const struct head *h, const double to[16], struct dvec3 *out)
{
    struct head near = {.spacing = h->spacing};
    struct headview v;
    size_t n = 0;

    for (size_t i = 0; i < h->n; i++) {
        const struct dvec3 q = vec_transform(to, h->at[i]);

        if (fabs(q.x) < 66 && q.y > -82 && q.y < 80 && q.z > -75)
            head_add(&near, q, HEAD_SKIN);
    }
    if (near.n < SURFACE_MIN_POINTS) {
        head_free(&near);
        return 0;
    }
    headview_make(&near, false, &v);
    for (size_t i = 0; i < near.n; i++)
        if (v.seen[i])
            out[n++] = near.at[i];
    headview_free(&v);
    head_free(&near);
    return n;
}

struct search {
    const struct head *head;
    const struct frame_mean *mean;
    struct dvec3 *room;    /* for the head's points */
    struct ivec3 *lattice; /* likewise */
    struct surface surface;
    struct scratch scratch;
    struct align_work align;
};

/* frame_likeness_heights() of the surface's points, moved by pose. */
static double likeness(const struct search *s, const struct pose *pose)
{
    double z[GRID_N] = {0}, n[GRID_N] = {0};
    const struct mesh *m = &s->surface.mesh;

    for (uint32_t v = 0; v < m->nv; v++) {
        const struct dvec3 q = pose_apply(
            pose, (struct dvec3){m->xy[v].x / LATTICE_PER_MM, m->xy[v].y / LATTICE_PER_MM,
                                 m->z[v] / LATTICE_PER_MM});
        const uint32_t i = grid_cell(q.x, q.y);

        if (i == GRID_NONE)
            continue;
        z[i] += q.z;
        n[i] += 1;
    }
    return frame_likeness_heights(s->mean, z, n);
}

/* How good the face is that is seen from there; afterwards `to` is its canonical frame. */
static double try(struct search *s, double to[16])
{
    const size_t n = crop(s->head, to, s->room);
    struct frame f;
    double m[16], all[16], like;

    if (n < SURFACE_MIN_POINTS ||
        lattice_from_mm(s->room, n, LATTICE_PER_MM, s->lattice, NULL) != ST_OK ||
        surface_prepare(s->lattice, n, true, &s->scratch, &s->surface) != ST_OK ||
        frame_find(s->mean, &s->surface, &s->align, &f) != ST_OK ||
        !((like = likeness(s, &f.pose)) > 0))
        return -INFINITY;
    pose_to_matrix(&f.pose, m);
    for (int i = 0; i < 16; i++)
        all[i] = m[i / 4 * 4] * to[i % 4] + m[i / 4 * 4 + 1] * to[4 + i % 4] +
                 m[i / 4 * 4 + 2] * to[8 + i % 4] + m[i / 4 * 4 + 3] * to[12 + i % 4];
    memcpy(to, all, sizeof all);
    return like - 0.2 * f.cost_mm;
}

static struct head some(const struct dvec3 *p, size_t n, size_t most)
{
    struct head h = {0};

    for (size_t i = 0; i < n && i < most; i++)
        head_add(&h, p[i * (n / (n < most ? n : most))], HEAD_SKIN);
    head_measure(&h);
    return h;
}

static bool find_in_crop(const struct dvec3 *p, size_t n, struct surface_work *w,
                         double to[16])
{
    struct surface_face f = {0};
    const bool ok = face_build(p, n, w, &f, NULL) == ST_OK;

    if (ok)
        pose_to_matrix(&f.frame.pose, to);
    face_free(&f);
    return ok;
}

bool headpose_find(const struct dvec3 *p, size_t n, bool is_crop, struct surface_work *w,
                   double to[16])
{
    struct search s = {.mean = face_work_mean(w)};
    struct nose nose[NOSES];
    struct head few;
    double best = -INFINITY, pose[16];
    size_t noses;

    if (is_crop)
        return find_in_crop(p, n, w, to);
    few = some(p, n, 15000);
    s.head = &few;
    s.room = head_alloc(few.n, sizeof *s.room);
    s.lattice = head_alloc(few.n, sizeof *s.lattice);
    noses = find_noses(few.at, few.n < LOOK ? few.n : LOOK, nose);
    for (size_t k = 0; k < noses * ROLLS * TILTS; k++) {
        double key;

        stand(&nose[k / (ROLLS * TILTS)], 0.4 * ((double)(k % TILTS) - 1),
              6.2832 * (double)(k / TILTS % ROLLS) / ROLLS, pose);
        key = try(&s, pose);
        if (key > best) {
            best = key;
            memcpy(to, pose, sizeof pose);
        }
    }
    for (int k = 0; k < 3; k++)
        (void)try(&s, to);
    head_free(&few);
    free(s.room);
    free(s.lattice);
    surface_free(&s.surface);
    scratch_free(&s.scratch);
    align_work_free(&s.align);
    return best > 0;
}
