#include "minimal.h"

#include <string.h>

#include "measure.h"

enum status minimal_find(const struct surface *tmpl, const struct surface *probe,
                         const double transform[16], struct measure_work *w,
                         struct minimal *out)
{
    memset(out, 0, sizeof *out);
    memcpy(out->transform, transform, sizeof out->transform);
    return measure_at(tmpl, probe, transform, NULL, w, &out->disparity);
}
