#include "clouddepth.h"

#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"
#include "errinfo.h"

static double value_mm(double scale)
{
    if (scale == 0)
        return 1;
    return scale >= 100 ? 1000 / scale : scale <= 0.01 ? 1000 * scale : scale;
}

enum status clouddepth_begin(struct clouddepth *d, const struct clouddepth_camera *camera,
                             uint32_t width, uint32_t height, struct cloudlist *list)
{
    const struct clouddepth_camera *c = camera;

    *d = (struct clouddepth){.camera = c, .list = list, .mm = value_mm(c->scale)};
    if (!(c->fx > 0) || !(c->fy > 0) || isnan(c->cx) || isnan(c->cy))
        return errinfo_set(list->e, ST_EVERSION,
                           "a depth image needs its camera: fx, fy, cx and cy in pixels, "
                           "and depth_scale if a value is not a millimetre");
    list->out.unit_mm = 1;
    list->out.width = width;
    list->out.height = height;
    return ST_OK;
}

enum status clouddepth_add(struct clouddepth *d, double value)
{
    const struct clouddepth_camera *c = d->camera;
    const double z = value > 0 ? d->mm * value : (double)NAN;
    const struct dvec3 p = {(d->u - c->cx) * z / c->fx, (c->cy - d->v) * z / c->fy, -z};

    if (++d->u == d->list->out.width) {
        d->u = 0;
        d->v++;
    }
    return cloudlist_add(d->list, p);
}

enum status clouddepth_values(struct cloudtext *t, const struct clouddepth_camera *camera,
                              uint32_t width, uint32_t height, bool big,
                              struct cloudlist *list)
{
    const uint64_t size = 2 * (uint64_t)width * height;
    const bool swap = cloudvalue_swap(big);
    struct clouddepth depth;
    enum status st;

    t->line = 0;
    if (size != (uint64_t)(t->end - t->p))
        return cloudtext_fail(
            t, ST_EINVAL,
            "%lu x %lu pixels of 16 bits take %llu bytes, from here on the file has %zu",
            (unsigned long)width, (unsigned long)height, (unsigned long long)size,
            (size_t)(t->end - t->p));
    st = clouddepth_begin(&depth, camera, width, height, list);
    for (; t->p < t->end && st == ST_OK; t->p += 2)
        st = clouddepth_add(
            &depth, cloudvalue_load((const unsigned char *)t->p, CLOUDVALUE_U16, swap));
    return st;
}
