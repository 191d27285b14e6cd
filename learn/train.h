/* train.h -- learn a model (core/model.h) from a collection of scans.
 *   1. The mean face and every face's frame: first by principal axes and noses of the
 *      enrolled scans, then by alignment to their mean, several times.
 *   2. The basis of motion: from all pairs of scans of one subject at their true poses, where
 *      the collection has them (train_motion.h); else the base model's.
 *   3. The basis of shape: how the faces differ from their mean (train_shape.h).
 *   4. The gaps per cell of all mated pairs and of some non-mated pairs, at the poses found.
 *   5. The basis of change from the mated pairs, with smooth changes added; u(x, y) from what
 *      it leaves of all pairs; the calibration from the non-mated scores, before noise, the core
 *      and what is hidden change the threshold (decision.h): of 12,000 pairs of the scans that
 *      the shipped model learned from its own decision takes 11, and 12 are wanted.
 * Error rates for subjects that were not learned from: each half of the subjects is scored by
 * what step 5 learned from the other half.
 * Deterministic: the same scans give the same model, on any number of threads. */
#ifndef LEARN_TRAIN_H
#define LEARN_TRAIN_H
#include <stdbool.h>
#include <stdint.h>
#include "model.h"
#include "rates.h"
#include "status.h"

struct errinfo;   /* errinfo.h */
struct train_set; /* train_set.h */

#define TRAIN_MIN_SUBJECTS 20
#define TRAIN_MIN_PROBES                                                                 \
    250 /* scans that are not enrolled: with 12 non-mated pairs each, the 3,000 pairs
                  that a rate of 0.1 % needs (rule of 3) */
#define TRAIN_FMR 0.001 /* of the calibration */

struct train_report {
    size_t genuine, impostor; /* pairs */
    struct rates_figures before,
        after; /* the base model; the new one, on the other half */
    double threshold_mm;
};

/* train_model(set, base, name, threads, say, arg, out, report, e): learn out from set.  Sets
 * the faces' frames by the new mean.
 * base     gives the basis of motion where no poses are known, and report->before
 * name     the model's name; printable ASCII, cut at MODEL_NAME_MAX
 * threads  0: one for each core
 * say      called with a line of text after each step, on the calling thread; may be NULL
 * out      rounded as its text form is
 * Memory: 16 kB for each pair, of which each probe has 13.  Cost: about two comparisons for
 * each pair.
 * Returns ST_OK; ST_EINVAL too few subjects, scans or pairs; ST_ECORRUPT the result is not a
 * valid model; ST_ENOMEM. */
enum status train_model(const struct train_set *set, const struct model *base,
                        const char *name, unsigned threads,
                        void (*say)(void *arg, const char *line), void *arg,
                        struct model *out, struct train_report *report,
                        struct errinfo *e);

#endif
