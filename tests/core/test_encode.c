/* Encodings against the definition in encode.h: the covariance of all but the identity is built
 * cell by cell and inverted; missing and outlying cells, noise, hostile heights. */
#include "pose.h"
#include "brute.h"
#include "dense.h"
#include "encode.h"
#include "shape_map.h"
#include "toy.h"
#include "unit.h"

#define FAR_MM 12.0 /* as encode.h says, in numbers: */
#define HUBER  2.5
#define LEAST  230

static struct draw rng;
static struct scratch scratch;
static struct surface_model model; /* the toy's, or another */
static struct encode_basis basis;
static float z[GRID_N];
static struct encoding got, again;

static void use(const struct surface_model *m)
{
    model = *m;
    encode_prepare(&model, &basis);
}

/* ---- the model's covariances, cell by cell */

/* The unit normal of the mean face at cell i. */
static void normal_at(uint32_t i, double n[3])
{
    float zx, zy;
    double length;

    shape_map_slope(model.mean, i, &zx, &zy);
    length = sqrt(1 + (double)zx * (double)zx + (double)zy * (double)zy);
    n[0] = -(double)zx / length;
    n[1] = -(double)zy / length;
    n[2] = 1 / length;
}

/* How far cell i moves along its normal by the motion k of one deviation: a turn about axis k
 * through the point POSE_LEVER_MM behind the nose, or a shift along it. */
static double moves(uint32_t i, int k)
{
    const double p[3] = {grid_x(i), grid_y(i), (double)model.mean[i] + POSE_LEVER_MM};
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    double n[3];

    normal_at(i, n);
    if (k >= 3)
        return ENCODE_MOTION_MM * n[k - 3];
    return ENCODE_MOTION_MM / POSE_LEVER_MM * (n[v] * p[u] - n[u] * p[v]);
}

/* ---- scans */

static bool used(uint32_t i)
{
    return model.change.rest[i] > 0.0f && !isnan(model.mean[i]);
}

static double noise_of(double residual)
{
    return sqrt(model.noise_floor_mm * model.noise_floor_mm +
                model.noise_factor * model.noise_factor * residual * residual);
}

/* The heights of a scan as the model says they are, the noise so small that no cell is an
 * outlier; a share of the cells is missing.  Returns how many are there. */
static uint32_t draw(double noise, double missing)
{
    double motion[6], change[MODEL_MODES], identity[MODEL_MODES];
    uint32_t cells = 0;

    for (int k = 0; k < 6; k++)
        motion[k] = draw_uniform(&rng, -1, 1);
    for (uint32_t k = 0; k < MODEL_MODES; k++) {
        change[k] = draw_uniform(&rng, -0.5, 0.5);
        identity[k] = draw_uniform(&rng, -1, 1);
    }
    for (uint32_t i = 0; i < GRID_N; i++) {
        double h = noise * draw_uniform(&rng, -1, 1), n[3];

        z[i] = (float)NAN;
        if (!used(i) || draw_uniform(&rng, 0, 1) < missing)
            continue;
        for (int k = 0; k < 6; k++)
            h += motion[k] * moves(i, k);
        for (uint32_t k = 0; k < model.change.n; k++)
            h += change[k] * (double)model.change.mode[i][k];
        for (uint32_t k = 0; k < model.identity.n; k++)
            h += identity[k] * (double)model.identity.mode[i][k];
        normal_at(i, n);
        z[i] = (float)((double)model.mean[i] + h / n[2]);
        cells++;
    }
    return cells;
}

static void encode(double residual)
{
    assert_int_equal(encode_heights(&basis, z, residual, &scratch, &got), ST_OK);
}

/* ---- A and b by definition */

#define N MODEL_MODES

struct answer {
    double a[N][N], b[N], gap[GRID_N];
    uint32_t cells;
};

static double gap_at(uint32_t i)
{
    double n[3];

    normal_at(i, n);
    return ((double)z[i] - (double)model.mean[i]) * n[2];
}

/* A = V' S^-1 V and b = V' S^-1 h, with the variance s^2 / share[i] of the noise of cell i;
 * share 0: it is not there. */
static void by_definition(double noise, const double *share, struct answer *out)
{
    const uint32_t n = model.identity.n;
    uint32_t cell[GRID_N];
    double *s, *v; /* v: V and h */
    uint32_t c = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (share[i] > 0)
            cell[c++] = i;
    out->cells = c;
    s = calloc((size_t)c * c, sizeof *s);
    v = calloc((size_t)c * (n + 1), sizeof *v);
    assert_true(s != NULL && v != NULL);
    for (uint32_t j = 0; j < c; j++) {
        const uint32_t p = cell[j];

        for (uint32_t k = 0; k <= j; k++) {
            const uint32_t q = cell[k];
            double sum = j == k ? noise * noise / share[p] : 0;

            for (int l = 0; l < 6; l++)
                sum += moves(p, l) * moves(q, l);
            for (uint32_t l = 0; l < model.change.n; l++)
                sum += (double)model.change.mode[p][l] * (double)model.change.mode[q][l];
            s[(size_t)j * c + k] = s[(size_t)k * c + j] = sum;
        }
        for (uint32_t k = 0; k < n; k++)
            v[(size_t)j * (n + 1) + k] = (double)model.identity.mode[p][k];
        v[(size_t)j * (n + 1) + n] = gap_at(p);
    }
    (void)dense_solve(s, c, v, n + 1);
    memset(out->a, 0, sizeof out->a);
    memset(out->b, 0, sizeof out->b);
    for (uint32_t j = 0; j < c; j++)
        for (uint32_t i = 0; i < n; i++) {
            const double mode = (double)model.identity.mode[cell[j]][i];

            for (uint32_t k = 0; k < n; k++)
                out->a[i][k] += mode * v[(size_t)j * (n + 1) + k];
            out->b[i] += mode * v[(size_t)j * (n + 1) + n];
        }
    free(s);
    free(v);
}

/* got is that, to the rounding of floats. */
static void check(const struct answer *want, double within)
{
    const float *a = got.a;
    double scale = 0;

    assert_int_equal(got.n, model.identity.n);
    assert_int_equal(got.cells, want->cells);
    for (uint32_t i = 0; i < got.n; i++)
        for (uint32_t k = 0; k <= i; k++, a++) {
            const double size = sqrt((1 + want->a[i][i]) * (1 + want->a[k][k]));

            if (!(fabs((double)*a - want->a[i][k]) < within * size))
                fail_msg("A %u, %u: %.9g, wanted %.9g", i, k, (double)*a, want->a[i][k]);
        }
    for (uint32_t i = 0; i < got.n; i++)
        scale = fmax(scale, fabs(want->b[i]));
    for (uint32_t i = 0; i < got.n; i++)
        if (!(fabs((double)got.b[i] - want->b[i]) < within * (1 + scale)))
            fail_msg("b %u: %.9g, wanted %.9g", i, (double)got.b[i], want->b[i]);
}

static void check_plain(double residual)
{
    static struct answer want;
    double share[GRID_N];

    for (uint32_t i = 0; i < GRID_N; i++) {
        const bool has = used(i) && !isnan(z[i]);

        share[i] = has ? 1 : 0;
        assert_int_equal(got.there[i / 8] >> i % 8 & 1, has);
    }
    by_definition(noise_of(residual), share, &want);
    check(&want, 2e-4);
}

/* Whole millimetres are not noise; the steps of a coarse sensor are, beside the residual. */
TEST(test_noise)
{
    assert_true(encode_noise(0.7, 0) == 0.7);
    assert_true(encode_noise(0.7, 1) == 0.7);
    assert_true(encode_noise(0.7, 1.2) > 0.7 &&
                encode_noise(0.7, 1.2) < encode_noise(0.7, 1.4));
    assert_float_equal(encode_noise(1.2, 2), 2, 1e-12);
    assert_float_equal(encode_noise(0, 4), 3.2, 1e-12);
}

/* Whole faces and what is left of them, quiet and noisy. */
TEST(test_definition)
{
    static const double missing[] = {0, 0.2, 0.45, 0.6};

    for (size_t k = 0; k < sizeof missing / sizeof *missing; k++) {
        const double residual = k % 2 == 0 ? 0 : 0.8;
        const uint32_t cells = draw(noise_of(residual), missing[k]);

        encode(residual);
        assert_int_equal(got.cells, cells);
        assert_true(got.residual_mm == (float)residual);
        check_plain(residual);
    }
}

/* All columns in use; then a model of no change, and of one mode of identity. */
TEST(test_modes)
{
    static struct surface_model few;

    few = model;
    few.change.n = 0;
    few.identity.n = 1;
    for (uint32_t i = 0; i < GRID_N; i++) {
        memset(few.change.mode[i], 0, sizeof few.change.mode[i]);
        memset(few.identity.mode[i] + 1, 0, sizeof few.identity.mode[i] - sizeof(float));
    }
    for (int k = 0; k < 2; k++) {
        use(k == 0 ? &model_default : &few);
        (void)draw(noise_of(0.4), 0.1);
        encode(0.4);
        check_plain(0.4);
    }
    toy_model(&few);
    use(&few);
}

/* ---- outliers */

/* What the coefficients of least squares leave of each cell, of all cells alike. */
static void left_over(double noise, double left[GRID_N])
{
    static double m[(6 + 2 * N) * (6 + 2 * N)], row[GRID_N][6 + 2 * N];
    const uint32_t first = 6 + model.change.n, n = first + model.identity.n;
    double x[6 + 2 * N] = {0};

    memset(m, 0, sizeof m);
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (!used(i) || isnan(z[i]))
            continue;
        for (uint32_t k = 0; k < n; k++)
            row[i][k] = k < 6       ? moves(i, (int)k)
                        : k < first ? (double)model.change.mode[i][k - 6]
                                    : (double)model.identity.mode[i][k - first];
        for (uint32_t k = 0; k < n; k++) {
            for (uint32_t l = 0; l < n; l++)
                m[k * n + l] += row[i][k] * row[i][l] / (noise * noise);
            x[k] += row[i][k] * gap_at(i) / (noise * noise);
        }
    }
    for (uint32_t k = 0; k < n; k++)
        m[k * n + k] += 1;
    (void)dense_solve(m, n, x, 1);
    for (uint32_t i = 0; i < GRID_N; i++) {
        left[i] = 0;
        if (!used(i) || isnan(z[i]))
            continue;
        left[i] = gap_at(i);
        for (uint32_t k = 0; k < n; k++)
            left[i] -= row[i][k] * x[k];
    }
}

/* Cells that no coefficients explain count less: by Huber's weights. */
TEST(test_outliers)
{
    static struct answer want, alike;
    const double noise = noise_of(0.3);
    double share[GRID_N], one[GRID_N], left[GRID_N], off[2] = {0, 0};
    static struct encoding clean;
    uint32_t outliers = 0;

    (void)draw(0.8 * noise, 0.1);
    encode(0.3);
    clean = got;
    for (uint32_t i = 0; i < GRID_N; i++) /* a part of a cheek, and strays */
        if (used(i) &&
            ((grid_x(i) > 34 && grid_y(i) > -20 && grid_y(i) < 8) || i % 61 == 0))
            z[i] += i % 2 == 0 ? 6.0f : 4.5f;
    encode(0.3);
    left_over(noise, left);
    for (uint32_t i = 0; i < GRID_N; i++) {
        one[i] = used(i) && !isnan(z[i]) ? 1 : 0;
        share[i] = fabs(left[i]) > HUBER * noise ? one[i] * HUBER * noise / fabs(left[i])
                                                 : one[i];
        outliers += share[i] < one[i];
    }
    assert_true(outliers > 20);
    by_definition(noise, share, &want);
    by_definition(noise, one, &alike);
    check(&want, 2e-3);
    for (uint32_t i = 0; i < got.n; i++) {
        off[0] += fabs((double)got.b[i] - (double)clean.b[i]);
        off[1] += fabs(alike.b[i] - (double)clean.b[i]);
    }
    print_message("%u outliers move b by %.2f, all alike by %.2f\n", outliers, off[0],
                  off[1]);
    assert_true(off[0] < off[1]);
}

/* ---- hostile and few heights */

/* Heights that no face has are as none. */
TEST(test_hostile)
{
    static const double bad[] = {1e30, -1e30,         (double)INFINITY, -(double)INFINITY,
                                 3e38, FAR_MM + 0.01, -FAR_MM - 0.01};
    static float plain[GRID_N];
    struct encoding none;

    (void)draw(noise_of(0.3), 0.1);
    memcpy(plain, z, sizeof z);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        for (int hostile = 0; hostile < 2; hostile++) {
            memcpy(z, plain, sizeof z);
            for (uint32_t i = (uint32_t)k; i < GRID_N; i += 7)
                if (used(i))
                    z[i] = !hostile ? (float)NAN
                                    : model.mean[i] +
                                          (float)(bad[k] / (double)basis.normal_z[i]);
            encode(0.3);
            if (!hostile)
                none = got;
        }
        assert_true(got.n == model.identity.n);
        assert_memory_equal(&got, &none, sizeof got);
    }
    memcpy(z, plain, sizeof z); /* and one that is hardly a face's yet is there */
    for (uint32_t i = 0; i < GRID_N; i += 97)
        if (used(i))
            z[i] = model.mean[i] + (float)((FAR_MM - 0.01) / (double)basis.normal_z[i]);
    encode(0.3);
    for (uint32_t i = 0; i < GRID_N; i += 97)
        assert_int_equal(got.there[i / 8] >> i % 8 & 1, used(i));
    /* off the model's cells nothing matters */
    again = got;
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = used(i) ? z[i] : i % 2 == 0 ? -20.0f : (float)NAN;
    encode(0.3);
    assert_memory_equal(&got, &again, sizeof got);
}

TEST(test_residual)
{
    static const double bad[] = {(double)NAN, (double)INFINITY, 1e30, 1e300, -1};

    (void)draw(noise_of(0.3), 0.1);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        encode(bad[k]);
        for (uint32_t i = 0; i < got.n * (got.n + 1) / 2; i++)
            assert_true(isfinite(got.a[i]));
        for (uint32_t i = 0; i < got.n; i++)
            assert_true(isfinite(got.b[i]));
    }
    encode(1);
    again = got;
    encode(-1); /* its sign does not count */
    assert_memory_equal(got.a, again.a, sizeof got.a);
    assert_memory_equal(got.b, again.b, sizeof got.b);
    encode(3); /* more noise, less evidence */
    for (uint32_t i = 0; i < got.n; i++)
        assert_true(got.a[i * (i + 1) / 2 + i] < again.a[i * (i + 1) / 2 + i]);
}

/* Fewer cells than a quarter of a face: nothing is known of it. */
TEST(test_few)
{
    double part[GRID_N] = {0}, slope[MODEL_MODES];

    for (uint32_t k = 0; k < MODEL_MODES; k++)
        slope[k] = 1;
    for (uint32_t keep = LEAST - 1; keep <= LEAST; keep++) {
        uint32_t n = 0;

        (void)draw(noise_of(0.3), 0);
        for (uint32_t i = 0; i < GRID_N; i++)
            if (!isnan(z[i]) && n++ >= keep)
                z[i] = (float)NAN;
        encode(0.3);
        assert_int_equal(got.cells, keep);
        assert_int_equal(got.n, keep < LEAST ? 0 : model.identity.n);
        if (keep < LEAST) {
            for (uint32_t i = 0; i < ENCODE_PAIRS; i++)
                assert_true(got.a[i] == 0.0f);
            assert_int_equal(encode_parts(&basis, z, 0.3, slope, &scratch, part), ST_OK);
            for (uint32_t i = 0; i < GRID_N; i++)
                assert_true(part[i] == 0);
        }
    }
    for (uint32_t i = 0; i < GRID_N; i++)
        z[i] = (float)NAN;
    encode(0.3);
    assert_true(got.n == 0 && got.cells == 0);
}

/* A cell's part is half of its height times the derivative of slope' b by it. */
TEST(test_part_of_cell)
{
    static double part[GRID_N];
    double slope[MODEL_MODES];
    uint32_t checked = 0;

    (void)draw(0.5 * noise_of(0.3), 0.1);
    for (uint32_t k = 0; k < MODEL_MODES; k++)
        slope[k] = draw_uniform(&rng, -1, 1);
    memset(part, 0, sizeof part);
    assert_int_equal(encode_parts(&basis, z, 0.3, slope, &scratch, part), ST_OK);
    for (uint32_t i = 11; i < GRID_N; i += 53) {
        const float was = z[i];
        double at[2] = {0, 0};

        if (!used(i) || isnan(was))
            continue;
        for (int k = 0; k < 2; k++) {
            z[i] = was + (k == 0 ? -0.25f : 0.25f);
            encode(0.3);
            for (uint32_t m = 0; m < got.n; m++)
                at[k] += slope[m] * (double)got.b[m];
        }
        z[i] = was;
        assert_true(
            fabs((at[1] - at[0]) / 0.5 * gap_at(i) / (double)basis.normal_z[i] / 2 -
                 part[i]) < 2e-3);
        checked++;
    }
    assert_true(checked > 10);
}

BEFORE_ALL(set_up)
{
    rng.x = brute_seed("encode");
    toy_model(&model);
    encode_prepare(&model, &basis);
}

/* ---- what is left of a gap */

/* z moved by a small motion, as its cells see it, and changed by one mode. */
static void move_scan(const double by[6], double change, float out[GRID_N])
{
    for (uint32_t i = 0; i < GRID_N; i++) {
        double h = change * (double)model.change.mode[i][0], n[3];

        out[i] = (float)NAN;
        if (isnan(z[i]))
            continue;
        for (int k = 0; k < 6; k++)
            h += by[k] * moves(i, k);
        normal_at(i, n);
        out[i] = z[i] + (float)(h / n[2]);
    }
}

static double largest(const float of[GRID_N])
{
    double most = 0;

    for (uint32_t i = 0; i < GRID_N; i++)
        if (!isnan(of[i]))
            most = fmax(most, fabs((double)of[i]));
    return most;
}

TEST(test_motion_and_change_leave_little)
{
    static const double by[6] = {0.6, -0.4, 0.5, -0.3, 0.7, 0.4};
    float moved[GRID_N], rest[GRID_N];

    (void)draw(0.0, 0.1);
    move_scan(by, 0.8, moved);
    assert_int_equal(
        encode_rest(&basis, z, moved, (const double[]){0, 0}, &scratch, rest), ST_OK);
    assert_true(largest(rest) < 0.15);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_int_equal(isnan(rest[i]), !used(i) || isnan(z[i]));
}

TEST(test_a_dent_is_left)
{
    const uint32_t at = 20 * GRID_NX + 16;
    float dented[GRID_N], rest[GRID_N];

    (void)draw(0.0, 0.0);
    memcpy(dented, z, sizeof dented);
    assert_true(used(at));
    dented[at] -= 3.0f / basis.normal_z[at];
    assert_int_equal(
        encode_rest(&basis, z, dented, (const double[]){0, 0}, &scratch, rest), ST_OK);
    assert_true((double)rest[at] < -2 && (double)rest[at] >= -3.01);
}

TEST(test_too_little_in_common_leaves_nothing_known)
{
    float half[GRID_N], rest[GRID_N];

    (void)draw(0.0, 0.0);
    for (uint32_t i = 0; i < GRID_N; i++)
        half[i] = i < GRID_N / 6 ? z[i] : (float)NAN;
    assert_int_equal(encode_rest(&basis, z, half, (const double[]){0, 0}, &scratch, rest),
                     ST_OK);
    for (uint32_t i = 0; i < GRID_N; i++)
        assert_true(isnan(rest[i]));
}
