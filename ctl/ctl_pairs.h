/* ctl_pairs.h -- comparisons of two subjects' templates: of each two subjects the nearest. */
#ifndef CTL_PAIRS_H
#define CTL_PAIRS_H
#include <stddef.h>
#include <stdint.h>

struct ctl_pair {
    uint32_t x, y; /* two subjects, in their order */
    uint32_t a, b; /* a template of each */
    double score;
};

/* ctl_pairs_sort(pair, n): keep the highest score of each two subjects, the highest of all
 * first: the same list in whatever order they came.  Returns how many are left. */
size_t ctl_pairs_sort(struct ctl_pair *pair, size_t n);

#endif
