#include "work.h"

#include <stdlib.h>
#include <string.h>

#include "align.h"
#include "pose.h"
#include "asymmetry.h"
#include "heatmap.h"
#include "lattice.h"
#include "measure.h"
#include "minimal.h"

static uint64_t executed, set_at;
static atomic_bool *flag;

/* Called by libcounted.a. */
void __sanitizer_cov_trace_pc(void);
void __sanitizer_cov_trace_pc(void)
{
    if (++executed == set_at)
        atomic_store(flag, true);
}

uint64_t work_executed(void)
{
    return executed;
}

void work_set_at(atomic_bool *f, uint64_t blocks)
{
    flag = f;
    set_at = executed + blocks;
}

const char *work_name(enum work_step step)
{
    static const char *const name[WORK_STEPS] = {"prepare", "align",   "measure",
                                                 "minimal", "heatmap", "asymmetry"};

    return name[step];
}

static enum status prepare(const struct dvec3 *p, size_t n, struct scratch *s,
                           struct surface *out)
{
    struct ivec3 *lattice = malloc(n * sizeof *lattice);
    enum status st = lattice_from_mm(p, n, LATTICE_PER_MM, lattice, NULL);

    if (st == ST_OK)
        st = surface_prepare(lattice, n, true, s, out);
    free(lattice);
    return st;
}

/* What was executed since *from, for each of n points; *from becomes now. */
static double since(uint64_t *from, size_t n)
{
    const uint64_t was = *from;

    *from = executed;
    return (double)(executed - was) / (double)n;
}

void work_count(const struct dvec3 *a, const struct dvec3 *b, size_t n,
                double blocks[WORK_STEPS])
{
    static const struct pose still = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const struct align_how how = {0};
    double *gap = malloc(n * sizeof *gap);
    struct surface s[2], upright = {0};
    struct align_work align = {0};
    struct measure_work m = {0};
    struct align_result found;
    struct disparity disparity;
    struct minimal minimal;
    struct surface_asymmetry asymmetry;
    uint64_t from = executed;

    memset(blocks, 0, WORK_STEPS * sizeof *blocks);
    memset(s, 0, sizeof s);
    if (prepare(a, n, &m.scratch, &s[0]) == ST_OK &&
        prepare(b, n, &m.scratch, &s[1]) == ST_OK) {
        blocks[WORK_PREPARE] = since(&from, n);
        if (align_search(&s[0], &s[1], &how, &align, &found) != ST_OK)
            abort();
        blocks[WORK_ALIGN] = since(&from, n);
        if (measure_at(&s[0], &s[1], found.transform, NULL, &m, &disparity) != ST_OK)
            abort();
        blocks[WORK_MEASURE] = since(&from, n);
        if (minimal_find(&s[0], &s[1], found.transform, &m, &minimal) != ST_OK)
            abort();
        blocks[WORK_MINIMAL] = since(&from, n);
        if (heatmap_gaps(&s[0], b, n, found.transform, gap) != ST_OK)
            abort();
        blocks[WORK_HEATMAP] = since(&from, n);
        if (asymmetry_find(&s[1], &still, NULL, &m, &upright, &asymmetry) != ST_OK)
            abort();
        blocks[WORK_ASYMMETRY] = since(&from, n);
    }
    surface_free(&s[0]);
    surface_free(&s[1]);
    surface_free(&upright);
    align_work_free(&align);
    measure_work_free(&m);
    free(gap);
}

double work_ratio(const double blocks[WORK_STEPS], const double ordinary[WORK_STEPS])
{
    const double half = blocks[WORK_PREPARE] / 2, other = ordinary[WORK_PREPARE] / 2;
    const double asymmetry =
        (half + blocks[WORK_ASYMMETRY]) / (other + ordinary[WORK_ASYMMETRY]);
    double sum = 0, all = 0;

    for (int i = 0; i < WORK_ASYMMETRY; i++) {
        sum += blocks[i];
        all += ordinary[i];
    }
    return sum / all > asymmetry ? sum / all : asymmetry;
}
