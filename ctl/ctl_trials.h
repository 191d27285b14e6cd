/* ctl_trials.h -- the comparisons of a corpus, on all cores: every probe with its own subject's
 * template and with others', or the pairs that it lists.  What is compared is settled before
 * anything is: the same on any number of threads. */
#ifndef CTL_TRIALS_H
#define CTL_TRIALS_H
#include "corpus.h"
#include "rates.h"
#include "ctl.h"

struct calibration; /* calibration.h */

/* Of a folder or manifest so many non-mated comparisons are made, at most, unless the caller
 * says how many. */
#define CTL_TRIALS_NON_MATED 200000
#define CTL_TRIALS_ALL       UINT32_MAX

struct ctl_trial {
    uint32_t template, probe; /* of corpus.scan */
    enum corpus_pair type;    /* mated, non-mated or relative */
    bool done;                /* false: one of both scans was refused */
    enum face_decision decision;
    double score, fmr_at_score;          /* as in face_result, as are these */
    float overlap, region[GRID_REGIONS]; /* region: NAN, not asked for */
    float disparity_mm;                  /* the minimal disparity; NAN: not asked for */
    float rotation_deg; /* between the rotation found and the true one; NAN: not known */
    float score_ms;
};

/* A scan as a template or as a probe. */
struct ctl_trials_scan {
    bool used; /* in this role; else the rest is 0 */
    enum status
        st;    /* why no face could be made of it: a failure to enroll or to acquire */
    char *why; /* in words; NULL where st is ST_OK */
};

struct ctl_trials {
    const struct corpus *corpus;
    struct ctl_trial *trial; /* by probe, its own template first; or as listed */
    size_t n;
    struct ctl_trials_scan *template, *probe; /* [corpus->nscan] */
    double threshold;                         /* the calibration's, or the one given */
    uint64_t seed;                            /* of the sampling */
    uint32_t
        non_mated; /* of each probe, at most; CTL_TRIALS_ALL; of a list CTL_TRIALS_ALL */
    uint32_t nthread;
    double build_s,
        compare_s; /* by the clock on the wall: enrolment; all of the probes */
};

struct ctl_trials_how {
    const struct calibration *calibration; /* NULL: the model's */
    uint32_t
        non_mated; /* of each probe; CTL_TRIALS_ALL; 0: all, but CTL_TRIALS_NON_MATED in
                           all.  Nothing where the corpus lists its pairs */
    bool minimal;  /* the minimal disparity too */
    bool regions;  /* each region's part of the score too */
};

/* ctl_trials_run(c, corpus, how, out): progress goes to standard error, when that is a
 * terminal.
 * out  new object, released by ctl_trials_free(); NULL on error; borrows corpus
 * A scan that is malformed or no face is refused and listed, no error.  Non-mated pairs
 * are drawn without replacement, for each probe on its own.
 * Memory: a face of each template, and one of a probe for each thread.
 * Returns ST_OK; ST_ENOMEM, ST_EIO, ST_ENOTFOUND with c->e filled. */
enum status ctl_trials_run(struct ctl *c, const struct corpus *corpus,
                           const struct ctl_trials_how *how, struct ctl_trials **out);
void ctl_trials_free(struct ctl_trials *t); /* NULL is allowed */

#endif
