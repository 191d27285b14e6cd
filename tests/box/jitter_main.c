/* jitter -- compare scans with changed copies of themselves.  A copy that does not match is a fault
 * of the frame, the crop or the cover, whoever the person is, so that no labels are needed. */
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "clouddepth.h"
#include "cloudfile.h"
#include "command.h"
#include "corpus.h"
#include "draw.h"
#include "errinfo.h"
#include "libsurface.h"
#include "mem.h"
#include "outfile.h"
#include "pool.h"
#include "vec.h"

static const char usage[] =
    "usage: jitter [OPTION]... FILE|DIR...\n"
    "Compare each scan with changed copies of itself, and list those that do not match.\n"
    "  --copies N     of each scan (10); their kinds take turns\n"
    "  --kind KIND    copies of this kind alone\n"
    "  --seed N       of all that is drawn (0); it grows by one after each kind had its turn\n"
    "  --threads N    one for each core\n"
    "  --units U      of the points: mm, cm, m, in, um or millimetres (found)\n"
    "  --camera C     of depth images: FX,FY,CX,CY[,SCALE[,WIDTH,HEIGHT]]\n"
    "  --axes A       auto, or scanner: kinds that leave the agreed axes are skipped\n"
    "  --list         a line for each copy, not only for those that fail\n"
    "  --write DIR    the copies that fail, as DIR/FILE-KIND-SEED.ply\n"
    "Kinds: %s\n"
    "Exit status: 0 if nothing failed, 1 if a copy failed, 2 if there is no result.\n";

/* What is changed.  The first rows leave a scan nearly as it is, the last one does most at once. */
struct kind {
    const char *name;
    double drop;     /* share of the points */
    double turn_deg; /* at most, about the nose */
    double crop;     /* share of the face's points, at most */
    bool thin;       /* every second point */
    bool noise;      /* as much as the scan has */
    double shift_mm;
    bool unit;    /* another one */
    bool picture; /* turned by 90, 180 or 270 degrees */
    bool any;     /* turned to any side */
};
static const struct kind kinds[] = {
    {.name = "dropped", .drop = 0.03, .turn_deg = 3},
    {.name = "turned", .drop = 0.15, .turn_deg = 12},
    {.name = "cropped", .crop = 0.15},
    {.name = "thinned", .thin = true},
    {.name = "noisy", .noise = true},
    {.name = "moved", .shift_mm = 20},
    {.name = "unit", .unit = true},
    {.name = "picture", .picture = true},
    {.name = "anyhow", .any = true},
    {.name = "combined",
     .drop = 0.15,
     .turn_deg = 12,
     .crop = 0.15,
     .noise = true,
     .shift_mm = 20,
     .unit = true},
};
#define KINDS (sizeof kinds / sizeof *kinds)

/* Half axes of the ellipse about the nose, mm; only their ratio matters. */
#define ELLIPSE_X 60.0
#define ELLIPSE_Y 85.0

/* Scores that differ by rounding alone. */
#define SAME_SCORE 1e-6

/* Scans of little surface score little above the threshold even with themselves: a copy may be
 * inconclusive that has this share of the score. */
#define ENOUGH 0.6

/* What became of the copies of a kind. */
struct count {
    uint32_t copies, refused, no_match, inconclusive;
    uint32_t not_enrolled;      /* of scans that are */
    uint32_t lopsided;          /* another score with template and probe exchanged */
    double score, disparity_mm; /* the least score, of those compared */
};

struct scan {
    char *path;
    const char *name; /* in path */
    bool refused;     /* by the gate of probes: it has no copies */
    bool lenient;     /* by that of enrolments alone */
    bool vague;       /* inconclusive even with itself */
    struct count count[KINDS];
    char *lines; /* about failures, by malloc(); NULL: none */
    size_t length;
};

struct jitter {
    double copies, seed, threads, unit_mm;
    int kind; /* -1: all */
    bool frontal, list;
    struct clouddepth_camera camera;
    const char *write; /* folder; NULL: none is written */
    struct scan *scan;
    size_t n;
};

/* How the points move, and which are left. */
struct change {
    struct dvec3 axis, about, view, shift;
    double rad, noise, by, far, drop;
    size_t step, first;
};

/* A scan and a copy while they are compared. */
struct pair {
    const struct jitter *j;
    struct scan *s;
    struct surface_work *w;
    struct cloudpoints cloud; /* of the scan */
    struct surface_face *face;
    struct surface_found found;
    double self; /* score with itself */
    double
        frame[16]; /* from the scan's points to the frame with the nose at its origin */
    FILE *lines;
    struct change change; /* to the copy */

    struct surface_cloud copy; /* whose memory is this, [cloud.n] each: */
    double (*at)[3], (*normal)[3];
    uint32_t *place;
    double *rank;
};

/* ---- what a copy is */

/* a after b, both row-major 4 x 4. */
static void multiply(const double a[16], const double b[16], double out[16])
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            double sum = 0;

            for (int m = 0; m < 4; m++)
                sum += a[4 * i + m] * b[4 * m + k];
            out[4 * i + k] = sum;
        }
}

/* The place in the scan of what m, a similarity, moves to q. */
static struct dvec3 back(const double m[16], struct dvec3 q)
{
    const struct dvec3 x = {m[0], m[1], m[2]};
    const struct dvec3 t = vec_sub(q, (struct dvec3){m[3], m[7], m[11]});
    const double square = vec_dot(x, x);

    return (struct dvec3){(m[0] * t.x + m[4] * t.y + m[8] * t.z) / square,
                          (m[1] * t.x + m[5] * t.y + m[9] * t.z) / square,
                          (m[2] * t.x + m[6] * t.y + m[10] * t.z) / square};
}

/* From where the face is seen, in the scan: a unit vector. */
static struct dvec3 view_of(const double m[16])
{
    const struct dvec3 z = {m[8], m[9], m[10]};

    return vec_along((struct dvec3){0, 0, 0}, 1 / sqrt(vec_dot(z, z)), z);
}

static struct dvec3 draw_axis(struct draw *r)
{
    const struct dvec3 v = {draw_normal(r), draw_normal(r), draw_normal(r)};
    const double length = sqrt(vec_dot(v, v));

    return length > 0 ? vec_along((struct dvec3){0, 0, 0}, 1 / length, v)
                      : (struct dvec3){0, 0, 1};
}

/* p turned about a unit vector. */
static struct dvec3 turn(struct dvec3 p, struct dvec3 axis, double rad)
{
    const double along = vec_dot(axis, p) * (1 - cos(rad));
    const struct dvec3 across = vec_cross(axis, p);

    return (struct dvec3){cos(rad) * p.x + sin(rad) * across.x + along * axis.x,
                          cos(rad) * p.y + sin(rad) * across.y + along * axis.y,
                          cos(rad) * p.z + sin(rad) * across.z + along * axis.z};
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* How far out a point is: below 1 within the ellipse's half axes. */
static double far_out(const struct pair *p, struct dvec3 at)
{
    const struct dvec3 q = vec_transform(p->frame, at);

    return q.x * q.x / (ELLIPSE_X * ELLIPSE_X) + q.y * q.y / (ELLIPSE_Y * ELLIPSE_Y);
}

/* The farthest that a point may be out, so that this share of the face's points is farther out. */
static double limit(const struct pair *p, double share)
{
    size_t n = 0;

    for (size_t i = 0; i < p->cloud.n; i++) {
        const double d = far_out(p, p->cloud.at[i]);

        if (d <= 1)
            p->rank[n++] = d;
    }
    qsort(p->rank, n, sizeof *p->rank, by_size);
    return n > 0 ? p->rank[(size_t)((double)(n - 1) * (1 - share))] : INFINITY;
}

static struct change draw_change(const struct pair *p, const struct kind *k,
                                 struct draw *r)
{
    static const double units[] = {10, 1000, 25.4};
    const double mm = p->found.unit_mm, unit = units[draw_next(r) % 3];
    const double quarters = 1 + (double)(draw_next(r) % 3);
    const double far = draw_uniform(r, 0, 1);
    struct change c = {.axis = draw_axis(r),
                       .about = back(p->frame, (struct dvec3){0, 0, 0}),
                       .view = view_of(p->frame),
                       .shift = draw_axis(r),
                       .rad = draw_uniform(r, 0, k->turn_deg) / VEC_DEGREES,
                       .noise = k->noise ? p->found.quality.noise_mm / mm : 0,
                       .by = k->unit ? mm / unit : 1,
                       .far = k->crop > 0 ? limit(p, k->crop * far) : INFINITY,
                       .drop = k->drop,
                       .step = k->thin ? 2 : 1};

    c.first = draw_next(r) % c.step;
    c.shift = vec_along((struct dvec3){0, 0, 0}, k->shift_mm / mm, c.shift);
    if (k->picture) {
        c.axis = c.view;
        c.rad = quarters * 90 / VEC_DEGREES;
    }
    if (k->any)
        c.rad = draw_uniform(r, 0, 360) / VEC_DEGREES;
    return c;
}

static struct dvec3 change_apply(const struct change *c, struct dvec3 p)
{
    const struct dvec3 q = turn(vec_sub(p, c->about), c->axis, c->rad);
    const struct dvec3 at = vec_along(vec_along(q, 1, c->about), 1, c->shift);

    return vec_along((struct dvec3){0, 0, 0}, c->by, at);
}

static void put(double out[3], struct dvec3 p)
{
    out[0] = p.x;
    out[1] = p.y;
    out[2] = p.z;
}

/* Fills p->copy, whose points are in the order of the scan's. */
static void make_copy(struct pair *p, const struct kind *k, uint64_t seed)
{
    const struct cloudpoints *from = &p->cloud;
    uint64_t name = 14695981039346656037U; /* FNV-1a: the same wherever the file is */
    struct change *c = &p->change;
    struct draw r;
    size_t n = 0;

    for (const char *s = p->s->name; *s != '\0'; s++)
        name = (name ^ (unsigned char)*s) * 1099511628211U;
    r = draw_stream(seed, name, (uint64_t)(k - kinds));
    *c = draw_change(p, k, &r);
    for (size_t i = 0; i < from->n; i++) {
        const bool drop = draw_uniform(&r, 0, 1) < c->drop;
        const double noise = c->noise > 0 ? c->noise * draw_normal(&r) : 0;
        const struct dvec3 at = from->at[i];

        if (drop || i % c->step != c->first || far_out(p, at) > c->far)
            continue;
        put(p->at[n], change_apply(c, vec_along(at, noise, c->view)));
        if (from->normal != NULL)
            put(p->normal[n], turn(from->normal[i], c->axis, c->rad));
        p->place[n++] = from->index != NULL ? from->index[i] : (uint32_t)i;
    }
    p->copy.n = n;
    p->copy.unit_mm = p->cloud.unit_mm / c->by;
}

/* ---- the file of a copy */

static enum status write_points(FILE *to, const void *arg, struct errinfo *e)
{
    const struct surface_cloud *c = arg;

    (void)e;
    (void)fprintf(to,
                  "ply\nformat ascii 1.0\nelement vertex %zu\nproperty double x\n"
                  "property double y\nproperty double z\n%send_header\n",
                  c->n,
                  c->normals != NULL
                      ? "property double nx\nproperty double ny\nproperty double nz\n"
                      : "");
    for (size_t i = 0; i < c->n; i++) {
        for (int k = 0; k < 3; k++)
            (void)fprintf(to, "%.17g ", c->points[i][k]);
        for (int k = 0; k < 3 && c->normals != NULL; k++)
            (void)fprintf(to, "%.9g ", c->normals[i][k]);
        (void)fprintf(to, "\n");
    }
    return ST_OK;
}

/* The grid of a depth image is lost. */
static enum status write_copy(const struct pair *p, const char *kind, uint64_t seed,
                              struct errinfo *e)
{
    char path[4096];

    if (p->j->write == NULL)
        return ST_OK;
    (void)snprintf(path, sizeof path, "%s/%s-%s-%llu.ply", p->j->write, p->s->name, kind,
                   (unsigned long long)seed);
    return outfile_write(path, true, write_points, &p->copy, e);
}

/* ---- a copy is compared */

static uint32_t cells_of(const struct surface_parts *parts)
{
    uint32_t n = 0;

    for (int i = 0; i < SURFACE_CELLS; i++)
        n += isnan(parts->gap_mm[i]) ? 0 : 1;
    return n;
}

static const char *const decisions[] = {
    [SURFACE_MATCH] = "match",
    [SURFACE_NO_MATCH] = "no_match",
    [SURFACE_INCONCLUSIVE] = "inconclusive",
};

/* Compares the copy's face with the scan's, in both directions.  *fault: NULL, if it matches. */
static enum status judge(struct pair *p, const struct surface_face *copy, struct count *c,
                         struct surface_comparison *one, const char **fault)
{
    struct surface_comparison other = {0};
    bool lopsided, vague;

    if (surface_compare(p->w, p->face, copy, one) != SURFACE_OK ||
        surface_compare(p->w, copy, p->face, &other) != SURFACE_OK)
        return ST_ENOMEM;
    lopsided = fabs(one->score - other.score) > SAME_SCORE;
    if (surface_compare_again(p->w, p->face, copy, one) != SURFACE_OK)
        return ST_ENOMEM;
    vague = one->decision == SURFACE_INCONCLUSIVE && one->score < ENOUGH * p->self;
    c->no_match += one->decision == SURFACE_NO_MATCH;
    c->inconclusive += vague;
    c->lopsided += lopsided;
    if (one->decision == SURFACE_NO_MATCH || vague)
        *fault = decisions[one->decision];
    else if (lopsided)
        *fault = "lopsided";
    return ST_OK;
}

/* How far at most the face's corners lie apart in both frames, mm. */
static double frames_apart(const struct pair *p, const double frame[16])
{
    double most = 0;

    for (int i = 0; i < 4; i++) {
        const struct dvec3 corner = {i % 2 != 0 ? ELLIPSE_X : -ELLIPSE_X,
                                     i / 2 != 0 ? ELLIPSE_Y : -ELLIPSE_Y, 0};
        const struct dvec3 at = back(p->frame, corner);
        const struct dvec3 off =
            vec_sub(vec_transform(frame, change_apply(&p->change, at)), corner);

        most = fmax(most, sqrt(vec_dot(off, off)));
    }
    return most;
}

/* What is known of a copy that was compared: the least score, and where it is wanted a line. */
static enum status tell(struct pair *p, const struct surface_face *copy,
                        const struct surface_found *found,
                        const struct surface_comparison *one, struct count *c, bool aloud)
{
    struct surface_disparity least = {0};
    struct surface_parts parts = {0};
    double to[16], frame[16];

    surface_face_frame(copy, to);
    if (surface_disparity(p->w, p->face, copy, &least) != SURFACE_OK ||
        surface_parts(p->w, p->face, copy, &parts) != SURFACE_OK)
        return ST_ENOMEM;
    if (one->score < c->score) {
        c->score = one->score;
        c->disparity_mm = least.disparity_mm;
    }
    if (!aloud)
        return ST_OK;
    multiply(to, found->view, frame);
    (void)fprintf(p->lines,
                  "score %.1f disparity %.3f size %.3f cells %u frame %.1f crop %d "
                  "%d covered %.2f %.2f\n",
                  one->score, least.disparity_mm, parts.scale, cells_of(&parts),
                  frames_apart(p, frame), p->found.cropped, found->cropped,
                  p->found.occluded, found->occluded);
    return ST_OK;
}

static void tell_refused(struct pair *p, const struct surface_found *f)
{
    (void)fprintf(p->lines,
                  "support %.2f likeness %.2f seen %.2f covered %.2f size %.3f\n",
                  f->support, f->likeness, f->seen, f->occluded, f->head_size);
}

/* Builds the copy, compares it and tells what came of it. */
static enum status judge_copy(struct pair *p, const struct kind *k, uint64_t seed,
                              struct surface_face **copy, const char **fault)
{
    struct count *c = &p->s->count[k - kinds];
    struct surface_found why = {0}, found = {0};
    struct surface_comparison one = {.score = INFINITY};
    enum surface_status refused, st;

    st = surface_check(p->w, &p->copy, copy, &refused, &why, &found);
    if (st == SURFACE_ENOMEM ||
        (st == SURFACE_OK && judge(p, *copy, c, &one, fault) != ST_OK))
        return ST_ENOMEM;
    c->copies++;
    c->not_enrolled += refused != SURFACE_OK && !p->s->lenient;
    c->refused += st != SURFACE_OK;
    if (st != SURFACE_OK)
        *fault = surface_message(st);
    if (*fault == NULL && !p->j->list && one.score >= c->score)
        return ST_OK;
    if (*fault != NULL || p->j->list)
        (void)fprintf(p->lines, "%s %s %s %llu: %s ", *fault != NULL ? "FAIL" : "FINE",
                      p->s->path, k->name, (unsigned long long)seed,
                      *fault != NULL ? *fault : decisions[one.decision]);
    if (st == SURFACE_OK)
        return tell(p, *copy, &found, &one, c, *fault != NULL || p->j->list);
    tell_refused(p, &found);
    return ST_OK;
}

static enum status try_copy(struct pair *p, const struct kind *k, uint64_t seed,
                            struct errinfo *e)
{
    struct surface_face *copy = NULL;
    const char *fault = NULL;
    enum status st;

    make_copy(p, k, seed);
    st = judge_copy(p, k, seed, &copy, &fault);
    surface_face_free(copy);
    if (st != ST_OK)
        return errinfo_set(e, st, "out of memory");
    return fault != NULL ? write_copy(p, k->name, seed, e) : ST_OK;
}

/* ---- a scan */

static enum status try_copies(struct pair *p, struct errinfo *e)
{
    const struct jitter *j = p->j;
    enum status st = ST_OK;

    for (uint64_t i = 0; st == ST_OK && i < (uint64_t)j->copies; i++) {
        const size_t turns = j->kind < 0 ? KINDS : 1;
        const struct kind *k = &kinds[j->kind < 0 ? i % KINDS : (size_t)j->kind];

        if (j->frontal && (k->picture || k->any))
            continue;
        st = try_copy(p, k, (uint64_t)j->seed + i / turns, e);
    }
    return st;
}

static struct surface_cloud whole(const struct pair *p)
{
    const struct cloudpoints *c = &p->cloud;
    const double usual = c->usual_mm != 0 ? c->usual_mm : 1;

    return (struct surface_cloud){
        .points = (const double(*)[3])c->at,
        .normals = (const double(*)[3])c->normal,
        .n = c->n,
        .width = c->width,
        .height = c->height,
        .unit_mm = p->j->frontal && c->unit_mm == 0 ? usual : c->unit_mm,
        .flags = p->j->frontal ? SURFACE_FRONTAL : 0,
        .place = c->index};
}

/* The scan's own face, which the copies are compared with. */
static enum status build(struct pair *p)
{
    struct surface_found why = {0};
    struct surface_comparison self = {0};
    enum surface_status refused;
    double frame[16];

    p->copy = whole(p);
    p->cloud.unit_mm = p->copy.unit_mm;
    p->s->refused =
        surface_check(p->w, &p->copy, &p->face, &refused, &why, &p->found) != SURFACE_OK;
    p->s->lenient = refused != SURFACE_OK;
    if (p->s->refused) {
        (void)fprintf(p->lines, "REFUSED %s: %s\n", p->s->path, surface_message(refused));
        return ST_OK;
    }
    if (p->s->lenient)
        (void)fprintf(p->lines, "PROBE %s: %s for an enrolment\n", p->s->path,
                      surface_message(refused));
    (void)surface_face_frame(p->face, frame);
    multiply(frame, p->found.view, p->frame);
    if (surface_compare(p->w, p->face, p->face, &self) != SURFACE_OK)
        return ST_ENOMEM;
    p->self = self.score;
    p->s->vague = self.decision != SURFACE_MATCH;
    if (p->s->vague)
        (void)fprintf(p->lines, "VAGUE %s: %s with itself, score %.1f\n", p->s->path,
                      decisions[self.decision], self.score);
    return ST_OK;
}

static enum status alloc(struct pair *p)
{
    const size_t n = p->cloud.n + 1;

    p->at = mem_array(n, sizeof *p->at);
    p->normal = mem_array(n, sizeof *p->normal);
    p->place = mem_array(n, sizeof *p->place);
    p->rank = mem_array(n, sizeof *p->rank);
    p->lines = open_memstream(&p->s->lines, &p->s->length);
    return p->at != NULL && p->normal != NULL && p->place != NULL && p->rank != NULL &&
                   p->lines != NULL
               ? ST_OK
               : ST_ENOMEM;
}

static enum status try_scan(void *arg, size_t i, struct surface_work *w,
                            struct errinfo *e)
{
    struct jitter *j = arg;
    struct pair p = {.j = j, .s = &j->scan[i], .w = w};
    enum status st = cloudfile_read_path(p.s->path, j->unit_mm, &j->camera, &p.cloud, e);

    if (st != ST_OK)
        return st;
    if ((st = alloc(&p)) == ST_OK)
        st = build(&p);
    if (st != ST_OK)
        (void)errinfo_set(e, st, "out of memory");
    if (st == ST_OK && !p.s->refused) {
        p.copy.points = (const double(*)[3])p.at;
        p.copy.normals = p.cloud.normal != NULL ? (const double(*)[3])p.normal : NULL;
        p.copy.place = p.copy.width != 0 ? p.place : NULL;
        st = try_copies(&p, e);
    }
    if (p.lines != NULL)
        (void)fclose(p.lines);
    surface_face_free(p.face);
    cloudpoints_free(&p.cloud);
    mem_free(p.at);
    mem_free(p.normal);
    mem_free(p.place);
    mem_free(p.rank);
    return st;
}

/* ---- the report */

static void add(struct count *to, const struct count *c)
{
    to->copies += c->copies;
    to->refused += c->refused;
    to->no_match += c->no_match;
    to->inconclusive += c->inconclusive;
    to->not_enrolled += c->not_enrolled;
    to->lopsided += c->lopsided;
    if (c->score < to->score) {
        to->score = c->score;
        to->disparity_mm = c->disparity_mm;
    }
}

static void print_count(const char *name, const struct count *c)
{
    (void)printf("%-10s %7u %8u %9u %13u %9u %13u", name, c->copies, c->refused,
                 c->no_match, c->inconclusive, c->lopsided, c->not_enrolled);
    if (isfinite(c->score))
        (void)printf(" %7.1f %10.3f", c->score, c->disparity_mm);
    (void)printf("\n");
}

/* Returns true if a copy failed. */
static bool report(const struct jitter *j)
{
    struct count sum[KINDS + 1];
    const struct count *all = &sum[KINDS];
    unsigned refused = 0, lenient = 0, vague = 0;

    for (size_t k = 0; k <= KINDS; k++)
        sum[k] = (struct count){.score = INFINITY};
    for (size_t i = 0; i < j->n; i++) {
        const struct scan *s = &j->scan[i];

        (void)fputs(s->lines, stdout);
        refused += s->refused;
        lenient += s->lenient && !s->refused;
        vague += s->vague;
        for (size_t k = 0; k < KINDS; k++) {
            add(&sum[k], &s->count[k]);
            add(&sum[KINDS], &s->count[k]);
        }
    }
    (void)printf(
        "%zu scans: %u refused, %u not for an enrolment alone, %u not conclusive "
        "with themselves\n",
        j->n, refused, lenient, vague);
    (void)printf("kind        copies  refused  no_match  inconclusive  lopsided  "
                 "not enrolled   worst  disparity\n");
    for (size_t k = 0; k < KINDS; k++)
        print_count(kinds[k].name, &sum[k]);
    print_count("all", all);
    return all->refused + all->no_match + all->inconclusive + all->lopsided > 0;
}

/* ---- the command line */

/* Takes ownership of path, by malloc(); NULL: out of memory. */
static bool add_scan(struct jitter *j, char *path)
{
    struct scan *list = realloc(j->scan, (j->n + 1) * sizeof *list);
    struct scan *s;

    j->scan = list != NULL ? list : j->scan;
    if (list == NULL || path == NULL) {
        free(path);
        return false;
    }
    s = &j->scan[j->n++];
    *s = (struct scan){.path = path};
    s->name = strrchr(path, '/');
    s->name = s->name != NULL ? s->name + 1 : path;
    for (size_t k = 0; k < KINDS; k++)
        s->count[k].score = INFINITY;
    return true;
}

/* A file in a folder, if it is a scan. */
static bool add_entry(struct jitter *j, const char *dir, const char *name)
{
    const size_t length = strlen(dir) + strlen(name) + 2;
    char *path = malloc(length);

    if (path == NULL)
        return false;
    (void)snprintf(path, length, "%s/%s", dir, name);
    if (corpus_is_scan(path))
        return add_scan(j, path);
    free(path);
    return true;
}

/* A file, or the scans in a folder, by name. */
static bool add_path(struct jitter *j, const char *path)
{
    struct dirent **entry;
    struct stat about;
    bool fine = true;
    int n;

    if (stat(path, &about) != 0 || !S_ISDIR(about.st_mode))
        return add_scan(j, strdup(path));
    if ((n = scandir(path, &entry, NULL, alphasort)) < 0)
        return false;
    for (int i = 0; i < n; i++) {
        fine = fine && add_entry(j, path, entry[i]->d_name);
        free(entry[i]);
    }
    free(entry);
    return fine;
}

static bool read_kind(const char *text, int *kind)
{
    for (size_t k = 0; k < KINDS; k++)
        if (strcmp(kinds[k].name, text) == 0) {
            *kind = (int)k;
            return true;
        }
    return false;
}

static bool read_option(struct jitter *j, const char *name, const char *value)
{
    if (strcmp(name, "--copies") == 0)
        return command_number(value, 1, 1e9, &j->copies);
    if (strcmp(name, "--seed") == 0)
        return command_number(value, 0, 9e15, &j->seed);
    if (strcmp(name, "--threads") == 0)
        return command_number(value, 1, 64, &j->threads);
    if (strcmp(name, "--units") == 0)
        return cloudfile_option_units(value, &j->unit_mm) == NULL;
    if (strcmp(name, "--camera") == 0)
        return cloudfile_option_camera(value, &j->camera) == NULL;
    if (strcmp(name, "--axes") == 0)
        return cloudfile_option_axes(value, &j->frontal) == NULL;
    if (strcmp(name, "--kind") == 0)
        return read_kind(value, &j->kind);
    if (strcmp(name, "--write") != 0)
        return false;
    j->write = value;
    return true;
}

/* Returns 0, or 2 after it has said what is wrong. */
static int read_command(int argc, char **argv, struct jitter *j)
{
    char list[256] = "";

    for (int i = 1; i < argc; i++) {
        const bool option = strncmp(argv[i], "--", 2) == 0;

        if (strcmp(argv[i], "--list") == 0) {
            j->list = true;
        } else if (option && i + 1 < argc && read_option(j, argv[i], argv[i + 1])) {
            i++;
        } else if (option) {
            for (size_t k = 0; k < KINDS; k++)
                (void)snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s",
                               k > 0 ? ", " : "", kinds[k].name);
            (void)fprintf(stderr, usage, list);
            return 2;
        } else if (!add_path(j, argv[i])) {
            (void)fprintf(stderr, "jitter: %s: %s\n", argv[i], strerror(errno));
            return 2;
        }
    }
    if (j->n == 0)
        (void)fprintf(stderr, "jitter: no scans\n");
    return j->n == 0 ? 2 : 0;
}

int main(int argc, char **argv)
{
    struct jitter j = {.copies = KINDS, .kind = -1, .camera = CLOUDDEPTH_NO_CAMERA};
    struct errinfo e;
    int rc = read_command(argc, argv, &j);

    if (rc == 0 &&
        pool_run("jitter", (uint32_t)j.threads, NULL, j.n, try_scan, &j, &e) != ST_OK) {
        (void)fprintf(stderr, "jitter: %s\n", e.msg);
        rc = 2;
    }
    if (rc == 0)
        rc = report(&j) ? 1 : 0;
    for (size_t i = 0; i < j.n; i++) {
        free(j.scan[i].path);
        free(j.scan[i].lines);
    }
    free(j.scan);
    if (!outfile_flush(stdout))
        rc = 2;
    return rc;
}
