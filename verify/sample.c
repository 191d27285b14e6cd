#include "sample.h"

#include <math.h>

#include "cloudpoints.h"
#include "errinfo.h"
#include "face.h"
#include "lattice.h"

/* What quality_extent() takes for the extent of a face. */
#define EXTENT_MIN_MM 60.0
#define EXTENT_MAX_MM 500.0

/* The unit by which `side` units are a face's extent; NULL: none of them, or the one given. */
static const char *likely_unit(double side, double given_mm)
{
    static const struct {
        const char *name;
        double mm;
    } unit[] = {{"millimetres", 1}, {"metres", 1000}, {"centimetres", 10}};

    for (size_t i = 0; i < sizeof unit / sizeof *unit; i++)
        if (unit[i].mm != given_mm && side * unit[i].mm >= EXTENT_MIN_MM &&
            side * unit[i].mm <= EXTENT_MAX_MM)
            return unit[i].name;
    return NULL;
}

/* ST_EUNITS, with the extent in the units given and the unit that it is likely in. */
static enum status tell_extent(const char *name, const struct scan_found *f,
                               struct errinfo *e)
{
    const double *x = f->extent;
    const char *unit = likely_unit(fmax(x[0], fmax(x[1], x[2])), f->unit_mm);

    return errinfo_set(
        e, ST_EUNITS,
        "%.80s: the extent is %.4g x %.4g x %.4g in the units given; a face "
        "is %.0f to %.0f mm: %s%s?",
        name, x[0], x[1], x[2], EXTENT_MIN_MM, EXTENT_MAX_MM,
        unit != NULL ? "is it " : "is it one face, and the unit right",
        unit != NULL ? unit : "");
}

enum status sample_build(const char *name, struct cloudpoints *c,
                         const struct scan_options *o, struct face_work *w,
                         struct face *out, struct scan_found *found, struct errinfo *e)
{
    const size_t n = c->n;
    size_t bad = 0;
    const enum status st = scan_build(c, o, w, out, &bad, found);

    switch (st) {
    case ST_OK:
        return st;
    case ST_ETOOFEW:
        return errinfo_set(e, st,
                           "%.80s: %zu points, fewer than %d at different places: a good "
                           "scan has 3,000 or more",
                           name, n, FACE_MIN_POINTS);
    case ST_ENOTFINITE:
        return errinfo_set(
            e, st,
            "%.80s: point %zu of %zu is not three finite numbers: leave out "
            "points without a value",
            name, bad + 1, n);
    case ST_ERANGE:
        return errinfo_set(
            e, st,
            "%.80s: point %zu of %zu has a coordinate beyond %.0f mm: is the "
            "unit right, and the origin near the face?",
            name, bad + 1, n, LATTICE_MAX / LATTICE_PER_MM);
    case ST_EDEGENERATE:
        return errinfo_set(e, st,
                           "%.80s: the %zu points lie on one line or at one place: send "
                           "points all over a face",
                           name, n);
    case ST_EUNITS:
        return tell_extent(name, found, e);
    case ST_ENOTFACE:
        return errinfo_set(
            e, st,
            "%.80s: the surface does not have the shape of a face: send one "
            "face seen from the front, without what is round it",
            name);
    case ST_EQUALITY:
        return errinfo_set(
            e, st,
            "%.80s: noise %.1f mm, %.0f %% of the outline covered, a point "
            "every %.1f mm: too noisy, or too many holes or spikes: scan "
            "again, nearer and without moving",
            name, out->quality.noise_mm, 100 * out->quality.coverage,
            out->quality.density_mm);
    default:
        return errinfo_set(e, st, "%.80s: %s", name, status_message(st));
    }
}
