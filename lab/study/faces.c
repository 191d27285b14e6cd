/* faces.c -- the disparity-measure paper's figures 10 and 11: two faces before and
 * after alignment; and what the weight u(x, y) of its definition (1) does. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "facegen.h"
#include "holes.h"
#include "study.h"
#include "lattice.h"
#include "measure.h"
#include "picture.h"
#include "study.h"
#include "locate.h"

static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/* How the second scan of a pair is turned (degrees) and shifted (mm), by facegen's rule:
 * about y, then about x, round a centre 80 mm behind the nose. */
#define YAW    4.0
#define PITCH  (-3.0)
#define SHIFT  3.0 /* along x */
#define NEARER 4.0 /* along z */
#define CENTRE (-80.0)

/* What undoes it. */
static void true_pose(double t[16])
{
    const double rad = acos(-1.0) / 180;
    const double cy = cos(YAW * rad), sy = sin(YAW * rad);
    const double cx = cos(PITCH * rad), sx = sin(PITCH * rad);
    const double r[3][3] = {
        {cy, 0, sy}, {sx * sy, cx, -sx * cy}, {-cx * sy, sx, cx * cy}};
    const double from[3] = {SHIFT, 0, NEARER + CENTRE};

    memcpy(t, identity, sizeof identity);
    for (int i = 0; i < 3; i++) {
        t[4 * i + 3] = i == 2 ? CENTRE : 0;
        for (int j = 0; j < 3; j++) {
            t[4 * i + j] = r[j][i];
            t[4 * i + 3] -= r[j][i] * from[j];
        }
    }
}

/* A scan of a subject; moved: as the second of a pair, turned and shifted a little. */
static void scan(uint64_t subject, uint64_t which, double smile, bool moved,
                 struct surface_work *w, struct surface_face *out)
{
    struct facegen_scan s;
    struct dvec3 *pts;

    facegen_default(&s);
    s.subject = subject;
    s.scan = which;
    s.smile = smile;
    if (moved) {
        s.yaw = YAW;
        s.pitch = PITCH;
        s.tx = SHIFT;
        s.tz = NEARER;
    }
    pts = study_alloc(s.points, sizeof *pts);
    study_must(face_build(pts, facegen_sample(&s, pts), w, out, NULL));
    free(pts);
}

/* The signed gap on a grid of 1 mm where both surfaces have something measured. */
static void gap_map(const struct study *study, const char *name,
                    const struct surface_face *tmpl, const struct measure_work *m)
{
    const struct mesh *t = &tmpl->surface.mesh, *p = &m->moved.mesh;
    struct location at = {t->out[0], 0}, on = {p->out[0], 0};
    FILE *f = study_open(study, name);

    while (mesh_is_ghost(t, at.he / 3))
        at.he = mesh_turn(t, at.he);
    while (mesh_is_ghost(p, on.he / 3))
        on.he = mesh_turn(p, on.he);
    for (int y = -90; y <= 90; y++) {
        for (int x = -75; x <= 75; x++) {
            const struct ivec2 q = {1000 * x, 1000 * y};
            bool both;

            at = locate_point(t, at.he, t->xy[t->org[at.he]], q, NULL);
            on = locate_point(p, on.he, p->xy[p->org[on.he]], q, NULL);
            both = at.where != LOCATE_OUTSIDE && on.where != LOCATE_OUTSIDE &&
                   holes_measured(t, tmpl->surface.bridge, at) &&
                   holes_measured(p, m->moved.bridge, on);
            fprintf(f, "%d %d %.3f\n", x, y,
                    both ? (locate_height(p, on, q) - locate_height(t, at, q)) /
                               LATTICE_PER_MM
                         : (double)NAN);
        }
        fprintf(f, "\n");
    }
    study_close(f);
}

static void both_faces(const struct study *study, const char *name, const struct mesh *a,
                       const struct mesh *b)
{
    struct picture r = {
        .wide = 330, .high = 380, .per = 2, .z = -20, .turn = 0.6, .tilt = 0.1};
    FILE *f = study_open(study, name);

    picture_begin(&r);
    picture_mesh(&r, a, NULL, LATTICE_PER_MM, 1, 0, 0x70a8e8);
    if (b != NULL)
        picture_mesh(&r, b, NULL, LATTICE_PER_MM, 1, 0, 0xf0a840);
    picture_end(&r, f);
    study_close(f);
}

static void figures(const struct study *study, struct surface_work *w)
{
    static const struct {
        const char *name, *what;
        uint64_t subject;
    } row[] = {{"person", "the same person again", 1}, {"other", "another person", 2}};
    static const char *const pose_name[] = {"as scanned", "after alignment",
                                            "at the true pose"};
    FILE *f = study_open(study, "alignment.csv");
    struct surface_face a = {0}, b = {0};
    struct measure_work m = {0};

    fprintf(f, "pair,pose,volume mm3,common area mm2,mean gap mm,"
               "share of the template\n");
    fprintf(f, "printed in the paper,figure 10: as they were,234254,,,\n");
    fprintf(f, "printed in the paper,figure 11: after alignment,120238.8,,,\n");
    scan(1, 0, 0, false, w, &a);
    both_faces(study, "template.dat", &a.surface.mesh, NULL);
    for (int k = 0; k < 2; k++) {
        struct face_result found;
        double truth[16];

        scan(row[k].subject, 1, 0, true, w, &b);
        study_must(face_align(&a, &b, NULL, w, &found));
        true_pose(truth);
        for (int i = 0; i < 3; i++) {
            const double *pose[] = {identity, found.align.transform, truth};
            struct disparity d;
            char name[64];

            study_must(measure_at(&a.surface, &b.surface, pose[i], NULL, &m, &d));
            fprintf(f, "%s,%s,%.1f,%.1f,%.3f,%.3f\n", row[k].what, pose_name[i],
                    d.volume_mm3, d.area_mm2, d.plain_mm, d.overlap);
            if (i == 2)
                continue;
            (void)snprintf(name, sizeof name, "%s-%s.dat", row[k].name,
                           i == 1 ? "after" : "before");
            both_faces(study, name, &a.surface.mesh, &m.moved.mesh);
            (void)snprintf(name, sizeof name, "%s-%s-gap.dat", row[k].name,
                           i == 1 ? "after" : "before");
            gap_map(study, name, &a, &m);
        }
    }
    study_close(f);
    face_free(&a);
    face_free(&b);
    measure_work_free(&m);
}

/* ---- the weight: examples, in the template's coordinates (nose tip near the origin) */

static float one(const void *arg, double x, double y, double z)
{
    (void)arg, (void)x, (void)y, (void)z;
    return 1;
}

static float seven(const void *arg, double x, double y, double z)
{
    return 7 * one(arg, x, y, z);
}

static float nose(const void *arg, double x, double y, double z)
{
    const double u = x / LATTICE_PER_MM / 18, v = (y / LATTICE_PER_MM - 15) / 30;

    (void)arg, (void)z;
    return (float)exp(-(u * u + v * v) / 2);
}

static float upper(const void *arg, double x, double y, double z)
{
    (void)arg, (void)x, (void)z;
    return y > -8 * LATTICE_PER_MM ? 1 : 0.02F;
}

static float lower(const void *arg, double x, double y, double z)
{
    (void)arg, (void)x, (void)z;
    return y > -8 * LATTICE_PER_MM ? 0.02F : 1;
}

static float left(const void *arg, double x, double y, double z)
{
    (void)arg, (void)y, (void)z;
    return x < 0 ? 1 : 0;
}

/* The mean weighted gap of mated comparisons, neutral and smiling, and of non-mated ones. */
static void weights(const struct study *study, struct surface_work *w)
{
    static const struct {
        const char *name;
        float (*at)(const void *arg, double x, double y, double z);
    } u[] = {
        {"u = 1", one},
        {"u = 7: the same mean; the volume times 7", seven},
        {"nose: a Gaussian round the bridge", nose},
        {"upper face: 1 above the upper lip; 0.02 below", upper},
        {"lower face: the reverse", lower},
        {"left half alone", left},
    };
    enum { KINDS = 3, U = sizeof u / sizeof u[0] };
    const size_t people = study->reduced ? 4 : 60;
    double *mm[U][KINDS];
    FILE *f = study_open(study, "weights.csv");
    struct surface_face a = {0}, b = {0};
    struct measure_work m = {0};

    for (int i = 0; i < U; i++)
        for (int k = 0; k < KINDS; k++)
            mm[i][k] = study_alloc(people, sizeof(double));
    for (size_t s = 0; s < people; s++) {
        scan(s, 0, 0, false, w, &a);
        for (int k = 0; k < KINDS; k++) { /* neutral, smiling, non-mated */
            struct face_result found;

            scan(k < 2 ? s : (s + 1) % people, 1, k == 1 ? 1 : 0, true, w, &b);
            study_must(face_align(&a, &b, NULL, w, &found));
            for (int i = 0; i < U; i++) {
                const struct disparity_weight weight = {u[i].at, NULL};
                struct disparity d;

                study_must(measure_at(&a.surface, &b.surface, found.align.transform,
                                      &weight, &m, &d));
                mm[i][k][s] = d.weighted_mm;
            }
        }
    }
    fprintf(f, "weight,mated: mean mm,mated with a smile: mean mm,95 %% of these below,"
               "non-mated: mean mm,95 %% of these above,"
               "smile mean / non-mated mean\n");
    for (int i = 0; i < U; i++) {
        const struct study_spread n = study_spread(mm[i][0], people);
        const struct study_spread s = study_spread(mm[i][1], people);
        const struct study_spread o = study_spread(mm[i][2], people);

        fprintf(f, "%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.2f\n", u[i].name, n.mean, s.mean,
                s.high, o.mean, o.low, s.mean / o.mean);
    }
    study_close(f);
    for (int i = 0; i < U; i++)
        for (int k = 0; k < KINDS; k++)
            free(mm[i][k]);
    face_free(&a);
    face_free(&b);
    measure_work_free(&m);
}

void faces_run(const struct study *study)
{
    struct surface_work *w = surface_work_new(NULL);

    if (w == NULL) {
        study_must(ST_ENOMEM);
    } else {
        figures(study, w);
        weights(study, w);
    }
    surface_work_free(w);
}
