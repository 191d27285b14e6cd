/* work_search [POINTS [ROUNDS [SEED]]]: search for two point sets whose comparison costs most
 * work a point, by changing the genes of the best so far.  Prints each that is better, in the
 * form of test_work.c's table, with its work as a multiple of a simulated scan's. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brute.h"
#include "clouds.h"
#include "contrived.h"
#include "work.h"

#define GENES (2 * CONTRIVED_GENES)

static double unit(struct brute_rng *r)
{
    return (double)brute_int(r, 0, 100) / 100;
}

static void change(struct brute_rng *r, double gene[GENES])
{
    for (int k = 1 + brute_int(r, 0, 3); k > 0; k--) {
        double *g = &gene[brute_int(r, 0, GENES - 1)];

        *g = brute_int(r, 0, 2) == 0 ? unit(r) : *g + 0.2 * (unit(r) - 0.5);
        *g = *g < 0 ? 0 : *g > 1 ? 1 : *g;
    }
}

int main(int argc, char **argv)
{
    const uint32_t n = argc > 1 ? (uint32_t)atoi(argv[1]) : 3000;
    const int rounds = argc > 2 ? atoi(argv[2]) : 300;
    struct brute_rng r = {argc > 3 ? (uint64_t)atoi(argv[3]) : 1};
    struct dvec3 *a = malloc(n * sizeof *a), *b = malloc(n * sizeof *b);
    double best[GENES], gene[GENES], blocks[WORK_STEPS], ordinary[WORK_STEPS];
    double most = 0;
    size_t na, nb;

    if (a == NULL || b == NULL)
        return 1;
    na = clouds_scan(1, 0, n, a);
    nb = clouds_scan(1, 1, n, b);
    work_count(a, b, na < nb ? na : nb, ordinary);
    for (int i = 0; i < rounds; i++) {
        double score;

        memcpy(gene, best, sizeof gene);
        for (int k = 0; k < GENES && i < rounds / 5; k++)
            gene[k] = k % CONTRIVED_GENES <= CONTRIVED_CLUSTER && brute_int(&r, 0, 1)
                          ? 0
                          : unit(&r);
        if (i >= rounds / 5)
            change(&r, gene);
        contrived_make(gene, 1, n, a);
        contrived_make(gene + CONTRIVED_GENES, 1, n, b);
        work_count(a, b, n, blocks);
        score = work_ratio(blocks, ordinary);
        if (score <= most)
            continue;
        most = score;
        memcpy(best, gene, sizeof best);
        printf("{%.1f, {", score);
        for (int k = 0; k < GENES; k++)
            printf("%.2f%s", gene[k], k + 1 < GENES ? ", " : "}}, //");
        for (int k = 0; k < WORK_STEPS; k++)
            printf(" %s %.1f", work_name((enum work_step)k), blocks[k] / ordinary[k]);
        printf("\n");
        (void)fflush(stdout);
    }
    free(a);
    free(b);
    return 0;
}
