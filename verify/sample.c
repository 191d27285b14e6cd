#include "sample.h"

#include <math.h>

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
static enum status tell_extent(const struct sample *s, struct errinfo *e)
{
    struct dvec3 lo = s->pts[0], hi = s->pts[0];
    const char *unit;

    for (size_t i = 1; i < s->n; i++) {
        lo = (struct dvec3){fmin(lo.x, s->pts[i].x), fmin(lo.y, s->pts[i].y),
                            fmin(lo.z, s->pts[i].z)};
        hi = (struct dvec3){fmax(hi.x, s->pts[i].x), fmax(hi.y, s->pts[i].y),
                            fmax(hi.z, s->pts[i].z)};
    }
    hi.x = (hi.x - lo.x) / s->unit_mm;
    hi.y = (hi.y - lo.y) / s->unit_mm;
    hi.z = (hi.z - lo.z) / s->unit_mm;
    unit = likely_unit(fmax(hi.x, fmax(hi.y, hi.z)), s->unit_mm);
    return errinfo_set(
        e, ST_EUNITS,
        "%.80s: the extent is %.4g x %.4g x %.4g in the units given; a face "
        "is %.0f to %.0f mm: %s%s?",
        s->name, hi.x, hi.y, hi.z, EXTENT_MIN_MM, EXTENT_MAX_MM,
        unit != NULL ? "is it " : "is it one face, and the unit right",
        unit != NULL ? unit : "");
}

enum status sample_build(const struct sample *s, struct face_work *w, struct face *out,
                         struct errinfo *e)
{
    size_t bad = 0;
    const enum status st = face_build(s->pts, s->n, w, out, &bad);

    switch (st) {
    case ST_OK:
        return st;
    case ST_ETOOFEW:
        return errinfo_set(e, st,
                           "%.80s: %zu points, fewer than %d at different places: a good "
                           "scan has 3,000 or more",
                           s->name, s->n, FACE_MIN_POINTS);
    case ST_ENOTFINITE:
        return errinfo_set(
            e, st,
            "%.80s: point %zu of %zu is not three finite numbers: leave out "
            "points without a value",
            s->name, bad + 1, s->n);
    case ST_ERANGE:
        return errinfo_set(
            e, st,
            "%.80s: point %zu of %zu has a coordinate beyond %.0f mm: is the "
            "unit right, and the origin near the face?",
            s->name, bad + 1, s->n, LATTICE_MAX / LATTICE_PER_MM);
    case ST_EDEGENERATE:
        return errinfo_set(e, st,
                           "%.80s: the %zu points lie on one line or at one place: send "
                           "points all over a face",
                           s->name, s->n);
    case ST_EUNITS:
        return tell_extent(s, e);
    case ST_ENOTFACE:
        return errinfo_set(
            e, st,
            "%.80s: the surface does not have the shape of a face: send one "
            "face seen from the front, without what is round it",
            s->name);
    case ST_EQUALITY:
        return errinfo_set(
            e, st,
            "%.80s: noise %.1f mm, %.0f %% of the outline covered, a point "
            "every %.1f mm: too noisy, or too many holes or spikes: scan "
            "again, nearer and without moving",
            s->name, out->quality.noise_mm, 100 * out->quality.coverage,
            out->quality.density_mm);
    default:
        return errinfo_set(e, st, "%.80s: %s", s->name, status_message(st));
    }
}
