/* step.h -- depths that come in steps: of disparities in whole pixels (structured light, stereo), of
 * 8- or 10-bit depth images, of coarse time-of-flight cameras. */
#ifndef CORE_STEP_H
#define CORE_STEP_H
#include <stddef.h>
#include "pose.h"
#include "vec.h"

/* step_of(pts, n, view): Returns the typical distance, in mm, between neighbouring depths of a face;
 * 0 if the depths come in no steps.
 *   pts   mm, in the axes of the file: a scanner's axes, or those rotated by right angles
 *   view  pts -> canonical frame of the face, rigid; NULL: pts are of a face alone, and z is the depth
 * A depth is the coordinate along that axis of pts which the face looks along.  Sorted, the depths of
 * a continuous surface are n / range apart, and those in steps lie in a few heaps: the step is the mean
 * gap at a random depth in the middle half of the range, and is one if it is many times larger than
 * it would be without heaps.  So noise that is small against the step does not hide it, and a step that
 * grows with the distance is that at the face.
 * A turn of the cloud by other angles hides the steps.
 * Cost: O(n); 64 KB of stack. */
double step_of(const struct dvec3 *pts, size_t n, const struct pose *view);

#endif
