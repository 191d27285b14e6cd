#include "population_render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "morphable.h"
#include "pool.h"
#include "shape_map.h"

#define PEOPLE      POPULATION_RENDER_PEOPLE
#define EXPRESSIONS POPULATION_RENDER_EXPRESSIONS

/* Cells in use: covered by this share of the people, of this cosine of the mean face's slope, and
 * from the chin to the forehead. */
#define COVERED    0.98
#define FLAT       0.4f
#define LOWEST_MM  (-88.0)
#define HIGHEST_MM 66.0

#define EXPRESSED_DEVIATION 0.8f /* of people whose expressions are rendered */

/* Gaps are cut off: beyond them another part of the head comes into view, at the jaw above all.
 * Of the people's 0.1 % are, without which a third of what 30 modes leave would be such. */
#define FARTHEST_EXPRESSION_MM 12.0f
#define FARTHEST_PERSON_MM     17.0f

/* The factors of B and W, and the fields: deviation and length. */
#define IDENTITY_SHARE    0.49
#define IDENTITY_FIELD    0.6, 14.0
#define CHANGE_FACTOR     2.0
#define CHANGE_TISSUE     1.0, 20.0 /* where soft tissue lies deep */
#define CHANGE_BONE_SHARE 0.25
#define CHANGE_FIELD      0.4, 35.0
#define SHAPE_FIELD       0.6, 15.0
#define SHAPE_IDENTITY    1.44 /* 60 modes of the people, */
#define SHAPE_PEOPLE      60
#define SHAPE_EXPRESSIONS 40 /* 40 of the expressions */

struct rendering {
    const struct morphable *m;
    float (*people)[GRID_N]; /* [PEOPLE] heights, mm; NAN: none */
    float (
        *expressions)[GRID_N]; /* [EXPRESSIONS] heights less those of the neutral face */
};

static enum status no_memory(struct errinfo *e)
{
    return errinfo_set(e, ST_ENOMEM, "out of memory");
}

/* A sample's own random numbers, whichever thread draws them. */
static uint64_t seed(uint32_t kind, size_t i)
{
    return ((uint64_t)kind << 32) + i;
}

static enum status render_person(void *arg, size_t i, struct surface_work *w,
                                 struct errinfo *e)
{
    struct rendering *r = arg;
    float *at = malloc(3 * (size_t)r->m->nv * sizeof *at);
    uint64_t random = seed(1, i);

    (void)w;
    if (at == NULL)
        return no_memory(e);
    morphable_person(r->m, 1.0f, &random, at);
    morphable_heights(r->m, at, r->people[i]);
    free(at);
    return ST_OK;
}

static enum status render_expression(void *arg, size_t i, struct surface_work *w,
                                     struct errinfo *e)
{
    struct rendering *r = arg;
    float *at = malloc(3 * (size_t)r->m->nv * sizeof *at), neutral[GRID_N];
    uint64_t random = seed(2, i);

    (void)w;
    if (at == NULL)
        return no_memory(e);
    morphable_person(r->m, EXPRESSED_DEVIATION, &random, at);
    morphable_heights(r->m, at, neutral);
    morphable_express(r->m, &random, at);
    morphable_heights(r->m, at, r->expressions[i]);
    for (uint32_t c = 0; c < GRID_N; c++)
        r->expressions[i][c] -= neutral[c];
    free(at);
    return ST_OK;
}

/* ---- the mean face */

static void mean_of(const struct rendering *r, float mean[GRID_N], float covered[GRID_N])
{
    float whole[GRID_N];

    for (uint32_t c = 0; c < GRID_N; c++) {
        double sum = 0;
        uint32_t n = 0;

        for (size_t i = 0; i < PEOPLE; i++)
            if (!isnan(r->people[i][c])) {
                sum += (double)r->people[i][c];
                n++;
            }
        whole[c] = n > 0 ? (float)(sum / n) : (float)NAN;
        covered[c] = (float)n / (float)PEOPLE;
    }
    for (uint32_t c = 0; c < GRID_N; c++)
        mean[c] = (whole[c] + whole[grid_mirror(c)]) / 2;
}

static bool in_use(const float mean[GRID_N], const float covered[GRID_N], uint32_t c)
{
    float x, y;

    if (isnan(mean[c]) || !((double)covered[c] > COVERED) || grid_y(c) < LOWEST_MM ||
        grid_y(c) > HIGHEST_MM)
        return false;
    shape_map_slope(mean, c, &x, &y);
    return 1.0f / sqrtf(1.0f + (x * x + y * y)) > FLAT;
}

/* Is the cell, which is in use, beside one of the face?  The grid's edge has none beyond it. */
static bool joins(const bool *face, uint32_t c)
{
    const uint32_t column = c % GRID_NX;

    return (column > 0 && face[c - 1]) || (column < GRID_NX - 1 && face[c + 1]) ||
           (c >= GRID_NX && face[c - GRID_NX]) ||
           (c + GRID_NX < GRID_N && face[c + GRID_NX]);
}

/* The face is what hangs together with the bridge of the nose: the neck does not. */
static void only_face(float used[GRID_N])
{
    bool face[GRID_N] = {false}, more = true;

    face[grid_cell(0, 20)] = true;
    while (more) {
        more = false;
        for (uint32_t c = 0; c < GRID_N; c++)
            if (!face[c] && !isnan(used[c]) && joins(face, c))
                face[c] = more = true;
    }
    for (uint32_t c = 0; c < GRID_N; c++)
        if (!face[c])
            used[c] = (float)NAN;
}

static enum status find_mean(const struct rendering *r, struct population *p)
{
    float mean[GRID_N], covered[GRID_N], used[GRID_N];

    mean_of(r, mean, covered);
    for (uint32_t c = 0; c < GRID_N; c++)
        used[c] = in_use(mean, covered, c) ? mean[c] : (float)NAN;
    only_face(used);
    return population_begin(used, p);
}

/* ---- the spreads */

static void add_sample(const struct population *p, const float gap[GRID_N], double by,
                       struct spread *s)
{
    double even[GRID_N / 2], odd[GRID_N / 2];

    spread_split(&p->cells, gap, (double *[]){even, odd});
    spread_add_pattern(s, false, even, by);
    spread_add_pattern(s, true, odd, by);
}

static float cut_off(float gap, float most)
{
    return isnan(gap) ? gap : fminf(fmaxf(gap, -most), most);
}

static void add_people(const struct rendering *r, const struct population *p,
                       struct spread *s)
{
    float gap[GRID_N];

    for (size_t i = 0; i < PEOPLE; i++) {
        for (uint32_t c = 0; c < GRID_N; c++)
            gap[c] = cut_off((r->people[i][c] - p->mean[c]) * p->normal_z[c],
                             FARTHEST_PERSON_MM);
        add_sample(p, gap, 1.0 / PEOPLE, s);
    }
    population_still(p, s);
}

static void add_expressions(const struct rendering *r, const struct population *p,
                            struct spread *s)
{
    float gap[GRID_N];

    for (size_t i = 0; i < EXPRESSIONS; i++) {
        for (uint32_t c = 0; c < GRID_N; c++)
            gap[c] =
                cut_off(r->expressions[i][c] * p->normal_z[c], FARTHEST_EXPRESSION_MM);
        add_sample(p, gap, 1.0 / EXPRESSIONS, s);
    }
    population_still(p, s);
}

/* How deep soft tissue lies, 0..1: on the lower face, less above the lower lids and on the
 * nose. */
static double tissue(uint32_t c)
{
    const double x = grid_x(c), y = grid_y(c), up = (y - 8) / 12;
    /* 0 below to 1 above, within some 20 mm */
    const double above = (1 + up / sqrt(1 + up * up)) / 2;

    if (fabs(x) < 18 && y > -12 && y < 34)
        return CHANGE_BONE_SHARE;
    return 1 - (1 - CHANGE_BONE_SHARE) * above;
}

/* Fields over the whole face, and where soft tissue lies. */
static void add_field(const struct population *p, double mm, double length_mm,
                      double (*share)(uint32_t), struct spread *s)
{
    double deviation[GRID_N];

    for (uint32_t c = 0; c < GRID_N; c++)
        deviation[c] = mm * (share != NULL ? share(c) : 1);
    spread_add_field(s, &p->cells, deviation, length_mm);
}

/* The k leading modes of s alone, times by; s is used up. */
static enum status add_leading(struct spread *s, uint32_t k, double by, struct spread *to)
{
    struct spread_mode mode[SHAPE_PEOPLE];
    const enum status st = spread_lead(s, k, mode);

    for (uint32_t i = 0; st == ST_OK && i < k; i++)
        spread_add_pattern(to, mode[i].odd, mode[i].pattern, by * mode[i].variance);
    if (st == ST_OK)
        spread_release(mode, k);
    return st;
}

static enum status spread_all(const struct rendering *r, struct population *p)
{
    struct spread people, expressions = {0};
    enum status st = spread_new(p->cells.n, &people);

    if (st == ST_OK)
        st = spread_new(p->cells.n, &expressions);
    if (st == ST_OK) {
        add_people(r, p, &people);
        add_expressions(r, p, &expressions);
        spread_add(&p->identity, &people, IDENTITY_SHARE);
        add_field(p, IDENTITY_FIELD, NULL, &p->identity);
        spread_add(&p->change, &expressions, CHANGE_FACTOR);
        add_field(p, CHANGE_TISSUE, tissue, &p->change);
        add_field(p, CHANGE_FIELD, NULL, &p->change);
        add_field(p, SHAPE_FIELD, NULL, &p->shape);
        population_still(p, &p->identity);
        population_still(p, &p->change);
        population_still(p, &p->shape);
        st = add_leading(&people, SHAPE_PEOPLE, SHAPE_IDENTITY, &p->shape);
    }
    if (st == ST_OK)
        st = add_leading(&expressions, SHAPE_EXPRESSIONS, 1, &p->shape);
    spread_free(&people);
    spread_free(&expressions);
    return st;
}

enum status population_render(const struct morphable *m, unsigned threads,
                              struct population *p, struct errinfo *e)
{
    struct rendering r = {.m = m};
    enum status st = ST_ENOMEM;

    memset(p, 0, sizeof *p);
    r.people = calloc(PEOPLE, sizeof *r.people);
    r.expressions = calloc(EXPRESSIONS, sizeof *r.expressions);
    if (r.people == NULL || r.expressions == NULL) {
        (void)no_memory(e);
        goto out;
    }
    st = pool_run("people", threads, NULL, PEOPLE, render_person, &r, e);
    if (st == ST_OK)
        st =
            pool_run("expressions", threads, NULL, EXPRESSIONS, render_expression, &r, e);
    if (st != ST_OK)
        goto out;
    st = find_mean(&r, p);
    if (st == ST_EINVAL)
        st = errinfo_set(e, ST_ENOTFACE,
                         "the random people of the morphable model have too little of a "
                         "face in common");
    else if (st != ST_OK || (st = spread_all(&r, p)) != ST_OK)
        (void)errinfo_set(e, st, "the morphable model: %s", status_message(st));
out:
    free(r.people);
    free(r.expressions);
    if (st != ST_OK)
        population_free(p);
    return st;
}
