#include "clouddepth.h"

#include <string.h>

#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"
#include "errinfo.h"
#include "number.h"

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
                           "a depth image needs its camera: fx, fy, cx and cy in "
                           "pixels, and depth_scale if its unit is not a millimetre");
    list->out.unit_mm = 1;
    list->out.width = width;
    list->out.height = height;
    list->out.pinhole = true;
    list->out.value_mm = d->mm;
    return ST_OK;
}

enum status clouddepth_add(struct clouddepth *d, double value)
{
    const struct clouddepth_camera *c = d->camera;
    const double z = value > 0 && value != CLOUDDEPTH_NONE ? d->mm * value : (double)NAN;
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

/* ---- a camera from text */

static bool is_side(double v)
{
    return v >= 1 && v <= CLOUDDEPTH_SIDE_MAX && v == floor(v);
}

bool clouddepth_camera_read(const char *text, struct clouddepth_camera *c)
{
    double v[7] = {0};
    const char *const end = text + strlen(text);
    int n = 0;

    do {
        if (n == 7 || (text = number_read(text, end, &v[n])) == NULL || !isfinite(v[n]))
            return false;
        n++;
    } while (*text++ == ',');
    if (text - 1 != end || n < 4 || n == 6 || !(v[0] > 0) || !(v[1] > 0) ||
        (n > 4 && !(v[4] > 0)) || (n > 5 && !(is_side(v[5]) && is_side(v[6]))))
        return false;
    *c = (struct clouddepth_camera){v[0], v[1],           v[2],          v[3],
                                    v[4], (uint32_t)v[5], (uint32_t)v[6]};
    return true;
}
