/* train.h -- a model (core/face/model.h) adapted to scans of real people, and its calibration:
 * docs/model.md, "How it is learned".
 * Deterministic: a model depends on nothing but the files, with any compiler and any number of
 * threads. */
#ifndef LAB_TRAIN_H
#define LAB_TRAIN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "model.h"
#include "rates.h"
#include "status.h"

struct corpus;       /* corpus.h */
struct errinfo;      /* errinfo.h */
struct surface_face; /* face.h */

#define TRAIN_MIN_SUBJECTS 20 /* with two scans or more */

struct train {
    const struct surface_model *
        base; /* the model to adapt; the new model keeps the parts that are not learned */
    const struct corpus *corpus; /* scans; NULL: none */
    const struct surface_face
        *face;     /* [corpus->nscan] built by base; of no points: not used */
    double weight; /* weight of the scans, 0 to 1; below 0: by the number of subjects */
    const char
        *scores; /* a file that evaluate wrote, to calibrate by; NULL: the base's table */
    unsigned threads; /* 0: one for each core */
};

/* Of scans, and only with them. */
struct train_report {
    uint32_t nsubject, nscan; /* used */
    double weight;
    size_t mated, non_mated; /* comparisons */
    /* Of these comparisons: by the base model, and by models that have learned from the scans of
     * other subjects alone. */
    struct rates_figures base, own;
    bool worse; /* own is: by EER or acceptance at FMR 1 %, and better by neither */
};

/* train_model(t, name, out, report, e)
 * name    the model's; printable ASCII of up to MODEL_NAME_MAX characters
 * out     rounded as its text form is
 * report  all 0 without scans
 * Memory: 30 KB a scan.  Cost: three encodings for each scan, 2 ms for each pair of scans of
 * one subject.
 * Returns ST_OK; ST_ETOOFEW subjects, or scores to calibrate by; ST_ECORRUPT the base has no
 * population, or the result is no valid model; the errors of csv_open() and csv_next();
 * ST_ENOMEM. */
enum status train_model(const struct train *t, const char *name,
                        struct surface_model *out, struct train_report *report,
                        struct errinfo *e);

#endif
