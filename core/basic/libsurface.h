/* surface.h -- libsurface: faces found in scans, stored as bytes, and compared.
 *
 *     struct surface_work *work = surface_work_new(NULL);
 *     struct surface_cloud a = {.points = p, .n = np};
 *     struct surface_cloud b = {.points = q, .n = nq};
 *     struct surface_comparison c = {0};
 *     struct surface_face *tmpl = NULL, *probe = NULL;
 *
 *     a.flags = SURFACE_ENROLMENT;
 *     if (work != NULL && surface_build(work, &a, &tmpl, NULL) == SURFACE_OK &&
 *         surface_build(work, &b, &probe, NULL) == SURFACE_OK &&
 *         surface_compare(work, tmpl, probe, &c) == SURFACE_OK)
 *         printf("%d: score %.1f\n", c.decision == SURFACE_MATCH, c.score);
 *
 * The library prints nothing, reads no file and never exits.  The same points give the
 * same digits on every machine with IEEE 754 numbers, on any number of threads.  Lengths
 * are millimetres, transforms rigid and row-major 4 x 4, unless stated otherwise. Link
 * with -lsurface -lm (pkg-config: surface).  docs/library.md has whole programs.
 *
 * Out parameters may be NULL only where stated.
 *
 * (In the source tree this is core/basic/libsurface.h, below the modules of the core that
 * fill its structs; make install calls it surface.h.) */
#ifndef SURFACE_H
#define SURFACE_H
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SURFACE_API __attribute__((visibility("default")))

#define SURFACE_VERSION       "0.2.0"
#define SURFACE_VERSION_MAJOR 0
#define SURFACE_VERSION_MINOR 2
#define SURFACE_VERSION_PATCH 0
SURFACE_API const char *surface_version(void); /* of the library that runs; static */

#define SURFACE_MIN_POINTS  100
#define SURFACE_MAX_POINTS  2097152
#define SURFACE_ENGINE      "surfaced/0.2.0 measure/7" /* and a model: surface_engine() */
#define SURFACE_ENGINE_SIZE 64
#define SURFACE_KNOTS       32

/* What is measured of a scan, and the limits of its defects. */
#define SURFACE_FARTHEST_MM   16777.216 /* the largest coordinate: 2^24 um */
#define SURFACE_EXTENT_MIN_MM 60        /* of a face's longest side */
#define SURFACE_EXTENT_MAX_MM 500
#define SURFACE_SPARSE_MM     3.0 /* between neighbouring points */
#define SURFACE_NOISY_MM      0.6
#define SURFACE_FOCAL_MOST    1.085 /* surface_found.focal_times of a face */
#define SURFACE_FOCAL_LEAST   0.85
#define SURFACE_STEP_MM       1.2 /* between neighbouring depths of the sensor */
#define SURFACE_YAW_DEG       30
#define SURFACE_TILT_DEG      20   /* of pitch and roll */
#define SURFACE_OCCLUDED_MOST 0.40 /* share of an enrolled face */

/* The values never change; the numbers left out are the program's own statuses
 * (status.h). */
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
        14, /* the quality of the scan is too low: noise, spikes, holes, covers */
    SURFACE_ECORRUPT = 15,  /* bytes that are not a face, or a text that is not a model */
    SURFACE_EVERSION = 16,  /* bytes or a text of another version */
    SURFACE_ESTOPPED = 25,  /* the caller stopped the call */
    SURFACE_EINTERNAL = 28, /* a defect of the library */
    SURFACE_EPEOPLE = 30,   /* frames of more than one person */
    SURFACE_EAPART = 31     /* a frame that does not lie on the others */
};

/* A phrase for a status, static, never NULL. */
SURFACE_API const char *surface_message(enum surface_status st);

/* ---- the model of faces, and the calibration of decisions */

/* What is known of faces in general; immutable, for any number of threads. */
struct surface_model;

/* Parse a model from its text form (docs/model.md), borrowed for the call.
 * out   a new model, to be released with surface_model_free(); NULL on failure
 * line  the number of the line that failed, from 1; may be NULL
 * Returns SURFACE_OK, SURFACE_ECORRUPT, SURFACE_EVERSION, SURFACE_ENOMEM. */
SURFACE_API enum surface_status surface_model_parse(const char *text, size_t length,
                                                    struct surface_model **out,
                                                    uint32_t *line);
SURFACE_API void surface_model_free(struct surface_model *model); /* NULL is allowed */

/* Write a model as text, NUL-terminated, to the size bytes at text, and return the text's
 * length; if that is >= size it did not fit.  Numbers are rounded to the text's units, so
 * that surface_model_parse() of the text gives the same model. */
SURFACE_API size_t surface_model_write(const struct surface_model *model, char *text,
                                       size_t size);

/* The engine that makes scores: "surfaced/VERSION measure/N model/HHHHHHHH",
 * NUL-terminated, with the first 8 hex digits of the model's digest.  N increases with
 * every change that gives two scans another score, or the same points another face.
 * Scores of another measure or another model are not comparable.  NULL: the shipped
 * model.  About 1 ms. */
SURFACE_API void surface_engine(const struct surface_model *model,
                                char out[SURFACE_ENGINE_SIZE]);

/* surface_same_engine(a, b): 1 if scores of the engines a and b are comparable: only the
 * version differs. */
SURFACE_API int surface_same_engine(const char *a, const char *b);

/* From a score to a decision.  A model has its own; another one can be learned from
 * comparisons of other people. */
struct surface_knot {
    double score; /* strictly rising, -1e4 to 1e4 */
    /* share of the scores of different people at or above it: the first is 1, strictly falling,
     * above 0 */
    double rate;
};
struct surface_calibration {
    double threshold; /* a score at or above it is a match */
    uint32_t n;       /* knots, 2..SURFACE_KNOTS */
    struct surface_knot knot[SURFACE_KNOTS];
};
/* The model's own; NULL: the shipped model's. */
SURFACE_API const struct surface_calibration *
surface_model_calibration(const struct surface_model *model);
/* 1 if it is as described above, else 0. */
SURFACE_API int surface_calibration_valid(const struct surface_calibration *by);
/* The false match rate at a threshold of this score, 0..1: 1 below the first knot, linear
 * between the knots, and constant from the last one on: never below what the comparisons
 * support. NaN gives 1. */
SURFACE_API double surface_calibration_rate(const struct surface_calibration *by,
                                            double score);

/* ---- memory to work with */

/* Memory for building and comparing, reused from call to call: after the first few calls
 * only new faces are allocated.  One thread at a time; each thread has its own. */
struct surface_work;

/* By this model, borrowed until surface_work_free(); NULL: the shipped one.  Returns NULL
 * without memory.  About 20 ms. */
SURFACE_API struct surface_work *surface_work_new(const struct surface_model *model);
SURFACE_API void surface_work_free(struct surface_work *work); /* NULL is allowed */

/* Decide by this calibration (copied) from now on; NULL: by the model's own.
 * Returns SURFACE_OK, or SURFACE_EINVAL: it is not as described above; nothing changes. */
SURFACE_API enum surface_status
surface_work_calibrate(struct surface_work *work, const struct surface_calibration *by);

/* The calibration that work decides by. */
SURFACE_API const struct surface_calibration *
surface_work_calibration(const struct surface_work *work);

/* A clock for the times that surface_disparity() reports, in ms; NULL: none. */
SURFACE_API void surface_work_clock(struct surface_work *work, double (*clock_ms)(void));

/* Overwrite what is left in the memory of the faces that were worked on, and give back what more
 * than faces of 10,000 points need. */
SURFACE_API void surface_work_wipe(struct surface_work *work);

/* ---- a face from a scan */

/* A scan, prepared for comparison.  Immutable: any number of threads may compare it at the
 * same time, and it outlives the memory that it was built with. */
struct surface_face;

enum {
    /* The points are one face as its scanner saw it: x to the image's right, y up, z towards
     * the scanner, yaw within 30 degrees, pitch and roll within 20.  Nothing is searched for,
     * turned or cropped.  Without it the face is found, cropped and turned, whatever lies
     * around it and whatever its pose. */
    SURFACE_FRONTAL = 1,
    /* with the stricter gate for faces that others are compared with */
    SURFACE_ENROLMENT = 2,
    /* x and y were computed from a depth image, by a focal length that may be wrong: the proportions
     * of the face are looked at too */
    SURFACE_PINHOLE = 4
};

/* Asked before each step of the search; when it returns other than 0 the build ends with
 * SURFACE_ESTOPPED. */
struct surface_stop {
    int (*wanted)(const void *arg);
    const void *arg;
};

/* The points of a scan, in any order; all borrowed for the call. */
struct surface_cloud {
    /* (x, y, z); those with a NaN or an infinity are left out, but with SURFACE_FRONTAL refused */
    const double (*points)[3];
    /* of any length, (0, 0, 0) where unknown; NULL: none.  They tell front from back, and a
     * mirror image */
    const double (*normals)[3];
    size_t n;
    /* of a depth image, whose points go row by row from the upper left, n = width height; else 0 */
    uint32_t width, height;
    /* millimetres for each unit of the points; 0: it is found, or with SURFACE_FRONTAL 1 */
    double unit_mm;
    uint32_t flags; /* SURFACE_FRONTAL | SURFACE_ENROLMENT | SURFACE_PINHOLE */
    /* of an image of which only some points are given: the place of each, ascending, and n is
     * their number; NULL: all are given */
    const uint32_t *place;
    const struct surface_stop *stop; /* NULL: the caller waits */
    /* [n], both or neither; NULL: not wanted.  They receive the points that the face was built
     * from, surface_found.kept of them, in the frontal view and mm, and the place of each among
     * those given, or in the image.  `kept` may be `points`, which is then overwritten, also on
     * failure, and costs no copy; likewise for the places */
    double (*kept)[3];
    uint32_t *kept_place;
};

/* What can be noted of a scan that a face was built from: bits 1 << surface_warning. */
enum surface_warning {
    SURFACE_SEVERAL,  /* more faces than one: the nearest was taken */
    SURFACE_MIRRORED, /* normals or the order of pixels are a mirror image's */
    SURFACE_BEHIND,   /* many points are outside the face; they were ignored */
    SURFACE_TURNED,   /* farther from the scanner's view than an enrolment may be */
    SURFACE_OCCLUDED, /* something covers a part of the face */
    SURFACE_THINNED,  /* more points than the measure needs */
    SURFACE_STEPPED,  /* step_mm above SURFACE_STEP_MM: its noise is that of the step */
    SURFACE_FOCAL,    /* focal_times beyond SURFACE_FOCAL_MOST or _LEAST */
    SURFACE_WARNINGS
};
/* "several_faces", "mirrored", ...; static; NULL for another value. */
SURFACE_API const char *surface_warning_name(enum surface_warning warning);

/* How good a surface is.  All 0: it was not rated, as that of a face that was decoded is not. */
struct surface_quality {
    double score;      /* 0..1, the least of its parts */
    double coverage;   /* share of the outline's area that was measured, 0..1 */
    double density_mm; /* typical distance between neighbours */
    /* white noise, estimated from the surface itself; of depths in steps half a step at least */
    double noise_mm;
};

/* What was found in a scan, also on failure as far as the search came; the rest is 0. */
struct surface_found {
    size_t points;      /* with finite coordinates */
    size_t points_used; /* of the face; 0 on failure */
    size_t kept;        /* of surface_cloud.kept; on failure they mean nothing */
    size_t bad;     /* the offending point's number for SURFACE_ENOTFINITE and _ERANGE */
    double unit_mm; /* the unit that was taken; 0: none */
    int unit_found; /* the caller did not give it */
    int cropped;    /* the face was taken out of the points; else it lies as given */
    uint32_t faces; /* in the cloud */
    uint32_t warnings; /* bits */
    double extent[3];  /* of the points, in their unit */
    /* from the points' unit and axes to the frontal view in mm, in which the face lies: a
     * similarity */
    double view[16];
    /* of the face against a scanner that looks along z: positive to the face's own left (the image's
     * right), upwards, and anticlockwise in the image.  Yaw and pitch do not depend on the roll, which is
     * near 90, -90 or 180 if the scanner was not upright.  NaN where they are unknown */
    double yaw_deg, pitch_deg, roll_deg;
    double occluded;  /* share of the face's area that something covers, 0..1 */
    double elsewhere; /* share of the points that are neither of the face nor cover it */
    /* The gate: what was measured, and what is wanted at least or at most. */
    double support, support_wanted; /* how much of what is seen a face explains */
    /* that it is a face (docs/model.md): likeness + 4 eyes + 5 support + 5 detail (at most 5) +
     * 2 seen + 2 forehead (0 at least: who wears a fringe lacks none) */
    double evidence, evidence_wanted;
    double seen, seen_wanted; /* share of a face that is there */
    /* what a face's shape leaves of the scan; INFINITY: a probe may have any */
    double residual_mm, residual_most;
    double head_size; /* 1: of adults */
    double likeness;  /* how little is left of the scan */
    double eyes;      /* how much like eyes the places of both are, -1..1 */
    double detail;    /* how much of a face's fine relief there is; 1: the mean face's */
    double forehead;  /* how much like a fitted face's it is, -1..1 */
    /* of the surface, also of one that is refused */
    struct surface_quality quality;
    /* distance between neighbouring depths at the face, along the sensor's axis; 0: the depths are
     * continuous, or the cloud is turned against the sensor's axes */
    double step_mm;
    /* with SURFACE_PINHOLE, of a face that looks at the camera: the focal length over the one that was
     * used, by which the face has usual proportions; its deviation over people is 0.04.  0: unknown */
    double focal_times;
    /* with SURFACE_EUNITS: about how many millimetres a unit would have for the points to be a face,
     * which they are in none of the usual units.  0: unknown */
    double fits_mm;
};

/* Build a face from a scan.
 * out    *out NULL: a new face, to be released with surface_face_free(); else a former one,
 *        which is replaced, in its memory.  On failure *out is NULL, and a former one released
 * found  may be NULL
 * Returns SURFACE_OK or any other status but SURFACE_ECORRUPT and SURFACE_EVERSION.
 * Cost  O(n log n): for 3,000 frontal points about 2 ms and 80 bytes a point; for 20,000
 * points of a head about 10 ms. */
SURFACE_API enum surface_status surface_build(struct surface_work *work,
                                              const struct surface_cloud *cloud,
                                              struct surface_face **out,
                                              struct surface_found *found);
SURFACE_API void surface_face_free(struct surface_face *face); /* NULL is allowed */

#define SURFACE_FRAMES_MAX 20

/* What became of a frame. */
struct surface_frame {
    /* SURFACE_OK: it is part of the fused face.  SURFACE_EPEOPLE: it shows another person than
     * the base.  SURFACE_EAPART: it cannot be laid on the base, or has too little in common with
     * it to tell whether it shows the same person.  Else why no face was built of it, as
     * surface_build() returns it */
    enum surface_status status;
    double score; /* against the base (surface_comparison); 0 of the base itself */
    double
        gap_mm; /* median distance from the base, once laid on it; INFINITY: it could not be */
    struct surface_found found;
};

/* Build one face from the frames of one capture session: those of one person, who hardly moves.
 * The face of the best frame, the base, is kept, but for its heights: each becomes a robust mean of
 * what all frames measured there.  So the noise falls with the square root of their number; with
 * one frame the face is that of surface_build().  The frames need not be aligned.
 * n      1..SURFACE_FRAMES_MAX
 * cloud  [n], with the same flags and the same stop.  The face is
 *        searched for in the first frame in which one is found, and then looked for near that
 *        place.  With SURFACE_ENROLMENT each must show exactly one face, not mirrored, from the
 *        front; the strict gate judges the fused face.  kept receives the points of each frame's face,
 *        and of the base's the fused ones
 * frame  [n]: the report on each
 * base   the number of the base, on success and with SURFACE_EPEOPLE
 * out    as in surface_build()
 * found  the base's report, with what the gate measured of the fused face; may be NULL
 * Returns SURFACE_OK; SURFACE_EPEOPLE, with the frame that is not of the person most are of; if no
 * frame has a face the first one's status; or the status of the fused face.
 * Cost  of five frames of 3,000 points 4.5 times that of one. */
SURFACE_API enum surface_status surface_fuse(struct surface_work *work, uint32_t n,
                                             const struct surface_cloud *cloud,
                                             struct surface_frame *frame, uint32_t *base,
                                             struct surface_face **out,
                                             struct surface_found *found);

/* Build a face from a scan as for an enrolment and, where that is refused, as for a
 * verification, with one search.  SURFACE_ENROLMENT has no meaning.
 * refused, why  the enrolment's status, and what was found then
 * found         the report on the face or the last refusal
 * Returns as surface_build() does for the verification. */
SURFACE_API enum surface_status
surface_check(struct surface_work *work, const struct surface_cloud *cloud,
              struct surface_face **out, enum surface_status *refused,
              struct surface_found *why, struct surface_found *found);

/* Build *face, of another engine, anew from the points that it keeps, in its memory; they do not
 * change by a bit.  On failure it is released, and *face NULL.  Returns as surface_build(). */
SURFACE_API enum surface_status surface_rebuild(struct surface_work *work,
                                                struct surface_face **face);

/* Defects of a scan that can still be used: bits 1 << surface_reason. */
enum surface_reason {
    SURFACE_SPARSE,     /* density_mm above SURFACE_SPARSE_MM */
    SURFACE_NOISY,      /* noise_mm above SURFACE_NOISY_MM */
    SURFACE_INCOMPLETE, /* too little of the outline's area was measured */
    SURFACE_OBLIQUE, /* by more than SURFACE_YAW_DEG, or SURFACE_TILT_DEG of pitch or roll */
    SURFACE_REASONS
};
/* "sparse", "noisy", "incomplete", "turned"; static; NULL for another value. */
SURFACE_API const char *surface_reason_name(enum surface_reason reason);
/* The defects, as bits.  face: NULL where it is not known; SURFACE_OBLIQUE is then not among
 * them. */
SURFACE_API uint32_t surface_quality_reasons(const struct surface_quality *q,
                                             const struct surface_face *face);

SURFACE_API struct surface_quality surface_face_quality(const struct surface_face *face);
/* Give a decoded face the quality that was stored beside its bytes. */
SURFACE_API void surface_face_rate(struct surface_face *face,
                                   const struct surface_quality *q);

/* Copy the points that the face keeps, in the frontal view, or the corners of its triangles,
 * anticlockwise, as numbers of points.  Both return their number; out may be NULL. */
SURFACE_API uint32_t surface_face_points(const struct surface_face *face,
                                         double (*out)[3]);
SURFACE_API uint32_t surface_face_triangles(const struct surface_face *face,
                                            uint32_t (*out)[3]);
/* The same of the triangles that do not only bridge missing points. */
SURFACE_API uint32_t surface_face_measured(const struct surface_face *face,
                                           uint32_t (*out)[3]);

/* From the face's frontal view to its canonical frame, nose tip at the origin: a rigid transform. */
SURFACE_API void surface_face_frame(const struct surface_face *face,
                                    double transform[16]);

/* The memory that the face takes, about, in bytes. */
SURFACE_API size_t surface_face_memory(const struct surface_face *face);

/* Are triangles and tree what the points give?  For faces from bytes, beyond what
 * surface_decode() checks.  SURFACE_OK, SURFACE_ECORRUPT. */
SURFACE_API enum surface_status surface_face_check(const struct surface_face *face);

/* ---- a face as bytes */

/* The bytes depend on no machine; layout: db/FORMAT.md.  They are biometric data and have no
 * checksum: who stores them encrypts and authenticates them. */
SURFACE_API size_t surface_encoded_size(const struct surface_face *face);
SURFACE_API void surface_encode(const struct surface_face *face, void *bytes);

/* Decode a face; bytes need not be aligned, and may be hostile.  Where the face was built by
 * another model, what depends on the model is computed from its points again.
 * out  as in surface_build()
 * Returns SURFACE_OK, SURFACE_ECORRUPT, SURFACE_EVERSION, SURFACE_ENOMEM.  About 0.3 ms. */
SURFACE_API enum surface_status surface_decode(struct surface_work *work,
                                               const void *bytes, size_t length,
                                               struct surface_face **out);

/* ---- comparisons */

enum surface_decision { SURFACE_MATCH, SURFACE_NO_MATCH, SURFACE_INCONCLUSIVE };

struct surface_comparison {
    enum surface_decision
        decision; /* SURFACE_INCONCLUSIVE: too little in common to say */
    double
        score; /* the log-likelihood ratio, about -100 to 60: a match at or above ... */
    double threshold;        /* ... this, where there is enough in common */
    double expected;         /* the mean score of two such scans of one person */
    double false_match_rate; /* at a threshold of the score, 0..1 */
    double overlap;          /* share of the template's cells that the probe has, 0..1 */
};

/* Decide whether both faces are of one person.  The template is the face that was enrolled.
 * Returns SURFACE_OK (an inconclusive comparison included) or SURFACE_ENOMEM.
 * Cost  0.3 ms, 0.1 ms for each further template with the same probe. */
SURFACE_API enum surface_status surface_compare(struct surface_work *work,
                                                const struct surface_face *tmpl,
                                                const struct surface_face *probe,
                                                struct surface_comparison *out);

/* A second look at a result of surface_compare() that the surfaces contradict: where *io is a no_match
 * with a score below SURFACE_DOUBT though the minimal disparity is SURFACE_DOUBT_MM at most, one of the
 * two was laid on the mean face in a wrong place.  The probe is laid there anew, from where the
 * template lies, and *io becomes what that gives if its score is higher.
 * Next to nothing for other results, else about the cost of surface_disparity(). */
#define SURFACE_DOUBT    (-20.0)
#define SURFACE_DOUBT_MM 0.2
SURFACE_API enum surface_status surface_compare_again(struct surface_work *work,
                                                      const struct surface_face *tmpl,
                                                      const struct surface_face *probe,
                                                      struct surface_comparison *io);

/* With the mirror image of the probe, to tell whether a scanner swaps left and right. */
SURFACE_API enum surface_status surface_compare_mirrored(struct surface_work *work,
                                                         const struct surface_face *tmpl,
                                                         const struct surface_face *probe,
                                                         struct surface_comparison *out);

/* c is one of n > 0 comparisons of a probe with the templates of one person, of which the best
 * decides: n chances for a false match.  Lowers score and expected by ln n; decision and rate
 * follow, by c->threshold, which the caller may have changed. */
SURFACE_API void surface_best_of(const struct surface_work *work, uint32_t n,
                                 struct surface_comparison *c);

/* Score and threshold in so many steps a unit, the threshold rounded up, the score so that it agrees with
 * the decision: below the threshold stays below. */
SURFACE_API void surface_shown(const struct surface_comparison *c, double steps,
                               double *score, double *threshold);

/* The minimal disparity of the papers, which does not decide. */
struct surface_disparity {
    double disparity_mm;  /* volume over area; 0 when there is none */
    double volume_mm3;    /* between both surfaces, over what both cover */
    double area_mm2;      /* of what both cover, as the template's scanner sees it */
    double transform[16]; /* probe -> template, where the disparity is least */
    /* by the weight of each place in telling people apart: of surface_weigh(), else as above */
    double weighted_mm;
    /* The alignment: where the probe is best explained as the same person. */
    double align_transform[16];
    double turn_deg, shift_mm; /* standard deviations of that pose; INFINITY: unknown */
    double cost_mm;            /* mean gap at the coarse pose that was refined */
    double rival_mm; /* the same of the best coarse pose elsewhere; INFINITY: none */
    uint32_t starts, evaluations; /* poses that were tried first, and in all */
    /* why the search ended: "converged", "steps" (too many), "apart" (too little in common) */
    const char *stop;
    double align_ms, minimal_ms; /* by surface_work_clock(), else 0 */
};

/* Align the probe to the template, and find the least disparity near that pose.
 * Returns SURFACE_OK, SURFACE_ENOMEM.  About 3 ms for two faces of 3,000 points. */
SURFACE_API enum surface_status surface_disparity(struct surface_work *work,
                                                  const struct surface_face *tmpl,
                                                  const struct surface_face *probe,
                                                  struct surface_disparity *out);

/* Set weighted_mm of what surface_disparity() found.  Returns SURFACE_OK, SURFACE_ENOMEM.  About
 * 1 ms. */
SURFACE_API enum surface_status surface_weigh(struct surface_work *work,
                                              const struct surface_face *tmpl,
                                              const struct surface_face *probe,
                                              struct surface_disparity *least);

/* How far each point, moved by transform, lies above the template along its scanner's z, in
 * mm; NaN where the template does not cover it.  For points given to surface_build() the
 * transform is that of surface_disparity() times surface_found.view.
 * Returns SURFACE_OK; SURFACE_ENOMEM: each gap is NaN.  O((m + n) log^2 m), m points of the
 * template. */
SURFACE_API enum surface_status surface_gaps(const struct surface_face *tmpl,
                                             const double (*points)[3], size_t n,
                                             const double transform[16], double *gap_mm);

enum surface_region {
    SURFACE_NOSE,
    SURFACE_EYES,
    SURFACE_FOREHEAD,
    SURFACE_CHEEKS,
    SURFACE_MOUTH,
    SURFACE_CHIN,
    SURFACE_REGIONS
};
SURFACE_API const char *surface_region_name(enum surface_region region); /* "nose", ... */

/* Cells of a frame with the nose tip near its origin: rows from the lower left. */
#define SURFACE_CELLS_X      32
#define SURFACE_CELLS_Y      41
#define SURFACE_CELLS        (SURFACE_CELLS_X * SURFACE_CELLS_Y)
#define SURFACE_CELL_MM      4.0
#define SURFACE_CELLS_LEFT   (-64.0)
#define SURFACE_CELLS_BOTTOM (-94.0)

/* What a comparison was decided on, for each cell. */
struct surface_parts {
    /* from the template's frontal view to the frame that has the cells: a rigid transform, whose
     * millimetres are to be multiplied by scale: 1 for adults */
    double frame[16];
    double scale;
    double region[SURFACE_REGIONS]; /* of the score */
    /* probe minus template, each at its own frame, at right angles to the mean face; NaN where
     * either has none */
    float gap_mm[SURFACE_CELLS];
    float part[SURFACE_CELLS]; /* of the score, whose sum is the score; NaN: none */
    float rest_mm
        [SURFACE_CELLS]; /* the gap less the motion and the change that explain most of it */
};
/* Returns SURFACE_OK, SURFACE_ENOMEM.  About 2 ms. */
SURFACE_API enum surface_status surface_parts(struct surface_work *work,
                                              const struct surface_face *tmpl,
                                              const struct surface_face *probe,
                                              struct surface_parts *out);

struct surface_asymmetry {
    int conclusive; /* enough of the face lies over its mirror image */
    /* between the face and its mirror image, at the plane where it is least */
    double disparity_mm;
    double first_mm;    /* at the starting plane */
    double normal[3];   /* of the plane, a unit vector towards the image's right; */
    double offset_mm;   /* normal . p for its points p, in the frontal view */
    double weighted_mm; /* as disparity_mm, by the weight of each place */
    double volume_mm3, area_mm2, overlap;
    double moved_deg, moved_mm; /* from the starting plane to the final one */
    double turn_deg, shift_mm;  /* standard deviations of both, by a jackknife */
    uint32_t evaluations;       /* planes that were tried */
    const char *stop;           /* as in struct surface_disparity */
};
/* Returns SURFACE_OK, SURFACE_ENOMEM.  About 20 ms. */
SURFACE_API enum surface_status surface_asymmetry(struct surface_work *work,
                                                  const struct surface_face *face,
                                                  struct surface_asymmetry *out);

#ifdef __cplusplus
}
#endif
#endif
