/* surface.h -- libsurface: faces found in scans, stored as bytes, and compared.
 *
 *     struct surface_work *work = surface_work_new(NULL);
 *     struct surface_cloud a = {.size = sizeof a, .points = p, .n = np};
 *     struct surface_cloud b = {.size = sizeof b, .points = q, .n = nq};
 *     struct surface_comparison c = {.size = sizeof c};
 *     struct surface_face *tmpl = NULL, *probe = NULL;
 *
 *     a.flags = SURFACE_ENROLMENT;
 *     if (work != NULL && surface_build(work, &a, &tmpl, NULL) == SURFACE_OK &&
 *         surface_build(work, &b, &probe, NULL) == SURFACE_OK &&
 *         surface_compare(work, tmpl, probe, &c) == SURFACE_OK)
 *         printf("%d: score %.1f\n", c.decision == SURFACE_MATCH, c.score);
 *
 * The library prints nothing, reads no file and never exits.  The same points give the same
 * digits on every machine with IEEE 754 numbers, on any number of threads.  Lengths are
 * millimetres, transforms rigid and row-major 4 x 4, unless something else is said.
 * Link with -lsurface -lm (pkg-config: surface).  docs/library.md has whole programs.
 *
 * Structs that may grow begin with their size, which the caller sets: a program built with an
 * older header gets what it knows.  Out parameters of such structs may be NULL where that is
 * said.
 *
 * (In the source tree this is core/libsurface.h; make install calls it surface.h.) */
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
#define SURFACE_ENGINE_SIZE 64
#define SURFACE_KNOTS       32
#define SURFACE_CELLS_X     32
#define SURFACE_CELLS_Y     41
#define SURFACE_CELLS       (SURFACE_CELLS_X * SURFACE_CELLS_Y)

/* The values stay: new ones get numbers of their own. */
enum surface_status {
    SURFACE_OK = 0,
    SURFACE_EINVAL = 1,      /* an argument is malformed */
    SURFACE_ENOMEM = 2,      /* out of memory */
    SURFACE_ELIMIT = 4,      /* more than SURFACE_MAX_POINTS */
    SURFACE_ETOOFEW = 5,     /* fewer than SURFACE_MIN_POINTS at places of their own */
    SURFACE_ENOTFINITE = 6,  /* with SURFACE_FRONTAL: a coordinate is NaN or infinite */
    SURFACE_ERANGE = 7,      /* a coordinate is beyond 16.7 m */
    SURFACE_EDEGENERATE = 8, /* all points lie on one line */
    SURFACE_EUNITS = 9,      /* the extent is not that of a face: 60 to 500 mm */
    SURFACE_ENOFACE = 10,    /* no face was found */
    SURFACE_ESEVERAL = 11,   /* enrolment: more than one face */
    SURFACE_EMIRRORED = 12,  /* enrolment: a mirror image */
    SURFACE_ENOTFACE = 13,   /* the surface does not have the shape of a face */
    SURFACE_EQUALITY = 14, /* a face, but too poor a scan: noise, spikes, holes, covers */
    SURFACE_ECORRUPT = 15, /* bytes that are no face, or a text that is no model */
    SURFACE_EVERSION = 16, /* bytes or a text of another version */
    SURFACE_EINTERNAL = 28 /* a defect of the library */
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

/* What makes scores: "surfaced/VERSION measure/N model/HHHHHHHH", NUL-terminated.  Scores of
 * another measure or another model are not comparable.  NULL: the shipped model.  About 1 ms. */
SURFACE_API void surface_engine(const struct surface_model *model,
                                char out[SURFACE_ENGINE_SIZE]);

/* From a score to a decision.  A model has its own; this is what is learned from the
 * comparisons of other people than the model's. */
struct surface_knot {
    double score; /* strictly rising, -1e4 to 1e4 */
    double
        rate; /* share of the scores of different people at or above it: the first is 1,
                     strictly falling, above 0 */
};
struct surface_calibration {
    size_t size;
    double threshold; /* a score at or above it is a match */
    uint32_t knots;   /* 2..SURFACE_KNOTS */
    struct surface_knot knot[SURFACE_KNOTS];
};

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

/* The false match rate at a threshold of this score, 0..1, by the calibration in force. */
SURFACE_API double surface_false_match_rate(const struct surface_work *work,
                                            double score);

/* Overwrite what is left in the memory of the faces that were worked on. */
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
    SURFACE_ENROLMENT =
        2 /* with the stricter gate for faces that others are compared with */
};

/* The points of a scan, in any order; all borrowed for the call. */
struct surface_cloud {
    size_t size;
    const double (*points)[3]; /* (x, y, z); those with a NaN or an infinity are left out,
                                  but with SURFACE_FRONTAL refused */
    const double (
        *normals)[3]; /* of any length, (0, 0, 0) where unknown; NULL: none.  They
                                   tell front from back, and a mirror image */
    size_t n;
    uint32_t width, height; /* of a depth image, whose points go row by row from the upper
                               left, n = width height; else 0 */
    double unit_mm;         /* millimetres for each unit of the points; 0: it is found, or
                               with SURFACE_FRONTAL 1 */
    uint32_t flags;         /* SURFACE_FRONTAL | SURFACE_ENROLMENT */
};

/* What can be noted of a scan that a face was built from: bits 1 << surface_warning. */
enum surface_warning {
    SURFACE_SEVERAL,  /* more faces than one: the nearest was taken */
    SURFACE_MIRRORED, /* normals or the order of pixels are a mirror image's */
    SURFACE_BEHIND,   /* many points are outside the face; they were ignored */
    SURFACE_TURNED,   /* farther from the scanner's view than an enrolment may be */
    SURFACE_OCCLUDED, /* something covers a part of the face */
    SURFACE_THINNED   /* more points than the measure needs */
};
/* "several_faces", "mirrored", ...; static; NULL for another value. */
SURFACE_API const char *surface_warning_name(enum surface_warning warning);

/* What was found in a scan, also on failure as far as the search came; the rest is 0. */
struct surface_found {
    size_t size;
    size_t points;      /* with finite coordinates */
    size_t points_used; /* of the face */
    size_t bad;     /* index of the offending point for SURFACE_ENOTFINITE and _ERANGE */
    double unit_mm; /* the unit that was taken; 0: none */
    int unit_found; /* the caller did not give it */
    uint32_t faces; /* in the cloud */
    uint32_t warnings; /* bits */
    double extent[3];  /* of the points, in their unit */
    double view[16]; /* from the points' unit and axes to the frontal view in mm, in which
                           the face lies: a similarity */
    double yaw_deg, pitch_deg, roll_deg; /* of the face's front, seen from the scanner:
        positive to the image's right, upwards, anticlockwise; NaN where that is unknown */
    double occluded;  /* share of the face's area that something covers, 0..1 */
    double elsewhere; /* share of the points that are neither of the face nor cover it */
    /* The gate: what was measured, and what is wanted at least or at most. */
    double support, support_wanted;   /* how much of what is seen a face explains */
    double evidence, evidence_wanted; /* that it is a face; docs/decision.md */
    double seen, seen_wanted;         /* share of a face that is there */
    double residual_mm, residual_most;
    double head_size; /* 1: of adults */
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

/* Defects of a scan that can still be used: bits 1 << surface_reason. */
enum surface_reason {
    SURFACE_SPARSE, /* too far between neighbouring points */
    SURFACE_NOISY,
    SURFACE_INCOMPLETE, /* too little of the outline's area was measured */
    SURFACE_OBLIQUE     /* by more than 30 degrees of yaw, or 20 of pitch or roll */
};
/* "sparse", "noisy", "incomplete", "turned"; static; NULL for another value. */
SURFACE_API const char *surface_reason_name(enum surface_reason reason);

struct surface_quality {
    size_t size;
    size_t points;     /* kept: points with the same x and y become one */
    double score;      /* 0..1, the least of its parts */
    double coverage;   /* share of the outline's area that was measured, 0..1 */
    double density_mm; /* typical distance between neighbours */
    double noise_mm;   /* white noise, estimated from the surface itself */
    uint32_t reasons;  /* bits */
};
/* All but points is 0 of a face that was decoded: bytes do not have it. */
SURFACE_API void surface_face_quality(const struct surface_face *face,
                                      struct surface_quality *out);

/* Copy the points that the face keeps, in the frontal view, to out[surface_quality.points]. */
SURFACE_API void surface_face_points(const struct surface_face *face, double (*out)[3]);

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
    size_t size;
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

/* c is one of n > 0 comparisons of a probe with the templates of one person, of which the best
 * decides: n chances for a false match.  Lowers score and expected by ln n; decision and rate
 * follow. */
SURFACE_API void surface_best_of(const struct surface_work *work, uint32_t n,
                                 struct surface_comparison *c);

/* The minimal disparity of the papers, which does not decide. */
struct surface_disparity {
    size_t size;
    double disparity_mm;  /* volume over area; 0 when there is none */
    double volume_mm3;    /* between both surfaces, over what both cover */
    double area_mm2;      /* of what both cover, as the template's scanner sees it */
    double transform[16]; /* probe -> template, where the disparity is least */
    double align_transform[16]; /* where the probe is best explained as the same person */
    double turn_deg, shift_mm;  /* standard deviations of that pose */
};

/* Align the probe to the template, and find the least disparity near that pose.
 * Returns SURFACE_OK, SURFACE_ENOMEM.  About 3 ms for two faces of 3,000 points. */
SURFACE_API enum surface_status surface_disparity(struct surface_work *work,
                                                  const struct surface_face *tmpl,
                                                  const struct surface_face *probe,
                                                  struct surface_disparity *out);

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

/* What a comparison was decided on, for each cell of 4 mm of a frame with the nose tip near its
 * origin: rows from the lower left, x from -64 mm, y from -94 mm. */
struct surface_parts {
    size_t size;
    double region[SURFACE_REGIONS]; /* of the score */
    float gap_mm[SURFACE_CELLS];    /* probe minus template; NaN where either has none */
    float part[SURFACE_CELLS];      /* of the score, whose sum is the score; NaN: none */
};
/* Returns SURFACE_OK, SURFACE_ENOMEM.  About 2 ms. */
SURFACE_API enum surface_status surface_parts(struct surface_work *work,
                                              const struct surface_face *tmpl,
                                              const struct surface_face *probe,
                                              struct surface_parts *out);

struct surface_asymmetry {
    size_t size;
    int conclusive; /* enough of the face lies over its mirror image */
    double
        disparity_mm; /* between the face and its mirror image, at the plane where it is
                               least */
    double first_mm;  /* at the starting plane */
    double normal[3]; /* of the plane, a unit vector towards the image's right; */
    double offset_mm; /* normal . p for its points p, in the frontal view */
};
/* Returns SURFACE_OK, SURFACE_ENOMEM.  About 20 ms. */
SURFACE_API enum surface_status surface_asymmetry(struct surface_work *work,
                                                  const struct surface_face *face,
                                                  struct surface_asymmetry *out);

#ifdef __cplusplus
}
#endif
#endif
