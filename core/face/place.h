/* place.h -- a face laid on the mean face: its canonical frame, the size of its head, its encoding.
 * A head is taken for one of the mean face's size unless another explains much more of it. */
#ifndef CORE_PLACE_H
#define CORE_PLACE_H
#include "encode.h"
#include "face_data.h"
#include "pose.h"
#include "shape_work.h"
#include "status.h"

/* place_find(f, w): f->frame and f->encoding of f->surface, by w's model.  Returns ST_OK, ST_ENOMEM. */
enum status place_find(struct surface_face *f, struct surface_work *w);

/* place_at(f, size, w, fit): f, whose frame is known, laid on the mean face once more as if its head
 * were so large, over the mean face's.  About 0.8 ms.  Returns ST_OK, ST_ENOMEM. */
enum status place_at(const struct surface_face *f, double size, struct surface_work *w,
                     struct shape_fit *fit);

/* place_encode(f, fit, w, out): the encoding of f as fit lays it.  Returns ST_OK, ST_ENOMEM. */
enum status place_encode(const struct surface_face *f, const struct shape_fit *fit,
                         struct surface_work *w, struct encoding *out);

/* place_size(pose): the size of the head that a canonical frame takes it for. */
double place_size(const struct pose *pose);

/* place_seen(fit): the cells of the face with points; place_explained(fit): what is explained of each
 * of them, at most 1. */
double place_seen(const struct shape_fit *fit);
double place_explained(const struct shape_fit *fit);

/* place_keep(fit, out): both, with the frame that the fit leads to, for pair.h. */
void place_keep(const struct shape_fit *fit, struct frame *out);

#endif
