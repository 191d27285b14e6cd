/* ctl_cross.h -- everybody in the database compared with everybody else.
 * A comparison is what a verification does: one scan against all templates of a subject, of
 * which the highest score counts, lowered by the logarithm of their number (surface_best_of()), also
 * where that is inconclusive at the threshold in force: at a lower one it may match. */
#ifndef CTL_CROSS_H
#define CTL_CROSS_H
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"
#include "rates.h"
#include "store.h"

struct ctl;

#define CTL_CROSS_MAX 2000 /* subjects in memory at once */

struct ctl_cross_subject {
    char id[STORE_SUBJECT_MAX + 1];
    uint32_t first, n; /* templates first .. first + n - 1 */
};

struct ctl_cross {
    struct ctl_cross_subject *subject; /* with templates, as they came */
    uint32_t nsubject;
    uint32_t nenrolled; /* that have templates: nsubject, or more than are in memory */
    struct surface_face **face; /* [ntemplate] */
    uint32_t ntemplate;

    struct rates_score *score; /* subjects are indices of subject */
    size_t nscore;
};

/* ctl_cross_load(c, seed, p): *p is all zero.  Of more than CTL_CROSS_MAX
 * subjects that many are drawn.  c->e is filled on failure, here and below. */
enum status ctl_cross_load(struct ctl *c, uint64_t seed, struct ctl_cross *p);
void ctl_cross_free(struct ctl_cross *p);

/* ctl_cross_non_mated(c, p, limit, seed): add the scores of each subject's templates
 * against every other's; where that is more than about limit comparisons of two templates,
 * each subject is met by as many others' templates, drawn without replacement.
 * ctl_cross_mated(c, p): each template against the same subject's others. */
enum status ctl_cross_non_mated(struct ctl *c, struct ctl_cross *p, double limit,
                                uint64_t seed);
enum status ctl_cross_mated(struct ctl *c, struct ctl_cross *p);

#endif
