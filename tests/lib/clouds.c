#include "clouds.h"

#include <math.h>
#include <stdlib.h>

#include "brute.h"
#include "facegen.h"
#include "lattice.h"

const char *clouds_name(enum clouds_kind kind)
{
    static const char *const name[CLOUDS_KINDS] = {
        "faces",          "uniform",        "sensor grid",    "tilted grid",
        "one circle",     "two lines",      "tight clusters", "two a column",
        "3 x each place", "half a parabola"};

    return name[kind];
}

size_t clouds_scan(uint64_t subject, uint64_t scan, size_t n, struct dvec3 *out)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = subject;
    s.scan = scan;
    s.points = (uint32_t)n;
    return facegen_sample(&s, out);
}

static size_t face(uint64_t k, size_t n, struct ivec3 *out)
{
    struct dvec3 *mm = malloc(n * sizeof *mm);
    size_t got;

    if (mm == NULL)
        abort();
    got = clouds_scan(k / 2, k, n, mm);
    if (lattice_from_mm(mm, got, LATTICE_PER_MM, out, NULL) != ST_OK)
        abort();
    free(mm);
    return got;
}

/* A point with a wave as its height, for kinds where only (x, y) matters. */
static struct ivec3 lifted(int32_t x, int32_t y)
{
    return (struct ivec3){x, y, (int32_t)(5000 * sin(x * 3e-5) * cos(y * 4e-5))};
}

/* Rows and columns with one spacing each, within an oval, 3 % missing. */
static size_t sensor_grid(struct draw *r, size_t n, struct ivec3 *out)
{
    const int32_t dx = brute_int(r, 300, 3000), dy = dx + brute_int(r, 0, 1) * 77;
    const int32_t half = (int32_t)(sqrt((double)n * 1.28 / 0.97) / 2) + 1;
    size_t m = 0;

    for (int32_t y = -half; y <= half; y++)
        for (int32_t x = -half; x <= half; x++)
            if (x * x + y * y < half * half && draw_next(r) % 100 >= 3 && m < n)
                out[m++] = lifted(x * dx, y * dy);
    return m;
}

static size_t tilted_grid(struct draw *r, size_t n, struct ivec3 *out)
{
    const int32_t a = brute_int(r, 100, 900), b = brute_int(r, 50, 800);
    const int32_t side = (int32_t)sqrt((double)n);
    size_t m = 0;

    for (int32_t y = 0; y < side; y++)
        for (int32_t x = 0; x < side; x++)
            out[m++] = lifted(a * x - b * y, b * x + a * y);
    return m;
}

/* x^2 + y^2 = r2, a product of small primes 4k + 1: 3,072 solutions. */
static size_t circle(struct draw *r, size_t n, struct ivec3 *out)
{
    static struct ivec3 all[3072];
    static size_t count;
    const int64_t r2 = INT64_C(5) * 5 * 13 * 17 * 29 * 37 * 41 * 53 * 61 * 73;

    for (int64_t x = 0; count == 0 || (count < 3072 && x * x <= r2); x++) {
        const int64_t y = (int64_t)sqrt((double)(r2 - x * x) + 0.5);

        if (x * x + y * y != r2)
            continue;
        for (int sx = -1; sx <= (x != 0); sx += 2)
            for (int sy = -1; sy <= (y != 0); sy += 2)
                all[count++] = lifted((int32_t)(sx * x), (int32_t)(sy * y));
    }
    brute_shuffle(all, count, sizeof *all, r);
    n = n < count ? n : count;
    for (size_t i = 0; i < n; i++)
        out[i] = all[i];
    return n;
}

/* Scatter: kinds whose points are drawn one by one. */
static struct ivec3 drawn(enum clouds_kind kind, struct draw *r, uint64_t k, size_t i,
                          size_t n)
{
    const int32_t slope = (int32_t)(k % 5), half = (int32_t)(n / 2);
    const int32_t step = 10 + (int32_t)(k % 7), far = LATTICE_MAX / 2;
    int32_t t;

    switch (kind) {
    case CLOUDS_LINES:
        if (i == 0)
            return lifted(77, 5);
        t = ((int32_t)(i / 2) - half / 2) * step;
        return i % 2 == 0 ? lifted(t, slope * t) : lifted(-slope * t, t);
    case CLOUDS_CLUSTERS:
        t = (int32_t)(draw_next(r) % 30);
        return lifted(t % 6 * 4000000 - far + brute_int(r, 0, 400),
                      t * 7 % 30 * 700000 - far + brute_int(r, 0, 400));
    case CLOUDS_COLUMNS:
        return lifted(((int32_t)(i / 2) - half / 2) * step,
                      (i % 2 == 0 ? 0 : 900 * step) + brute_int(r, 0, 3000));
    case CLOUDS_PARABOLA:
        t = (int32_t)i;
        return lifted(n > 5000 ? t / 8 : t, n > 5000 ? t / 8 * (t / 8) : t * t - far);
    default:
        return lifted(brute_int(r, -90000, 90000), brute_int(r, -90000, 90000));
    }
}

size_t clouds_make(enum clouds_kind kind, uint64_t k, size_t n, struct ivec3 *out)
{
    struct draw r = {k * 1000 + (uint64_t)kind};
    size_t m;

    switch (kind) {
    case CLOUDS_FACE:
        return face(k, n, out);
    case CLOUDS_GRID:
        m = sensor_grid(&r, n, out);
        break;
    case CLOUDS_TILTED:
        m = tilted_grid(&r, n, out);
        break;
    case CLOUDS_CIRCLE:
        m = circle(&r, n, out);
        break;
    case CLOUDS_DUPLICATES:
        for (m = 0; m < n; m++)
            out[m] = m % 3 == 0 ? drawn(kind, &r, k, m, n) : out[m - 1];
        break;
    default:
        for (m = 0; m < n; m++)
            out[m] = drawn(kind, &r, k, m, n);
    }
    brute_shuffle(out, m, sizeof *out, &r);
    return m;
}

void clouds_move(struct dvec3 *pts, size_t n, uint64_t k, double degrees, double mm,
                 double transform[16])
{
    struct draw r = {k ^ 0x6d6f7665};
    const double pi = 3.14159265358979323846, angle = degrees * pi / 180;
    const double c = cos(angle), s = sin(angle), along = draw_uniform(&r, 0, 2 * pi);
    const double h = draw_uniform(&r, -1, 1), rim = sqrt(1 - h * h);
    const double a[3] = {rim * cos(along), rim * sin(along), h};
    const double way = draw_uniform(&r, 0, 2 * pi), up = draw_uniform(&r, -1, 1);
    const double out = sqrt(1 - up * up);
    const double shift[3] = {mm * out * cos(way), mm * out * sin(way), mm * up};
    const double cross[9] = {0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0};

    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            transform[4 * i + j] =
                (i == j) * c + (1 - c) * a[i] * a[j] + s * cross[3 * i + j];
        transform[4 * i + 3] = shift[i];
        transform[12 + i] = 0;
    }
    transform[15] = 1;
    for (size_t i = 0; i < n; i++)
        pts[i] = vec_transform(transform, pts[i]);
}
