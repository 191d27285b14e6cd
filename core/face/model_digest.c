#include "model_digest.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "model.h"

uint32_t model_mean_id(const struct surface_model *m)
{
    uint32_t hash = 2166136261u; /* FNV-1a over the heights in micrometres */

    for (uint32_t i = 0; i < GRID_N; i++) {
        const int32_t um =
            isnan(m->mean[i]) ? INT32_MIN : (int32_t)lrint((double)m->mean[i] * 1000);

        for (int b = 0; b < 32; b += 8)
            hash = (hash ^ (((uint32_t)um >> b) & 255)) * 16777619u;
    }
    return hash != 0 ? hash : 1;
}

#define DIGEST_BASIS UINT64_C(14695981039346656037)
#define DIGEST_PRIME UINT64_C(1099511628211)
#define DIGEST_NAN   UINT32_C(0x7fc00000)

static uint64_t digest(uint64_t hash, uint32_t v)
{
    for (int b = 0; b < 32; b += 8)
        hash = (hash ^ ((v >> b) & 255)) * DIGEST_PRIME;
    return hash;
}

static uint64_t digest_floats(uint64_t hash, const float *v, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t bits = DIGEST_NAN; /* one of many that are NAN */

        if (!isnan(v[i]))
            memcpy(&bits, &v[i], sizeof bits);
        hash = digest(hash, bits);
    }
    return hash;
}

static uint64_t digest_basis(uint64_t hash, const struct model_basis *b)
{
    hash = digest_floats(digest(hash, b->n), b->rest, GRID_N);
    for (uint32_t i = 0; i < GRID_N; i++)
        hash = digest_floats(hash, b->mode[i], b->n);
    return hash;
}

static uint64_t digest_all(const struct surface_model *m)
{
    const float scalar[] = {(float)m->kinship, (float)m->noise_floor_mm,
                            (float)m->noise_factor};
    uint64_t hash = digest_floats(DIGEST_BASIS, m->mean, GRID_N);

    hash = digest_floats(hash, scalar, sizeof scalar / sizeof *scalar);
    hash = digest_basis(digest_basis(hash, &m->change), &m->identity);
    return digest_basis(hash, &m->shape);
}

/* The shipped model never changes: its digest is worked out once.  Threads that come together
 * work out the same. */
uint64_t model_digest(const struct surface_model *m)
{
    static _Atomic uint64_t of_default; /* 0: not yet known */
    uint64_t hash;

    if (m != &model_default)
        return digest_all(m);
    if ((hash = of_default) == 0)
        of_default = hash = digest_all(m);
    return hash;
}
