#include "replay.h"

#include <math.h>
#include <sodium.h>
#include <string.h>

#include "cloudpoints.h"
#include "digest.h"
#include "errinfo.h"
#include "face.h"
#include "scan.h"
#include "store.h"

#define UNITS 500.0 /* of the lattice, to the greatest coordinate */
#define FAR   1e15
#define HALF  1024 /* lattice units: more than any coordinate */

/* Lattice units for one of the file's, so that any unit gives the same points; 0 for what is no
 * cloud of anything. */
static double scale_of(const struct cloudpoints *c)
{
    double most = 0;

    for (size_t i = 0; i < c->n; i++)
        most =
            fmax(most, fmax(fabs(c->at[i].x), fmax(fabs(c->at[i].y), fabs(c->at[i].z))));
    return most > 1 / FAR && most < FAR ? UNITS / most : 0;
}

/* Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators", mix64(): one to
 * one, so that different points have different hashes. */
static uint64_t hash_of(const struct dvec3 *p, double scale)
{
    uint64_t h = (uint64_t)(p->x * scale + HALF + 0.5) << 42 ^
                 (uint64_t)(p->y * scale + HALF + 0.5) << 21 ^
                 (uint64_t)(p->z * scale + HALF + 0.5);

    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9U;
    h = (h ^ h >> 27) * 0x94d049bb133111ebU;
    return h ^ h >> 31;
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

/* The digest takes time, and points of another number are no template's. */
enum status replay_probe(const struct store_template *t, const struct scan_found *found,
                         const struct face *probe, struct store_probe *out,
                         struct errinfo *e)
{
    const struct mesh *m = &probe->surface.mesh;

    *out = (struct store_probe){.read = found->digest};
    if (m->nv == t->points && digest_points(m, out->used) != ST_OK)
        return errinfo_set(e, ST_ENOMEM, "no memory for the probe's digest");
    return ST_OK;
}

enum status replay_refuse(struct errinfo *e)
{
    return errinfo_set(
        e, ST_EREPLAYED,
        "the scan is not a new one: a template of the subject was made of these "
        "points; scan again");
}
