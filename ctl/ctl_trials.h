/* ctl_trials.h -- the comparisons of a corpus: every probe with its own subject's
 * template and with others', on all cores.  What is compared is settled before anything
 * is: the same on any number of threads. */
#ifndef CTL_TRIALS_H
#define CTL_TRIALS_H
#include "corpus.h"
#include "rates.h"
#include "ctl.h"

struct decision; /* decision.h */

/* Without --non-mated so many non-mated comparisons are made, at most. */
#define CTL_TRIALS_NON_MATED 200000

struct ctl_trial {
    uint32_t template, probe; /* of corpus.scan */
    enum corpus_pair type;    /* mated, non-mated or relative */
    bool done;                /* false: one of both scans was refused */
    enum face_decision decision;
    bool comparable; /* as in face_result, as are these */
    double score_mm, threshold_mm, calibrated_mm, fmr_at_score;
    double overlap, weight_overlap;
    double rotation_deg; /* between the rotation found and the true one; NAN: not known */
    double align_ms, measure_ms;
};

struct ctl_trials {
    const struct corpus *corpus;
    struct ctl_trial *trial; /* by probe, its own template first */
    size_t n;
    char **refused;      /* [corpus->nscan] why no model could be made of it, or NULL */
    double threshold_mm; /* the calibration's, or the one given: of calibrated_mm */
    uint64_t seed;       /* of the sampling */
    uint32_t non_mated;  /* of each probe, at most; UINT32_MAX: all */
    uint32_t nthread;
    double build_s,
        compare_s; /* by the clock on the wall: enrolment; all of the probes */
};

/* ctl_trials_run(c, corpus, decision, non_mated, out): progress goes to standard error,
 * when that is a terminal.
 * decision   NULL: the model's
 * non_mated  of each probe; 0: all, but CTL_TRIALS_NON_MATED in all
 * out        new object, released by ctl_trials_free(); NULL on error; borrows corpus
 * A scan that is malformed or no face is refused and listed, no error.  Non-mated pairs
 * are drawn without replacement, for each probe on its own.
 * Memory: a model of each enrolled scan, and one of a probe for each thread.
 * Returns ST_OK; ST_ENOMEM, ST_EIO, ST_ENOTFOUND with c->e filled. */
enum status ctl_trials_run(struct ctl *c, const struct corpus *corpus,
                           const struct decision *decision, uint32_t non_mated,
                           struct ctl_trials **out);
void ctl_trials_free(struct ctl_trials *t); /* NULL is allowed */

#endif
