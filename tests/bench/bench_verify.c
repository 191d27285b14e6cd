/* bench_verify.c -- one verification and its parts: loading the template, alignment from 8
 * degrees and 10 mm, the whole from bytes and points to the decision; memory of a comparison. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "align.h"
#include "align_field.h"
#include "align_pose.h"
#include "clouds.h"
#include "codec.h"
#include "face.h"
#include "facegen.h"
#include "fit.h"
#include "frame.h"
#include "lattice.h"
#include "measure.h"
#include "mem.h"
#include "model.h"
#include "peers.h"
#include "timing.h"

#define PAIRS  48
#define POINTS 3000
#define ROUNDS 11

enum row {
    LOAD,
    PREPARE, /* the probe: points to model */
    SEARCH,
    COMPARE, /* search, exact measure and score */
    STORED,  /* bytes of the template, points of the probe, to the decision */
    RAW,     /* points of both */
    PEER_ONE,
    ROWS
};

struct pair {
    struct dvec3 *tmpl_pts, *probe_pts;
    size_t n_tmpl, n_probe, blob_size;
    struct face tmpl, probe;
    unsigned char *blob;
    double moved[16]; /* the motion of the probe */
    void *points;     /* the template's, for the peer */
};

static const struct peers *peers;
static struct timing row[ROWS], search_error, final_error;
static struct scratch scratch;
static struct align_work search;
static struct frame_mean mean;
static struct fit_basis motion;
static struct face_work *work;
static struct face stored, fresh, fresh2;
static unsigned matches;

static void must(enum status st)
{
    if (st == ST_OK)
        return;
    fprintf(stderr, "bench: %s\n", status_message(st));
    exit(1);
}

static void pair_make(struct pair *p, uint64_t k)
{
    struct ivec3 *pts = timing_alloc(POINTS, sizeof *pts);

    p->tmpl_pts = timing_alloc(POINTS, sizeof *p->tmpl_pts);
    p->probe_pts = timing_alloc(POINTS, sizeof *p->probe_pts);
    p->n_tmpl = clouds_scan(k, 2 * k, POINTS, p->tmpl_pts);
    p->n_probe = clouds_scan(k, 2 * k + 1, POINTS, p->probe_pts);
    clouds_move(p->probe_pts, p->n_probe, k, 8, 10, p->moved);
    must(face_build(p->tmpl_pts, p->n_tmpl, work, &p->tmpl, NULL));
    must(face_build(p->probe_pts, p->n_probe, work, &p->probe, NULL));
    p->blob_size = codec_size(&p->tmpl.surface.mesh);
    p->blob = timing_alloc(p->blob_size, 1);
    codec_encode(&p->tmpl, p->blob);
    must(lattice_from_mm(p->tmpl_pts, p->n_tmpl, LATTICE_PER_MM, pts, NULL));
    if (peers != NULL)
        p->points = peers->points(pts, p->n_tmpl);
    free(pts);
}

static double lap(enum row r, double since)
{
    const double now = timing_now_ms();

    timing_add(&row[r], now - since);
    return now;
}

/* Root mean square distance, over the probe's points, of the pose found from the inverse of
 * the motion. */
static double pose_error(const struct pair *p, const double *t)
{
    double sum = 0;

    for (size_t i = 0; i < p->n_probe; i++) {
        const struct dvec3 q =
            p->probe_pts[i]; /* moved; m^T (q - shift) is where it was */
        const double *m = p->moved;
        const double d[3] = {q.x - m[3], q.y - m[7], q.z - m[11]};

        for (int r = 0; r < 3; r++) {
            const double was = m[r] * d[0] + m[4 + r] * d[1] + m[8 + r] * d[2];
            const double now =
                t[4 * r] * q.x + t[4 * r + 1] * q.y + t[4 * r + 2] * q.z + t[4 * r + 3];

            sum += (now - was) * (now - was);
        }
    }
    return sqrt(sum / (double)p->n_probe);
}

static void pass(struct pair *p)
{
    const struct align_pose first =
        align_pose_after(&p->tmpl.frame.pose, &p->probe.frame.pose);
    const struct align_weight u = {mean.rigid, p->tmpl.frame.pose};
    const struct align_how how = {.start = &first, .u = &u, .motion = &motion};
    struct align_result found;
    struct face_result r;
    double t = timing_now_ms();

    must(codec_decode(p->blob, p->blob_size, work, &stored, NULL));
    t = lap(LOAD, t);
    must(face_build(p->probe_pts, p->n_probe, work, &fresh, NULL));
    t = lap(PREPARE, t);
    must(align_search(&p->tmpl.surface, &p->probe.surface, &how, &search, &found));
    t = lap(SEARCH, t);
    must(face_compare(&p->tmpl, &p->probe, 0, NULL, work, &r));
    (void)lap(COMPARE, t);
    timing_add(&search_error, pose_error(p, found.transform));
    timing_add(&final_error, pose_error(p, r.align.transform));
    matches += r.decision == FACE_MATCH;

    t = timing_now_ms();
    must(codec_decode(p->blob, p->blob_size, work, &stored, NULL));
    must(face_build(p->probe_pts, p->n_probe, work, &fresh, NULL));
    must(face_compare(&stored, &fresh, 0, NULL, work, &r));
    t = lap(STORED, t);
    must(face_build(p->tmpl_pts, p->n_tmpl, work, &fresh2, NULL));
    must(face_build(p->probe_pts, p->n_probe, work, &fresh, NULL));
    must(face_compare(&fresh2, &fresh, 0, NULL, work, &r));
    t = lap(RAW, t);
    if (peers != NULL) {
        void *dt = peers->triangulate(p->points);

        (void)lap(PEER_ONE, t);
        peers->triangulation_free(dt);
    }
}

static void line(const char *what, enum row r)
{
    const double ms = timing_median(&row[r]), one = timing_median(&row[PEER_ONE]);

    printf("  %-56s %9.3f", what, ms);
    if (!isnan(one))
        printf(" %9.2f", ms / one);
    putchar('\n');
}

static void report(void)
{
    const double one = timing_median(&row[PEER_ONE]);

    printf("\nVerification, 3,000 against 3,000 points, 8 degrees and 10 mm off\n");
    printf("  %-56s %9s %9s\n", "", "ms", "units");
    line("template load: bytes to validated model", LOAD);
    line("probe: points to model", PREPARE);
    line("alignment, search", SEARCH);
    line("comparison: search, exact measure, score", COMPARE);
    line("whole, template stored", STORED);
    line("whole, both from points", RAW);
    printf("  template stored: %.2f of the time from both clouds; %zu bytes a point\n",
           timing_median(&row[STORED]) / timing_median(&row[RAW]),
           stored.surface.mesh.nv == 0
               ? (size_t)0
               : codec_size(&stored.surface.mesh) / stored.surface.mesh.nv);
    printf("  pose error, median: %.3f mm after the search, %.3f mm at the end\n",
           timing_median(&search_error), timing_median(&final_error));
    printf("  matched: %u of %zu\n", matches, row[COMPARE].n);

    timing_target("template load", timing_median(&row[LOAD]) / one, 0.1, "units");
    timing_target("alignment from 8 degrees + 10 mm, search",
                  timing_median(&row[SEARCH]) / one, 2.5, "units");
    timing_target("  the same with the exact measure and the score",
                  timing_median(&row[COMPARE]) / one, 4, "units");
}

/* The pose error of scans with white noise alone: the smooth errors of two scans are a
 * difference of shape, which no pose can remove. */
static void white_noise_only(void)
{
    struct timing error = {0};
    struct pair p = {.tmpl_pts = timing_alloc(POINTS, sizeof *p.tmpl_pts),
                     .probe_pts = timing_alloc(POINTS, sizeof *p.probe_pts)};

    for (uint64_t k = 0; k < PAIRS; k++) {
        struct facegen_scan s;
        struct face_result r;

        facegen_default(&s);
        s.warp = 0;
        s.subject = k;
        s.scan = 2 * k;
        p.n_tmpl = facegen_sample(&s, p.tmpl_pts);
        s.scan++;
        p.n_probe = facegen_sample(&s, p.probe_pts);
        clouds_move(p.probe_pts, p.n_probe, k, 8, 10, p.moved);
        must(face_build(p.tmpl_pts, p.n_tmpl, work, &fresh, NULL));
        must(face_build(p.probe_pts, p.n_probe, work, &fresh2, NULL));
        must(face_compare(&fresh, &fresh2, 0, NULL, work, &r));
        timing_add(&error, pose_error(&p, r.align.transform));
    }
    printf("  pose error, median, scans with white noise alone: %.3f mm\n",
           timing_median(&error));
    timing_free(&error);
    free(p.tmpl_pts);
    free(p.probe_pts);
}

/* Everything a comparison allocates in the steady state: both faces and the worker's memory. */
static void memory(const struct pair *p)
{
    const double before = timing_bytes();
    struct face_work *w = face_work_new(NULL);
    struct face a = {0}, b = {0};
    struct face_result r;
    double bytes;

    if (w == NULL)
        must(ST_ENOMEM);
    must(codec_decode(p->blob, p->blob_size, w, &a, NULL));
    must(face_build(p->probe_pts, p->n_probe, w, &b, NULL));
    must(face_compare(&a, &b, 0, NULL, w, &r));
    bytes = timing_bytes() - before;
    printf("\nMemory: working set of a comparison: %.2f MB\n", bytes / 1e6);
    timing_target("memory, working set of a comparison", bytes / 1e6, 2, "MB");
    face_free(&a);
    face_free(&b);
    face_work_free(w);
}

int main(void)
{
    static struct pair pair[PAIRS];

    peers = timing_peers();
    if ((work = face_work_new(NULL)) == NULL)
        must(ST_ENOMEM);
    must(frame_mean_make(&model_default, &scratch, &mean));
    fit_prepare(&model_default.motion, &motion);
    for (size_t k = 0; k < PAIRS; k++)
        pair_make(&pair[k], k);
    for (size_t k = 0; k < PAIRS; k++) /* warm-up: memory grown */
        pass(&pair[k]);
    for (size_t r = 0; r < ROWS; r++)
        row[r].n = 0;
    search_error.n = final_error.n = matches = 0;
    for (int round = 0; round < ROUNDS; round++)
        for (size_t k = 0; k < PAIRS; k++)
            pass(&pair[k]);
    report();
    white_noise_only();
    memory(&pair[0]);
    return 0;
}
