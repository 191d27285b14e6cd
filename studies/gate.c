/* gate.c -- what is enrolled: things that are no faces, random reliefs, surfaces sought against
 * the gate; and faces.  The gate was tuned on the even seeds of each alone. */
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloudpoints.h"
#include "face.h"
#include "facegen.h"
#include "lab.h"
#include "mem.h"
#include "object.h"
#include "people.h"
#include "relief.h"
#include "scan.h"
#include "sought.h"
#include "study.h"
#include "tuning.h"

#define POINTS 20000 /* of a thing, at most */

struct trial {
    struct face_work *work;
    struct face face;
    struct scan_found found;
    FILE *scans;
};

/* How many of a set were tried and enrolled, of even and of odd seeds. */
struct count {
    size_t tried[2], enrolled[2];
};

static enum status build(struct trial *g, const struct scan_options *o,
                         const struct dvec3 *pts, size_t n)
{
    struct cloudpoints c = {.n = n, .read = n, .unit_mm = 1};
    enum status st;

    if ((c.at = mem_array(n, sizeof *c.at)) == NULL)
        lab_must(ST_ENOMEM);
    memcpy(c.at, pts, n * sizeof *pts);
    st = scan_build(&c, o, g->work, &g->face, NULL, &g->found);
    cloudpoints_free(&c);
    return st;
}

static void count(struct trial *g, const char *set, const char *name, uint64_t seed,
                  const struct dvec3 *pts, size_t n, struct count *to)
{
    static const struct scan_options strict = {.enrolment = true};
    const enum status st = build(g, &strict, pts, n);
    const struct scan_found *f = &g->found;

    to->tried[seed % 2]++;
    to->enrolled[seed % 2] += st == ST_OK;
    fprintf(g->scans, "%s,%s,%d,%d,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%g,%g,%g\n", set,
            name, (int)seed, (int)n, st == ST_OK ? "enrolled" : status_message(st),
            f->gate.support, f->gate.likeness, f->gate.eyes, f->gate.seen,
            f->gate.forehead, f->gate.detail, f->gate.evidence, f->gate.scale[0],
            f->gate.scale[1], f->gate.scale[2]);
}

/* By how much the surface falls short of an enrolment, where it is worst; as it lies, as a
 * search for the face costs more. */
static double evidence(void *of, struct dvec3 *pts, size_t n)
{
    static const struct scan_options quick = {.axes = SCAN_AXES_SCANNER};
    struct trial *g = of;
    const struct scan_found *f = &g->found;
    double most;

    (void)build(g, &quick, pts, n);
    if (f->gate.support_wanted == 0)
        return -5 - g->face.frame.cost_mm; /* not even aligned */
    most = fmin(2 * (f->gate.support - GATE_SUPPORT), f->gate.likeness - GATE_LIKENESS);
    most = fmin(most, fmin(f->gate.eyes - GATE_EYES, 2 * (f->gate.seen - GATE_SEEN)));
    most = fmin(most, f->gate.forehead - GATE_FOREHEAD);
    most = fmin(most, 2 * (f->gate.detail - GATE_DETAIL));
    return fmin(most, 0.3 * (f->gate.evidence - GATE_EVIDENCE));
}

static void sum_up(FILE *f, const char *set, const struct count *c)
{
    for (int odd = 0; odd < 2; odd++) {
        double low, high;

        lab_share(c->enrolled[odd], c->tried[odd], &low, &high);
        fprintf(f, "%s,%s,%zu,%zu,%.2f,%.2f\n", set, odd ? "held out" : "worked on",
                c->tried[odd], c->enrolled[odd], 100 * low, 100 * high);
    }
}

static void things(const struct lab *lab, struct trial *g, FILE *sum, struct dvec3 *pts)
{
    static const uint32_t points[] = {3000, 5000, 10000, POINTS};
    FILE *f = lab_open(lab, "kinds.csv");
    struct count all = {0};

    fprintf(f, "kind,worked on,enrolled,held out,enrolled\n");
    for (uint32_t k = 0; k < object_kinds(); k += lab->reduced ? 12 : 1) {
        struct count c = {0};

        for (uint64_t seed = 0; seed < 2; seed++)
            count(g, "things", object_name(k), seed, pts,
                  object_scan(k, seed, points[(k + seed) % 4], pts), &c);
        fprintf(f, "%s,%zu,%zu,%zu,%zu\n", object_name(k), c.tried[0], c.enrolled[0],
                c.tried[1], c.enrolled[1]);
        for (int i = 0; i < 2; i++) {
            all.tried[i] += c.tried[i];
            all.enrolled[i] += c.enrolled[i];
        }
    }
    lab_close(f);
    sum_up(sum, "things", &all);
}

static void reliefs(const struct lab *lab, struct trial *g, FILE *sum, struct dvec3 *pts)
{
    struct count c = {0};

    for (uint64_t seed = 0; seed < (lab->reduced ? 6 : 100); seed++) {
        struct draw r = draw_stream(seed, 0, 6);
        struct relief f;

        relief_draw(seed, &f);
        count(g, "reliefs", "random relief", seed, pts,
              relief_sample(&f, 4000, 0.2, &r, pts), &c);
    }
    sum_up(sum, "random reliefs", &c);
}

static void sought(const struct lab *lab, struct trial *g, FILE *sum, struct dvec3 *pts)
{
    struct count c = {0};

    for (uint64_t seed = 0; seed < (lab->reduced ? 4 : 100); seed++) {
        /* half of either form is held out */
        const size_t n = sought_find(seed / 2 * 2 + (seed / 2 + seed) % 2,
                                     lab->reduced ? 5 : 250, evidence, g, pts);

        count(g, "sought", "sought", seed, pts, n, &c);
    }
    sum_up(sum, "sought against the gate", &c);
}

static void made_up(const struct lab *lab, struct trial *g, FILE *sum, struct dvec3 *pts)
{
    struct count c = {0};

    for (uint64_t who = 0; who < (lab->reduced ? 4 : 100); who++) {
        struct facegen_scan s;

        facegen_default(&s);
        s.subject = 5000 + who;
        facegen_pose(&s, 3, 4);
        count(g, "faces", "made up", who, pts, facegen_sample(&s, pts), &c);
    }
    sum_up(sum, "made-up faces", &c);
}

static int scans_alone(const struct dirent *e)
{
    return strstr(e->d_name, ".ply") != NULL;
}

static void scanned(const struct lab *lab, struct trial *g, FILE *sum)
{
    struct dirent **list = NULL;
    const int files = scandir(lab->faces, &list, scans_alone, alphasort);
    struct count c = {0};

    for (int i = 0; i < files; i++) {
        size_t n;
        struct dvec3 *pts = people_points(lab->faces, list[i]->d_name, &n);
        const char *digit = strpbrk(list[i]->d_name, "0123456789");

        if (pts != NULL)
            count(g, "faces", list[i]->d_name, digit ? strtoull(digit, NULL, 10) : 0, pts,
                  n, &c);
        free(pts);
        free(list[i]);
    }
    free(list);
    sum_up(sum, "scans of faces", &c);
}

void gate_run(const struct lab *lab)
{
    struct trial g = {.work = face_work_new(NULL), .scans = lab_open(lab, "scans.csv")};
    FILE *sum = lab_open(lab, "summary.csv");
    struct dvec3 *pts = lab_alloc(POINTS, sizeof *pts);

    if (g.work == NULL)
        lab_must(ST_ENOMEM);
    fprintf(
        g.scans,
        "set,what,seed,points,outcome,support,likeness,eyes,seen,forehead,detail,evidence,"
        "scale x,y,z\n");
    fprintf(sum, "what,half,number,enrolled,95 %% from,to\n");
    things(lab, &g, sum, pts);
    reliefs(lab, &g, sum, pts);
    sought(lab, &g, sum, pts);
    made_up(lab, &g, sum, pts);
    if (lab->faces != NULL)
        scanned(lab, &g, sum);
    lab_close(g.scans);
    lab_close(sum);
    face_free(&g.face);
    face_work_free(g.work);
    free(pts);
}
