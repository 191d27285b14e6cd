/* surface.h -- libsurface: faces built from point clouds, and compared.
 *
 *     struct surface_work *work = surface_work_new();
 *     struct surface_face *a, *b;
 *     struct surface_comparison c;
 *
 *     if (work != NULL && surface_face_new(work, p, np, &a, NULL) == SURFACE_OK &&
 *         surface_face_new(work, q, nq, &b, NULL) == SURFACE_OK &&
 *         surface_compare(work, a, b, &c) == SURFACE_OK)
 *         printf("%d: score %.1f\n", c.decision == SURFACE_MATCH, c.score);
 *
 * Points are in millimetres: x to the image's right, y up, z towards the scanner; the face
 * roughly frontal (yaw within 30 degrees, pitch and roll within 20), anywhere in space.
 * The library prints nothing, reads no file and never exits.  The same points give the same
 * digits on every machine with IEEE 754 numbers, on any number of threads.
 * Link with -lsurface -lm (pkg-config: surface).
 *
 * (In the source tree this is core/libsurface.h; make install calls it surface.h.) */
#ifndef SURFACE_H
#define SURFACE_H
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SURFACE_MIN_POINTS  100
#define SURFACE_MAX_POINTS  2097152
#define SURFACE_ENGINE_SIZE 64

enum surface_status {
    SURFACE_OK,
    SURFACE_ENOMEM,      /* out of memory */
    SURFACE_ELIMIT,      /* more than SURFACE_MAX_POINTS */
    SURFACE_ETOOFEW,     /* fewer than SURFACE_MIN_POINTS at places of their own */
    SURFACE_ENOTFINITE,  /* a coordinate is NaN or infinite */
    SURFACE_ERANGE,      /* a coordinate is beyond 16.7 m */
    SURFACE_EDEGENERATE, /* all points lie on one line as the scanner sees them */
    SURFACE_EUNITS,      /* the extent is not 60 to 500 mm: other units? */
    SURFACE_ENOTFACE,    /* the surface is not a face */
    SURFACE_EQUALITY,    /* a face, but too poor a scan: noise, spikes, holes */
    SURFACE_STATUSES     /* how many; not a status */
};

/* A phrase for a status, static, never NULL. */
const char *surface_message(enum surface_status st);

/* What compares: "surfaced/VERSION measure/N model/HHHHHHHH", NUL-terminated.  Scores of
 * another measure or model are not comparable.  About 1 ms the first time. */
void surface_engine(char out[SURFACE_ENGINE_SIZE]);

/* Memory for building and comparing, reused from call to call: after the first few calls
 * only new faces are allocated.  One thread at a time; each thread has its own. */
struct surface_work;
struct surface_work *surface_work_new(void);       /* NULL: out of memory */
void surface_work_free(struct surface_work *work); /* NULL is allowed */

/* A scan, prepared for comparison.  Immutable: any number of threads may compare it at the
 * same time, and it outlives the memory that it was built with. */
struct surface_face;

/* Build a face from n points in any order.
 * points  borrowed for the call
 * out     a new face, to be released with surface_face_free(); NULL on failure
 * bad     the index of the offending point for SURFACE_ENOTFINITE and SURFACE_ERANGE; may be
 *         NULL
 * Returns SURFACE_OK, or any other status.  SURFACE_ENOTFACE is a coarse gate: a narrow part of a
 * face, or something with a face's relief, passes.
 * Cost  O(n log n): about 2 ms for 3,000 points, and 80 bytes a point. */
enum surface_status surface_face_new(struct surface_work *work, const double (*points)[3],
                                     size_t n, struct surface_face **out, size_t *bad);
void surface_face_free(struct surface_face *face); /* NULL is allowed */

/* What a scan is worth. */
struct surface_quality {
    size_t points;     /* kept: points with the same x and y become one */
    double score;      /* 0..1, the least of its parts */
    double coverage;   /* share of the outline's area that was measured, 0..1 */
    double density_mm; /* typical distance between neighbours */
    double noise_mm;   /* white noise, estimated from the surface itself */
};
void surface_face_quality(const struct surface_face *face, struct surface_quality *out);

enum surface_decision { SURFACE_MATCH, SURFACE_NO_MATCH, SURFACE_INCONCLUSIVE };

struct surface_comparison {
    enum surface_decision
        decision;            /* SURFACE_INCONCLUSIVE: too little in common to say */
    double score;            /* higher is more alike: SURFACE_MATCH at or above ... */
    double threshold;        /* ... this, where there is enough in common */
    double false_match_rate; /* share of pairs of different people who score as high or
                                       higher, 0..1: by the shipped model's table */
    double overlap;          /* share of the template's measured area covered, 0..1 */
    double transform[16];    /* probe (mm) -> template (mm), row-major 4 x 4, rigid */
    /* The minimal disparity of the papers, at its own pose near that one.  It does not
     * decide. */
    double disparity_mm; /* volume over area; 0 when there is none */
    double volume_mm3;   /* between both surfaces, over what both cover */
    double area_mm2;     /* of what both cover, as the template's scanner sees it */
    double minimal_transform[16]; /* as transform */
};

/* Align the probe to the template, measure, decide.  Not symmetric: the template is the face
 * that was enrolled.
 * Returns SURFACE_OK (an inconclusive comparison included) or SURFACE_ENOMEM.
 * Cost  about 5 ms for two faces of 3,000 points. */
enum surface_status surface_compare(struct surface_work *work,
                                    const struct surface_face *tmpl,
                                    const struct surface_face *probe,
                                    struct surface_comparison *out);

#ifdef __cplusplus
}
#endif
#endif
