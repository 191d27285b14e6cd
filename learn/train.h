/* train.h -- a model (core/model.h) learned from a collection of scans.
 *   1. The mean face and every face's frame: from the principal axes and noses of the
 *      enrolled scans, then laid on their mean again and again.
 *   2. The basis of motion: from all pairs of scans of one subject at their true poses, where
 *      the collection knows them (train_motion.h); else the base model's.
 *   3. The gaps per cell of all genuine pairs and of impostor pairs, each at the pose found.
 *   4. The basis of change from the genuine ones, smooth changes added; u(x, y) from what
 *      it leaves of both; the calibration from the impostors' disparities.
 * Steps 4's outcome for people it was not learned from is told by learning from one half
 * of the subjects and judging the other, and the other way round.
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
    250                 /* scans besides the enrolled ones: 12 impostors each, and 3000
                                  are what a rate of 0.1 % takes (rule of 3) */
#define TRAIN_FMR 0.001 /* the calibration's */

struct train_report {
    size_t genuine, impostor; /* pairs */
    struct rates_figures before,
        after; /* the base model; the new one, on the other half */
    double threshold_mm;
};

/* train_model(set, base, name, threads, say, arg, out, report, e): the faces' frames are set
 * anew, by the new mean.
 * base     its motion is used where no poses are known; compared with
 * name     what is written into the model; printable ASCII, cut at MODEL_NAME_MAX
 * threads  0: one a core
 * say      called with a line of text now and then, on the calling thread; may be NULL
 * out      as it will be read from its text: rounded
 * Memory: 16 kB a pair, of which there are 13 for each probe.  Cost: about two comparisons a
 * pair.
 * Returns ST_OK; ST_EINVAL: too few subjects, scans or pairs to learn from; ST_ECORRUPT:
 * what was learned is no model; ST_ENOMEM. */
enum status train_model(const struct train_set *set, const struct model *base,
                        const char *name, unsigned threads,
                        void (*say)(void *arg, const char *line), void *arg,
                        struct model *out, struct train_report *report,
                        struct errinfo *e);

#endif
