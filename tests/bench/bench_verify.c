/* bench_verify.c -- one verification and its parts: loading the template, the probe's model,
 * finding the pose from 8 degrees and 10 mm off, the decision from bytes and points; dense
 * scans; memory of a comparison. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "align.h"
#include "align_field.h"
#include "place.h"
#include "pose.h"
#include "clouds.h"
#include "cloudpoints.h"
#include "codec.h"
#include "face.h"
#include "facegen.h"
#include "fit.h"
#include "frame.h"
#include "lattice.h"
#include "measure.h"
#include "mem.h"
#include "minimal.h"
#include "model.h"
#include "peers.h"
#include "scan.h"
#include "timing.h"

#define PAIRS  48
#define POINTS 3000
#define ROUNDS 11
#define LARGER 1.16

#define DENSE  50000
#define DENSES 4

enum row {
    LOAD,
    PROBE, /* points to model */
    FRAME, /* one face's canonical frame, where the search starts */
    SEARCH,
    COMPARE,
    DECIDE,  /* bytes of the template, points of the probe, to the decision */
    SIZES,   /* the same where the template was taken for another head's size */
    MINIMAL, /* the same, and to the minimal disparity */
    RAW,     /* the decision from the points of both */
    PEER_ONE,
    ROWS
};

struct pair {
    struct dvec3 *tmpl_pts, *probe_pts;
    size_t n_tmpl, n_probe, blob_size;
    struct surface_face tmpl, probe;
    unsigned char *blob, *larger; /* the template, and as a larger head */
    double moved[16];             /* the motion of the probe */
    double score, larger_score;
    void *points; /* the template's, for the peer */
};

static const struct peers *peers;
static struct timing row[ROWS];
static struct align_work search;
static struct frame_mean mean;
static struct fit_basis motion;
static struct surface_work *work;
static struct surface_face stored, fresh, fresh2;

/* The template as if it had been taken for a head so large. */
static void larger_make(struct pair *p)
{
    struct surface_face f = p->tmpl;
    struct surface_comparison r;
    struct shape_fit fit;

    timing_must(place_at(&p->tmpl, LARGER, work, &fit));
    f.frame.pose = fit.pose;
    place_keep(&fit, &f.frame);
    timing_must(place_encode(&p->tmpl, &fit, work, &f.encoding));
    p->larger = timing_alloc(p->blob_size, 1);
    surface_encode(&f, p->larger);
    timing_must(status_from(surface_compare(work, &f, &p->probe, &r)));
    p->larger_score = r.score;
}

static void pair_make(struct pair *p, uint64_t k, size_t n)
{
    struct ivec3 *pts = timing_alloc(n, sizeof *pts);

    p->tmpl_pts = timing_alloc(n, sizeof *p->tmpl_pts);
    p->probe_pts = timing_alloc(n, sizeof *p->probe_pts);
    p->n_tmpl = clouds_scan(k, 2 * k, n, p->tmpl_pts);
    p->n_probe = clouds_scan(k, 2 * k + 1, n, p->probe_pts);
    clouds_move(p->probe_pts, p->n_probe, k, 8, 10, p->moved);
    timing_must(face_build(p->tmpl_pts, p->n_tmpl, work, &p->tmpl, NULL));
    timing_must(face_build(p->probe_pts, p->n_probe, work, &p->probe, NULL));
    p->blob_size = surface_encoded_size(&p->tmpl);
    p->blob = timing_alloc(p->blob_size, 1);
    surface_encode(&p->tmpl, p->blob);
    larger_make(p);
    timing_must(lattice_from_mm(p->tmpl_pts, p->n_tmpl, LATTICE_PER_MM, pts, NULL));
    if (peers != NULL)
        p->points = peers->points(pts, p->n_tmpl);
    free(pts);
}

static void pair_free(struct pair *p)
{
    free(p->tmpl_pts);
    free(p->probe_pts);
    free(p->blob);
    free(p->larger);
    face_free(&p->tmpl);
    face_free(&p->probe);
    if (p->points != NULL)
        peers->points_free(p->points);
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

/* The search as surface_compare() starts it: from the frames of both faces. */
static void find_pose(const struct surface_face *tmpl, const struct surface_face *probe,
                      struct align_result *out)
{
    const struct pose first = pose_after(&tmpl->frame.pose, &probe->frame.pose);
    const struct align_weight u = {mean.rigid, tmpl->frame.pose};
    const struct align_how how = {.start = &first, .u = &u, .motion = &motion};

    timing_must(align_search(&tmpl->surface, &probe->surface, &how, &search, out));
}

/* Every way to a pair's score must give the same digits. */
static void same_score(double want, const struct surface_comparison *r)
{
    if (r->score == want)
        return;
    fprintf(stderr, "bench: scores of one pair differ: %.17g, %.17g\n", want, r->score);
    exit(1);
}

/* With a stored template; out: the minimal disparity too, unless NULL. */
static void decide(const struct pair *p, struct surface_disparity *out)
{
    struct surface_comparison r;

    timing_must(codec_decode(p->blob, p->blob_size, work, &stored));
    timing_must(face_build(p->probe_pts, p->n_probe, work, &fresh, NULL));
    timing_must(status_from(surface_compare(work, &stored, &fresh, &r)));
    same_score(p->score, &r);
    if (out != NULL)
        timing_must(status_from(surface_disparity(work, &stored, &fresh, out)));
}

/* With a template of another head's size. */
static void decide_sizes(const struct pair *p)
{
    struct surface_comparison r;

    timing_must(codec_decode(p->larger, p->blob_size, work, &stored));
    timing_must(face_build(p->probe_pts, p->n_probe, work, &fresh, NULL));
    timing_must(status_from(surface_compare(work, &stored, &fresh, &r)));
    same_score(p->larger_score, &r);
}

/* From the points of both. */
static void decide_raw(const struct pair *p)
{
    struct surface_comparison r;

    timing_must(face_build(p->tmpl_pts, p->n_tmpl, work, &fresh2, NULL));
    timing_must(face_build(p->probe_pts, p->n_probe, work, &fresh, NULL));
    timing_must(status_from(surface_compare(work, &fresh2, &fresh, &r)));
    same_score(p->score, &r);
}

/* The pair for a part of the k-th pass: each part has another, because what the processor
 * has learned of a pair would help whoever has it next. */
static struct pair *turn(struct pair *pair, size_t k, enum row part)
{
    return &pair[(k + part * PAIRS / ROWS) % PAIRS];
}

static void pass(struct pair *pair, size_t k)
{
    struct pair *p = turn(pair, k, LOAD);
    struct align_result found;
    struct surface_comparison r;
    struct surface_disparity least;
    double t = timing_now_ms();

    timing_must(codec_decode(p->blob, p->blob_size, work, &stored));
    t = lap(LOAD, t);
    p = turn(pair, k, PROBE);
    timing_must(face_build(p->probe_pts, p->n_probe, work, &fresh, NULL));
    t = lap(PROBE, t);
    timing_must(place_find(&turn(pair, k, FRAME)->probe, work));
    t = lap(FRAME, t);
    p = turn(pair, k, SEARCH);
    find_pose(&p->tmpl, &p->probe, &found);
    t = lap(SEARCH, t);
    p = turn(pair, k, COMPARE);
    timing_must(status_from(surface_compare(work, &p->tmpl, &p->probe, &r)));
    t = lap(COMPARE, t);
    decide(turn(pair, k, DECIDE), NULL);
    t = lap(DECIDE, t);
    decide_sizes(turn(pair, k, SIZES));
    t = lap(SIZES, t);
    decide(turn(pair, k, MINIMAL), &least);
    t = lap(MINIMAL, t);
    decide_raw(turn(pair, k, RAW));
    t = lap(RAW, t);
    if (peers != NULL) {
        void *dt = peers->triangulate(turn(pair, k, PEER_ONE)->points);

        (void)lap(PEER_ONE, t);
        peers->triangulation_free(dt);
    }
}

static void line(const char *what, double ms)
{
    const double units = ms / timing_median(&row[PEER_ONE]);

    printf("  %-56s %9.3f", what, ms);
    if (!isnan(units))
        printf(" %9.2f", units);
    putchar('\n');
}

static void report(void)
{
    const double one = timing_median(&row[PEER_ONE]);
    const double load = timing_median(&row[LOAD]), probe = timing_median(&row[PROBE]);
    const double frame = timing_median(&row[FRAME]), from = timing_median(&row[SEARCH]);
    const double both = timing_median(&row[DECIDE]), raw = timing_median(&row[RAW]);

    printf("\nVerification, 3,000 against 3,000 points, 8 degrees and 10 mm off\n");
    printf("  %-56s %9s %9s\n", "", "ms", "units");
    line("template load: bytes to validated model", load);
    line("probe: points to model, its frame included", probe);
    line("comparison of two models", timing_median(&row[COMPARE]));
    line("decision, template stored: all of the above", both);
    line("decision, heads of two sizes", timing_median(&row[SIZES]));
    line("decision and minimal disparity, template stored", timing_median(&row[MINIMAL]));
    line("decision, from the points of both", raw);
    line("finding the pose, template's frame stored", frame + from);
    line("  the probe's frame (part of its model above)", frame);
    line("  the search from both frames (part of the comparison)", from);
    printf("  template stored: %.2f of the time from both clouds; %zu bytes a point\n",
           both / raw, surface_encoded_size(&stored) / stored.surface.mesh.nv);
    timing_unit(one);
    timing_target("template load", load / one, 0.1, "units");
    timing_target("probe: points to model", probe / one, 3, "units");
    timing_target("finding the pose, the frame included", (frame + from) / one, 3,
                  "units");
    timing_target("decision, template stored, in the library", both / one, 2.6, "units");
    timing_target("  decision, heads of two sizes", timing_median(&row[SIZES]) / one, 4,
                  "units");
    timing_target("  decision and minimal disparity", timing_median(&row[MINIMAL]) / one,
                  5, "units");
}

/* Each pair once: what is decided, and how far the pose is off. */
static void outcome(struct pair *pair)
{
    struct timing error = {0};
    unsigned matches = 0;

    for (size_t k = 0; k < PAIRS; k++) {
        struct surface_comparison r;
        struct align_result a;

        timing_must(
            status_from(surface_compare(work, &pair[k].tmpl, &pair[k].probe, &r)));
        pair[k].score = r.score;
        matches += r.decision == SURFACE_MATCH;
        timing_must(face_align(&pair[k].tmpl, &pair[k].probe, work, &a));
        timing_add(&error, pose_error(&pair[k], a.transform));
    }
    printf("%d mated pairs: %u match; pose error, median: %.3f mm", PAIRS, matches,
           timing_median(&error));
    timing_free(&error);
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
        struct align_result a;

        facegen_default(&s);
        s.warp = 0;
        s.subject = k;
        s.scan = 2 * k;
        p.n_tmpl = facegen_sample(&s, p.tmpl_pts);
        s.scan++;
        p.n_probe = facegen_sample(&s, p.probe_pts);
        clouds_move(p.probe_pts, p.n_probe, k, 8, 10, p.moved);
        timing_must(face_build(p.tmpl_pts, p.n_tmpl, work, &fresh, NULL));
        timing_must(face_build(p.probe_pts, p.n_probe, work, &fresh2, NULL));
        timing_must(face_align(&fresh, &fresh2, work, &a));
        timing_add(&error, pose_error(&p, a.transform));
    }
    printf(", with white noise alone %.3f mm\n", timing_median(&error));
    timing_free(&error);
    free(p.tmpl_pts);
    free(p.probe_pts);
}

/* The model of a scan as it leaves its scanner. */
static void scan(struct cloudpoints *c, struct surface_face *out)
{
    static const struct scan_options as_found;
    struct surface_found found;

    timing_must(scan_build(c, &as_found, work, out, NULL, &found));
}

static void points_of(const struct dvec3 *pts, size_t n, struct cloudpoints *out)
{
    *out = (struct cloudpoints){.at = mem_array(n, sizeof *pts), .n = n, .read = n};
    if (out->at == NULL)
        timing_must(ST_ENOMEM);
    memcpy(out->at, pts, n * sizeof *pts);
}

/* A dense scan with its template: what both become is thinned. */
static void dense_make(struct pair *p, uint64_t k)
{
    struct cloudpoints c;
    struct surface_comparison r;

    pair_make(p, k, DENSE);
    free(p->blob);
    points_of(p->tmpl_pts, p->n_tmpl, &c);
    scan(&c, &p->tmpl);
    cloudpoints_free(&c);
    points_of(p->probe_pts, p->n_probe, &c);
    scan(&c, &p->probe);
    cloudpoints_free(&c);
    p->blob_size = surface_encoded_size(&p->tmpl);
    p->blob = timing_alloc(p->blob_size, 1);
    surface_encode(&p->tmpl, p->blob);
    timing_must(status_from(surface_compare(work, &p->tmpl, &p->probe, &r)));
    p->score = r.score;
}

static void decide_dense(struct timing *t, const struct pair *p,
                         struct surface_disparity *out)
{
    struct cloudpoints c;
    struct surface_comparison r;

    points_of(p->probe_pts, p->n_probe, &c);
    timing_start(t);
    timing_must(codec_decode(p->blob, p->blob_size, work, &stored));
    scan(&c, &fresh);
    timing_must(status_from(surface_compare(work, &stored, &fresh, &r)));
    same_score(p->score, &r);
    if (out != NULL)
        timing_must(status_from(surface_disparity(work, &stored, &fresh, out)));
    timing_stop(t);
    cloudpoints_free(&c);
}

/* Dense scans, the template stored, as a multiple of 3,000 points, in turn. */
static void dense(const struct pair *pair)
{
    struct pair big[DENSES] = {{0}};
    struct timing many[2] = {{0}}, few[2] = {{0}};
    const char *what[2] = {"decision", "decision and minimal disparity"};

    for (size_t k = 0; k < DENSES; k++)
        dense_make(&big[k], PAIRS + k);
    for (size_t k = 0; k < PAIRS; k++) {
        struct surface_disparity least;

        TIMED(&few[0], decide(&pair[k], NULL));
        TIMED(&few[1], decide(&pair[(k + PAIRS / 2) % PAIRS], &least));
        if (k % 3 == 0)
            decide_dense(&many[0], &big[k / 3 % DENSES], NULL);
        if (k % 3 == 1)
            decide_dense(&many[1], &big[k / 3 % DENSES], &least);
    }
    printf("\n50,000 against 50,000 points, template stored\n");
    printf("  %-56s %9s %9s\n", "", "ms", "x 3,000's");
    for (int i = 0; i < 2; i++) {
        const double ms = timing_median(&many[i]), times = ms / timing_median(&few[i]);
        char title[80];

        printf("  %-56s %9.3f %9.1f\n", what[i], ms, times);
        (void)snprintf(title, sizeof title, "50,000 against 50,000 points, %s", what[i]);
        timing_target(title, times, 4, "x 3,000's");
        timing_free(&many[i]);
        timing_free(&few[i]);
    }
    for (size_t k = 0; k < DENSES; k++)
        pair_free(&big[k]);
}

/* Everything that a comparison and its minimal disparity allocate in the steady state: both faces and the worker's memory. */
static void memory(const struct pair *p)
{
    const double before = timing_bytes();
    struct surface_work *w = surface_work_new(NULL);
    struct surface_face a = {0}, b = {0};
    struct surface_comparison r;
    struct surface_disparity least;
    double bytes;

    if (w == NULL)
        timing_must(ST_ENOMEM);
    timing_must(codec_decode(p->blob, p->blob_size, w, &a));
    timing_must(face_build(p->probe_pts, p->n_probe, w, &b, NULL));
    timing_must(status_from(surface_compare(w, &a, &b, &r)));
    timing_must(status_from(surface_disparity(w, &a, &b, &least)));
    bytes = timing_bytes() - before;
    printf("\nMemory: working set of a comparison: %.2f MB\n", bytes / 1e6);
    timing_target("memory, working set of a comparison", bytes / 1e6, 4, "MB");
    face_free(&a);
    face_free(&b);
    surface_work_free(w);
}

int main(void)
{
    static struct pair pair[PAIRS];

    peers = timing_peers();
    if ((work = surface_work_new(NULL)) == NULL)
        timing_must(ST_ENOMEM);
    timing_must(frame_mean_make(&model_default, &mean));
    fit_prepare(&model_default.change, &motion);
    for (size_t k = 0; k < PAIRS; k++)
        pair_make(&pair[k], k, POINTS);
    outcome(pair);
    white_noise_only();
    for (size_t k = 0; k < PAIRS; k++) /* warm-up: memory grown */
        pass(pair, k);
    for (size_t r = 0; r < ROWS; r++)
        row[r].n = 0;
    for (int round = 0; round < ROUNDS; round++)
        for (size_t k = 0; k < PAIRS; k++)
            pass(pair, k);
    report();
    dense(pair);
    memory(&pair[0]);
    return 0;
}
