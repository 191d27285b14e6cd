/* ---- surface_basic.h: version, statuses, the calibration of decisions */
#ifndef CORE_SURFACE_BASIC_H
#define CORE_SURFACE_BASIC_H
#include <stddef.h>
#include <stdint.h>

#define SURFACE_API __attribute__((visibility("default")))

#define SURFACE_VERSION "0.2.0"

#define SURFACE_MIN_POINTS 100
#define SURFACE_MAX_POINTS 2097152
#define SURFACE_KNOTS      32
#define SURFACE_FRAMES_MAX 20

/* The values never change.  The missing numbers belong to statuses of the daemon. */
enum surface_status {
    SURFACE_OK = 0,
    SURFACE_EINVAL = 1,      /* an argument is malformed */
    SURFACE_ENOMEM = 2,      /* out of memory */
    SURFACE_ELIMIT = 4,      /* more than SURFACE_MAX_POINTS */
    SURFACE_ETOOFEW = 5,     /* fewer than SURFACE_MIN_POINTS at different places */
    SURFACE_ENOTFINITE = 6,  /* with SURFACE_FRONTAL: a coordinate is NaN or infinite */
    SURFACE_ERANGE = 7,      /* a coordinate is beyond 16.7 m */
    SURFACE_EDEGENERATE = 8, /* all points lie on one line */
    SURFACE_EUNITS = 9,      /* the extent is not that of a face: 60 to 500 mm */
    SURFACE_ENOFACE = 10,    /* no face was found */
    SURFACE_ESEVERAL = 11,   /* enrolment: more than one face */
    SURFACE_EMIRRORED = 12,  /* enrolment: a mirror image */
    SURFACE_ENOTFACE = 13,   /* the surface does not have the shape of a face */
    SURFACE_EQUALITY =
        14, /* the quality of the scan is too low: noise, spikes, holes, occlusion */
    SURFACE_ECORRUPT = 15,  /* bytes that are not a face, or a text that is not a model */
    SURFACE_EVERSION = 16,  /* bytes or a text of another version */
    SURFACE_ESTOPPED = 25,  /* the caller cancelled the call */
    SURFACE_EINTERNAL = 28, /* a defect of the library */
    SURFACE_EPEOPLE = 30,   /* frames of more than one person */
    SURFACE_EAPART = 31     /* a frame that does not lie on the others */
};

/* Returns a phrase for a status, static, never NULL. */
SURFACE_API const char *surface_message(enum surface_status st);

/* From a score to a decision.  A model has its own; another one can be learned from
 * comparisons of other people. */
struct surface_knot {
    double score; /* strictly rising, -1e4 to 1e4 */
    /* share of the scores of different people at or above it: the first is 1, strictly falling,
     * above 0 */
    double rate;
};
/* A law for scores from the last knot on, fitted to such scores.  Used by identifications alone. */
struct surface_tail {
    double rate;     /* at the last knot's score; above 0, not above that knot's */
    double decade;   /* the score by which the rate falls to a tenth */
    uint32_t people; /* the largest gallery that is searched by it; 0: there is no law */
};
struct surface_calibration {
    double threshold; /* a score at or above it is a match */
    uint32_t n;       /* knots, 2..SURFACE_KNOTS */
    struct surface_knot knot[SURFACE_KNOTS];
    struct surface_tail tail;
};

/* Returns 1 if the members of by are as described above, else 0. */
SURFACE_API int surface_calibration_valid(const struct surface_calibration *by);

/* Gives *c the law of another calibration, from c's own last knot and its rate on: that rate is an upper limit, and
 * how fast rates fall behind it is not known from few comparisons. */
SURFACE_API void surface_calibration_continue(struct surface_calibration *c,
                                              const struct surface_calibration *by);

/* Returns the false match rate at a threshold of this score, 0..1: 1 below the first knot, linear
 * between the knots, and constant from the last one on: never below what the comparisons
 * support.  NaN gives 1. */
SURFACE_API double surface_calibration_rate(const struct surface_calibration *by,
                                            double score);

/* ---- identification: one scan against a gallery of people.  Each of them is one more chance for a false
 * match, so a larger gallery needs a higher score. */

/* The share of scans of people outside the gallery that may match somebody in it: the false-positive
 * identification rate (FPIR, ISO/IEC 19795-1) at the threshold. */
#define SURFACE_FPIR 0.01

/* Returns the FPIR at a threshold of this score, 0..1: 1 - (1 - rate)^people.  The rate is that of the knots and,
 * from the last one on, that of the tail's law; without a law it stays the last knot's.
 *   people        size of the gallery
 *   extrapolated  receives 1 if the rate is the law's, else 0; may be NULL */
SURFACE_API double surface_search_fpir(const struct surface_calibration *by,
                                       uint32_t people, double score, int *extrapolated);

/* Returns the least score, rounded up to a thousandth, at which the best of people is a match: not
 * below by->threshold, and with an FPIR of at most SURFACE_FPIR.  INFINITY: knots and law support none, so
 * that no score is a match.
 * For the decision on the best comparison set its threshold to this, then call surface_best_of().
 * Cost: about 10 us. */
SURFACE_API double surface_search_threshold(const struct surface_calibration *by,
                                            uint32_t people);

/* Returns the size of the largest gallery in which somebody can match.  Cost: about 100 us. */
SURFACE_API uint32_t surface_search_people(const struct surface_calibration *by);

#endif /* CORE_SURFACE_BASIC_H */
