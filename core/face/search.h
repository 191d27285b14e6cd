/* search.h -- who of many people a scan may show: a first stage, which finds the templates that may have a
 * high score (ratio.h), so that only these are compared.
 * A template enters by its descriptor: the posterior mean of its identity, m = (I + A)^-1 b, in steps of the
 * model's own modes, and the class of its A.  With A taken from the class the score is a quadratic form of m.
 * One Cholesky factor makes it a constant less half a sum of squares, which is summed in integers.  So partial
 * faces, glasses and noise, which are in A, need no rule.
 * Classes are made from the model alone: its mean face at three residuals, and with a part missing.
 * (PLDA by posterior means: Kenny et al., "PLDA for Speaker Verification with Utterances of Arbitrary
 * Duration", ICASSP 2013.) */
#ifndef CORE_SEARCH_H
#define CORE_SEARCH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "encode.h"
#include "mem.h"
#include "model.h"
#include "status.h"
#include "surface_search.h"

#define SEARCH_MODES                                                                     \
    100 /* modes of identity that a descriptor has; those behind are left out */
#define SEARCH_CLASSES 8

/* A descriptor is the class, a byte, and then a signed byte for each mode. */
_Static_assert((SURFACE_DESCRIPTOR) == 1 + SEARCH_MODES, "the public header says so");

/* Constants of a model, for descriptors and probes; read-only, for any number of threads.  650 KB. */
struct search_basis {
    uint32_t n;                /* modes in use, up to SEARCH_MODES */
    double step[SEARCH_MODES]; /* size of a unit of each coefficient */
    /* I + A of each class, whole, and the logarithm of its determinant. */
    double precision[SEARCH_CLASSES][SEARCH_MODES][SEARCH_MODES];
    double ln_det[SEARCH_CLASSES];
};

/* search_prepare(e, s, out): Computes the basis of the model of e.  Cost: 15 ms.
 * Returns ST_OK; ST_ENOMEM. */
enum status search_prepare(const struct encode_basis *e, struct scratch *s,
                           struct search_basis *out);

/* search_describe(b, e, s, out): Computes the descriptor of the encoding e.  Cost: 1 ms.
 * Returns ST_OK; ST_EINVAL: e has no modes, or is not positive definite; ST_ENOMEM.  out[0] is then
 * SURFACE_UNDESCRIBED. */
enum status search_describe(const struct search_basis *b, const struct encoding *e,
                            struct scratch *s, unsigned char out[SURFACE_DESCRIPTOR]);

/* A row of the factor of a class: its value of a descriptor x is (sum of factor * x - offset) >> shift, in
 * 1 / SEARCH_UNIT of a deviation. */
#define SEARCH_UNIT 64
struct search_row {
    int16_t factor[SEARCH_MODES];
    int32_t offset, shift;
};

struct search_rows { /* of a class, by falling information of the mode that ends them */
    struct search_row row[SEARCH_MODES];
    int32_t base; /* cost of a descriptor whose values are all 0 */
};

/* A probe, ready for search_scan().  A cost c means the score best - c / (2 SEARCH_UNIT^2).  170 KB. */
struct search_probe {
    double best;
    struct search_rows class[SEARCH_CLASSES];
};

/* search_classes(x): Returns the classes of the descriptors in x, bit c for class c. */
unsigned search_classes(const struct surface_index *x);

/* search_probe(b, p, rho, classes, s, out): Prepares the encoding p of a probe.
 *   rho      the model's kinship
 *   classes  those wanted, as from search_classes(); out is only for indices without others
 * Cost: 0.4 ms a class.
 * Returns ST_OK; ST_EINVAL: as search_describe(); ST_ENOMEM. */
enum status search_probe(const struct search_basis *b, const struct encoding *p,
                         double rho, unsigned classes, struct scratch *s,
                         struct search_probe *out);

/* search_score(p, cost): Returns the score that a cost means. */
double search_score(const struct search_probe *p, int32_t cost);

struct search_hit {
    int32_t cost;
    uint32_t slot;
};

/* search_scan(x, p, allowed, floor, most, hit): Finds the descriptors of the lowest cost.
 *   allowed  bit slot % 16 of word slot / 16 is set for the slots to be searched; NULL: all
 *   floor    least score (search_score()) that is wanted
 *   most     capacity of hit, at least 1
 *   hit      receives the best, by rising cost, then by slot
 * Exact: no descriptor is left out.  Integers alone: the same digits on every machine.
 * Cost: 70 ns a descriptor of the model that is shipped.
 * Returns the number of hits. */
size_t search_scan(const struct surface_index *x, const struct search_probe *p,
                   const uint16_t *allowed, double floor, size_t most,
                   struct search_hit *hit);

/* ---- the inner loop, for its test */

#define SEARCH_BLOCK 16 /* descriptors of one class that are summed together */

/* The values of pairs of modes, of eight descriptors each: what pmaddwd wants side by side. */
struct search_block {
    int8_t x[SEARCH_MODES / 2][2][SEARCH_BLOCK / 2][2];
};

/* search_cost(b, rows, limit, cost): Computes the costs of a block without rows->base.  Returns false as soon as all
 * exceed limit: then cost is unspecified.  search_cost_plain(): Does the same in plain C. */
bool search_cost(const struct search_block *b, const struct search_rows *rows,
                 int32_t limit, int32_t cost[SEARCH_BLOCK]);
bool search_cost_plain(const struct search_block *b, const struct search_rows *rows,
                       int32_t limit, int32_t cost[SEARCH_BLOCK]);

#endif
