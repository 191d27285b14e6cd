/* facegen.h -- parametric faces and simulated scans of them, for the demo and the tests.
 * A face is a height field z = f(x, y) in millimetres, the nose tip near the origin, z
 * towards the scanner: a smooth skull, and on it nose, orbits, brow, cheeks, lips and chin
 * from FACEGEN_PARAMS normally distributed numbers, and small bumps of its own, on the nose
 * too.  The mean is that of people, so that a learned mean face can be laid on it.
 * Everything follows from the seeds: an integer generator, no clock, no rand(). */
#ifndef SIM_FACEGEN_H
#define SIM_FACEGEN_H
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

#define FACEGEN_PARAMS 24
#define FACEGEN_BUMPS  64

struct facegen_bump {
    double x, y, sx, sy, h; /* a Gaussian hill or hollow: centre, widths, height */
};

struct facegen_face {
    double width, depth, jaw, forehead; /* the skull */
    double nose, bridge, hump, length, nose_width, side;
    struct facegen_bump bump[FACEGEN_BUMPS];
    uint32_t nbumps;
    double symmetry; /* removed share of the asymmetry; 0: none */
};

/* facegen_face(subject, smile, out): Makes the face of a subject; smile 0 (neutral) to 1. */
void facegen_face(uint64_t subject, double smile, struct facegen_face *out);

/* facegen_height(f, x, y): Returns z of the surface, in the coordinates of the head: the even part of
 * the drawn height, plus 1 - symmetry times its odd part, (f(x) - f(-x)) / 2. */
double facegen_height(const struct facegen_face *f, double x, double y);

struct facegen_scan {
    uint64_t subject, scan;  /* seeds of the person and of the scan */
    uint32_t points;         /* sampled; the scan has fewer when holes are cut out */
    double yaw, pitch, roll; /* degrees about y, x, z; centre 80 mm behind the nose */
    double tx, ty, tz;       /* then moved, mm */
    double noise;  /* white noise along z, mm; up to 2.5 times as much on steep places */
    double warp;   /* smooth depth error, mm rms */
    double holes;  /* share of the points cut out in blobs */
    double spikes; /* share of the points thrown 4 to 40 mm off */
    double smile;  /* 0 to 1 */
    double symmetry; /* facegen_face.symmetry; negative: more asymmetric than drawn */
};

/* facegen_default(s): Sets *s to a clean frontal scan of subject 0: 3,000 points, 0.12 mm of noise,
 * 0.15 mm of smooth error. */
void facegen_default(struct facegen_scan *s);

/* facegen_pose(s, degrees, mm): Draws the pose from the seeds of the scan: each angle within
 * +-degrees, each shift within +-mm. */
void facegen_pose(struct facegen_scan *s, double degrees, double mm);

/* facegen_turn(s, r): Sets r to the rotation of the pose, Rz Rx Ry. */
void facegen_turn(const struct facegen_scan *s, double r[9]);

/* facegen_sample(s, out): Samples the points that a scanner looking along -z sees, within an
 * irregular oval outline of this scan, in random order; out has capacity s->points.  Returns the
 * number of points; 0 if the pose hides nearly all of the face. */
size_t facegen_sample(const struct facegen_scan *s, struct dvec3 *out);

#endif
