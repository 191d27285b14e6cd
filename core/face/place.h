/* place.h -- a face laid on the mean face: its canonical frame, the size of its head, its encoding.
 * A head is taken for one of the mean face's size unless another explains much more of it. */
#ifndef CORE_PLACE_H
#define CORE_PLACE_H
#include "encode.h"
#include "face_data.h"
#include "pose.h"
#include "shape_work.h"
#include "status.h"

/* place_find(f, w): Computes f->frame and f->encoding of f->surface, by w's model.  Returns ST_OK, ST_ENOMEM. */
enum status place_find(struct surface_face *f, struct surface_work *w);

/* place_at(f, size, w, fit): Lays f, whose frame is known, on the mean face again, as if its head had
 * this size, over the mean face's.  Cost: about 0.8 ms.  Returns ST_OK, ST_ENOMEM. */
enum status place_at(const struct surface_face *f, double size, struct surface_work *w,
                     struct shape_fit *fit);

/* place_encode(f, fit, w, out): Encodes f at the place of fit.  Returns ST_OK, ST_ENOMEM. */
enum status place_encode(const struct surface_face *f, const struct shape_fit *fit,
                         struct surface_work *w, struct encoding *out);

/* place_size(pose): Returns the size of the head that a canonical frame implies. */
double place_size(const struct pose *pose);

/* place_explained(fit): Returns the mean share, at most 1, that is explained of each cell with points. */
double place_explained(const struct shape_fit *fit);

/* place_keep(fit, out): Sets seen and explained of the frame that the fit leads to, for pair.h. */
void place_keep(const struct shape_fit *fit, struct frame *out);

#endif
