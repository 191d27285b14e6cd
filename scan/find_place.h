/* find_place.h -- the mean face laid on a place that may be the tip of a nose: every roll
 * about the direction in which it sticks out.  Internal to find.h. */
#ifndef SCAN_FIND_PLACE_H
#define SCAN_FIND_PLACE_H
#include <stdint.h>

struct find_near;  /* find_near.h */
struct find_nose;  /* find_nose.h */
struct frame_mean; /* frame.h */

#define FIND_SAMPLES 128
#define FIND_ROLLS   18

/* Samples of the mean face, from its tip, along axes of which the third is that in which the
 * nose sticks out. */
struct find_face_samples {
    double tip[3], axes[9]; /* canonical frame, mm; rows */
    uint32_t n;
    struct find_sample {
        float at[3], flat; /* mm; 1 / sqrt(1 + slope^2) */
    } sample[FIND_SAMPLES];
};

void find_place_samples(const struct frame_mean *mean, struct find_face_samples *out);

/* A starting pose: a place goes to the mean face's tip. */
struct find_place {
    float cost; /* mm, mean distance to the mean face's samples, capped */
    float r[9]; /* rotation to the canonical frame */
};

/* find_place_turn(s, near, axis, out): the rolls about axis, from some roll on. */
void find_place_turn(const struct find_face_samples *s, const struct find_near *near,
                     const float axis[3], struct find_place out[FIND_ROLLS]);

/* find_place_tilt(axis, k, out): axis, tilted to side k of FIND_TILTS. */
#define FIND_TILTS 6
void find_place_tilt(const float axis[3], int k, float out[3]);

#endif
