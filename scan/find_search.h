/* find_search.h -- the search of a grid for poses of the mean face: every roll at each of its
 * noses, the best of them refined.  Internal to find.h. */
#ifndef SCAN_FIND_SEARCH_H
#define SCAN_FIND_SEARCH_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include "align_pose.h"
#include "find_near.h"
#include "find_place.h"
#include "find_refine.h"
#include "tuning.h"
#include "vec.h"

struct find_grid;  /* find_grid.h */
struct find_nose;  /* find_nose.h */
struct frame_mean; /* frame.h */

struct find_found {
    double unit_mm, key, likeness, covered; /* as in find.h */
    struct align_pose pose;
    struct dvec3 nose; /* the tip, mm, in the points' axes */
    uint64_t points;   /* on the face */
};

#define FIND_FOUND 16

/* By falling key, no two the same. */
struct find_list {
    struct find_found found[FIND_FOUND];
    uint32_t n;
};

struct find_start {
    uint32_t nose;
    struct find_place place;
};

struct find_search {
    const struct frame_mean *mean;
    struct find_face_samples samples;
    struct find_near near;
    struct find_front front;
    struct find_start start[FIND_STARTS]; /* by rising cost */
    uint32_t starts;
    struct find_list best;   /* in all grids so far */
    int64_t left;            /* points and voxels that may still be looked at */
    const atomic_bool *stop; /* find.h */
};

struct find_effort {
    uint32_t noses, places; /* at most so many noses, and poses refined */
    bool tilted;            /* other axes than that in which a nose sticks out, too */
};

/* find_search_begin(mean, stop, s): nothing is found yet.
 * find_search_spend(s, work): so many points and voxels are looked at.  False: no more may be.
 * find_search_stopped(s): is *stop set?
 * find_search_grid(s, g, nose, n, e): search g, whose noses were found by find_nose_all().  Returns
 * the best key in it. */
void find_search_begin(const struct frame_mean *mean, const atomic_bool *stop,
                       struct find_search *s);
bool find_search_spend(struct find_search *s, int64_t work);
bool find_search_stopped(const struct find_search *s);
double find_search_grid(struct find_search *s, const struct find_grid *g,
                        const struct find_nose *nose, uint32_t n,
                        const struct find_effort *e);

/* Is the best key found that of a face: without doubt, or likely? */
bool find_search_plain(const struct find_search *s);
bool find_search_likely(const struct find_search *s);

#endif
