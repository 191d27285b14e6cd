#include "advice.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

#include "cloudunit.h"
#include "cloudfile.h"

#define NEARLY_A_FACE    0.5 /* of the support that is wanted */
#define ON_ITS_SIDE_DEG  45  /* a head is not tilted so far */
#define HALF_PROFILE_DEG 55  /* beyond it less than half of a face is seen */

__attribute__((format(printf, 2, 3))) static void add(struct advice *a, const char *fmt,
                                                      ...)
{
    va_list ap;

    if (a->n == ADVICE_LINES)
        return;
    va_start(ap, fmt);
    (void)vsnprintf(a->line[a->n++], ADVICE_MAX, fmt, ap);
    va_end(ap);
}

__attribute__((format(printf, 2, 3))) static void note(struct advice *a, const char *fmt,
                                                       ...)
{
    va_list ap;

    va_start(ap, fmt);
    (void)vsnprintf(a->note[a->nnote++], ADVICE_MAX, fmt, ap);
    va_end(ap);
}

static bool warns(const struct surface_found *f, enum surface_warning k)
{
    return (f->warnings >> k & 1) != 0;
}

/* The unit by which the longest side is as long as a face's; 0: none of them, or `but`. */
static double unit_of(const struct surface_found *f, double but)
{
    static const double mm[] = {1, 1000, 10, 25.4, 0.001};
    const double side = fmax(f->extent[0], fmax(f->extent[1], f->extent[2]));

    for (size_t i = 0; i < sizeof mm / sizeof *mm; i++)
        if (mm[i] != but && side * mm[i] >= SURFACE_EXTENT_MIN_MM &&
            side * mm[i] <= SURFACE_EXTENT_MAX_MM)
            return mm[i];
    return 0;
}

double advice_round(double v)
{
    const double step = pow(10, floor(log10(v)) - 1);

    return rint(v / step) * step;
}

static void unit(const struct surface_found *f, struct advice *a)
{
    const double likely = unit_of(f, f->unit_mm);

    if (f->fits_mm > 0 && f->unit_found)
        add(a, "send it in one of the units: mm, cm, m, in or um");
    else if (f->fits_mm > 0) /* below 0.01 it would be metres (clouddepth.h) */
        add(a, "give depth_scale=%.7g",
            advice_round(f->fits_mm <= 0.01 ? 1000 / f->fits_mm : f->fits_mm));
    else if (likely != 0)
        add(a, "is it %s? Give the unit%s", cloudunit_plural(likely),
            f->unit_found ? "" : ", or use auto");
    else
        add(a, "is it one face, and the unit right?");
}

/* The reasons that have nothing but the status to tell them by. */
static void reason(enum status st, const struct surface_found *f, struct advice *a)
{
    switch (st) {
    case ST_ELIMIT:
        add(a, "let the scanner measure fewer points: %d are read at most",
            CLOUDFILE_POINTS);
        break;
    case ST_ETOOFEW:
        add(a,
            "move nearer to the scanner, or let it measure more points: a good scan has "
            "3,000 or more");
        break;
    case ST_ENOTFINITE:
        add(a, "leave out points without a value");
        break;
    case ST_ERANGE:
        add(a, "is the unit right, and the origin near the face?");
        break;
    case ST_EDEGENERATE:
        add(a, "send points all over a face");
        break;
    case ST_EUNITS:
        unit(f, a);
        break;
    case ST_ENOFACE:
        add(a,
            "let the scanner see the whole face, from the front or turned by up to %d°",
            HALF_PROFILE_DEG);
        break;
    case ST_ENOTFACE:
        add(a, "send one face seen from the front, with forehead, nose and chin");
        break;
    default:
        break;
    }
}

/* "turn the head ...: 38° to the left now". */
static void turned(const struct surface_found *f, struct advice *a)
{
    const double tilt = f->roll_deg - 90 * rint(f->roll_deg / 90);

    if (fabs(f->yaw_deg) > SURFACE_YAW_DEG)
        add(a,
            "turn the head towards the scanner: %.0f° to the %s now, up to %d° for "
            "enrolment",
            fabs(f->yaw_deg), f->yaw_deg > 0 ? "left" : "right", SURFACE_YAW_DEG);
    if (fabs(f->pitch_deg) > SURFACE_TILT_DEG)
        add(a, "%s the chin: the face looks %.0f° %s now, up to %d° is good",
            f->pitch_deg > 0 ? "lower" : "raise", fabs(f->pitch_deg),
            f->pitch_deg > 0 ? "up" : "down", SURFACE_TILT_DEG);
    if (fabs(tilt) > SURFACE_TILT_DEG)
        add(a, "hold the head upright: tilted by %.0f° to the %s now, up to %d° is good",
            fabs(tilt), tilt > 0 ? "right" : "left", SURFACE_TILT_DEG);
}

/* Returns true if so little of a face is seen because its points are too far apart. */
static bool too_sparse(enum status st, const struct surface_found *f)
{
    return st == ST_EQUALITY && f->seen < f->seen_wanted &&
           f->quality.density_mm > SURFACE_SPARSE_MM;
}

static void found(enum status st, const struct surface_found *f, struct advice *a)
{
    if (st == ST_ESEVERAL || warns(f, SURFACE_SEVERAL))
        add(a, "let only one person be in view: %u faces were found%s",
            (unsigned)f->faces, st == ST_OK ? ", the nearest was used" : "");
    if (st == ST_EMIRRORED || warns(f, SURFACE_MIRRORED))
        add(a,
            "the scan seems to be a mirror image: switch mirroring off where it was made");
    if (warns(f, SURFACE_OCCLUDED))
        add(a,
            "take off glasses or mask, keep hair and hands away: %.0f %% of the face is "
            "covered",
            100 * f->occluded);
    if (st == ST_EQUALITY && f->seen < f->seen_wanted && !too_sparse(st, f))
        add(a, "let the scanner see all of the face: %.0f %% of it now, %.0f %% at least",
            100 * f->seen, 100 * f->seen_wanted);
    if (st == ST_EQUALITY && f->residual_mm > f->residual_most)
        add(a, "move nearer, hold still, and let the scanner average several frames: the "
               "scan is too noisy to tell people apart");
    if (warns(f, SURFACE_STEPPED))
        add(a,
            "use a finer depth mode, move nearer, or let the scanner average several frames: "
            "its depths are %.1f mm apart, %.1f mm or less is good",
            f->step_mm, SURFACE_STEP_MM);
    if (warns(f, SURFACE_FOCAL))
        add(a,
            "check fx and fy: the face is too %s for its depth, as if they should be %.2f times "
            "those given or %s",
            f->focal_times > 1 ? "wide" : "narrow", f->focal_times,
            f->focal_times > 1 ? "more" : "less");
    if (warns(f, SURFACE_TURNED))
        turned(f, a);
    if (st == ST_OK && warns(f, SURFACE_BEHIND))
        note(a, "%.0f %% of the points are outside the face and were ignored",
             100 * f->elsewhere);
    if (st == ST_OK && fabs(f->roll_deg) > ON_ITS_SIDE_DEG)
        note(
            a,
            "the picture is turned by %.0f°: hold the scanner upright, or turn its pictures",
            fabs(f->roll_deg));
    if (st == ST_OK && f->unit_found && f->unit_mm != 1)
        note(a, "detected %s; units=%s skips the detection", cloudunit_plural(f->unit_mm),
             cloudunit_name(f->unit_mm));
}

/* Returns true if a surface that is not a face may be part of one, so that its other findings hold.  On an egg or
 * a ball the model lies best if it looks far up or down. */
static bool nearly_a_face(const struct surface_found *f)
{
    return f->support > NEARLY_A_FACE * f->support_wanted &&
           !(warns(f, SURFACE_TURNED) && fabs(f->pitch_deg) > SURFACE_TILT_DEG);
}

static void sparse(const struct surface_found *f, struct advice *a)
{
    add(a,
        "move nearer to the scanner: a point every %.1f mm now, every %.1f mm or less is good",
        f->quality.density_mm, SURFACE_SPARSE_MM);
}

static void quality(enum status st, const struct surface_found *f,
                    const struct surface_face *face, struct advice *a)
{
    const struct surface_quality *q = &f->quality;
    const uint32_t bits = surface_quality_reasons(q, face);

    if ((bits & 1U << SURFACE_NOISY) != 0 && !warns(f, SURFACE_STEPPED))
        add(a, "hold still and scan again: the noise is %.1f mm, %.1f mm or less is good",
            q->noise_mm, SURFACE_NOISY_MM);
    if ((bits & 1U << SURFACE_SPARSE) != 0 && !too_sparse(st, f))
        sparse(f, a);
    if ((bits & 1U << SURFACE_INCOMPLETE) != 0)
        add(a, "let the scanner see all of the face: %.0f %% of its outline was measured",
            100 * q->coverage);
    if ((bits & 1U << SURFACE_OBLIQUE) != 0 && !warns(f, SURFACE_TURNED))
        add(a, "face the scanner: the head is turned away from it");
}

void advice_give(enum status st, const struct surface_found *f,
                 const struct surface_face *face, struct advice *out)
{
    out->n = out->nnote = 0;
    if (too_sparse(st, f))
        sparse(f, out);
    if (f->fits_mm == 0 && (st != ST_ENOTFACE || nearly_a_face(f)))
        found(st, f, out); /* else it was found in something else */
    reason(st, f, out);
    if (f->quality.density_mm > 0 && (st == ST_OK || st == ST_EQUALITY))
        quality(st, f, st == ST_OK ? face : NULL, out);
    if (st == ST_EQUALITY && out->n == 0)
        add(out, "scan again, nearer and without moving");
}
