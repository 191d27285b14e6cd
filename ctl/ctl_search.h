/* ctl_search.h -- the pairs of templates of two subjects with a high score, among all pairs.
 * A search by each template (surface_search()) names the pairs that may have one; these are compared exactly.
 * A search takes the other template by its class, which makes the score of a partial one too low, by up to 30.  So
 * each pair is searched from both sides: the side of the partial template has the better score.  Of 10,443 pairs
 * with a score of -2 or more, of real and simulated scans with glasses, turned, coarse and cut, the better of both was
 * too low by 4.8 at most, by 4.0 at scores from 8 on; of a dozen simulated children, whose heads are of other sizes, by
 * 6.3.  None is beyond the margin.
 * Memory: 250 bytes a template and 16 a pair compared; faces are read when they are needed. */
#ifndef CTL_SEARCH_H
#define CTL_SEARCH_H
#include <stddef.h>
#include <stdint.h>
#include "ctl_cross.h"

#define CTL_SEARCH_MARGIN 7.0

#define CTL_SEARCH_ALL UINT32_MAX

struct ctl_search_pair {
    uint32_t a, b; /* templates of p, a < b, of two subjects */
    double score;
};

struct ctl_search {
    struct ctl_search_pair *pair; /* [n] at or above the floor, by a, then b */
    size_t n;
    uint64_t compared;     /* pairs that were compared exactly */
    uint64_t inconclusive; /* of these, pairs whose expected score is below the floor */
    uint32_t
        skipped; /* templates that were not searched: deleted since, or of another engine */
};

/* ctl_search_run(c, p, alone, floor, out): Finds the pairs of p, as from ctl_cross_list(), that score floor or more.
 *   alone  a subject, whose templates are compared exactly with all others'; CTL_SEARCH_ALL: each two subjects
 *   out    to be released by ctl_search_free(), also after a failure
 * Reports damaged templates on standard error, and counts them in p->damaged.
 * Cost: about 4 ms a template, 50 ns each two, and 0.5 ms a pair compared; of a subject alone 0.5 ms a template. */
enum status ctl_search_run(struct ctl *c, struct ctl_cross *p, uint32_t alone,
                           double floor, struct ctl_search *out);

void ctl_search_free(struct ctl_search *s);

#endif
