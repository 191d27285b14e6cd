/* scans.c -- scans as scanners deliver them: whole heads, busts, half profiles, a depth
 * camera's grid, heads from all sides, and faces with something before them.  What the program
 * makes of each kind, and what it makes of it when told that axes and unit are as agreed.
 * Scans: made-up heads, rendered; of a folder (--faces) the people's frontal scans with covers
 * drawn on them; of another (--raw) the same people's SUBJECT_KIND.ply, and their heads
 * (SUBJECT_round.ply), rendered. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloudpoints.h"
#include "face.h"
#include "headpose.h"
#include "headscan.h"
#include "lab.h"
#include "mem.h"
#include "people.h"
#include "scan.h"
#include "scanned.h"
#include "study.h"

#define MOST 40 /* people */

struct people {
    struct person p[MOST];
    size_t n;
    size_t relative[MOST];  /* the number of a close relative, or of the person */
    struct head head[MOST]; /* from all sides; n 0: none */
};

struct study {
    const struct lab *lab;
    struct face_work *work;
    struct people *people;
    FILE *decisions, *found, *pictures;
};

/* ---- decisions */

struct tally {
    size_t scans, refused[SCANNED_REASONS];
    size_t match[2], no_match[2], inconclusive[2]; /* [1]: non-mated */
};

static size_t comparisons(const struct tally *t, int others)
{
    return t->match[others] + t->no_match[others] + t->inconclusive[others];
}

/* probe, of p[who], against everybody's template, where there is one; close relatives left
 * out. */
static void compare(const struct study *s, const struct people *p,
                    const struct face *probe, size_t who, struct tally *t,
                    enum face_decision *own)
{
    for (size_t i = 0; i < p->n; i++) {
        const int other = i != who;
        struct face_result r;

        if (p->p[i].template.surface.mesh.nv == 0 ||
            (other && (p->relative[i] == who || p->relative[who] == i)))
            continue;
        lab_must(face_compare(&p->p[i].template, probe, (double)NAN, NULL, s->work, &r));
        t->match[other] += r.decision == FACE_MATCH;
        t->no_match[other] += r.decision == FACE_NO_MATCH;
        t->inconclusive[other] += r.decision == FACE_INCONCLUSIVE;
        if (!other)
            *own = r.decision;
    }
}

/* ", k of n as a share %, and its 95 % interval". */
static void write_share(FILE *f, size_t k, size_t n, int places)
{
    double low, high;

    lab_share(k, n, &low, &high);
    lab_field(f, places, n > 0 ? 100.0 * (double)k / (double)n : (double)NAN);
    lab_field(f, places, n > 0 ? 100 * low : (double)NAN);
    lab_field(f, places, n > 0 ? 100 * high : (double)NAN);
}

static void write_reasons(FILE *f, const struct tally *t)
{
    const char *between = "";

    (void)fputc(',', f);
    for (unsigned k = 1; k < SCANNED_REASONS; k++)
        if (t->refused[k] > 0) {
            fprintf(f, "%s%s %zu", between, scanned_reason(k), t->refused[k]);
            between = "; ";
        }
}

/* Mated matches are a share of the scans, those refused included. */
static void write_tally(FILE *f, const struct tally *t)
{
    size_t refused = 0;

    for (unsigned k = 1; k < SCANNED_REASONS; k++)
        refused += t->refused[k];
    fprintf(f, ",%zu,%zu,%zu,%zu,%zu", t->scans, t->match[0], t->no_match[0],
            t->inconclusive[0], refused);
    write_share(f, t->match[0], t->scans, 1);
    fprintf(f, ",%zu,%zu,%zu", comparisons(t, 1), t->match[1], t->inconclusive[1]);
    write_share(f, t->match[1], comparisons(t, 1), 2);
    write_reasons(f, t);
    (void)fputc('\n', f);
}

#define TALLY_COLUMNS                                                                    \
    "scans,mated: match,non-match,inconclusive,refused,match %%,95 %% from,to,"          \
    "non-mated,match,inconclusive,match %%,95 %% from,to,refused for\n"

/* ---- a kind of scan */

struct truth {
    double unit_mm, yaw, pitch; /* 0, NAN: not known */
};

struct kind {
    const char *source, *name;
    struct tally before, after;
    size_t units, right, angles, warned[SCAN_WARNINGS], found;
    double off[MOST], occluded, elsewhere, used;
};

static void note_found(struct kind *k, const struct scanned *s, const struct truth *t)
{
    const struct scan_found *f = &s->found;

    if (s->reason != 0)
        return;
    k->found++;
    k->units += t->unit_mm > 0;
    k->right += t->unit_mm > 0 && fabs(f->unit_mm / t->unit_mm - 1) < 1e-6;
    if (!isnan(t->yaw) && !isnan(f->yaw_deg))
        k->off[k->angles++] = hypot(f->yaw_deg - t->yaw, f->pitch_deg - t->pitch);
    k->occluded += f->occluded;
    k->elsewhere += f->elsewhere;
    k->used += (double)f->points_used;
    for (unsigned w = 0; w < SCAN_WARNINGS; w++)
        k->warned[w] += f->warnings >> w & 1;
}

/* One scan of the person `who`, both ways.  c stays the caller's. */
static void one_scan(const struct study *s, struct kind *k, const struct people *p,
                     size_t who, const struct cloudpoints *c, const struct truth *truth)
{
    static const char *const decision[] = {[FACE_MATCH] = "match",
                                           [FACE_NO_MATCH] = "non-match",
                                           [FACE_INCONCLUSIVE] = "inconclusive"};
    const bool first = k->after.scans == 0; /* it is drawn */
    const char *outcome[2];

    for (int found = 0; found < 2; found++) {
        struct tally *t = found ? &k->after : &k->before;
        const struct scan_options o = {.axes =
                                           found ? SCAN_AXES_AUTO : SCAN_AXES_SCANNER};
        enum face_decision own = FACE_INCONCLUSIVE;
        struct scanned done;

        scanned_build(c, found ? 0 : 1, &o, s->work, &done);
        t->scans++;
        t->refused[done.reason]++;
        if (done.reason == 0)
            compare(s, p, &done.face, who, t, &own);
        outcome[found] = done.reason == 0 ? decision[own] : scanned_reason(done.reason);
        if (found)
            note_found(k, &done, truth);
        if (first && found)
            scanned_draw(s->lab, k->source, k->name, c, &done);
        scanned_free(&done);
    }
    if (first)
        fprintf(s->pictures, "%s,%s,%s,%s\n", k->source, k->name, outcome[0], outcome[1]);
}

static void end_kind(const struct study *s, struct kind *k)
{
    const double n = k->found > 0 ? (double)k->found : (double)NAN;
    FILE *f = s->found;

    if (k->after.scans == 0)
        return;
    fprintf(s->decisions, "%s,%s,as agreed", k->source, k->name);
    write_tally(s->decisions, &k->before);
    fprintf(s->decisions, "%s,%s,found", k->source, k->name);
    write_tally(s->decisions, &k->after);
    fprintf(f, "%s,%s,%zu,%zu,%zu", k->source, k->name, k->after.scans, k->found,
            k->right);
    if (k->angles > 0) {
        const struct lab_spread off = lab_spread(k->off, k->angles);

        lab_field(f, 1, off.median);
        lab_field(f, 1, off.high);
    } else {
        fprintf(f, ",,");
    }
    lab_field(f, 1, 100 * k->occluded / n);
    lab_field(f, 1, 100 * k->elsewhere / n);
    lab_field(f, 0, k->used / n);
    for (unsigned w = 0; w < SCAN_WARNINGS; w++)
        fprintf(f, ",%zu", k->warned[w]);
    (void)fputc('\n', f);
}

/* ---- where the scans come from */

static const struct truth unknown = {0, (double)NAN, (double)NAN};

static void files(const struct study *s)
{
    static const char *const name[] = {"head",    "bust", "round", "half",
                                       "glasses", "mask", "other"};
    const struct people *p = s->people;

    for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        struct kind k = {.source = "files", .name = name[i]};

        for (size_t who = 0; who < p->n; who++) {
            struct cloudpoints c = {0};
            char file[96];

            (void)snprintf(file, sizeof file, "%s_%s.ply", p->p[who].name, name[i]);
            if ((c.at = people_points(s->lab->raw, file, &c.n)) == NULL)
                continue;
            c.read = c.n;
            one_scan(s, &k, p, who, &c, &unknown);
            free(c.at);
        }
        end_kind(s, &k);
    }
}

/* Of the next person; else the same. */
static const struct head *second_head(const struct people *p, size_t who)
{
    const struct head *next = &p->head[(who + 1) % p->n];

    return next->n > 0 ? next : &p->head[who];
}

/* A kind rendered of a head, or of a frontal scan. */
static void render(const struct study *s, struct kind *k, unsigned kind, size_t who,
                   const struct head *h, bool crop)
{
    struct headscan_options o;
    struct headscan scan;
    struct cloudpoints c;
    struct truth t;

    headscan_kind(kind, s->lab->seed + who, crop, &o);
    headscan_render(h, second_head(s->people, who), &o, &scan);
    scanned_cloud(&scan, &c);
    t = (struct truth){o.unit_mm, crop || o.axes == HEADSCAN_ANY ? (double)NAN : o.yaw,
                       o.pitch};
    one_scan(s, k, s->people, who, &c, &t);
    cloudpoints_free(&c);
    headscan_free(&scan);
}

static void heads(const struct study *s)
{
    for (unsigned i = 0; i < HEADSCAN_KINDS; i++) {
        struct headscan_options o;
        struct kind k = {.name = headscan_name(i)};

        headscan_kind(i, 0, false, &o);
        k.source = o.cover == HEADCOVER_NONE ? "heads" : "covered";
        for (size_t who = 0; who < s->people->n; who++)
            if (s->people->head[who].n > 0)
                render(s, &k, i, who, &s->people->head[who], false);
        end_kind(s, &k);
    }
}

static void crops(const struct study *s)
{
    struct people *p = s->people;

    for (unsigned i = 0; i < HEADSCAN_KINDS; i++) {
        struct kind k = {.source = "crops", .name = headscan_name(i)};
        struct headscan_options o;

        headscan_kind(i, 0, true, &o);
        for (size_t who = 0; who < p->n && o.cover != HEADCOVER_NONE; who++) {
            struct head h = {0};

            if (scanned_stand(p->p[who].probe, p->p[who].n, true, s->work, &h))
                render(s, &k, i, who, &h, true);
            head_free(&h);
        }
        end_kind(s, &k);
    }
}

/* ---- enrolment of such scans, frontal probes */

/* The scan that p[i] enrols: of the raw folder, or rendered. */
static bool enrolment(const struct study *s, const char *file, unsigned kind,
                      bool mirrored, size_t i, struct cloudpoints *c)
{
    const struct people *p = s->people;
    struct headscan_options h;
    struct headscan scan;
    struct dvec3 *pts;
    char name[96];

    if (file != NULL) {
        (void)snprintf(name, sizeof name, "%s_%s.ply", p->p[i].name, file);
        scan = (struct headscan){0};
        if ((pts = people_points(s->lab->raw, name, &scan.n)) == NULL)
            return false;
        scan.at = pts;
    } else {
        if (p->head[i].n == 0)
            return false;
        headscan_kind(kind, s->lab->seed + 1000 + i, false, &h);
        h.mirrored = mirrored;
        headscan_render(&p->head[i], second_head(p, i), &h, &scan);
    }
    scanned_cloud(&scan, c);
    headscan_free(&scan);
    return true;
}

static void enrol(const struct study *s, FILE *f, const char *file, unsigned kind,
                  bool mirrored)
{
    const struct scan_options o = {.enrolment = true};
    struct people *p = s->people, *q = lab_alloc(1, sizeof *q);
    struct tally t = {0};
    size_t enrolled = 0;
    struct face probe = {0};

    memcpy(q, p, sizeof *q);
    for (size_t i = 0; i < p->n; i++) {
        struct cloudpoints c;
        struct scanned done;

        memset(&q->p[i].template, 0, sizeof q->p[i].template);
        if (!enrolment(s, file, kind, mirrored, i, &c))
            continue;
        scanned_build(&c, 0, &o, s->work, &done);
        t.refused[done.reason]++;
        q->p[i].template = done.face;
        enrolled += done.reason == 0;
        cloudpoints_free(&c);
    }
    fprintf(f, "%s%s%s,%zu", file != NULL ? "files: " : "",
            file != NULL ? file : headscan_name(kind), mirrored ? " mirrored" : "",
            enrolled);
    for (size_t i = 0; i < p->n; i++) {
        enum face_decision own;

        if (face_build(p->p[i].probe, p->p[i].n, s->work, &probe, NULL) != ST_OK)
            continue;
        t.scans += q->p[i].template.surface.mesh.nv > 0;
        compare(s, q, &probe, i, &t, &own);
    }
    write_tally(f, &t);
    for (size_t i = 0; i < q->n; i++)
        face_free(&q->p[i].template);
    face_free(&probe);
    free(q);
}

static void enrolments(const struct study *s)
{
    static const char *const name[] = {"head", "bust",    "round", "depth", "half",
                                       "two",  "glasses", "mask",  "behind"};
    FILE *f = lab_open(s->lab, "enrolment.csv");

    fprintf(f, "enrolled from,templates," TALLY_COLUMNS);
    for (unsigned k = 0; k < HEADSCAN_KINDS; k++)
        for (size_t i = 0; i < sizeof name / sizeof *name; i++)
            if (strcmp(headscan_name(k), name[i]) == 0)
                enrol(s, f, NULL, k, false);
    enrol(s, f, NULL, 0, true);
    for (size_t i = 0; i < 3 && s->lab->raw != NULL; i++)
        enrol(s, f, name[i], 0, false);
    lab_close(f);
}

/* ---- people */

static void gather(const struct study *s)
{
    const struct lab *lab = s->lab;
    struct people *p = s->people;

    if (lab->faces != NULL) {
        p->n = people_scanned(lab->faces, "p1", lab->reduced ? 2 : MOST, s->work, p->p);
        people_relatives(lab->faces, p->p, p->n, p->relative);
    } else {
        p->n = lab->reduced ? 2 : 20;
        people_made_up(0, p->n, s->work, p->p);
        people_relatives(NULL, p->p, p->n, p->relative);
    }
    for (size_t i = 0; i < p->n; i++) {
        struct dvec3 *pts = NULL;
        char file[96];
        size_t n;

        (void)snprintf(file, sizeof file, "%s_round.ply", p->p[i].name);
        if (lab->faces == NULL)
            head_make_up(i, &p->head[i]);
        else if (lab->raw != NULL && (pts = people_points(lab->raw, file, &n)) != NULL)
            (void)scanned_stand(pts, n, false, s->work, &p->head[i]);
        free(pts);
    }
}

void scans_run(const struct lab *lab)
{
    struct study s = {.lab = lab,
                      .work = face_work_new(NULL),
                      .people = lab_alloc(1, sizeof *s.people),
                      .decisions = lab_open(lab, "decisions.csv"),
                      .found = lab_open(lab, "found.csv"),
                      .pictures = lab_open(lab, "pictures.csv")};

    if (s.work == NULL)
        lab_must(ST_ENOMEM);
    fprintf(s.decisions, "source,kind,axes and unit," TALLY_COLUMNS);
    fprintf(s.found, "source,kind,scans,face found,unit right,view off: median degrees,"
                     "95 %%,covered %%,elsewhere %%,points used");
    for (unsigned w = 0; w < SCAN_WARNINGS; w++)
        fprintf(s.found, ",%s", scan_warning_name(w));
    fprintf(s.found, "\n");
    gather(&s);
    if (lab->raw != NULL)
        files(&s);
    heads(&s);
    crops(&s);
    enrolments(&s);
    lab_close(s.decisions);
    lab_close(s.found);
    lab_close(s.pictures);
    for (size_t i = 0; i < s.people->n; i++)
        head_free(&s.people->head[i]);
    people_free(s.people->p, s.people->n);
    face_work_free(s.work);
    free(s.people);
}
