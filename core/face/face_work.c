#include "face_work.h"

void face_work_exchange(struct surface_work *w)
{
    const struct scratch block = w->measure.scratch;

    w->measure.scratch = w->align.field;
    w->align.field = block;
}

void face_work_lend(struct surface_work *w)
{
    const struct scratch block = w->measure.scratch;

    w->measure.scratch = w->shape.points;
    w->shape.points = block;
}
