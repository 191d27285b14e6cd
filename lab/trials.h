/* trials.h -- the comparisons of a corpus, on all cores: every probe with its own subject's
 * template and with others', or the pairs that it lists.  The comparisons are chosen before the first one is
 * made, so that the number of threads does not matter. */
#ifndef LAB_TRIALS_H
#define LAB_TRIALS_H
#include "corpus.h"
#include "lab.h"

/* The most non-mated comparisons of a folder or manifest, unless the caller says how
 * many. */
#define TRIALS_NON_MATED 200000
#define TRIALS_ALL       UINT32_MAX
#define TRIALS_SEED      UINT64_C(19795) /* of the sampling; the standard's number */

struct trial {
    uint32_t template, probe; /* indices of corpus.scan */
    enum corpus_pair type;    /* mated, non-mated or relative */
    bool done;                /* false: one of both scans was refused */
    enum surface_decision decision;
    double score, fmr_at_score;             /* unrounded, of surface_comparison */
    float overlap, region[SURFACE_REGIONS]; /* region: NAN, not asked for */
    float disparity_mm; /* the minimal disparity; NAN: not asked for */
    float score_ms;
};

/* A scan as a template or as a probe. */
struct trials_scan {
    bool used; /* the scan has this role; else the rest is 0 */
    enum status
        st;    /* why no face could be made of it: a failure to enroll or to acquire */
    char *why; /* reason in words; NULL if st is ST_OK */
};

struct trials {
    const struct corpus *corpus;
    struct trial *trial; /* [n] by probe, its own template first; or as listed */
    size_t n;
    struct trials_scan *template, *probe; /* [corpus->nscan] */
    double threshold;                     /* the model's, or the one given */
    uint32_t non_mated; /* most comparisons of each probe, or TRIALS_ALL */
    uint32_t nthread;
    double build_s, compare_s; /* wall time of the enrolment and of all probes, s */
};

/* trials_run(c, corpus, out): progress goes to standard error, when that is a
 * terminal.
 * out  new object, released by trials_free(); NULL on error; borrows corpus
 * A scan that is malformed or no face is refused and listed, no error.  Non-mated pairs
 * are drawn without replacement, for each probe on its own.
 * Memory: a face of each template, and one of a probe for each thread.
 * Returns ST_OK; ST_ENOMEM, ST_EIO, ST_ENOTFOUND with c->e filled. */
enum status trials_run(struct lab *c, const struct corpus *corpus, struct trials **out);
void trials_free(struct trials *t); /* NULL is allowed */

#endif
