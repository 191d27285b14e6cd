#include "population.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "encode.h"

#define NOISE_MM 1.0 /* of a cell, where modes of identity are weighed against the rest */
#define SHAPE_MM 0.5 /* that a shape's rest has besides what its modes leave */
#define LEAST_MM 0.001 /* of a rest: 0 stands for a cell that is not in use */

/* Which motions are symmetric: about x; along y, z.  The others are antisymmetric. */
static const uint32_t motions[2][3] = {{0, 4, 5}, {1, 2, 3}};

/* The slopes of the mean face and what follows from them are encode.h's. */
static enum status population_place(struct population *p)
{
    struct surface_model *m = calloc(1, sizeof *m);
    struct encode_basis *e = calloc(1, sizeof *e);
    const enum status st = m != NULL && e != NULL ? ST_OK : ST_ENOMEM;

    if (st == ST_OK) {
        memcpy(m->mean, p->mean, sizeof m->mean);
        for (uint32_t i = 0; i < GRID_N; i++)
            m->change.rest[i] = isnan(p->mean[i]) ? 0.0f : 1.0f;
        encode_prepare(m, e);
        memcpy(p->normal_z, e->normal_z, sizeof p->normal_z);
        for (uint32_t i = 0; i < GRID_N; i++)
            for (uint32_t k = 0; k < POPULATION_MOTIONS; k++)
                p->motion[k][i] = e->motion[i][k];
    }
    free(m);
    free(e);
    return st;
}

/* A population of this mean face, of which all variances are 0.  Returns: as population_read(). */
static enum status population_begin(const float mean[GRID_N], struct population *p)
{
    enum status st;

    memset(p, 0, sizeof *p);
    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t k = grid_mirror(i);

        p->mean[i] = (mean[i] + mean[k]) / 2;
        if (i < k && !isnan(p->mean[i]))
            p->cells.at[p->cells.n++] = i;
    }
    if (2 * p->cells.n < MODEL_FACE_MIN)
        return ST_EINVAL;
    st = population_place(p);
    if (st == ST_OK)
        st = spread_new(p->cells.n, &p->change);
    if (st == ST_OK)
        st = spread_new(p->cells.n, &p->identity);
    if (st == ST_OK)
        st = spread_new(p->cells.n, &p->shape);
    if (st != ST_OK)
        population_free(p);
    return st;
}

void population_free(struct population *p)
{
    spread_free(&p->change);
    spread_free(&p->identity);
    spread_free(&p->shape);
    memset(p, 0, sizeof *p);
}

enum status population_copy(const struct population *from, struct population *to)
{
    const enum status st = population_begin(from->mean, to);

    if (st != ST_OK)
        return st;
    spread_add(&to->change, &from->change, 1);
    spread_add(&to->identity, &from->identity, 1);
    spread_add(&to->shape, &from->shape, 1);
    return ST_OK;
}

/* variance[i] at the i-th cell in use: independent noise. */
static void add_noise(struct spread *s, const double *variance)
{
    for (uint32_t i = 0; i < s->n; i++)
        for (int b = 0; b < 2; b++)
            s->block[b][(size_t)i * s->n + i] += variance[i];
}

/* ---- from a model */

/* The modes and the rest of b, times scale (of each cell), less a rest of less_mm. */
static void add_basis(const struct population *p, const struct model_basis *b,
                      const float *scale, double less_mm, struct spread *s)
{
    double even[GRID_N / 2], odd[GRID_N / 2];
    float gap[GRID_N];

    for (uint32_t k = 0; k < b->n; k++) {
        for (uint32_t i = 0; i < GRID_N; i++)
            gap[i] = b->mode[i][k] * scale[i];
        spread_split(&p->cells, gap, (double *[]){even, odd});
        spread_add_pattern(s, false, even, 1);
        spread_add_pattern(s, true, odd, 1);
    }
    for (uint32_t i = 0; i < p->cells.n; i++) {
        const uint32_t at = p->cells.at[i], other = grid_mirror(at);
        const double u = (double)(b->rest[at] * scale[at]);
        const double v = (double)(b->rest[other] * scale[other]);

        even[i] = fmax((u * u + v * v) / 2 - less_mm * less_mm, 0);
    }
    add_noise(s, even);
}

enum status population_read(const struct surface_model *m, struct population *p)
{
    float mean[GRID_N], one[GRID_N];
    enum status st;

    for (uint32_t i = 0; i < GRID_N; i++) {
        mean[i] =
            m->change.rest[i] > 0.0f && m->shape.rest[i] > 0.0f ? m->mean[i] : (float)NAN;
        one[i] = 1.0f;
    }
    if ((st = population_begin(mean, p)) != ST_OK)
        return st;
    add_basis(p, &m->change, one, 0, &p->change);
    add_basis(p, &m->identity, one, 0, &p->identity);
    add_basis(p, &m->shape, p->normal_z, SHAPE_MM, &p->shape);
    return ST_OK;
}

/* ---- motion */

void population_still(const struct population *p, struct spread *s)
{
    double x[3 * (GRID_N / 2)] = {0}, other[GRID_N / 2] = {0};

    for (int odd = 0; odd < 2; odd++) {
        for (uint32_t k = 0; k < 3; k++) {
            double *own = x + (size_t)k * s->n;

            spread_split(&p->cells, p->motion[motions[odd][k]],
                         (double *[]){odd ? other : own, odd ? own : other});
        }
        spread_remove(s, odd, x, 3);
    }
}

/* ---- to a model */

static enum status copy(const struct spread *from, struct spread *to)
{
    const enum status st = spread_new(from->n, to);

    if (st == ST_OK)
        spread_add(to, from, 1);
    return st;
}

static uint32_t at_most(const struct population *p, uint32_t modes)
{
    return modes < 2 * p->cells.n ? modes : 2 * p->cells.n;
}

/* left[i]: the variance at the i-th cell that k modes of s leave. */
static void leave(const struct population *p, const struct spread *s,
                  const struct spread_mode *mode, uint32_t k, double *left)
{
    for (uint32_t i = 0; i < p->cells.n; i++) {
        left[i] = spread_variance(s, i);
        for (uint32_t j = 0; j < k; j++)
            left[i] -= mode[j].variance * (mode[j].pattern[i] * mode[j].pattern[i]) / 2;
        left[i] = fmax(left[i], 0);
    }
}

static void put_modes(const struct population *p, const struct spread_mode *mode,
                      uint32_t k, struct model_basis *b)
{
    b->n = k;
    for (uint32_t j = 0; j < k; j++)
        spread_join(&p->cells, mode[j].odd, mode[j].pattern, sqrt(mode[j].variance),
                    &b->mode[0][j], MODEL_MODES);
}

static void put_rest(const struct population *p, const double *left, double more_mm,
                     struct model_basis *b)
{
    for (uint32_t i = 0; i < p->cells.n; i++) {
        const double mm = fmax(sqrt(left[i] + more_mm * more_mm), LEAST_MM);

        b->rest[p->cells.at[i]] = (float)mm;
        b->rest[grid_mirror(p->cells.at[i])] = (float)mm;
    }
}

/* The leading modes of s, and what they leave. */
static enum status cut(const struct population *p, const struct spread *s, uint32_t k,
                       struct spread_mode *mode, double *left)
{
    struct spread own;
    enum status st = copy(s, &own);

    if (st == ST_OK)
        st = spread_lead(&own, k, mode);
    if (st == ST_OK)
        leave(p, s, mode, k, left);
    return st;
}

/* All that a scan shows besides identity. */
static enum status besides(const struct population *p, const struct spread_mode *change,
                           uint32_t k, const double *left, struct spread *out)
{
    double variance[GRID_N / 2], part[2][GRID_N / 2];
    const enum status st = spread_new(p->cells.n, out);

    if (st != ST_OK)
        return st;
    for (uint32_t j = 0; j < k; j++)
        spread_add_pattern(out, change[j].odd, change[j].pattern, change[j].variance);
    for (uint32_t i = 0; i < p->cells.n; i++)
        variance[i] = left[i] + NOISE_MM * NOISE_MM;
    add_noise(out, variance);
    for (int odd = 0; odd < 2; odd++)
        for (int i = 0; i < 3; i++) {
            spread_split(&p->cells, p->motion[motions[odd][i]],
                         (double *[]){part[0], part[1]});
            spread_add_pattern(out, odd, part[odd], 1);
        }
    return ST_OK;
}

static enum status put_identity(const struct population *p, struct spread *noise,
                                struct surface_model *m)
{
    const uint32_t k = at_most(p, POPULATION_IDENTITY);
    struct spread_mode mode[POPULATION_IDENTITY];
    struct spread own;
    enum status st = copy(&p->identity, &own);

    if (st != ST_OK)
        return st;
    if ((st = spread_against(&own, noise)) != ST_OK) {
        spread_free(&own);
        return st;
    }
    if ((st = spread_lead(&own, k, mode)) != ST_OK)
        return st;
    spread_back(noise, mode, k);
    put_modes(p, mode, k, &m->identity);
    free(mode->pattern);
    return ST_OK;
}

/* The change, and the identity against it. */
static enum status put_change(const struct population *p, struct surface_model *m)
{
    const uint32_t k = at_most(p, POPULATION_CHANGE);
    struct spread_mode mode[POPULATION_CHANGE];
    struct spread noise = {0};
    double left[GRID_N / 2];
    enum status st = cut(p, &p->change, k, mode, left);

    if (st != ST_OK)
        return st;
    put_modes(p, mode, k, &m->change);
    put_rest(p, left, 0, &m->change);
    st = besides(p, mode, k, left, &noise);
    free(mode->pattern);
    if (st == ST_OK)
        st = put_identity(p, &noise, m);
    spread_free(&noise);
    return st;
}

static enum status put_shape(const struct population *p, struct surface_model *m)
{
    const uint32_t k = at_most(p, POPULATION_SHAPE);
    struct spread_mode mode[POPULATION_SHAPE];
    double left[GRID_N / 2];
    const enum status st = cut(p, &p->shape, k, mode, left);

    if (st != ST_OK)
        return st;
    put_modes(p, mode, k, &m->shape);
    put_rest(p, left, SHAPE_MM, &m->shape);
    free(mode->pattern);
    for (uint32_t i = 0; i < GRID_N; i++) { /* gaps to heights */
        const float over = p->normal_z[i] > 0.0f ? 1.0f / p->normal_z[i] : 0.0f;

        m->shape.rest[i] *= over;
        for (uint32_t j = 0; j < k; j++)
            m->shape.mode[i][j] *= over;
    }
    return ST_OK;
}

enum status population_model(const struct population *p, struct surface_model *m)
{
    enum status st;

    memcpy(m->mean, p->mean, sizeof m->mean);
    memset(&m->change, 0, sizeof m->change);
    memset(&m->identity, 0, sizeof m->identity);
    memset(&m->shape, 0, sizeof m->shape);
    st = put_change(p, m);
    return st == ST_OK ? put_shape(p, m) : st;
}
