/* faces.c -- the disparity-measure paper's figures 10 and 11: two faces before and
 * after alignment, and the least disparity over all poses.  The seed is the person. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "facegen.h"
#include "holes.h"
#include "study.h"
#include "lattice.h"
#include "measure.h"
#include "minimal.h"
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
static void scan(uint64_t subject, uint64_t which, bool moved, struct surface_work *w,
                 struct surface_face *out)
{
    struct facegen_scan s;
    struct dvec3 *pts;

    facegen_default(&s);
    s.subject = subject;
    s.scan = which;
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

static void faces_figures(const struct study *study, struct surface_work *w)
{
    static const struct {
        const char *name, *what;
    } row[] = {{"person", "the same person again"}, {"other", "another person"}};
    static const char *const pose_name[] = {"as scanned", "after alignment",
                                            "at the true pose", "at the minimum"};
    FILE *f = study_open(study, "alignment.csv");
    struct surface_face a = {0}, b = {0};
    struct measure_work m = {0};

    fprintf(f, "pair,pose,volume mm3,common area mm2,mean gap mm,"
               "share of the template\n");
    fprintf(f, "printed in the paper,figure 10: as they were,234254,,,\n");
    fprintf(f, "printed in the paper,figure 11: after alignment,120238.8,,,\n");
    scan(study->seed, 0, false, w, &a);
    study_triangles(study, "template.dat", &a.surface.mesh, LATTICE_PER_MM);
    for (uint64_t k = 0; k < 2; k++) {
        struct align_result found;
        struct minimal least;
        double truth[16];

        scan(study->seed + k, 1, true, w, &b);
        study_must(face_align(&a, &b, w, &found));
        study_must(minimal_find(&a.surface, &b.surface, found.transform, &m, &least));
        true_pose(truth);
        for (int i = 0; i < 4; i++) {
            const double *pose[] = {identity, found.transform, truth, least.transform};
            struct disparity d;
            char name[64];

            study_must(measure_at(&a.surface, &b.surface, pose[i], NULL, &m, &d));
            fprintf(f, "%s,%s,%.1f,%.1f,%.3f,%.3f\n", row[k].what, pose_name[i],
                    d.volume_mm3, d.area_mm2, d.plain_mm, d.overlap);
            if (i >= 2)
                continue;
            (void)snprintf(name, sizeof name, "%s-%s.dat", row[k].name,
                           i == 1 ? "after" : "before");
            study_triangles(study, name, &m.moved.mesh, LATTICE_PER_MM);
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

void faces_run(const struct study *study)
{
    struct surface_work *w = surface_work_new(NULL);

    study_must(w != NULL ? ST_OK : ST_ENOMEM);
    faces_figures(study, w);
    surface_work_free(w);
}
