/* Populations: from a model and back, and from a morphable model, where all is symmetric and free
 * of motion. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "errinfo.h"
#include "morphable.h"
#include "population.h"
#include "population_render.h"
#include "sculpt.h"
#include "toy.h"

static struct model toy, made;
static char dir[] = "/tmp/test_population.XXXXXX";

/* The covariance of a basis between two cells. */
static double covariance(const struct model_basis *b, uint32_t i, uint32_t k)
{
    double sum = i == k ? (double)b->rest[i] * (double)b->rest[i] : 0;

    for (uint32_t n = 0; n < b->n; n++)
        sum += (double)b->mode[i][n] * (double)b->mode[k][n];
    return sum;
}

/* Every mode is symmetric or antisymmetric, every rest symmetric, nothing is off the face. */
static void check_symmetric(const struct model *m)
{
    const struct model_basis *basis[] = {&m->change, &m->identity, &m->shape};

    for (uint32_t i = 0; i < GRID_N; i++) {
        const uint32_t k = grid_mirror(i);

        assert_true(isnan(m->mean[i])
                        ? isnan(m->mean[k])
                        : m->mean[i] >= m->mean[k] && m->mean[i] <= m->mean[k]);
        for (int b = 0; b < 3; b++) {
            assert_memory_equal(&basis[b]->rest[i], &basis[b]->rest[k], sizeof(float));
            assert_int_equal(basis[b]->rest[i] > 0.0f, b != 1 && !isnan(m->mean[i]));
        }
    }
    for (int b = 0; b < 3; b++)
        for (uint32_t n = 0; n < basis[b]->n; n++) {
            bool even = true, odd = true;

            for (uint32_t i = 0; i < GRID_N; i++) {
                const float u = basis[b]->mode[i][n],
                            v = basis[b]->mode[grid_mirror(i)][n];

                even = even && u >= v && u <= v;
                odd = odd && u >= -v && u <= -v;
                assert_true(!isnan(m->mean[i]) || (u >= 0.0f && u <= 0.0f));
            }
            assert_true(even != odd);
        }
}

/* A population of a model, cut down to modes again, varies as the model did, but that a mode of
 * change may pass into the rest.  The toy's modes are symmetric already. */
static void test_round_trip(void **state)
{
    struct population p, copy;
    double worst[3] = {0};

    (void)state;
    assert_int_equal(population_read(&toy, &p), ST_OK);
    assert_int_equal(population_copy(&p, &copy), ST_OK);
    population_free(&p);
    made = toy;
    assert_int_equal(population_model(&copy, &made), ST_OK);
    population_free(&copy);
    check_symmetric(&made);
    for (uint32_t i = 0; i < GRID_N; i++)
        for (uint32_t k = i % 7; k < GRID_N; k += 7) {
            const uint32_t mi = grid_mirror(i), mk = grid_mirror(k);
            const struct model_basis *from[] = {&toy.change, &toy.identity, &toy.shape};
            const struct model_basis *to[] = {&made.change, &made.identity, &made.shape};

            for (int b = 0; b < 3 && i != k && !isnan(toy.mean[i]) && !isnan(toy.mean[k]);
                 b++)
                worst[b] = fmax(
                    worst[b],
                    fabs(covariance(to[b], i, k) -
                         (covariance(from[b], i, k) + covariance(from[b], mi, mk)) / 2));
        }
    assert_true(worst[0] < 0.05 && worst[1] < 1e-3 && worst[2] < 0.05);
}

static void test_too_little(void **state)
{
    struct population p;
    struct model *m = malloc(sizeof *m);

    (void)state;
    assert_non_null(m);
    *m = toy;
    for (uint32_t i = 0; i < GRID_N; i++)
        if (grid_x(i) > 0)
            m->mean[i] = (float)NAN;
    assert_int_equal(population_read(m, &p), ST_EINVAL);
    assert_null(p.change.block[0]);
    population_free(&p);
    free(m);
}

/* What looks like motion is in no mode of change or identity. */
static void check_still(const struct population *p, const struct model *m)
{
    const struct model_basis *basis[] = {&m->change, &m->identity};

    for (uint32_t n = 0; n < POPULATION_MOTIONS; n++)
        for (uint32_t k = 0; k < m->change.n; k++) {
            double dot = 0, size = 0, motion = 0;

            for (uint32_t i = 0; i < GRID_N; i++) {
                dot += (double)p->motion[n][i] * (double)basis[0]->mode[i][k];
                size += (double)basis[0]->mode[i][k] * (double)basis[0]->mode[i][k];
                motion += (double)p->motion[n][i] * (double)p->motion[n][i];
            }
            assert_true(fabs(dot) < 1e-4 * sqrt(motion) * (1e-3 + sqrt(size)));
        }
    assert_int_equal(basis[1]->n, basis[0]->n);
}

/* Expressions and people of the sculpted face show where they move it. */
static void check_places(const struct model *m)
{
    const uint32_t mouth = grid_cell(26, -24), temple = grid_cell(50, 20);
    const uint32_t cheek = grid_cell(42, -8), brow = grid_cell(1, 34);

    assert_true(covariance(&m->change, mouth, mouth) >
                4 * covariance(&m->change, temple, temple));
    assert_true(covariance(&m->identity, cheek, cheek) >
                covariance(&m->identity, brow, brow));
}

static void test_render(void **state)
{
    struct population p;
    struct morphable *m;
    struct errinfo e;
    char command[100];

    (void)state;
    assert_true(sculpt_write(dir, 10, 0.1));
    assert_int_equal(morphable_read(dir, &m, &e), ST_OK);
    memset(&made, 0, sizeof made);
    assert_int_equal(population_render(m, 2, &p, &e), ST_OK);
    assert_true(p.cells.n > 300);
    assert_int_equal(population_model(&p, &made), ST_OK);
    assert_int_equal(made.change.n, POPULATION_CHANGE);
    assert_int_equal(made.identity.n, POPULATION_IDENTITY);
    assert_int_equal(made.shape.n, POPULATION_SHAPE);
    check_symmetric(&made);
    check_still(&p, &made);
    check_places(&made);
    population_free(&p);
    morphable_free(m);
    (void)snprintf(command, sizeof command, "rm -r %s", dir);
    assert_int_equal(system(command), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_too_little),
        cmocka_unit_test(test_render),
    };

    if (mkdtemp(dir) == NULL)
        return 1;
    toy_model(&toy);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
