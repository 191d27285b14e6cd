/* jitter -- compares scans with changed copies of themselves.  A copy that does not match is a fault
 * of the frame, the crop or the cover.  No labels are needed. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clouddepth.h"
#include "cloudfile.h"
#include "command.h"
#include "draw.h"
#include "errinfo.h"
#include "libsurface.h"
#include "mem.h"
#include "outfile.h"
#include "vec.h"

static const char usage[] =
    "usage: jitter COPIES SEED FILE...\n"
    "Compare each scan with changed copies of itself, and list those that do not match.\n"
    "  COPIES  of each scan; their kinds take turns\n"
    "  SEED    of all that is drawn; it grows by one after each kind had its turn\n"
    "Exit status: 0 if nothing failed, 1 if a copy failed, 2 if there is no result.\n";

/* Kinds of change.  The first rows change a scan least, the last one combines most changes. */
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

/* Results of the copies of a kind. */
struct count {
    uint32_t copies, refused, no_match, inconclusive;
    uint32_t lopsided; /* another score with template and probe exchanged */
    double score;      /* the least one */
};

/* How the points move, and which are left. */
struct change {
    struct dvec3 axis, about, view, shift;
    double rad, noise, by, far, drop;
    size_t step, first;
};

/* A scan and a copy while they are compared. */
struct pair {
    const char *path;
    struct surface_work *w;
    struct cloudpoints cloud; /* of the scan */
    struct surface_face *face;
    struct surface_found found;
    double self; /* score with itself */
    double
        frame[16]; /* from the scan's points to the frame with the nose at its origin */

    struct surface_cloud copy; /* whose memory is this, [cloud.n] each: */
    double (*at)[3], (*normal)[3];
    uint32_t *place;
    double *rank;
};

/* ---- what a copy is */

/* Sets out to the product of a and b, row-major 4 x 4. */
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

/* Returns the point that the similarity m moves to q. */
static struct dvec3 back(const double m[16], struct dvec3 q)
{
    const struct dvec3 x = {m[0], m[1], m[2]};
    const struct dvec3 t = vec_sub(q, (struct dvec3){m[3], m[7], m[11]});
    const double square = vec_dot(x, x);

    return (struct dvec3){(m[0] * t.x + m[4] * t.y + m[8] * t.z) / square,
                          (m[1] * t.x + m[5] * t.y + m[9] * t.z) / square,
                          (m[2] * t.x + m[6] * t.y + m[10] * t.z) / square};
}

/* Returns the unit vector from the face to the scanner, in the scan's coordinates. */
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

/* Returns p rotated about a unit vector. */
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

/* Returns the squared distance of a point from the nose in half axes of the ellipse: 1 on the ellipse. */
static double far_out(const struct pair *p, struct dvec3 at)
{
    const struct dvec3 q = vec_transform(p->frame, at);

    return q.x * q.x / (ELLIPSE_X * ELLIPSE_X) + q.y * q.y / (ELLIPSE_Y * ELLIPSE_Y);
}

/* Returns the far_out() that this share of the face's points exceeds. */
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

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');

    return slash != NULL ? slash + 1 : path;
}

/* Fills p->copy; its points keep the scan's order. */
static void make_copy(struct pair *p, const struct kind *k, uint64_t seed)
{
    const struct cloudpoints *from = &p->cloud;
    uint64_t name = 14695981039346656037U; /* FNV-1a: the same wherever the file is */
    struct change c;
    struct draw r;
    size_t n = 0;

    for (const char *s = base_name(p->path); *s != '\0'; s++)
        name = (name ^ (unsigned char)*s) * 1099511628211U;
    r = draw_stream(seed, name, (uint64_t)(k - kinds));
    c = draw_change(p, k, &r);
    for (size_t i = 0; i < from->n; i++) {
        const bool drop = draw_uniform(&r, 0, 1) < c.drop;
        const double noise = c.noise > 0 ? c.noise * draw_normal(&r) : 0;
        const struct dvec3 at = from->at[i];

        if (drop || i % c.step != c.first || far_out(p, at) > c.far)
            continue;
        put(p->at[n], change_apply(&c, vec_along(at, noise, c.view)));
        if (from->normal != NULL)
            put(p->normal[n], turn(from->normal[i], c.axis, c.rad));
        p->place[n++] = from->index != NULL ? from->index[i] : (uint32_t)i;
    }
    p->copy.n = n;
    p->copy.unit_mm = p->cloud.unit_mm / c.by;
}

/* ---- a copy is compared */

static const char *const decisions[] = {
    [SURFACE_MATCH] = "match",
    [SURFACE_NO_MATCH] = "no_match",
    [SURFACE_INCONCLUSIVE] = "inconclusive",
};

/* Compares the copy's face with the scan's, in both directions.  *fault: NULL, if it matches. */
static enum status judge(struct pair *p, const struct surface_face *copy, struct count *c,
                         const char **fault)
{
    struct surface_comparison one = {0}, other = {0};
    bool lopsided, vague;

    if (surface_compare(p->w, p->face, copy, &one) != SURFACE_OK ||
        surface_compare(p->w, copy, p->face, &other) != SURFACE_OK)
        return ST_ENOMEM;
    lopsided = fabs(one.score - other.score) > SAME_SCORE;
    if (surface_compare_again(p->w, p->face, copy, &one) != SURFACE_OK)
        return ST_ENOMEM;
    vague = one.decision == SURFACE_INCONCLUSIVE && one.score < ENOUGH * p->self;
    c->no_match += one.decision == SURFACE_NO_MATCH;
    c->inconclusive += vague;
    c->lopsided += lopsided;
    c->score = fmin(c->score, one.score);
    if (one.decision == SURFACE_NO_MATCH || vague)
        *fault = decisions[one.decision];
    else if (lopsided)
        *fault = "lopsided";
    return ST_OK;
}

static enum status try_copy(struct pair *p, const struct kind *k, uint64_t seed,
                            struct count *c)
{
    struct surface_face *copy = NULL;
    struct surface_found found;
    const char *fault = NULL;
    enum surface_status built;
    enum status st = ST_OK;

    make_copy(p, k, seed);
    built = surface_build(p->w, &p->copy, &copy, &found);
    if (built == SURFACE_OK)
        st = judge(p, copy, c, &fault);
    else if (built == SURFACE_ENOMEM)
        st = ST_ENOMEM;
    else
        fault = surface_message(built);
    c->copies++;
    c->refused += built != SURFACE_OK;
    if (fault != NULL)
        (void)printf("FAIL %s %s %llu: %s\n", p->path, k->name, (unsigned long long)seed,
                     fault);
    surface_face_free(copy);
    return st;
}

/* ---- a scan */

static struct surface_cloud whole(const struct pair *p)
{
    const struct cloudpoints *c = &p->cloud;

    return (struct surface_cloud){.points = (const double(*)[3])c->at,
                                  .normals = (const double(*)[3])c->normal,
                                  .n = c->n,
                                  .width = c->width,
                                  .height = c->height,
                                  .unit_mm = c->unit_mm,
                                  .place = c->index};
}

/* Builds the scan's own face, which the copies are compared with; p->face is NULL afterwards if the
 * scan is refused. */
static enum status build(struct pair *p)
{
    struct surface_comparison self = {0};
    enum surface_status st;
    double frame[16];

    p->copy = whole(p);
    st = surface_build(p->w, &p->copy, &p->face, &p->found);
    if (st == SURFACE_ENOMEM)
        return ST_ENOMEM;
    if (st != SURFACE_OK) {
        (void)printf("REFUSED %s: %s\n", p->path, surface_message(st));
        return ST_OK;
    }
    (void)surface_face_frame(p->face, frame);
    multiply(frame, p->found.view, p->frame);
    if (surface_compare(p->w, p->face, p->face, &self) != SURFACE_OK)
        return ST_ENOMEM;
    p->self = self.score;
    return ST_OK;
}

static bool alloc(struct pair *p)
{
    const size_t n = p->cloud.n + 1;

    p->at = mem_array(n, sizeof *p->at);
    p->normal = mem_array(n, sizeof *p->normal);
    p->place = mem_array(n, sizeof *p->place);
    p->rank = mem_array(n, sizeof *p->rank);
    return p->at != NULL && p->normal != NULL && p->place != NULL && p->rank != NULL;
}

static enum status try_copies(struct pair *p, uint64_t copies, uint64_t seed,
                              struct count count[KINDS])
{
    enum status st = alloc(p) ? build(p) : ST_ENOMEM;

    if (st != ST_OK || p->face == NULL)
        return st;
    p->copy.points = (const double(*)[3])p->at;
    p->copy.normals = p->cloud.normal != NULL ? (const double(*)[3])p->normal : NULL;
    p->copy.place = p->copy.width != 0 ? p->place : NULL;
    for (uint64_t i = 0; st == ST_OK && i < copies; i++)
        st = try_copy(p, &kinds[i % KINDS], seed + i / KINDS, &count[i % KINDS]);
    return st;
}

static enum status try_scan(struct surface_work *w, const char *path, uint64_t copies,
                            uint64_t seed, struct count count[KINDS], struct errinfo *e)
{
    const struct clouddepth_camera camera = CLOUDDEPTH_NO_CAMERA;
    struct pair p = {.path = path, .w = w};
    enum status st = cloudfile_read_path(path, 0, &camera, &p.cloud, e);

    if (st != ST_OK)
        return st;
    st = try_copies(&p, copies, seed, count);
    surface_face_free(p.face);
    cloudpoints_free(&p.cloud);
    mem_free(p.at);
    mem_free(p.normal);
    mem_free(p.place);
    mem_free(p.rank);
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "out of memory");
}

/* ---- the report */

static void print_count(const char *name, const struct count *c)
{
    (void)printf("%-10s %7u %8u %9u %13u %9u", name, c->copies, c->refused, c->no_match,
                 c->inconclusive, c->lopsided);
    if (isfinite(c->score))
        (void)printf(" %7.1f", c->score);
    (void)printf("\n");
}

/* Returns true if a copy failed. */
static bool report(const struct count count[KINDS])
{
    struct count all = {.score = INFINITY};

    (void)printf(
        "kind        copies  refused  no_match  inconclusive  lopsided   worst\n");
    for (size_t k = 0; k < KINDS; k++) {
        const struct count *c = &count[k];

        all.copies += c->copies;
        all.refused += c->refused;
        all.no_match += c->no_match;
        all.inconclusive += c->inconclusive;
        all.lopsided += c->lopsided;
        all.score = fmin(all.score, c->score);
        print_count(kinds[k].name, c);
    }
    print_count("all", &all);
    return all.refused + all.no_match + all.inconclusive + all.lopsided > 0;
}

int main(int argc, char **argv)
{
    struct surface_work *w = surface_work_new(NULL);
    struct count count[KINDS];
    enum status st = ST_OK;
    struct errinfo e;
    double copies, seed;
    bool failed;

    if (argc < 4 || !command_number(argv[1], 1, 1e9, &copies) ||
        !command_number(argv[2], 0, 9e15, &seed)) {
        surface_work_free(w);
        (void)fputs(usage, stderr);
        return 2;
    }
    for (size_t k = 0; k < KINDS; k++)
        count[k] = (struct count){.score = INFINITY};
    if (w == NULL)
        st = errinfo_memory(&e);
    for (int i = 3; st == ST_OK && i < argc; i++)
        st = try_scan(w, argv[i], (uint64_t)copies, (uint64_t)seed, count, &e);
    surface_work_free(w);
    if (st != ST_OK)
        (void)fprintf(stderr, "jitter: %s\n", e.msg);
    failed = st == ST_OK && report(count);
    return !outfile_flush(stdout) || st != ST_OK ? 2 : failed;
}
