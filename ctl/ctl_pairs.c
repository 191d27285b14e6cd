#include "ctl_pairs.h"

#include <stdlib.h>

static int by_subjects(const void *p, const void *q)
{
    const struct ctl_pair *v = p, *w = q;

    if (v->x != w->x)
        return v->x < w->x ? -1 : 1;
    if (v->y != w->y)
        return v->y < w->y ? -1 : 1;
    if (v->score != w->score)
        return v->score > w->score ? -1 : 1;
    return v->a != w->a ? (v->a > w->a) - (v->a < w->a) : (v->b > w->b) - (v->b < w->b);
}

static int by_score(const void *p, const void *q)
{
    const struct ctl_pair *v = p, *w = q;

    return v->score != w->score ? (v->score < w->score) - (v->score > w->score)
                                : by_subjects(p, q);
}

size_t ctl_pairs_sort(struct ctl_pair *pair, size_t n)
{
    size_t kept = 0;

    if (n == 0)
        return 0;
    qsort(pair, n, sizeof *pair, by_subjects);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || pair[kept - 1].x != pair[i].x || pair[kept - 1].y != pair[i].y)
            pair[kept++] = pair[i];
    qsort(pair, kept, sizeof *pair, by_score);
    return kept;
}
