#include "replay.h"

#include <math.h>
#include <sodium.h>
#include <string.h>

#include "admission.h"
#include "cloudpoints.h"
#include "codec.h"
#include "errinfo.h"
#include "scan.h"

#define LEAST 1e2 /* lattice units, of the greatest coordinate; below ten times that */
#define FAR   1e15

/* Lattice units for one of the file's, a power of ten, so that metres and millimetres give the
 * same points. */
static double scale_of(const struct cloudpoints *c)
{
    double most = 0, scale = 1;

    for (size_t i = 0; i < c->n; i++)
        most =
            fmax(most, fmax(fabs(c->at[i].x), fmax(fabs(c->at[i].y), fabs(c->at[i].z))));
    if (!(most > 1 / FAR && most < FAR))
        return 1;
    while (most * scale < LEAST)
        scale *= 10;
    while (most * scale >= 10 * LEAST)
        scale /= 10;
    return scale;
}

static void put(unsigned char *to, double v)
{
    const int64_t at = llround(fmax(-FAR, fmin(FAR, v)));

    for (int i = 0; i < 8; i++)
        to[i] = (unsigned char)((uint64_t)at >> 8 * i);
}

static uint64_t hash_of(const struct dvec3 *p, double scale)
{
    static const unsigned char key[crypto_shorthash_KEYBYTES] = {0};
    unsigned char point[24], hash[crypto_shorthash_BYTES];
    uint64_t out;

    put(point, p->x * scale);
    put(point + 8, p->y * scale);
    put(point + 16, p->z * scale);
    (void)crypto_shorthash(hash, point, sizeof point, key);
    memcpy(&out, hash, sizeof out);
    return out;
}

/* Into least[0..n-1], which ascends and has room for REPLAY_SAMPLE; one that is there already is
 * left out.  Returns the new n. */
static size_t insert(uint64_t *least, size_t n, uint64_t hash)
{
    size_t i = n;

    while (i > 0 && least[i - 1] > hash)
        i--;
    if (i > 0 && least[i - 1] == hash)
        return n;
    if (n == REPLAY_SAMPLE)
        n--; /* the last one goes */
    memmove(&least[i + 1], &least[i], (n - i) * sizeof *least);
    least[i] = hash;
    return n + 1;
}

void replay_digest(const struct cloudpoints *c, char hex[65])
{
    unsigned char hash[crypto_hash_sha256_BYTES];
    uint64_t least[REPLAY_SAMPLE] = {0};
    const double scale = scale_of(c);
    size_t n = 0;

    for (size_t i = 0; i < c->n; i++) {
        const uint64_t h = hash_of(&c->at[i], scale);

        if (n < REPLAY_SAMPLE || h < least[n - 1])
            n = insert(least, n, h);
    }
    (void)crypto_hash_sha256(hash, (const unsigned char *)least, sizeof least);
    (void)sodium_bin2hex(hex, 65, hash, sizeof hash);
}

enum status replay_probe(const struct admission *a, const struct scan_found *found,
                         const struct face *probe, int64_t keep_ms,
                         struct store_probe *out, struct errinfo *e)
{
    const struct mesh *m = &probe->surface.mesh;
    bool as_many = a == NULL;

    *out = (struct store_probe){.read = found->digest, .keep_ms = keep_ms};
    for (size_t i = 0; a != NULL && i < a->of.n; i++)
        as_many |= a->of.t[i].points == m->nv;
    if (as_many && codec_digest(m, out->used) != ST_OK)
        return errinfo_set(e, ST_ENOMEM, "no memory for the probe's digest");
    return ST_OK;
}

enum status replay_refuse(struct errinfo *e)
{
    return errinfo_set(
        e, ST_EREPLAYED,
        "the scan is not a new one: a template was made of these points, or "
        "they matched before; scan again");
}
