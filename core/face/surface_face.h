/* ---- surface_face.h: models, faces, comparisons */
#ifndef CORE_SURFACE_FACE_H
#define CORE_SURFACE_FACE_H
#include "../basic/surface_basic.h"

/* Knowledge of faces in general.  Immutable, for any number of threads. */
struct surface_model;

/* Parses a model from its text form (docs/model.md), borrowed for the call.
 *   out   a new model, to be released with surface_model_free(); NULL on failure
 *   line  the number of the line that failed, from 1; may be NULL
 * Returns SURFACE_OK, SURFACE_ECORRUPT, SURFACE_EVERSION, SURFACE_ENOMEM. */
SURFACE_API enum surface_status surface_model_parse(const char *text, size_t length,
                                                    struct surface_model **out,
                                                    uint32_t *line);
SURFACE_API void surface_model_free(struct surface_model *model); /* NULL is allowed */

/* Writes a model as text, NUL-terminated, to the size bytes at text, and returns the text's
 * length; if that is >= size it did not fit.  Rounds numbers to the text's units, so
 * that surface_model_parse() of the text gives the same model. */
SURFACE_API size_t surface_model_write(const struct surface_model *model, char *text,
                                       size_t size);

/* Returns the calibration of the model, or of the shipped model if model is NULL. */
SURFACE_API const struct surface_calibration *
surface_model_calibration(const struct surface_model *model);

#define SURFACE_ENGINE      "surfaced/" SURFACE_VERSION " measure/7" /* and a model */
#define SURFACE_ENGINE_SIZE 64

/* Writes the name of the engine that makes scores: "surfaced/VERSION measure/N model/HHHHHHHH",
 * NUL-terminated, with the first 8 hex digits of the model's digest.  N increases with
 * every change that gives two scans another score, or the same points another face.
 * Scores of another measure or another model are not comparable.
 *   model  NULL: the shipped model
 * Cost: about 1 ms. */
SURFACE_API void surface_engine(const struct surface_model *model,
                                char out[SURFACE_ENGINE_SIZE]);

/* Returns 1 if scores of the engines a and b are comparable: only the version differs. */
SURFACE_API int surface_same_engine(const char *a, const char *b);

/* Memory for building and comparing, reused from call to call: after the first few calls
 * only new faces are allocated.  One thread at a time; each thread has its own. */
struct surface_work;

/* Returns new memory for work by this model, or NULL if out of memory.
 *   model  borrowed until surface_work_free(); NULL: the shipped model
 * Cost: about 20 ms. */
SURFACE_API struct surface_work *surface_work_new(const struct surface_model *model);
SURFACE_API void surface_work_free(struct surface_work *work); /* NULL is allowed */

/* Sets the calibration of further decisions.
 *   by  copied; NULL: the model's own
 * Returns SURFACE_OK; SURFACE_EINVAL: surface_calibration_valid() is 0, and nothing changes. */
SURFACE_API enum surface_status
surface_work_calibrate(struct surface_work *work, const struct surface_calibration *by);

/* Returns the calibration that work decides by. */
SURFACE_API const struct surface_calibration *
surface_work_calibration(const struct surface_work *work);

/* Sets the clock, in ms, for the times that surface_disparity() reports; NULL: none. */
SURFACE_API void surface_work_clock(struct surface_work *work, double (*clock_ms)(void));

/* Overwrites the remains of faces in the memory of work, and frees the part that faces of
 * more than 10,000 points need.  Cost: O(bytes used since the last call). */
SURFACE_API void surface_work_wipe(struct surface_work *work);

/* ---- faces */

/* A scan, prepared for comparison.  Immutable: any number of threads may compare it at the
 * same time, and it outlives the memory that it was built with. */
struct surface_face;

SURFACE_API void surface_face_free(struct surface_face *face); /* NULL is allowed */

/* Rebuilds *face, of another engine, in its memory from the points that it keeps, which do not
 * change by a bit.  On failure *face is released and becomes NULL.  Returns as surface_build(). */
SURFACE_API enum surface_status surface_rebuild(struct surface_work *work,
                                                struct surface_face **face);

/* Limits of the defects of a scan that can still be used. */
#define SURFACE_EXTENT_MIN_MM 60 /* of a face's longest side */
#define SURFACE_EXTENT_MAX_MM 500
#define SURFACE_SPARSE_MM     3.0 /* between neighbouring points */
#define SURFACE_NOISY_MM      0.6
#define SURFACE_YAW_DEG       30
#define SURFACE_TILT_DEG      20 /* of pitch and roll */

/* Quality of a surface.  All 0: not rated, as a decoded face is not. */
struct surface_quality {
    double score;      /* 0..1, the least of its parts */
    double coverage;   /* share of the outline's area that was measured, 0..1 */
    double density_mm; /* typical distance between neighbours */
    double
        noise_mm; /* white noise, estimated from the surface; at least half of step_mm */
};

/* Defects of a scan that can still be used: bits 1 << surface_reason. */
enum surface_reason {
    SURFACE_SPARSE,     /* density_mm above SURFACE_SPARSE_MM */
    SURFACE_NOISY,      /* noise_mm above SURFACE_NOISY_MM */
    SURFACE_INCOMPLETE, /* too little of the outline's area was measured */
    SURFACE_OBLIQUE, /* turned by more than SURFACE_YAW_DEG, or SURFACE_TILT_DEG of pitch or roll */
    SURFACE_REASONS
};

/* Returns "sparse", "noisy", "incomplete" or "turned", static; NULL for another value. */
SURFACE_API const char *surface_reason_name(enum surface_reason reason);

/* Returns the defects as bits.
 *   face  NULL: unknown; the bit of SURFACE_OBLIQUE is then 0 */
SURFACE_API uint32_t surface_quality_reasons(const struct surface_quality *q,
                                             const struct surface_face *face);

SURFACE_API struct surface_quality surface_face_quality(const struct surface_face *face);

/* Sets the quality of a decoded face, as it was stored beside the bytes. */
SURFACE_API void surface_face_rate(struct surface_face *face,
                                   const struct surface_quality *q);

/* Copies the points that the face keeps, in the frontal view, and returns their number.
 *   out  may be NULL */
SURFACE_API uint32_t surface_face_points(const struct surface_face *face,
                                         double (*out)[3]);

/* Copies the corners of the triangles, anticlockwise, as numbers of points, and returns the
 * number of triangles.
 *   out  may be NULL */
SURFACE_API uint32_t surface_face_triangles(const struct surface_face *face,
                                            uint32_t (*out)[3]);

/* As surface_face_triangles(), without the triangles that span a hole. */
SURFACE_API uint32_t surface_face_measured(const struct surface_face *face,
                                           uint32_t (*out)[3]);

/* Writes the rigid transform from the face's frontal view to its canonical frame, which has the
 * nose tip at the origin. */
SURFACE_API void surface_face_frame(const struct surface_face *face,
                                    double transform[16]);

/* Checks that triangles and tree are those of the points: for decoded faces, beyond what
 * surface_decode() checks.  Returns SURFACE_OK, SURFACE_ECORRUPT. */
SURFACE_API enum surface_status surface_face_check(const struct surface_face *face);

/* ---- a face as bytes */

/* Writes a face as surface_encoded_size() bytes, which depend on no machine (db/FORMAT.md).
 * They are biometric data and have no checksum: encrypt and authenticate what you store. */
SURFACE_API void surface_encode(const struct surface_face *face, void *bytes);
SURFACE_API size_t surface_encoded_size(const struct surface_face *face);

/* Returns the size of the head, the first of these bytes (about 21 KB), which can be decoded alone; 0 if the
 * bytes are no encoded face. */
SURFACE_API size_t surface_encoded_head(const void *bytes, size_t length);

/* Decodes a face.  If it was built by another model, computes what depends on the model from the
 * face's points.
 *   bytes   need not be aligned, and may be hostile
 *   length  of the head alone: the face has no surface.  It has no points, and can only be compared with
 *           surface_compare()
 *   out     as in surface_build()
 * Cost: about 0.3 ms; of the head 0.02 ms.
 * Returns SURFACE_OK, SURFACE_ECORRUPT, SURFACE_ENOMEM, SURFACE_EVERSION (also for the head of a face of
 * another model). */
SURFACE_API enum surface_status surface_decode(struct surface_work *work,
                                               const void *bytes, size_t length,
                                               struct surface_face **out);

/* ---- comparisons */

enum surface_decision {
    SURFACE_MATCH,
    SURFACE_NO_MATCH,
    SURFACE_INCONCLUSIVE /* too little in common */
};

struct surface_comparison {
    enum surface_decision decision;
    double score;            /* the log-likelihood ratio, about -100 to 60 */
    double threshold;        /* the least score of a match */
    double expected;         /* the mean score of two such scans of one person */
    double false_match_rate; /* at a threshold of the score, 0..1 */
    double overlap;          /* share of the template's cells that the probe has, 0..1 */
};

/* Decides whether both faces are of one person.  The result depends only on the two faces, the
 * model and the calibration.
 *   tmpl  the enrolled face
 * Cost: 0.3 ms, 0.1 ms for each further template with the same probe.
 * Returns SURFACE_OK (an inconclusive comparison included); SURFACE_ENOMEM; SURFACE_EINVAL: the scans were
 * taken for heads of different sizes, and a face has no surface. */
SURFACE_API enum surface_status surface_compare(struct surface_work *work,
                                                const struct surface_face *tmpl,
                                                const struct surface_face *probe,
                                                struct surface_comparison *out);

/* Corrects a result of surface_compare() that the surfaces contradict: if *io is a no_match
 * with a score below SURFACE_DOUBT, and the minimal disparity is at most SURFACE_DOUBT_MM, one of
 * the two faces lies in a wrong place on the mean face.  Lays the probe there again, from the
 * place of the template.  Sets *io to the new result if its score is higher.
 * Cost: about that of surface_disparity(); next to nothing for other results. */
#define SURFACE_DOUBT    (-20.0)
#define SURFACE_DOUBT_MM 0.2
SURFACE_API enum surface_status surface_compare_again(struct surface_work *work,
                                                      const struct surface_face *tmpl,
                                                      const struct surface_face *probe,
                                                      struct surface_comparison *io);

/* Compares with the mirror image of the probe, to tell whether a scanner swaps left and right. */
SURFACE_API enum surface_status surface_compare_mirrored(struct surface_work *work,
                                                         const struct surface_face *tmpl,
                                                         const struct surface_face *probe,
                                                         struct surface_comparison *out);

/* Corrects *c, the best of n > 0 comparisons of a probe with the templates of one person, for the
 * n chances of a false match: lowers score and expected by ln n, and sets decision and rate by
 * them and by c->threshold, which the caller may have changed, for an identification to
 * surface_search_threshold(). */
SURFACE_API void surface_best_of(const struct surface_work *work, uint32_t n,
                                 struct surface_comparison *c);

/* Rounds threshold and score of *c for display: the threshold up, the score so that it agrees with the
 * decision: a score below the threshold stays below.
 *   steps  values per unit: 10 gives one decimal */
SURFACE_API void surface_shown(const struct surface_comparison *c, double steps,
                               double *score, double *threshold);

/* The minimal disparity of the papers, which does not decide, and the alignment before it: the
 * pose at which the probe is best explained as the same person. */
struct surface_disparity {
    double disparity_mm;  /* volume over area; 0 if there is none */
    double volume_mm3;    /* between both surfaces, over what both cover */
    double area_mm2;      /* of what both cover, as the template's scanner sees it */
    double transform[16]; /* probe -> template, of the least disparity */
    /* disparity by how well each cell distinguishes people, set by surface_weigh(); before that the
     * same as disparity_mm */
    double weighted_mm;
    double align_transform[16]; /* probe -> template, of the alignment */
    double turn_deg,
        shift_mm;    /* standard deviations of the alignment; INFINITY: unknown */
    double cost_mm;  /* mean gap at the coarse pose that was refined */
    double rival_mm; /* mean gap at the best coarse pose elsewhere; INFINITY: none */
    uint32_t starts, evaluations; /* number of starting poses; of all poses */
    const char *
        stop; /* end of the search: "converged", "steps" (too many), "apart" (too little in common) */
    double align_ms, minimal_ms; /* times by surface_work_clock(), else 0 */
};

/* Aligns the probe to the template, and finds the least disparity near that pose.
 * Cost: about 3 ms for two faces of 3,000 points.
 * Returns SURFACE_OK, SURFACE_ENOMEM. */
SURFACE_API enum surface_status surface_disparity(struct surface_work *work,
                                                  const struct surface_face *tmpl,
                                                  const struct surface_face *probe,
                                                  struct surface_disparity *out);

/* Sets weighted_mm of a result of surface_disparity().
 * Cost: about 1 ms.
 * Returns SURFACE_OK, SURFACE_ENOMEM. */
SURFACE_API enum surface_status surface_weigh(struct surface_work *work,
                                              const struct surface_face *tmpl,
                                              const struct surface_face *probe,
                                              struct surface_disparity *least);

/* Measures how far each point, moved by transform, lies above the template along its scanner's z,
 * in mm; NaN if the template does not cover it.  For points given to surface_build() the
 * transform is that of surface_disparity() times surface_found.view.
 * Cost: O((m + n) log^2 m), m points of the template.
 * Returns SURFACE_OK; SURFACE_ENOMEM: each gap is NaN. */
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

/* The contributions of regions and cells to a score. */
struct surface_parts {
    double frame
        [16]; /* rigid transform, template's frontal view -> the frame that has the cells */
    double scale;                   /* factor of the frame's millimetres; 1 for adults */
    double region[SURFACE_REGIONS]; /* contributions to the score */
    /* probe minus template, each at its own frame, at right angles to the mean face; NaN if
     * either has none */
    float gap_mm[SURFACE_CELLS];
    float part[SURFACE_CELLS]; /* contributions, their sum is the score; NaN: none */
    float rest_mm
        [SURFACE_CELLS]; /* gap_mm less the rigid motion residual and the expression */
};

/* Explains the result of surface_compare() and surface_compare_again().  The score is a quadratic
 * form of the heights of both scans and a constant.  The contribution of a cell is half of its height times
 * the derivative of the score by it, plus a share of the constant in proportion to how well the
 * cell distinguishes people.
 * Cost: about 2 ms.
 * Returns SURFACE_OK, SURFACE_ENOMEM. */
SURFACE_API enum surface_status surface_parts(struct surface_work *work,
                                              const struct surface_face *tmpl,
                                              const struct surface_face *probe,
                                              struct surface_parts *out);

struct surface_asymmetry {
    int conclusive; /* 1: enough of the face lies over its mirror image */
    /* between the face and its mirror image, at the plane of the least disparity */
    double disparity_mm;
    double first_mm;    /* disparity at the starting plane */
    double normal[3];   /* unit vector of the plane, towards the image's right */
    double offset_mm;   /* normal . p for the plane's points p, in the frontal view */
    double weighted_mm; /* disparity by how well each cell distinguishes people */
    double volume_mm3, area_mm2, overlap;
    double moved_deg, moved_mm; /* from the starting plane to the final one */
    double turn_deg, shift_mm;  /* standard deviations of both, by a jackknife */
    uint32_t evaluations;       /* number of planes that were tried */
    const char *stop;           /* as in struct surface_disparity */
};

/* Measures the disparity between a face and its mirror image.  Deterministic.
 * Cost: about 20 ms.
 * Returns SURFACE_OK, SURFACE_ENOMEM. */
SURFACE_API enum surface_status surface_asymmetry(struct surface_work *work,
                                                  const struct surface_face *face,
                                                  struct surface_asymmetry *out);

#endif /* CORE_SURFACE_FACE_H */
